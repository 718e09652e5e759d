// What a camera looks down on: a level plane, or a grid of terrain heights. Where does a ray meet
// it?
#pragma once

#include <optional>
#include <variant>
#include <vector>

#include "filters/gaussian/camera.hpp"

namespace hearsay::gaussian {

/// z = height, everywhere.
struct Plane {
  double height_m = 0.0;
};

/// Heights at the nodes of a square grid, bilinear between them. Beyond its edge there is nothing.
class Terrain {
 public:
  /// Nodes a side.
  static constexpr int side_min = 2;
  static constexpr int side_max = 4096;

  struct Options {
    double x_m = 0.0, y_m = 0.0;    ///< of the first node
    double spacing_m = 1.0;         ///< > 0
    int columns = 2, rows = 2;      ///< nodes along x and y, 2 … 4096
    std::vector<double> heights_m;  ///< columns·rows: a row of rising x for each y
  };
  /// @throws BrokenInvariant for other shapes, and for heights that are not finite.
  explicit Terrain(Options options);

  /// Height of the ground; nothing beyond the edge.
  std::optional<double> height_m(double x_m, double y_m) const;

 private:
  friend class TerrainMarch;
  /// Height over a cell: a + b·u + c·v + e·u·v, 0 ≤ u, v ≤ 1.
  struct Patch {
    double a, b, c, e;
  };
  Patch patch(int column, int row) const;

  Options options_;
};

using Ground = std::variant<Plane, Terrain>;

/// Where a ray meets the ground.
struct Hit {
  Vector3 point_m;
  Vector3 normal;     ///< (−∂h/∂x, −∂h/∂y, 1) there
  double distance_m;  ///< from the ray's origin
};

/// Rays that run farther without meeting anything miss.
inline constexpr double range_max_m = 1e5;

/// The first point where a ray that starts above the ground meets it. Nothing if it starts under
/// or on the ground, never comes down to it within `range_max_m`, or leaves the terrain before.
/// From cell to cell a ray's height over a terrain is quadratic in its length, and solved for as
/// such: at most columns + rows cells are looked at, and no ridge is jumped over.
std::optional<Hit> meet(const Ground& ground, const Ray& ray);

}  // namespace hearsay::gaussian
