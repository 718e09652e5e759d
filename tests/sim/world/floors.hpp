// Floors for tests, and their geometry done plainly in long double.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/kernel/random.hpp"
#include "sim/world/plan.hpp"

namespace hearsay::plan {

using Real = long double;

/// A room with a share of its cells filled, in lumps.
inline Drawing random_drawing(Stream& stream, int side_cells_max, double cell_m) {
  Drawing d;
  d.columns = 3 + static_cast<int>(stream.below(static_cast<std::uint64_t>(side_cells_max)));
  d.rows = 3 + static_cast<int>(stream.below(static_cast<std::uint64_t>(side_cells_max)));
  d.cell_m = cell_m;
  const double share = stream.uniform(0.0, 0.5);
  for (int row = 0; row < d.rows; ++row) {
    for (int column = 0; column < d.columns; ++column) d.walls.push_back(stream.bernoulli(share));
  }
  d.walls[stream.below(d.walls.size())] = 0;
  return d;
}

/// Walls anywhere, some of them in corners and along lines.
inline Plan random_plan(Stream& stream) {
  const double width = stream.uniform(2.0, 30.0), height = stream.uniform(2.0, 30.0);
  std::vector<Segment> walls;
  const auto point = [&] { return Point{stream.uniform(0.0, width), stream.uniform(0.0, height)}; };
  for (std::uint64_t n = stream.below(12); n > 0; --n) {
    Point a = point();
    const Point b = point(), c = stream.bernoulli(0.5) ? Point{a.x_m, b.y_m} : point();
    walls.push_back({a, b});
    walls.push_back({b, c});
  }
  return {width, height, walls};
}

inline Real distance(Point a, Point b) {
  const Real dx = Real{a.x_m} - b.x_m, dy = Real{a.y_m} - b.y_m;
  return std::sqrt(dx * dx + dy * dy);
}

inline Real distance(Point p, const Segment& s) {
  const Real wx = Real{s.to.x_m} - s.from.x_m, wy = Real{s.to.y_m} - s.from.y_m;
  const Real vx = Real{p.x_m} - s.from.x_m, vy = Real{p.y_m} - s.from.y_m;
  const Real u = std::clamp((vx * wx + vy * wy) / (wx * wx + wy * wy), Real{0}, Real{1});
  const Real dx = vx - u * wx, dy = vy - u * wy;
  return std::sqrt(dx * dx + dy * dy);
}

inline Real distance(Point p, std::span<const Segment> walls) {
  Real least = 1e30L;
  for (const Segment& s : walls) least = std::min(least, distance(p, s));
  return least;
}

/// Where a ray meets a segment, by Cramer's rule; nothing for parallels.
inline std::optional<Real> crossing(Point o, Point d, const Segment& s) {
  const Real wx = Real{s.to.x_m} - s.from.x_m, wy = Real{s.to.y_m} - s.from.y_m;
  const Real ax = Real{s.from.x_m} - o.x_m, ay = Real{s.from.y_m} - o.y_m;
  const Real det = wx * d.y_m - wy * d.x_m;
  if (det == 0) return std::nullopt;
  const Real t = (wx * ay - wy * ax) / det, u = (d.x_m * ay - d.y_m * ax) / det;
  if (t < 0 || u < 0 || u > 1) return std::nullopt;
  return t;
}

}  // namespace hearsay::plan
