// Areas, places and views for tests of exploration.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "agents/behaviours/exploration.hpp"

namespace hearsay::exploring {

using grid::Area;
using State = Exploration::State;
using Options = Exploration::Options;
using Choice = Exploration::Choice;
using Vehicle = Exploration::Vehicle;
inline constexpr double pi = std::numbers::pi;

inline Stream stream(std::uint64_t n) { return Stream(n, Purpose("exploration test"), Entity{0}); }

inline Area cells(int columns, int rows, double cell_m = 1.0, grid::Point corner = {}) {
  return Area(
      {.columns = columns, .rows = rows, .cell_m = cell_m, .x_m = corner.x_m, .y_m = corner.y_m});
}
inline State in_cell(const Area& area, int column, int row, double heading_rad = 0.0) {
  return {area.centre(area.number({column, row})), heading_rad};
}
inline double distance(grid::Point a, grid::Point b) {
  return std::sqrt((a.x_m - b.x_m) * (a.x_m - b.x_m) + (a.y_m - b.y_m) * (a.y_m - b.y_m));
}
inline double wrapped(double angle) { return std::remainder(angle, 2 * pi); }
/// How far a place is from an area.
inline double outside_m(const Area& area, grid::Point p) {
  const grid::Point o = area.origin();
  const double right = o.x_m + area.columns() * area.cell_m();
  const double top = o.y_m + area.rows() * area.cell_m();
  const double x = std::max({o.x_m - p.x_m, p.x_m - right, 0.0});
  const double y = std::max({o.y_m - p.y_m, p.y_m - top, 0.0});
  return std::sqrt(x * x + y * y);
}
/// The cells whose centres are within 2.3 cells.
inline std::vector<int> view(const Area& area, grid::Point from) {
  std::vector<int> seen;
  for (int k = 0; k < area.cells(); ++k) {
    if (distance(area.centre(k), from) < 2.3 * area.cell_m()) seen.push_back(k);
  }
  return seen;
}

}  // namespace hearsay::exploring
