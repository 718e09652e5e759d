// What must fit together in sensors that look from a place.
#include <string>

#include "scenarios/scenario_under_check.hpp"

namespace hearsay {
namespace {

void check_camera(const ScenarioUnderCheck& file, const AgentSpec& agent, const KeyPath& path) {
  if (!agent.motion || agent.motion->altitude_m <= 0.0) {
    file.fail(path["kind"],
              "\"camera\" needs to know how high over the ground (z = 0) the agent flies, as "
              "motion = { kind = \"hover\", altitude_m = 40 }");
  }
}

}  // namespace

void check_sensors(const ScenarioUnderCheck& file) {
  const KeyPath top;
  const KeyPath agents = top["agents"];
  for (std::size_t i = 0; i < file.scenario.agents.size(); ++i) {
    const AgentSpec& agent = file.scenario.agents[i];
    const std::string& kind = agent.sensor.kind;
    if (kind != "camera" && kind != "range-bearing") continue;
    const KeyPath entry = agents[i];
    const KeyPath path = entry["sensor"];
    if (file.scenario.world.targets.empty()) {
      file.fail(path["kind"], "\"" + kind + "\" needs at least one target in world.targets");
    }
    if (kind == "camera") check_camera(file, agent, path);
    if (!has_place(agent)) {
      file.fail(path["kind"], "\"" + kind +
                                  "\" needs to know where the agent stands: position_m, circle "
                                  "or motion");
    }
  }
}

}  // namespace hearsay
