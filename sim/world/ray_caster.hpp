// Rays: how far it is to the nearest wall.
//
// A ray begins at a point and has a direction. It hits every standing wall that it touches, at an
// end too; so it cannot slip through where two walls meet. One that begins on a wall hits it at 0
// (for a slanting wall: to within rounding), one that runs along a wall at the wall's nearest
// point. One that begins within a thick wall sees that wall's surface from inside. Discs are hit at
// their edge, at 0 from within.
#pragma once

#include <span>
#include <vector>

#include "sim/world/plan.hpp"
#include "sim/world/wall_index.hpp"

namespace hearsay::plan {

inline constexpr int nothing = -1;

struct Hit {
  double distance_m;  ///< the range, where nothing is hit within it
  /// Number of the wall among segments() of the index; behind them come the discs; or nothing.
  int what = nothing;
};

/// The nearest thing within range along a direction.
/// @throws BrokenInvariant if `from` is not within the plan, the direction not of length 1 (to
/// 1e-9), or the range not above 0 and finite.
Hit cast(const WallIndex& walls, Point from, Point direction, double range_m,
         std::span<const Disc> discs = {});

/// The directions of a scan, relative to where the sensor looks: `rays` evenly over the field of
/// view, counter-clockwise from −view/2, each in the middle of its share of it.
class Fan {
 public:
  /// @throws BrokenInvariant unless rays ≥ 1 and 0 ≤ view ≤ 2π.
  Fan(int rays, double view_rad);
  std::span<const Point> directions() const { return directions_; }
  double view_rad() const { return view_rad_; }
  /// The direction of one ray, relative to the sensor's.
  double angle_rad(std::size_t ray) const;

 private:
  double view_rad_;
  std::vector<Point> directions_;
};

/// Distances along all rays of a fan into `distances_m`, one a ray; the range, where there is
/// nothing within it. Allocates nothing. `discs` are the round things near by, without the body
/// that carries the sensor.
/// @throws BrokenInvariant as above, or if `distances_m` has another length than the fan.
void scan(const WallIndex& walls, Point from, double heading_rad, const Fan& fan, double range_m,
          std::span<const Disc> discs, std::span<double> distances_m);

}  // namespace hearsay::plan
