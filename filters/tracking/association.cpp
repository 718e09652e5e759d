#include "filters/tracking/association.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace hearsay::tracking {
namespace {

std::vector<int> nearest_first(const Table& d2, double gate) {
  std::vector<std::tuple<double, int, int>> pairs;
  for (int i = 0; i < d2.rows(); ++i) {
    for (int j = 0; j < d2.columns(); ++j) {
      if (d2(i, j) <= gate) pairs.emplace_back(d2(i, j), i, j);
    }
  }
  std::sort(pairs.begin(), pairs.end());
  std::vector<int> column_of(static_cast<std::size_t>(d2.rows()), unassigned);
  std::vector<char> used(static_cast<std::size_t>(d2.columns()), 0);
  for (const auto& [squared, row, column] : pairs) {
    int& chosen = column_of[static_cast<std::size_t>(row)];
    char& taken = used[static_cast<std::size_t>(column)];
    if (chosen != unassigned || taken != 0) continue;
    chosen = column;
    taken = 1;
  }
  return column_of;
}

// With costs cut off at the gate a pair beyond it costs as much as none.
std::vector<int> optimal(const Table& d2, double gate) {
  Table costs(d2.rows(), d2.columns());
  for (int i = 0; i < d2.rows(); ++i) {
    for (int j = 0; j < d2.columns(); ++j) costs(i, j) = std::min(d2(i, j), gate);
  }
  std::vector<int> column_of = assign(costs);
  for (int i = 0; i < d2.rows(); ++i) {
    int& column = column_of[static_cast<std::size_t>(i)];
    if (column != unassigned && !(d2(i, column) <= gate)) column = unassigned;
  }
  return column_of;
}

}  // namespace

std::vector<int> pair_within(const Table& d2, double gate, Pairing pairing) {
  require(gate > 0.0 && std::isfinite(gate), "pair_within: the gate must be positive");
  for (int i = 0; i < d2.rows(); ++i) {
    for (int j = 0; j < d2.columns(); ++j) {
      require(d2(i, j) >= 0.0, "pair_within: a squared distance is negative or no number");
    }
  }
  return pairing == Pairing::nearest ? nearest_first(d2, gate) : optimal(d2, gate);
}

}  // namespace hearsay::tracking
