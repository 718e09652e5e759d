#include "filters/grid/regions.hpp"

#include <cmath>
#include <cstddef>

#include "filters/tracking/ospa.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay::grid {

std::span<const Region> RegionFinder::find(const BernoulliGrid& grid, double threshold) {
  grid.mark_above(threshold, marks_);
  collect(grid.area(), [&](int cell) { return grid.probability(cell); });
  return regions_;
}

std::span<const Region> RegionFinder::find(const BetaGrid& grid, double threshold) {
  grid.mark_above(threshold, marks_);
  collect(grid.area(), [&](int cell) { return *grid.mean(cell); });
  return regions_;
}

void RegionFinder::flood(const Area& area, int first) {
  members_.assign(1, first);
  marks_[static_cast<std::size_t>(first)] = 0;
  for (std::size_t i = 0; i < members_.size(); ++i) {
    for (const int beside : area.neighbours(members_[i])) {
      unsigned char& mark = marks_[static_cast<std::size_t>(beside)];
      if (mark == 0) continue;
      mark = 0;
      members_.push_back(beside);
    }
  }
}

template <typename Probability>
void RegionFinder::collect(const Area& area, const Probability& probability) {
  regions_.clear();
  for (int cell = 0; cell < area.cells(); ++cell) {
    if (marks_[static_cast<std::size_t>(cell)] == 0) continue;
    flood(area, cell);
    Region region{.first_cell = cell, .cells = static_cast<int>(members_.size())};
    // About the first cell, so that nothing cancels far from the origin.
    const Point about = area.centre(cell);
    double p = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
    for (const int member : members_) {
      const Point at = area.centre(member);
      const double weight = probability(member), dx = at.x_m - about.x_m, dy = at.y_m - about.y_m;
      p += weight;
      x += weight * dx;
      y += weight * dy;
      xx += weight * dx * dx;
      xy += weight * dx * dy;
      yy += weight * dy * dy;
    }
    x /= p;
    y /= p;
    region.mean_probability = p / region.cells;
    region.position = {about.x_m + x, about.y_m + y};
    region.xx_m2 = std::fmax(0.0, xx / p - x * x);
    region.xy_m2 = xy / p - x * y;
    region.yy_m2 = std::fmax(0.0, yy / p - y * y);
    regions_.push_back(region);
  }
}

Match match(std::span<const Region> regions, std::span<const Point> places, double gate_m) {
  require(gate_m > 0.0 && std::isfinite(gate_m), "match: the gate is positive");
  tracking::Table distances(static_cast<int>(regions.size()), static_cast<int>(places.size()));
  for (std::size_t i = 0; i < regions.size(); ++i) {
    for (std::size_t j = 0; j < places.size(); ++j) {
      const double dx = regions[i].position.x_m - places[j].x_m;
      const double dy = regions[i].position.y_m - places[j].y_m;
      distances(static_cast<int>(i), static_cast<int>(j)) = std::sqrt(dx * dx + dy * dy);
    }
  }
  const tracking::Gospa gospa = tracking::gospa(distances, 1.0, gate_m);
  Match result;
  result.place_of = gospa.truth_of;
  result.missed = gospa.missed_count;
  result.false_alarms = gospa.false_count;
  double sum = 0.0;
  for (std::size_t i = 0; i < regions.size(); ++i) {
    const int place = result.place_of[i];
    if (place == tracking::unassigned) continue;
    const double d = distances(static_cast<int>(i), place);
    sum += d * d;
    ++result.detected;
  }
  if (result.detected > 0) result.position_error_m = std::sqrt(sum / result.detected);
  return result;
}

CellRates cell_rates(std::span<const unsigned char> marks, std::span<const unsigned char> truth) {
  require(marks.size() == truth.size(), "cell rates: marks and truth of different lengths");
  CellRates rates;
  for (std::size_t i = 0; i < marks.size(); ++i) {
    if (truth[i] != 0) {
      ++rates.true_cells;
      rates.hits += marks[i] != 0 ? 1 : 0;
    } else {
      ++rates.empty_cells;
      rates.false_alarms += marks[i] != 0 ? 1 : 0;
    }
  }
  return rates;
}

}  // namespace hearsay::grid
