#include <string>

#include "scenarios/scenario_under_check.hpp"

namespace hearsay {
namespace {

void resolve_edges(ScenarioUnderCheck& file, const KeyPath& radio) {
  const KeyPath edges = radio["edges"];
  for (std::size_t i = 0; i < file.scenario.radio.edges.size(); ++i) {
    const KeyPath path = edges[i];
    const TomlNode& node = file.locate(path);
    auto& [a, b] = file.scenario.radio.edges[i];
    a = file.resolve_agent(node.children[0], path, a);
    b = file.resolve_agent(node.children[1], path, b);
    if (a == b) reject(node, path, "joins an agent to itself");
  }
}

}  // namespace

void check_radio(ScenarioUnderCheck& file) {
  const KeyPath top;
  const KeyPath agents = top["agents"];
  const KeyPath path = top["radio"];
  const RadioSpec& radio = file.scenario.radio;
  check_transmitter(file);
  check_channel(file);
  if (radio.topology == "edges" && radio.edges.empty()) {
    file.fail(path["topology"], "\"edges\" needs radio.edges, as [[0, 1], [1, 2]]");
  }
  if (radio.topology != "edges" && !radio.edges.empty()) {
    file.fail(path["edges"], "only for topology = \"edges\"; found \"" + radio.topology + "\"");
  }
  resolve_edges(file, path);
  const bool knows_lengths = radio.topology == "disk" || radio.topology == "by-position";
  if (radio.propagation_m_per_s && !knows_lengths) {
    file.fail(path["propagation_m_per_s"],
              "only for topology = \"disk\" or \"by-position\", which know how long links are; "
              "found \"" +
                  radio.topology + "\"");
  }
  if (radio.topology == "disk" && radio.range_m <= 0.0) {
    file.fail(path["topology"], "\"disk\" needs radio.range_m above 0");
  }
  if (!knows_lengths && radio.jammers.empty()) return;
  const std::string who = knows_lengths ? "topology = \"" + radio.topology + "\"" : "a jammer";
  for (std::size_t i = 0; i < file.scenario.agents.size(); ++i) {
    if (placed(file.scenario.agents[i])) continue;
    file.fail(agents[i], who + " needs to know where it stands: position_m or circle");
  }
}

}  // namespace hearsay
