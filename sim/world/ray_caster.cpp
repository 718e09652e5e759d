#include "sim/world/ray_caster.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"

namespace hearsay::plan {
namespace {

/// Where a ray from o along d meets a segment, below `best`; otherwise `best`. On which side of the
/// ray an end lies is the same number for both walls that share it, so that no ray passes between.
inline double meet(Point o, Point d, const Segment& s, double best) {
  const double ax = s.from.x_m - o.x_m, ay = s.from.y_m - o.y_m;
  const double bx = s.to.x_m - o.x_m, by = s.to.y_m - o.y_m;
  const double side_a = d.x_m * ay - d.y_m * ax, side_b = d.x_m * by - d.y_m * bx;
  if ((side_a > 0.0 && side_b > 0.0) || (side_a < 0.0 && side_b < 0.0)) return best;
  const double along_a = d.x_m * ax + d.y_m * ay, along_b = d.x_m * bx + d.y_m * by;
  const auto [near, far] = std::minmax(along_a, along_b);
  if (far < 0.0 || near >= best) return best;
  const double wx = s.to.x_m - s.from.x_m, wy = s.to.y_m - s.from.y_m;
  const double across = d.x_m * wy - d.y_m * wx;
  double t = near <= 0.0 ? 0.0 : near;  // along the wall: its nearest point
  if (across != 0.0 && side_a != side_b) {
    t = (ax * wy - ay * wx) / across;
    // Nearly along the wall the quotient is rounding noise; the ends still bound it.
    t = std::clamp(t, near, far);
    if (t < 0.0) return best;
  }
  return t < best ? t : best;
}

/// The same for a disc.
inline double meet(Point o, Point d, const Disc& disc, double best) {
  const double x = disc.at.x_m - o.x_m, y = disc.at.y_m - o.y_m;
  const double r = disc.radius_m;
  if (x * x + y * y <= r * r) return 0.0;
  const double ahead = d.x_m * x + d.y_m * y;
  const double aside = std::fabs(d.x_m * y - d.y_m * x);
  if (ahead < 0.0 || aside > r) return best;
  const double t = ahead - std::sqrt((r - aside) * (r + aside));
  return t < best ? std::max(t, 0.0) : best;
}

/// Goes from cell to cell along the ray (J. Amanatides, A. Woo, A fast voxel traversal algorithm
/// for ray tracing, Eurographics 1987).
Hit walk(const WallIndex& walls, Point o, Point d, Hit hit) {
  constexpr double never = std::numeric_limits<double>::infinity();
  const double cell = walls.cell_m();
  int column = std::clamp(walls.column(o.x_m), 0, walls.columns() - 1);
  int row = std::clamp(walls.row(o.y_m), 0, walls.rows() - 1);
  const int step_x = d.x_m > 0.0 ? 1 : -1, step_y = d.y_m > 0.0 ? 1 : -1;
  const double per_x = d.x_m != 0.0 ? 1.0 / d.x_m : never;
  const double per_y = d.y_m != 0.0 ? 1.0 / d.y_m : never;
  double exit_x = d.x_m != 0.0 ? ((column + (step_x > 0)) * cell - o.x_m) * per_x : never;
  double exit_y = d.y_m != 0.0 ? ((row + (step_y > 0)) * cell - o.y_m) * per_y : never;
  const double width = cell * std::fabs(per_x), height = cell * std::fabs(per_y);
  for (;;) {
    for (const auto& [segment, number] : walls.in_cell(column, row)) {
      const double t = meet(o, d, segment, hit.distance_m);
      if (t < hit.distance_m && walls.stands(number)) hit = {t, number};
    }
    if (exit_x < exit_y) {
      if (hit.distance_m <= exit_x) return hit;
      column += step_x;
      if (column < 0 || column >= walls.columns()) return hit;
      exit_x += width;
    } else {
      if (hit.distance_m <= exit_y) return hit;
      row += step_y;
      if (row < 0 || row >= walls.rows()) return hit;
      exit_y += height;
    }
  }
}

/// Discs first: they shorten the way through the grid.
inline Hit nearest(const WallIndex& walls, Point o, Point d, double range_m,
                   std::span<const Disc> discs) {
  Hit hit{range_m, nothing};
  for (std::size_t i = 0; i < discs.size(); ++i) {
    const double t = meet(o, d, discs[i], hit.distance_m);
    if (t < hit.distance_m) hit = {t, static_cast<int>(walls.segments().size() + i)};
  }
  return walk(walls, o, d, hit);
}

/// Shortens the rays that one disc is in the way of; others are not looked at.
void shorten(Point from, double heading_rad, Point turn, const Fan& fan, const Disc& disc,
             std::span<double> distances_m) {
  const auto directions = fan.directions();
  const int rays = static_cast<int>(directions.size());
  const auto look = [&](int first, int last) {
    for (int i = std::max(first, 0); i <= std::min(last, rays - 1); ++i) {
      const Point& d = directions[static_cast<std::size_t>(i)];
      const Point turned{turn.x_m * d.x_m - turn.y_m * d.y_m, turn.y_m * d.x_m + turn.x_m * d.y_m};
      double& best = distances_m[static_cast<std::size_t>(i)];
      best = meet(from, turned, disc, best);
    }
  };
  const double dx = disc.at.x_m - from.x_m, dy = disc.at.y_m - from.y_m;
  const double distance_m = std::sqrt(dx * dx + dy * dy);
  // Of so narrow a view the rays to a radian are no number that can be reckoned with.
  constexpr double narrow_rad = 1e-6;
  if (distance_m <= disc.radius_m || fan.view_rad() < narrow_rad) return look(0, rays - 1);
  const double bearing_rad = math::wrap_angle(math::atan2(dy, dx) - heading_rad);
  const double half_rad = math::asin(disc.radius_m / distance_m);
  const double rays_a_rad = rays / fan.view_rad();
  // A whole turn on, the bearing is the same; one ray more on either side for rounding.
  for (const double turn_rad : {-2.0 * math::pi, 0.0, 2.0 * math::pi}) {
    const double middle = (bearing_rad + turn_rad) * rays_a_rad + 0.5 * (rays - 1);
    const double side = half_rad * rays_a_rad + 1.0;
    if (middle + side < 0.0 || middle - side > rays - 1) continue;
    look(static_cast<int>(std::floor(std::max(middle - side, 0.0))),
         static_cast<int>(std::ceil(std::min(middle + side, rays - 1.0))));
  }
}

void check(const WallIndex& walls, Point from, double range_m) {
  require(walls.contains(from), "ray: begins outside the plan");
  require(range_m > 0.0 && std::isfinite(range_m), "ray: the range is above 0 and finite");
}

}  // namespace

Hit cast(const WallIndex& walls, Point from, Point direction, double range_m,
         std::span<const Disc> discs) {
  check(walls, from, range_m);
  const double square = direction.x_m * direction.x_m + direction.y_m * direction.y_m;
  require(std::fabs(square - 1.0) <= 2e-9, "ray: a direction has length 1");
  return nearest(walls, from, direction, range_m, discs);
}

Fan::Fan(int rays, double view_rad) : view_rad_(view_rad) {
  require(rays >= 1 && view_rad >= 0.0 && view_rad <= 2.0 * math::pi,
          "fan: at least one ray, a field of view of 0 … 2π");
  directions_.resize(static_cast<std::size_t>(rays));
  for (std::size_t i = 0; i < directions_.size(); ++i) {
    const double angle = angle_rad(i);
    directions_[i] = {math::cos(angle), math::sin(angle)};
  }
}

double Fan::angle_rad(std::size_t ray) const {
  return view_rad_ *
         ((static_cast<double>(ray) + 0.5) / static_cast<double>(directions_.size()) - 0.5);
}

void scan(const WallIndex& walls, Point from, double heading_rad, const Fan& fan, double range_m,
          std::span<const Disc> discs, std::span<double> distances_m) {
  check(walls, from, range_m);
  require(std::isfinite(heading_rad), "ray: the heading is finite");
  const auto directions = fan.directions();
  require(distances_m.size() == directions.size(), "ray: one distance a ray of the fan");
  const double c = math::cos(heading_rad), s = math::sin(heading_rad);
  std::fill(distances_m.begin(), distances_m.end(), range_m);
  for (const Disc& disc : discs) shorten(from, heading_rad, {c, s}, fan, disc, distances_m);
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const Point& d = directions[i];
    const Point turned{c * d.x_m - s * d.y_m, s * d.x_m + c * d.y_m};
    distances_m[i] = walk(walls, from, turned, {distances_m[i], nothing}).distance_m;
  }
}

}  // namespace hearsay::plan
