#include "net/topology.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

using Lists = std::vector<std::vector<AgentId>>;

Lists empty_lists(int agents) {
  if (agents < 1) {
    throw InputError("a topology needs at least one agent, not " + std::to_string(agents));
  }
  return Lists(static_cast<std::size_t>(agents));
}

void join(Lists& lists, AgentId a, AgentId b) {
  lists[static_cast<std::size_t>(a)].push_back(b);
  lists[static_cast<std::size_t>(b)].push_back(a);
}

// Agents sorted by the cell of a square grid that holds them. Row and column share one number, so
// three neighbouring cells of a row are one run in the array.
class Grid {
 public:
  Grid(std::span<const std::array<double, 3>> positions_m, double range_m) {
    double min_m[2] = {positions_m[0][0], positions_m[0][1]};
    double extent_m = 0.0;
    for (std::size_t axis = 0; axis < 2; ++axis) {
      double max_m = min_m[axis];
      for (const auto& p : positions_m) {
        min_m[axis] = std::min(min_m[axis], p[axis]);
        max_m = std::max(max_m, p[axis]);
      }
      extent_m = std::max(extent_m, max_m - min_m[axis]);
    }
    // A little larger than the range, so that rounding cannot put two agents in range two cells
    // apart; and never more than 2^20 cells a side, so that a cell number is small and exact.
    const double cell_m = std::max(range_m * (1.0 + 1e-6), extent_m * 0x1p-20);
    cells_.reserve(positions_m.size());
    for (std::size_t i = 0; i < positions_m.size(); ++i) {
      const auto column = static_cast<std::uint64_t>((positions_m[i][0] - min_m[0]) / cell_m) + 1;
      const auto row = static_cast<std::uint64_t>((positions_m[i][1] - min_m[1]) / cell_m) + 1;
      cells_.push_back({(row << 32) | column, static_cast<AgentId>(i)});
    }
    cell_of_.reserve(cells_.size());
    for (const Entry& entry : cells_) cell_of_.push_back(entry.cell);
    std::sort(cells_.begin(), cells_.end(),
              [](const Entry& a, const Entry& b) { return a.cell < b.cell; });
  }

  // Calls visit(other) for everybody in the nine cells around `agent`, itself included.
  template <typename Visit>
  void around(std::size_t agent, Visit visit) const {
    const std::uint64_t middle = cell_of_[agent];
    for (const std::uint64_t cell :
         {middle - (std::uint64_t{1} << 32), middle, middle + (std::uint64_t{1} << 32)}) {
      auto entry = std::lower_bound(cells_.begin(), cells_.end(), cell - 1,
                                    [](const Entry& e, std::uint64_t c) { return e.cell < c; });
      for (; entry != cells_.end() && entry->cell <= cell + 1; ++entry) visit(entry->agent);
    }
  }

 private:
  struct Entry {
    std::uint64_t cell;
    AgentId agent;
  };
  std::vector<Entry> cells_;
  std::vector<std::uint64_t> cell_of_;
};

using Position = std::array<double, 3>;

double squared_distance_m2(const Position& p, const Position& q) {
  const double dx = q[0] - p[0], dy = q[1] - p[1], dz = q[2] - p[2];
  return dx * dx + dy * dy + dz * dz;
}

void check_disk(std::span<const std::array<double, 3>> positions_m, double range_m) {
  if (!(range_m > 0.0) || !std::isfinite(range_m)) {
    std::ostringstream text;
    text << "range_m must be positive and finite, not " << range_m;
    throw InputError(text.str());
  }
  for (std::size_t i = 0; i < positions_m.size(); ++i) {
    for (const double x : positions_m[i]) {
      if (std::abs(x) <= 1e12) continue;  // false for NaN, too
      std::ostringstream text;
      text << "position of agent " << i << " must be within ±1e12 m on each axis, not " << x;
      throw InputError(text.str());
    }
  }
}

}  // namespace

Topology::Topology(std::vector<std::vector<AgentId>> lists) {
  first_.reserve(lists.size() + 1);
  first_.push_back(0);
  for (auto& row : lists) {
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end()), row.end());
    first_.push_back(first_.back() + row.size());
  }
  neighbour_.reserve(first_.back());
  for (const auto& row : lists) neighbour_.insert(neighbour_.end(), row.begin(), row.end());
}

Topology Topology::line(int agents) {
  Lists lists = empty_lists(agents);
  for (AgentId a = 1; a < agents; ++a) join(lists, a - 1, a);
  return Topology(std::move(lists));
}

Topology Topology::ring(int agents) {
  Lists lists = empty_lists(agents);
  for (AgentId a = 1; a < agents; ++a) join(lists, a - 1, a);
  if (agents > 2) join(lists, agents - 1, 0);
  return Topology(std::move(lists));
}

Topology Topology::star(int agents) {
  Lists lists = empty_lists(agents);
  for (AgentId a = 1; a < agents; ++a) join(lists, 0, a);
  return Topology(std::move(lists));
}

Topology Topology::full(int agents) {
  Lists lists = empty_lists(agents);
  for (AgentId a = 0; a < agents; ++a) {
    for (AgentId b = a + 1; b < agents; ++b) join(lists, a, b);
  }
  return Topology(std::move(lists));
}

Topology Topology::binary_tree(int agents) {
  Lists lists = empty_lists(agents);
  for (AgentId a = 1; a < agents; ++a) join(lists, (a - 1) / 2, a);
  return Topology(std::move(lists));
}

Topology Topology::grid(int agents, int columns) {
  Lists lists = empty_lists(agents);
  if (columns < 1 || columns > agents) {
    throw InputError("a grid of " + std::to_string(agents) + " agents has 1 … " +
                     std::to_string(agents) + " columns, not " + std::to_string(columns));
  }
  for (AgentId a = 1; a < agents; ++a) {
    if (a % columns != 0) join(lists, a - 1, a);
    if (a >= columns) join(lists, a - columns, a);
  }
  return Topology(std::move(lists));
}

Topology Topology::edges(int agents, std::span<const std::pair<AgentId, AgentId>> edges) {
  Lists lists = empty_lists(agents);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const AgentId a = edges[i].first;
    const AgentId b = edges[i].second;
    const auto name = [&] {
      return "edge " + std::to_string(i) + " [" + std::to_string(a) + ", " + std::to_string(b) +
             "]";
    };
    for (const AgentId end : {a, b}) {
      if (end >= 0 && end < agents) continue;
      throw InputError(name() + " names agent " + std::to_string(end) +
                       ", which is not there (agents are 0 … " + std::to_string(agents - 1) + ")");
    }
    if (a == b) throw InputError(name() + " joins agent " + std::to_string(a) + " to itself");
    join(lists, a, b);
  }
  return Topology(std::move(lists));
}

Topology Topology::disk(std::span<const std::array<double, 3>> positions_m, double range_m) {
  Lists lists = empty_lists(static_cast<int>(positions_m.size()));
  check_disk(positions_m, range_m);
  const Grid grid(positions_m, range_m);
  for (std::size_t i = 0; i < positions_m.size(); ++i) {
    grid.around(i, [&](AgentId other) {
      const auto j = static_cast<std::size_t>(other);
      if (j == i) return;
      const double d2_m2 = squared_distance_m2(positions_m[i], positions_m[j]);
      if (d2_m2 <= range_m * range_m) lists[i].push_back(other);
    });
  }
  Topology topology(std::move(lists));
  topology.placed_ = true;
  topology.length_m_.reserve(topology.links());
  for (AgentId a = 0; a < topology.agents(); ++a) {
    const Position& p = positions_m[static_cast<std::size_t>(a)];
    for (const AgentId b : topology.neighbours(a)) {
      const Position& q = positions_m[static_cast<std::size_t>(b)];
      topology.length_m_.push_back(std::sqrt(squared_distance_m2(p, q)));
    }
  }
  return topology;
}

std::int64_t Topology::link(AgentId from, AgentId to) const {
  if (from < 0 || from >= agents()) return -1;
  const std::span<const AgentId> row = neighbours(from);
  const auto found = std::lower_bound(row.begin(), row.end(), to);
  if (found == row.end() || *found != to) return -1;
  return static_cast<std::int64_t>(first_link(from)) + (found - row.begin());
}

bool Topology::is_tree() const {
  const auto n = static_cast<std::size_t>(agents());
  return links() == 2 * (n - 1) && is_connected();
}

bool Topology::is_connected() const {
  const auto n = static_cast<std::size_t>(agents());
  std::vector<bool> seen(n, false);
  std::vector<AgentId> reached{0};
  seen[0] = true;
  for (std::size_t i = 0; i < reached.size(); ++i) {
    for (const AgentId next : neighbours(reached[i])) {
      if (seen[static_cast<std::size_t>(next)]) continue;
      seen[static_cast<std::size_t>(next)] = true;
      reached.push_back(next);
    }
  }
  return reached.size() == n;
}

}  // namespace hearsay
