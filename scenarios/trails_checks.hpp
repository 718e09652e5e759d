// What must fit together in how a forager uses trails.
#pragma once

#include "filters/trails/parameters.hpp"
#include "scenarios/scenario_under_check.hpp"

namespace hearsay {

/// As given, or as the parameter set says.
trails::Laying laying_of(const TrailsSpec& spec);
trails::Distance distance_of(const TrailsSpec& spec);

/// @throws InputError for keys that contradict each other, or are without effect beside others.
void check_trails(const ScenarioUnderCheck& file, const TrailsSpec& spec, const KeyPath& path);
/// For a robot that is carried back to its start after each event, as the key at `path` says.
/// @throws InputError if it would lay nothing.
void check_respawn(const ScenarioUnderCheck& file, const TrailsSpec& spec, const KeyPath& path);

}  // namespace hearsay
