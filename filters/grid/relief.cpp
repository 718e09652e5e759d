#include "filters/grid/relief.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "filters/grid/footprint.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay::grid {
namespace {

using gaussian::Vector3;

constexpr double never = std::numeric_limits<double>::infinity();

/// A ray along one axis of the area, in cells from its corner.
struct Along {
  double from, by;
  int count;

  /// Narrows [begin, end] to where the ray is over the area; end < begin if nowhere.
  void clip(double& begin, double& end) const {
    if (by == 0.0) {
      if (!(from >= 0.0 && from < count)) end = -1.0;
      return;
    }
    const double a = -from / by, b = (count - from) / by;
    begin = std::max(begin, std::min(a, b));
    end = std::min(end, std::max(a, b));
  }
  int cell(double times) const {
    return static_cast<int>(std::clamp(std::floor(from + times * by), 0.0, count - 1.0));
  }
  /// Where the ray leaves a cell.
  double border(int cell) const {
    return by == 0.0 ? never : (cell + (by > 0.0 ? 1 : 0) - from) / by;
  }
  int next(int cell) const { return by > 0.0 ? cell + 1 : cell - 1; }
};

}  // namespace

Relief::Relief(const Area& area, std::vector<double> heights_m)
    : area_(area), heights_m_(std::move(heights_m)) {
  require(heights_m_.size() == static_cast<std::size_t>(area.cells()), "Relief: one height a cell");
  require(
      std::all_of(heights_m_.begin(), heights_m_.end(), [](double h) { return std::isfinite(h); }),
      "Relief: heights are finite");
  const auto [lowest, highest] = std::minmax_element(heights_m_.begin(), heights_m_.end());
  lowest_m_ = *lowest;
  highest_m_ = *highest;
}

std::optional<Relief::Met> Relief::first_met(const Vector3& from_m,
                                             const Vector3& direction) const {
  const Point corner = area_.origin();
  const double cell_m = area_.cell_m();
  const Along x{(from_m(0) - corner.x_m) / cell_m, direction(0) / cell_m, area_.columns()};
  const Along y{(from_m(1) - corner.y_m) / cell_m, direction(1) / cell_m, area_.rows()};
  double at = 0.0, end = never;
  x.clip(at, end);
  y.clip(at, end);
  const double over_all = from_m(2) - highest_m_;
  if (over_all > 0.0) at = std::max(at, direction(2) < 0.0 ? over_all / -direction(2) : never);
  if (!(at <= end) || at == never) return std::nullopt;
  int column = x.cell(at), row = y.cell(at);
  for (int cells = 0; cells <= area_.columns() + area_.rows(); ++cells) {
    const int cell = row * area_.columns() + column;
    const double across_x = x.border(column), across_y = y.border(row);
    const double leaves = std::max(at, std::min({across_x, across_y, end}));
    const double over = from_m(2) - height_m(cell);
    if (over + at * direction(2) < 0.0) return Met{cell, at};
    // Only a ray that sinks comes under a level cell; one that never leaves it does so for certain.
    if (direction(2) < 0.0 && (leaves == never || over + leaves * direction(2) < 0.0)) {
      return Met{cell, std::clamp(over / -direction(2), at, leaves)};
    }
    if (leaves >= end) return std::nullopt;
    int& crossed = across_x <= across_y ? column : row;
    crossed = (across_x <= across_y ? x : y).next(crossed);
    if (!area_.has(Cell{column, row})) return std::nullopt;
    at = leaves;
  }
  return std::nullopt;
}

bool Relief::sees(const Vector3& from_m, int cell) const {
  const Point centre = area_.centre(cell);
  const Vector3 to = Vector3(centre.x_m, centre.y_m, height_m(cell)) - from_m;
  if (!(to(2) < 0.0)) return false;
  const auto met = first_met(from_m, to);
  return met && met->cell == cell;
}

std::optional<double> Slab::reach(double z_m, double range_m) const {
  if (z_m > low_m && z_m <= high_m) return range_m;
  return grid::reach(z_m - high_m, range_m);
}

Slab slab_of(const Relief* relief, double ground_m) {
  if (relief == nullptr) return {ground_m, ground_m};
  return {ground_m + relief->lowest_m(), ground_m + relief->highest_m()};
}

const Relief* uneven(const Relief* relief, const Area& area) {
  if (relief == nullptr) return nullptr;
  require(relief->area() == area, "Relief: of another area");
  return relief->level() ? nullptr : relief;
}

}  // namespace hearsay::grid
