#include "scenarios/links.hpp"

#include <utility>

#include "net/random_graphs.hpp"
#include "scenarios/channel.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

Time at(double seconds) { return Time::at(Duration::seconds(seconds)); }
Time at(const std::optional<double>& seconds) { return seconds ? at(*seconds) : Time::never(); }

LinkCauses causes_of(const Scenario& scenario) {
  const RadioSpec& radio = scenario.radio;
  LinkCauses causes;
  for (const OutageSpec& outage : radio.outages) {
    for (const auto& [a, b] : outage.links) {
      causes.outages.push_back({a, b, at(outage.down_s), at(outage.up_s)});
    }
  }
  for (const PartitionSpec& partition : radio.partitions) {
    causes.partitions.push_back({partition.groups, at(partition.from_s), at(partition.until_s)});
  }
  if (!radio.rotation) return causes;
  const RotationSpec& rotation = *radio.rotation;
  const double until_s = rotation.until_s.value_or(scenario.duration_s.value_or(0.0));
  // One that would begin after the run never does.
  if (until_s <= rotation.from_s) return causes;
  const double period_s = rotation.period_s.value_or(0.0);
  causes.rotations.push_back({.groups = rotation.groups,
                              .period = Duration::seconds(period_s),
                              .cut = Duration::seconds(rotation.cut_s.value_or(period_s)),
                              .from = at(rotation.from_s),
                              .until = at(until_s)});
  return causes;
}

}  // namespace

std::vector<Point> positions_of(const AgentPlaces& places) {
  std::vector<Point> positions;
  for (const auto& place : places) {
    if (!place) return {};
    positions.push_back({(*place)[0], (*place)[1], 0.0});
  }
  return positions;
}

bool is_drawn(const RadioSpec& radio) {
  return radio.topology == "erdos-renyi" || radio.topology == "small-world" ||
         radio.topology == "random-geometric";
}

Topology topology_of(const Scenario& scenario, const AgentPlaces& places, std::uint64_t seed) {
  const RadioSpec& radio = scenario.radio;
  const int agents = scenario.agent_count();
  if (radio.topology == "line") return Topology::line(agents);
  if (radio.topology == "ring") return Topology::ring(agents);
  if (radio.topology == "star") return Topology::star(agents);
  if (radio.topology == "full") return Topology::full(agents);
  if (radio.topology == "binary-tree") return Topology::binary_tree(agents);
  if (radio.topology == "grid") return Topology::grid(agents, radio.columns.value());
  if (radio.topology == "erdos-renyi") {
    return erdos_renyi(agents, radio.link_probability.value(), seed);
  }
  if (radio.topology == "small-world") {
    return small_world(agents,
                       {.mean_degree = radio.mean_degree.value(),
                        .rewire_probability = radio.rewire_probability.value()},
                       seed);
  }
  if (radio.topology == "random-geometric") {
    return random_geometric(agents, {.side_m = radio.side_m.value(), .range_m = radio.range_m},
                            seed)
        .topology;
  }
  if (radio.topology == "edges") {
    std::vector<std::pair<AgentId, AgentId>> edges;
    for (const auto& [a, b] : radio.edges) edges.emplace_back(a, b);
    return Topology::edges(agents, edges);
  }
  if (radio.topology == "contacts") return plan_contacts(agents, *radio.contact_trace, {}).topology;
  return Topology::disk(positions_of(places), propagation_of(radio).reach_m());
}

Topology topology_of(const Scenario& scenario, const AgentPlaces& places) {
  return topology_of(scenario, places, scenario.seed);
}

LinkPlan make_link_plan(const Scenario& scenario, const AgentPlaces& places, std::uint64_t seed) {
  const LinkCauses causes = causes_of(scenario);
  try {
    if (scenario.radio.topology == "contacts") {
      return plan_contacts(scenario.agent_count(), *scenario.radio.contact_trace, causes);
    }
    return plan_links(topology_of(scenario, places, seed), causes);
  } catch (const InputError& error) {
    throw InputError(scenario.file, 0, error.what());
  }
}

}  // namespace hearsay
