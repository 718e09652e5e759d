// Axis labels and names as text that can be compared.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scenarios/study.hpp"

namespace hearsay::analysis {

/// Axis → label of a cell, in axis order, labels as label_text() gives them.
using Labels = std::vector<std::pair<std::string, std::string>>;

/// One spelling for equal labels, whether they come from a study file or from a database:
/// ring, 0.1, 1 (also for 1.0), true.
std::string label_text(const Value& value);
/// The same from the text of a JSON scalar or a bare text: "\"ring\"", "ring", "1.0".
std::string stored_label_text(std::string_view stored);

/// "topology=ring loss=0.1"; nothing for no labels.
std::string to_string(const Labels& labels);

}  // namespace hearsay::analysis
