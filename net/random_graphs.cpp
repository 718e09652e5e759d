#include "net/random_graphs.hpp"

#include <algorithm>
#include <sstream>
#include <string>
#include <utility>

#include "sim/kernel/error.hpp"
#include "sim/kernel/random.hpp"

namespace hearsay {
namespace {

using Edges = std::vector<std::pair<AgentId, AgentId>>;
using Lists = std::vector<std::vector<AgentId>>;

void require_probability(double p, const char* name) {
  if (p >= 0.0 && p <= 1.0) return;
  std::ostringstream text;
  text << name << " must be between 0 and 1, not " << p;
  throw InputError(text.str());
}

void insert(std::vector<AgentId>& sorted, AgentId agent) {
  sorted.insert(std::lower_bound(sorted.begin(), sorted.end(), agent), agent);
}

void erase(std::vector<AgentId>& sorted, AgentId agent) {
  sorted.erase(std::lower_bound(sorted.begin(), sorted.end(), agent));
}

// Moves the far end of the link between `from` and `to`, unless everybody is a neighbour already.
void rewire(Lists& lists, AgentId from, AgentId to, Stream& stream) {
  auto& row = lists[static_cast<std::size_t>(from)];
  const std::size_t strangers = lists.size() - 1 - row.size();
  if (strangers == 0) return;
  // The drawn one among the strangers: of all agents, `from` and its neighbours are passed over.
  auto other = static_cast<AgentId>(stream.below(strangers));
  insert(row, from);
  for (const AgentId known : row) {
    if (known <= other) ++other;
  }
  erase(row, from);
  erase(row, to);
  erase(lists[static_cast<std::size_t>(to)], from);
  insert(row, other);
  insert(lists[static_cast<std::size_t>(other)], from);
}

}  // namespace

Topology erdos_renyi(int agents, double link_probability, std::uint64_t seed) {
  require_probability(link_probability, "link_probability");
  if (agents > erdos_renyi_agents_max) {
    throw InputError("an Erdős–Rényi graph has at most " + std::to_string(erdos_renyi_agents_max) +
                     " agents, not " + std::to_string(agents));
  }
  Edges edges;
  for (AgentId b = 1; b < agents; ++b) {
    Stream row(seed, Purpose("erdos-renyi"), Entity::agent(b));
    for (AgentId a = 0; a < b; ++a) {
      if (row.bernoulli(link_probability)) edges.emplace_back(a, b);
    }
  }
  return Topology::edges(agents, edges);
}

Topology small_world(int agents, const SmallWorld& options, std::uint64_t seed) {
  require_probability(options.rewire_probability, "rewire_probability");
  const int half = options.mean_degree / 2;
  if (options.mean_degree < 0 || options.mean_degree % 2 != 0 || options.mean_degree >= agents) {
    throw InputError("mean_degree must be even and below the number of agents (" +
                     std::to_string(agents) + "), not " + std::to_string(options.mean_degree));
  }
  Lists lists(static_cast<std::size_t>(agents));
  const auto after = [agents](AgentId a, int places) {
    return static_cast<AgentId>((std::int64_t{a} + places) % agents);
  };
  for (int places = 1; places <= half; ++places) {
    for (AgentId a = 0; a < agents; ++a) {
      const AgentId b = after(a, places);
      insert(lists[static_cast<std::size_t>(a)], b);
      insert(lists[static_cast<std::size_t>(b)], a);
    }
  }
  for (int places = 1; places <= half; ++places) {
    for (AgentId a = 0; a < agents; ++a) {
      Stream stream = Stream::at(seed, Purpose("small-world"), Entity::agent(a),
                                 static_cast<std::uint64_t>(places));
      if (stream.bernoulli(options.rewire_probability)) {
        rewire(lists, a, after(a, places), stream);
      }
    }
  }
  Edges edges;
  for (AgentId a = 0; a < agents; ++a) {
    for (const AgentId b : lists[static_cast<std::size_t>(a)]) {
      if (a < b) edges.emplace_back(a, b);
    }
  }
  return Topology::edges(agents, edges);
}

PlacedGraph random_geometric(int agents, const RandomGeometric& options, std::uint64_t seed) {
  if (!(options.side_m > 0.0 && options.side_m <= 1e12)) {
    std::ostringstream text;
    text << "side_m must be positive and at most 1e12, not " << options.side_m;
    throw InputError(text.str());
  }
  std::vector<std::array<double, 3>> positions_m;
  for (AgentId a = 0; a < agents; ++a) {
    Stream stream(seed, Purpose("random-geometric"), Entity::agent(a));
    const double x_m = stream.uniform(0.0, options.side_m);
    const double y_m = stream.uniform(0.0, options.side_m);
    positions_m.push_back({x_m, y_m, 0.0});
  }
  Topology topology = Topology::disk(positions_m, options.range_m);
  return {std::move(topology), std::move(positions_m)};
}

}  // namespace hearsay
