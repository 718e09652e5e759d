#include "scenarios/network.hpp"

#include <limits>
#include <utility>

namespace hearsay {

Topology topology_of(const Scenario& scenario, const Places& places) {
  const RadioSpec& radio = scenario.radio;
  const int agents = scenario.agent_count();
  if (radio.topology == "line") return Topology::line(agents);
  if (radio.topology == "ring") return Topology::ring(agents);
  if (radio.topology == "star") return Topology::star(agents);
  if (radio.topology == "full") return Topology::full(agents);
  if (radio.topology == "edges") {
    std::vector<std::pair<AgentId, AgentId>> edges;
    for (const auto& [a, b] : radio.edges) edges.emplace_back(a, b);
    return Topology::edges(agents, edges);
  }
  std::vector<std::array<double, 3>> positions;
  for (const auto& place : places) positions.push_back({place.value()[0], place.value()[1], 0.0});
  return Topology::disk(positions, radio.range_m);
}

RadioOptions radio_options(const RadioSpec& spec) {
  return {.rate_bps = spec.rate_bps,
          .header_bytes = static_cast<std::uint32_t>(spec.header_bytes),
          .queue = {.packets_max = static_cast<std::uint32_t>(spec.queue_packets_max)},
          .latency = Duration::seconds(spec.latency_s),
          .loss = spec.loss.model == "bernoulli" ? Loss::bernoulli(spec.loss.probability) : Loss(),
          .propagation_m_per_s =
              spec.propagation_m_per_s.value_or(std::numeric_limits<double>::infinity())};
}

}  // namespace hearsay
