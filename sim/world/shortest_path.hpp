// The shortest way of a disc between two points, for somebody who has the map: what robots without
// one are measured against.
#pragma once

#include <optional>
#include <vector>

#include "sim/world/plan.hpp"
#include "sim/world/wall_index.hpp"

namespace hearsay::plan {

struct Path {
  std::vector<Point> points;  ///< from one end to the other
  double length_m = 0.0;
};

/// A way that the disc can go, by advance() from point to point, past the barriers that are up:
/// nothing if there is none on the grid.
///
/// A* over a grid of points `spacing_m` apart, to eight neighbours each, by the octile distance
/// (P. Hart, N. Nilsson, B. Raphael, IEEE Trans. Systems Science and Cybernetics 4(2), 1968); then
/// the way is drawn tight as a string. The way found is among the shortest of the grid; drawn
/// tight, to within 1 or 2 mm a corner, it passes the obstacles on the same sides. Gaps less than
/// about two spacings wider than the disc may be missed.
/// @throws BrokenInvariant if an end is not within the plan, for a radius below radius_min_m, for a
/// spacing that is not above 0 or gives more than 2^25 points.
std::optional<Path> shortest_path(const WallIndex& walls, Point from, Point to, double radius_m,
                                  double spacing_m);

}  // namespace hearsay::plan
