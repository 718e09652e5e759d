#include "sim/world/wall_index.hpp"

#include "sim/kernel/error.hpp"

namespace hearsay::plan {
namespace {

constexpr double margin = 1e-6;  // of a cell's side: far above rounding, far below what costs
constexpr double cells_max = 1e6;
constexpr double side_cells_max = 16384;
constexpr std::size_t entries_max = 10000000;

}  // namespace

WallIndex::WallIndex(const Plan& plan, std::span<const Rectangle> barriers, double cell_m)
    : width_m_(plan.width_m()),
      height_m_(plan.height_m()),
      walls_(plan.walls().size()),
      segments_(plan.walls().begin(), plan.walls().end()),
      up_(barriers.size(), 0) {
  for (std::size_t i = 0; i < barriers.size(); ++i) {
    const auto& [low, high] = barriers[i];
    if (!plan.contains(low) || !plan.contains(high) || !(low.x_m < high.x_m) ||
        !(low.y_m < high.y_m)) {
      throw InputError("barrier " + std::to_string(i) +
                       " must lie within the plan, its least corner first, with sides above 0");
    }
    const Point right{high.x_m, low.y_m}, left{low.x_m, high.y_m};
    for (const Segment& side :
         {Segment{low, left}, Segment{left, high}, Segment{high, right}, Segment{right, low}}) {
      segments_.push_back(side);
    }
  }
  if (!(cell_m > 0.0)) {
    cell_m = std::sqrt(width_m_ * height_m_ / (4.0 * static_cast<double>(segments_.size())));
  }
  // Where long slanting walls are many, larger cells keep the lists within bounds.
  do {
    size_cells(cell_m);
    cell_m *= 2.0;
  } while (fill() > entries_max && columns_ * rows_ > 1);
}

void WallIndex::size_cells(double cell_m) {
  cell_m_ = std::max({cell_m, std::sqrt(width_m_ * height_m_ / cells_max),
                      width_m_ / side_cells_max, height_m_ / side_cells_max});
  per_m_ = 1.0 / cell_m_;
  columns_ = std::max(1, static_cast<int>(std::ceil(width_m_ * per_m_)));
  rows_ = std::max(1, static_cast<int>(std::ceil(height_m_ * per_m_)));
}

/// Puts the segments into their cells; gives their number, and leaves off if it is beyond bounds.
std::size_t WallIndex::fill() {
  const auto for_each_cell_of = [this](const Segment& s, auto&& f) {
    const double m = margin * cell_m_;
    const double dx = s.to.x_m - s.from.x_m, dy = s.to.y_m - s.from.y_m;
    const auto [x0, x1] = std::minmax(s.from.x_m, s.to.x_m);
    const auto [y0, y1] = std::minmax(s.from.y_m, s.to.y_m);
    const int last = std::min(rows_ - 1, row(y1 + m));
    for (int r = std::max(0, row(y0 - m)); r <= last; ++r) {
      double left = x0, right = x1;
      if (dx != 0.0 && dy != 0.0) {  // the piece of it within the row
        const double at_low = s.from.x_m + (r * cell_m_ - m - s.from.y_m) / dy * dx;
        const double at_high = s.from.x_m + ((r + 1) * cell_m_ + m - s.from.y_m) / dy * dx;
        left = std::clamp(std::min(at_low, at_high), x0, x1);
        right = std::clamp(std::max(at_low, at_high), x0, x1);
      }
      const int end = std::min(columns_ - 1, column(right + m));
      for (int c = std::max(0, column(left - m)); c <= end; ++c) {
        f(static_cast<std::size_t>(r) * static_cast<std::size_t>(columns_) +
          static_cast<std::size_t>(c));
      }
    }
  };
  begins_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_) + 1, 0);
  std::size_t count = 0;
  for (const Segment& s : segments_) {
    for_each_cell_of(s, [&](std::size_t cell) { ++begins_[cell + 1], ++count; });
    if (count > entries_max && columns_ * rows_ > 1) return count;
  }
  for (std::size_t cell = 1; cell < begins_.size(); ++cell) begins_[cell] += begins_[cell - 1];
  entries_.resize(count);
  std::vector<std::size_t> next(begins_.begin(), begins_.end() - 1);
  for (std::size_t i = 0; i < segments_.size(); ++i) {
    for_each_cell_of(segments_[i], [&](std::size_t cell) {
      entries_[next[cell]++] = {segments_[i], static_cast<int>(i)};
    });
  }
  return count;
}

void WallIndex::set(std::size_t barrier, std::uint8_t up) {
  require(barrier < up_.size(), "walls: no barrier of that number");
  up_[barrier] = up;
}

}  // namespace hearsay::plan
