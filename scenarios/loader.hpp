// Reads scenario and study files. Every mistake is an InputError that gives file, line, key, what
// was found, what is allowed, and for an unknown key or name the nearest known one.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "scenarios/scenario.hpp"
#include "scenarios/study.hpp"

namespace hearsay {

/// Names a user's program adds to what scenario files may say.
struct KnownNames {
  std::vector<std::string> agent_kinds = {"estimator", "tracker", "localizer",
                                          "explorer",  "forager", "source"};
  std::vector<std::string> metrics;  ///< that claims and record.series may name; empty: not checked
};

/// "key=value" of --set. The value is TOML; a bare word that is not TOML is taken as a string.
/// @throws InputError naming --set.
Override parse_set(std::string_view text);

/// Reads a scenario with overrides laid over it, checks every field and all combinations.
Scenario load_scenario(const std::string& file, std::span<const Override> overrides,
                       const KnownNames& names);

/// Reads a study; checks its own fields, that axis keys exist in the schema, that claims name known
/// metrics, axes and labels, and that the scenario of every cell loads.
Study load_study(const std::string& file, const KnownNames& names,
                 std::span<const Override> overrides = {});

/// True if the file's content is a study (has a `scenario` key). @throws InputError if unreadable.
bool is_study(const std::string& file);

/// The scenario as canonical text: every field with its value, defaults included, fixed order.
std::string canonical_text(const Scenario& scenario);

}  // namespace hearsay
