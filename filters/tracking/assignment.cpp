#include "filters/tracking/assignment.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hearsay::tracking {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

std::size_t index(int i) { return static_cast<std::size_t>(i); }

void require_finite(const Table& costs) {
  for (int i = 0; i < costs.rows(); ++i) {
    for (int j = 0; j < costs.columns(); ++j) {
      require(std::isfinite(costs(i, j)), "assignment: costs must be finite");
    }
  }
}

Table transposed(const Table& a) {
  Table t(a.columns(), a.rows());
  for (int i = 0; i < a.rows(); ++i) {
    for (int j = 0; j < a.columns(); ++j) t(j, i) = a(i, j);
  }
  return t;
}

// Prices u of rows and v of columns keep every reduced cost c − u − v at or above zero, and at zero
// on assigned pairs. One row after the other gets a column: along the path of least reduced cost to
// a free column, found as Dijkstra would, everybody moves on by one.
class ShortestPaths {
 public:
  explicit ShortestPaths(const Table& costs)
      : costs_(costs),
        u_(index(costs.rows()), 0.0),
        v_(index(costs.columns()), 0.0),
        row_of_(index(costs.columns()), unassigned),
        length_(index(costs.columns())),
        before_(index(costs.columns())),
        settled_(index(costs.columns())) {}

  /// The row of each column. For no more rows than columns.
  const std::vector<int>& solve() {
    for (int row = 0; row < costs_.rows(); ++row) add(row);
    return row_of_;
  }

 private:
  void add(int row) {
    const int free = path_from(row);
    const double length = length_[index(free)];
    u_[index(row)] += length;
    for (std::size_t j = 0; j < settled_.size(); ++j) {
      if (settled_[j] == 0 || static_cast<int>(j) == free) continue;
      u_[index(row_of_[j])] += length - length_[j];
      v_[j] -= length - length_[j];
    }
    int column = free;
    for (; before_[index(column)] != unassigned; column = before_[index(column)]) {
      row_of_[index(column)] = row_of_[index(before_[index(column)])];
    }
    row_of_[index(column)] = row;
  }

  /// The free column at the end of the shortest path from `row`.
  int path_from(int row) {
    std::fill(length_.begin(), length_.end(), infinity);
    std::fill(settled_.begin(), settled_.end(), char{0});
    int last = unassigned;
    double so_far = 0.0;
    while (true) {
      int nearest = unassigned;
      for (int j = 0; j < costs_.columns(); ++j) {
        if (settled_[index(j)] != 0) continue;
        const double length = so_far + (costs_(row, j) - u_[index(row)] - v_[index(j)]);
        if (length < length_[index(j)]) {
          length_[index(j)] = length;
          before_[index(j)] = last;
        }
        if (nearest == unassigned || length_[index(j)] < length_[index(nearest)]) nearest = j;
      }
      settled_[index(nearest)] = 1;
      if (row_of_[index(nearest)] == unassigned) return nearest;
      row = row_of_[index(nearest)];
      so_far = length_[index(nearest)];
      last = nearest;
    }
  }

  const Table& costs_;
  std::vector<double> u_, v_;
  std::vector<int> row_of_;
  std::vector<double> length_;  // of the shortest path to each column known so far
  std::vector<int> before_;     // the column before it on that path
  std::vector<char> settled_;
};

/// Whether all rows find a column of cost at most `limit`.
class Matching {
 public:
  Matching(const Table& costs, double limit)
      : costs_(costs), limit_(limit), row_of_(index(costs.columns()), unassigned) {}
  bool complete() {
    for (int row = 0; row < costs_.rows(); ++row) {
      seen_.assign(row_of_.size(), 0);
      if (!place(row)) return false;
    }
    return true;
  }

 private:
  bool place(int row) {
    for (int j = 0; j < costs_.columns(); ++j) {
      if (seen_[index(j)] != 0 || costs_(row, j) > limit_) continue;
      seen_[index(j)] = 1;
      if (row_of_[index(j)] == unassigned || place(row_of_[index(j)])) {
        row_of_[index(j)] = row;
        return true;
      }
    }
    return false;
  }

  const Table& costs_;
  double limit_;
  std::vector<int> row_of_;
  std::vector<char> seen_;
};

}  // namespace

std::vector<int> assign(const Table& costs) {
  require_finite(costs);
  if (costs.rows() > costs.columns()) return ShortestPaths(transposed(costs)).solve();
  std::vector<int> column_of(index(costs.rows()), unassigned);
  ShortestPaths paths(costs);
  const std::vector<int>& row_of = paths.solve();
  for (std::size_t j = 0; j < row_of.size(); ++j) {
    if (row_of[j] != unassigned) column_of[index(row_of[j])] = static_cast<int>(j);
  }
  return column_of;
}

double bottleneck(const Table& costs) {
  require(costs.rows() == costs.columns(), "bottleneck: the table must be square");
  require_finite(costs);
  if (costs.rows() == 0) return 0.0;
  std::vector<double> limits;
  for (int i = 0; i < costs.rows(); ++i) {
    for (int j = 0; j < costs.columns(); ++j) limits.push_back(costs(i, j));
  }
  std::sort(limits.begin(), limits.end());
  std::size_t low = 0, high = limits.size() - 1;  // limits[high] is enough
  while (low < high) {
    const std::size_t middle = (low + high) / 2;
    if (Matching(costs, limits[middle]).complete()) {
      high = middle;
    } else {
      low = middle + 1;
    }
  }
  return limits[high];
}

}  // namespace hearsay::tracking
