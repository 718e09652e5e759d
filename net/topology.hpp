// Who can hear whom: a static graph over n radios. If a hears b, b hears a.
//
// Built by name (line, ring, star, binary tree, grid, full), from a list of edges, or from
// positions and a range; graphs that are drawn at random are in random_graphs.hpp. Neighbours are
// held in one array (compressed rows), sorted by number, so a broadcast costs its number of
// hearers.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "sim/kernel/ids.hpp"

namespace hearsay {

class Topology {
 public:
  // Each of these throws InputError if there is not at least one agent.

  /// 0–1–2–…–(n−1).
  static Topology line(int agents);
  /// A line whose ends are joined; n = 2 is one edge, n = 1 none.
  static Topology ring(int agents);
  /// Agent 0 in the middle.
  static Topology star(int agents);
  static Topology full(int agents);
  /// Agent 0 is the root; the parent of agent i > 0 is (i − 1) / 2, rounded down.
  static Topology binary_tree(int agents);
  /// Rows of `columns` agents each, numbered row by row; the last row may be shorter. Neighbours
  /// are those left, right, above and below. @throws InputError unless 1 ≤ columns ≤ agents.
  static Topology grid(int agents, int columns);
  /// Undirected edges; duplicates count once. @throws InputError for an agent outside 0 … n−1 or an
  /// edge from an agent to itself (message names the edge).
  static Topology edges(int agents, std::span<const std::pair<AgentId, AgentId>> edges);
  /// Everybody within `range_m` (inclusive, in three dimensions) hears; agent i is at
  /// positions_m[i]. Neighbours are found through a square grid in x and y.
  /// @throws InputError unless 0 < range_m < ∞ and every coordinate is within ±1e12 m.
  static Topology disk(std::span<const std::array<double, 3>> positions_m, double range_m);

  int agents() const { return static_cast<int>(first_.size()) - 1; }
  /// Who hears `agent` (0 … n−1), in order of number.
  std::span<const AgentId> neighbours(AgentId agent) const {
    const auto a = static_cast<std::size_t>(agent);
    return std::span(neighbour_).subspan(first_[a], first_[a + 1] - first_[a]);
  }
  /// Position of the directed link from→to among all links, 0 … links()−1; −1 if there is none.
  std::int64_t link(AgentId from, AgentId to) const;
  /// Position of `from`'s first link: the link to neighbours(from)[i] is first_link(from) + i.
  std::size_t first_link(AgentId from) const { return first_[static_cast<std::size_t>(from)]; }
  /// Number of directed links: each edge is two.
  std::size_t links() const { return neighbour_.size(); }
  /// True if it was built from positions, so that links have lengths.
  bool has_lengths() const { return placed_; }
  /// Distance between the ends of a link, 0 … links()−1, in m; 0 without positions.
  double length_m(std::size_t link) const { return placed_ ? length_m_[link] : 0.0; }
  /// True if every two agents are joined by a path.
  bool is_connected() const;
  /// True if every two agents are joined by exactly one path.
  bool is_tree() const;

 private:
  explicit Topology(std::vector<std::vector<AgentId>> lists);
  std::vector<std::size_t> first_;  // row starts, n + 1 of them
  std::vector<AgentId> neighbour_;
  bool placed_ = false;
  std::vector<double> length_m_;  // a link, if placed
};

}  // namespace hearsay
