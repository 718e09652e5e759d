// Graphs that are drawn at random: who can hear whom, as a function of a seed.
//
// Draws are keyed by agents, so that graphs can be compared: with more agents those that were there
// before keep their links (Erdős–Rényi) or their places (random geometric), and a larger link
// probability or range only adds links.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "net/topology.hpp"

namespace hearsay {

/// G(n, p) of Erdős, Rényi and Gilbert (1959): each pair is joined with `link_probability`,
/// independently. Takes time ∝ n².
/// @throws InputError unless 1 ≤ agents ≤ 30,000 and 0 ≤ link_probability ≤ 1.
Topology erdos_renyi(int agents, double link_probability, std::uint64_t seed);
inline constexpr int erdos_renyi_agents_max = 30'000;

/// The small world of Watts and Strogatz (Nature 393, 1998). On a ring, each agent is joined to the
/// mean_degree / 2 next ones on either side. Then each link, going round once for the next ones,
/// once for those after them and so on, is rewired with `rewire_probability`: the agent whose turn
/// it is keeps it, and its far end moves to one drawn among all who are not neighbours of that
/// agent.
struct SmallWorld {
  int mean_degree = 4;              ///< even, 0 … n − 1
  double rewire_probability = 0.1;  ///< 0 … 1
};
/// @throws InputError for a parameter outside its range.
Topology small_world(int agents, const SmallWorld& options, std::uint64_t seed);

/// Agents at independent places, uniform in a square, with a disk around each (Gilbert, 1961).
struct RandomGeometric {
  double side_m = 1000.0;  ///< of the square with corners (0, 0) and (side, side); > 0
  double range_m = 250.0;  ///< who is no farther hears; > 0
};
struct PlacedGraph {
  Topology topology;                               ///< its links have lengths
  std::vector<std::array<double, 3>> positions_m;  ///< of each agent; z = 0
};
/// @throws InputError for a parameter outside its range, or a side beyond 1e12 m.
PlacedGraph random_geometric(int agents, const RandomGeometric& options, std::uint64_t seed);

}  // namespace hearsay
