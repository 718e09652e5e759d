// Parts of a study file that several readers need.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "scenarios/document.hpp"
#include "scenarios/loader.hpp"
#include "scenarios/reading.hpp"

namespace hearsay {

/// A number, string or boolean. @throws InputError for anything else.
Value read_value(const TomlNode& node, const KeyPath& path);

/// A table of axis = value or axis = [values]. Values become the axis's own labels.
/// @throws InputError for an axis or value that the study does not have.
Where read_where(const TomlNode& node, const KeyPath& path, const Study& study);
/// One axis = value of such a table.
std::vector<Value> read_labels(const TomlNode& node, const KeyPath& path, const Study& study);

/// What claims may refer to.
struct ClaimContext {
  const Study& study;
  const std::vector<Cell>& cells;
  const std::vector<std::string>& agent_names;
  const KnownNames& names;
};
/// [[claims]].
std::vector<Claim> read_claims(const TomlNode& node, const KeyPath& path,
                               const ClaimContext& context);

}  // namespace hearsay
