#include "scenarios/scenario.hpp"

#include <cstddef>

#include "sim/math/functions.hpp"

namespace hearsay {

int Scenario::agent_count() const {
  int count = 0;
  for (const AgentSpec& agent : agents) count += agent.count;
  return count;
}

std::vector<std::string> agent_names(const Scenario& scenario) {
  std::vector<std::string> names;
  for (const AgentSpec& agent : scenario.agents) {
    for (int k = 0; k < agent.count; ++k) {
      if (agent.name.empty()) {
        names.push_back(agent.kind + std::to_string(names.size()));
      } else {
        names.push_back(agent.count == 1 ? agent.name : agent.name + std::to_string(k));
      }
    }
  }
  return names;
}

std::vector<std::optional<std::array<double, 2>>> agent_positions(const Scenario& scenario) {
  std::vector<std::optional<std::array<double, 2>>> positions;
  for (const AgentSpec& agent : scenario.agents) {
    for (int k = 0; k < agent.count; ++k) {
      auto& position = positions.emplace_back();
      if (agent.position_m) {
        position = {agent.position_m->at(0), agent.position_m->at(1)};
      } else if (agent.circle) {
        const CircleSpec& circle = *agent.circle;
        const double angle_rad = 2.0 * math::pi * k / agent.count;
        position = {circle.center_m.at(0) + circle.radius_m * math::cos(angle_rad),
                    circle.center_m.at(1) + circle.radius_m * math::sin(angle_rad)};
      }
    }
  }
  return positions;
}

}  // namespace hearsay
