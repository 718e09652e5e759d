// The part of a level plane that a sensor can see, and the cells in it: a convex polygon, so that
// the cells are found row by row and none beyond it is looked at.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>

#include "filters/gaussian/camera.hpp"
#include "filters/grid/area.hpp"

namespace hearsay::grid {

class Footprint {
 public:
  /// A square with its centre there, 2·`reach_m` a side.
  static Footprint around(Point centre, double reach_m);

  /// Cuts off what lies behind a wall: keeps the points p of the plane z = `ground_m` with
  /// inward·(p − on_wall) ≥ 0. At most 8 cuts. @throws BrokenInvariant for more.
  void cut(const gaussian::Vector3& on_wall, const gaussian::Vector3& inward, double ground_m);

  /// Counter-clockwise; none if nothing is left.
  std::span<const Point> corners() const { return std::span(corners_).first(count_); }
  double square_metres() const;

  /// Where the line y = `y_m` runs through it, from the least to the greatest x; nothing if
  /// it does not.
  struct Stretch {
    double from_m, to_m;
  };
  std::optional<Stretch> along(double y_m) const;

 private:
  static constexpr std::size_t corners_max = 12;
  std::array<Point, corners_max> corners_{};
  std::size_t count_ = 0;
};

/// How far a sensor at this height over the plane reaches along it: √(range² − height²); nothing if
/// it does not reach down to it, or is not above it.
std::optional<double> reach(double height_m, double range_m);

/// Calls f(cell), rising, for the cells with centres in the polygon, and for up to one more at
/// either end of a row: f has to look at centres that lie on the edge itself.
template <typename F>
void for_each_cell(const Footprint& ground, const Area& area, F&& f) {
  if (ground.corners().empty()) return;
  double low = ground.corners()[0].y_m, high = low;
  for (const Point& corner : ground.corners()) {
    low = std::min(low, corner.y_m);
    high = std::max(high, corner.y_m);
  }
  const double cell = area.cell_m();
  const Point origin = area.origin();
  // Indices of the cells around a coordinate, from −1 to count. A polygon so large that its sides
  // are beyond double may have NaN for a coordinate: it counts as before all cells.
  const auto index = [cell](double from_origin_m, int count) {
    const double at = std::floor(from_origin_m / cell);
    if (at >= count) return count;
    return at > -1.0 ? static_cast<int>(at) : -1;
  };
  const int last_row = std::min(index(high - origin.y_m, area.rows()), area.rows() - 1);
  for (int row = std::max(0, index(low - origin.y_m, area.rows())); row <= last_row; ++row) {
    const auto stretch = ground.along(origin.y_m + (row + 0.5) * cell);
    if (!stretch) continue;
    const int first = std::max(0, index(stretch->from_m - origin.x_m, area.columns()));
    const int last =
        std::min(index(stretch->to_m - origin.x_m, area.columns()), area.columns() - 1);
    for (int column = first; column <= last; ++column) f(row * area.columns() + column);
  }
}

}  // namespace hearsay::grid
