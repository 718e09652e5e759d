// Round robots among walls and among each other: how far one gets.
//
// A robot is a disc that moves straight. It stops where it touches a standing wall or another disc,
// whatever its speed: the whole way is looked at, not places along it. There is no sliding.
//
// From where a move stopped it may go on wherever the distance to the wall does not fall: away from
// it, or along it. Headings are rounded, so a disc that touches may come closer by `slack_m` before
// it is stopped again; no sequence of moves brings it farther in than 1e-9 m. A disc that overlaps
// a wall by more (a barrier came up, or somebody put it there) may still move away, and
// one that is inside a thick wall goes on to its surface, or to the edge of the plan: no farther.
#pragma once

#include <span>

#include "sim/world/plan.hpp"
#include "sim/world/wall_index.hpp"

namespace hearsay::plan {

inline constexpr double slack_m = 5e-10;
inline constexpr double radius_min_m = 1e-6;

struct Advance {
  Point at;           ///< where it ends
  double distance_m;  ///< the way made
  bool blocked;       ///< whether something stopped it
};

/// Moves a disc from one point towards another. `others` are the discs near by, without itself.
/// @throws BrokenInvariant if `from` is not within the plan, `to` beyond ±1e12 m, or the radius
/// below radius_min_m or not finite.
Advance advance(const WallIndex& walls, Point from, Point to, double radius_m,
                std::span<const Disc> others = {});

struct Pose {
  Point at;
  double heading_rad = 0.0;
};
struct ArcAdvance {
  Pose end;
  double distance_m;
  bool blocked;
};

/// Moves a disc along an arc of length `length_m`, over which it turns by `turn_rad`
/// (counter-clockwise; negative lengths are backwards), as chords that leave the arc by less than
/// 1 mm and turn by at most 0.1 rad. Unless it is blocked it ends on the arc; else on a chord, with
/// a share of its turn.
/// @throws BrokenInvariant as above, or for a length beyond ±1e4 m, a turn beyond ±1e3 rad.
ArcAdvance advance_along_arc(const WallIndex& walls, const Pose& from, double length_m,
                             double turn_rad, double radius_m, std::span<const Disc> others = {});

/// Distance from a point within the plan to the nearest standing wall, or `up_to_m` ≥ 0 if there is
/// none so near.
double clearance(const WallIndex& walls, Point from, double up_to_m);

}  // namespace hearsay::plan
