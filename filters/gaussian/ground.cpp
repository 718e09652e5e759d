#include "filters/gaussian/ground.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "filters/gaussian/symmetric.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay::gaussian {
namespace {

constexpr double never = std::numeric_limits<double>::infinity();

/// The least t ≥ 0 with a + b·t + c·t² = 0, given a > 0; never if there is none.
double first_root(double a, double b, double c) {
  const double discriminant = b * b - 4.0 * a * c;
  if (!(discriminant >= 0.0)) return never;
  const double root = std::sqrt(discriminant);
  if (b < 0.0) return 2.0 * a / (root - b);
  return c < 0.0 ? -(b + root) / (2.0 * c) : never;
}

std::optional<Hit> meet_plane(const Plane& plane, const Ray& ray) {
  const double above = ray.origin_m(2) - plane.height_m;
  const double distance = above / -ray.direction(2);
  if (!(above > 0.0) || !(ray.direction(2) < 0.0) || !(distance <= range_max_m)) {
    return std::nullopt;
  }
  Vector3 point = ray.origin_m + distance * ray.direction;
  point(2) = plane.height_m;
  return Hit{point, Vector3(0.0, 0.0, 1.0), distance};
}

/// The part of a ray over 0 … length along one axis of the grid.
void clip(double from, double direction, double length, double& begin, double& end) {
  if (direction == 0.0) {
    if (from < 0.0 || from > length) end = -1.0;
    return;
  }
  const double a = (0.0 - from) / direction, b = (length - from) / direction;
  begin = std::max(begin, std::min(a, b));
  end = std::min(end, std::max(a, b));
}

int cell_of(double along, int nodes) {
  return std::clamp(static_cast<int>(std::floor(along)), 0, nodes - 2);
}

}  // namespace

Terrain::Terrain(Options options) : options_(std::move(options)) {
  const int columns = options_.columns, rows = options_.rows;
  require(std::min(columns, rows) >= side_min && std::max(columns, rows) <= side_max,
          "terrain: 2 to 4096 nodes a side");
  require(options_.spacing_m > 0.0 && std::isfinite(options_.spacing_m) &&
              std::isfinite(options_.x_m) && std::isfinite(options_.y_m),
          "terrain: the spacing must be positive, the place finite");
  require(options_.heights_m.size() ==
              static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows),
          "terrain: one height a node");
  require(std::all_of(options_.heights_m.begin(), options_.heights_m.end(),
                      [](double h) { return std::isfinite(h); }),
          "terrain: heights must be finite");
}

Terrain::Patch Terrain::patch(int column, int row) const {
  const auto height = [&](int i, int j) {
    return options_
        .heights_m[static_cast<std::size_t>(row + j) * static_cast<std::size_t>(options_.columns) +
                   static_cast<std::size_t>(column + i)];
  };
  const double h = height(0, 0), x = height(1, 0), y = height(0, 1), xy = height(1, 1);
  return {h, x - h, y - h, xy - x - y + h};
}

std::optional<double> Terrain::height_m(double x_m, double y_m) const {
  const double x = (x_m - options_.x_m) / options_.spacing_m;
  const double y = (y_m - options_.y_m) / options_.spacing_m;
  if (!(x >= 0.0 && x <= options_.columns - 1 && y >= 0.0 && y <= options_.rows - 1)) {
    return std::nullopt;
  }
  const int column = cell_of(x, options_.columns), row = cell_of(y, options_.rows);
  const Patch p = patch(column, row);
  const double u = x - column, v = y - row;
  return p.a + p.b * u + p.c * v + p.e * u * v;
}

/// A ray on its way over a terrain, in units of the grid along x and y.
class TerrainMarch {
 public:
  TerrainMarch(const Terrain& terrain, const Ray& ray)
      : terrain_(terrain),
        ray_(ray),
        spacing_(terrain.options_.spacing_m),
        x_((ray.origin_m(0) - terrain.options_.x_m) / spacing_),
        y_((ray.origin_m(1) - terrain.options_.y_m) / spacing_),
        dx_(ray.direction(0) / spacing_),
        dy_(ray.direction(1) / spacing_) {}

  std::optional<Hit> go() const {
    const int columns = terrain_.options_.columns, rows = terrain_.options_.rows;
    double t = 0.0, end = range_max_m;
    clip(x_, dx_, columns - 1, t, end);
    clip(y_, dy_, rows - 1, t, end);
    if (!(t <= end)) return std::nullopt;
    int column = cell_of(x_ + t * dx_, columns), row = cell_of(y_ + t * dy_, rows);
    if (!(over(column, row, t).a > 0.0)) return std::nullopt;
    for (int cells = 0; cells <= columns + rows; ++cells) {
      const double across_x = border(x_, dx_, column), across_y = border(y_, dy_, row);
      const double leaves = std::max(t, std::min({across_x, across_y, end}));
      if (const auto hit = within(column, row, t, leaves)) return hit;
      if (leaves >= end) return std::nullopt;
      (across_x <= across_y ? column : row) += (across_x <= across_y ? dx_ : dy_) > 0.0 ? 1 : -1;
      if (column < 0 || row < 0 || column > columns - 2 || row > rows - 2) return std::nullopt;
      t = leaves;
    }
    return std::nullopt;
  }

 private:
  /// Where the ray leaves a cell along one axis.
  static double border(double from, double direction, int cell) {
    if (direction == 0.0) return never;
    return (cell + (direction > 0.0 ? 1 : 0) - from) / direction;
  }

  /// How high the ray is over the ground of a cell at length t + τ: a + b·τ + c·τ².
  struct Above {
    double a, b, c;
  };
  Above over(int column, int row, double t) const {
    const Terrain::Patch p = terrain_.patch(column, row);
    const double u = x_ + t * dx_ - column, v = y_ + t * dy_ - row;
    return {ray_.origin_m(2) + t * ray_.direction(2) - (p.a + p.b * u + p.c * v + p.e * u * v),
            ray_.direction(2) - (p.b * dx_ + p.c * dy_ + p.e * (u * dy_ + v * dx_)),
            -p.e * dx_ * dy_};
  }

  /// A hit between lengths t and `leaves` in this cell.
  std::optional<Hit> within(int column, int row, double t, double leaves) const {
    const Above above = over(column, row, t);
    // At a border the ray may be under the ground by rounding: then it came down just there.
    const double at = t + (above.a > 0.0 ? first_root(above.a, above.b, above.c) : 0.0);
    if (!(at <= leaves)) return std::nullopt;
    const Terrain::Patch p = terrain_.patch(column, row);
    const double slope_x = (p.b + p.e * (y_ + at * dy_ - row)) / spacing_;
    const double slope_y = (p.c + p.e * (x_ + at * dx_ - column)) / spacing_;
    return Hit{ray_.origin_m + at * ray_.direction, Vector3(-slope_x, -slope_y, 1.0), at};
  }

  const Terrain& terrain_;
  const Ray& ray_;
  double spacing_;
  double x_, y_, dx_, dy_;
};

std::optional<Hit> meet(const Ground& ground, const Ray& ray) {
  if (!all_finite(ray.origin_m) || !all_finite(ray.direction)) return std::nullopt;
  if (const Plane* plane = std::get_if<Plane>(&ground)) return meet_plane(*plane, ray);
  return TerrainMarch(std::get<Terrain>(ground), ray).go();
}

}  // namespace hearsay::gaussian
