// The floor that a scenario names: a drawing in text or a bitmap, with places of the scenario's
// own.
#pragma once

#include "scenarios/scenario_under_check.hpp"

namespace hearsay {

/// Reads world.plan.file, if there is a plan, into world.plan.plan, and adds the places.
/// @throws InputError "corridor.txt:3: …" for what plan::read_text() and plan::read_png() refuse,
/// and with the key for a file that is not there, and for places without name or position, twice
/// there, or in a wall.
void take_plan(ScenarioUnderCheck& file);

}  // namespace hearsay
