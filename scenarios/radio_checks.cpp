#include <string>

#include "scenarios/scenario_under_check.hpp"

namespace hearsay {

void check_radio(ScenarioUnderCheck& file) {
  const KeyPath top;
  const KeyPath path = top["radio"];
  const RadioSpec& radio = file.scenario.radio;
  check_transmitter(file);
  check_channel(file);
  check_links(file);
  const bool placed_agents = radio.topology == "disk" || radio.topology == "by-position";
  if (radio.propagation_m_per_s && !placed_agents && radio.topology != "random-geometric") {
    file.fail(path["propagation_m_per_s"],
              "only for topology = \"disk\", \"by-position\" or \"random-geometric\", which "
              "know how long links are; found \"" +
                  radio.topology + "\"");
  }
  if (!placed_agents && radio.jammers.empty()) return;
  const std::string who = placed_agents ? "topology = \"" + radio.topology + "\"" : "a jammer";
  for (std::size_t i = 0; i < file.scenario.agents.size(); ++i) {
    if (has_place(file.scenario.agents[i])) continue;
    file.fail(top["agents"][i],
              who + " needs to know where it stands: position_m, circle or motion");
  }
}

}  // namespace hearsay
