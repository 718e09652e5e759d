// Heights of cells: uneven ground under a grid.
//
// The ground is terraced: each cell is level at its own height, with upright walls between cells of
// different heights. So a cell is seen where its centre and its extent are, and a ray meets the
// first cell that it comes under. Of a smooth slope terraces hide more than the slope itself would,
// never less: looking down a slope, a ray must fall twice as steeply to reach the next centre.
//
// Heights count from the level plane of the cells (`ground_m` of a sensor). That plane is what lies
// around the area; it hides nothing.
#pragma once

#include <optional>
#include <vector>

#include "filters/gaussian/camera.hpp"
#include "filters/grid/area.hpp"

namespace hearsay::grid {

class Relief {
 public:
  /// A height a cell, m, by number. @throws BrokenInvariant for another number of heights, or if
  /// one is not finite.
  Relief(const Area& area, std::vector<double> heights_m);

  const Area& area() const { return area_; }
  double height_m(int cell) const { return heights_m_[static_cast<std::size_t>(cell)]; }
  double lowest_m() const { return lowest_m_; }
  double highest_m() const { return highest_m_; }
  /// True if all heights are 0: sensors then do, and cost, what they do without a relief.
  bool level() const { return lowest_m_ == 0.0 && highest_m_ == 0.0; }

  /// The cell that a ray comes under first, and where, in lengths of `direction`.
  struct Met {
    int cell;
    double times;
  };
  /// The ray from_m + t·direction, t ≥ 0, z over the plane. Nothing if it stays over all cells;
  /// from under a cell's height, that cell at once. Costs as much as there are cells below it from
  /// where it comes down to the highest height.
  std::optional<Met> first_met(const gaussian::Vector3& from_m,
                               const gaussian::Vector3& direction) const;

  /// True if nothing stands between a place (z over the plane) and the centre of a cell below it.
  bool sees(const gaussian::Vector3& from_m, int cell) const;

 private:
  Area area_;
  std::vector<double> heights_m_;
  double lowest_m_, highest_m_;
};

/// Heights of the world between which all cells are.
struct Slab {
  double low_m, high_m;

  /// Of these, the one that is farthest before a wall: where a polygon is cut that is to hold the
  /// cells before the wall at any height between. (Cut at the lowest and at the highest instead,
  /// two polygons would not hold those between: a narrow tilted view has them side by side.)
  double before(const gaussian::Vector3& inward) const { return inward(2) > 0.0 ? high_m : low_m; }
  /// As reach() of the plane nearest to a sensor at `z_m`, but not above it.
  std::optional<double> reach(double z_m, double range_m) const;
};
Slab slab_of(const Relief* relief, double ground_m);

/// Nothing for a relief that is level or not there. @throws BrokenInvariant for one of another
/// area.
const Relief* uneven(const Relief* relief, const Area& area);

}  // namespace hearsay::grid
