// What must fit together in a scenario whose fields are each in order.
#pragma once

#include "scenarios/document.hpp"
#include "scenarios/scenario.hpp"

namespace hearsay {

/// Checks combinations, and fills in what follows from others: names of targets, numbers of agents
/// in edges. `root` is what `scenario` was read from, for the lines in messages.
/// @throws InputError.
void finish(const TomlNode& root, Scenario& scenario);

}  // namespace hearsay
