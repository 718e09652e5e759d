// What must fit together in floors, and in agents that forage on them.
#include <algorithm>
#include <string>

#include "scenarios/plans.hpp"
#include "scenarios/scenario_under_check.hpp"

namespace hearsay {

void check_foragers(ScenarioUnderCheck& file) { take_plan(file); }

}  // namespace hearsay
