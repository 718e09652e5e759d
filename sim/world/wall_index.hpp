// The walls of a plan, found by where they are: a uniform grid over the plan, in each of its cells
// the walls that pass through. Rays, moving robots and paths look their walls up here, at a cost
// that grows with the cells they pass, not with the number of walls.
//
// Barriers are rectangles named from the beginning that can stand or not: a corridor blocked in the
// middle of a run. They are in the grid all the time, so that to switch one is to write one byte.
// Nobody is pushed aside by a barrier: who is in its way when it comes up stands inside, or across
// its edge.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/world/plan.hpp"

namespace hearsay::plan {

class WallIndex {
 public:
  /// All barriers are down. Cells have about `cell_m` a side, 0: chosen by the number of walls;
  /// more where there would be too many.
  /// @throws InputError for a barrier that is not within the plan or has a side of length 0.
  explicit WallIndex(const Plan& plan, std::span<const Rectangle> barriers = {},
                     double cell_m = 0.0);

  /// Puts a barrier up, takes it down. @throws BrokenInvariant for a number that is none.
  void block(std::size_t barrier) { set(barrier, 1); }
  void unblock(std::size_t barrier) { set(barrier, 0); }
  std::size_t barriers() const { return up_.size(); }
  /// Whether a barrier is up; `barrier` < barriers().
  bool up(std::size_t barrier) const { return up_[barrier] != 0; }

  double width_m() const { return width_m_; }
  double height_m() const { return height_m_; }
  bool contains(Point p) const {
    return p.x_m >= 0.0 && p.y_m >= 0.0 && p.x_m <= width_m_ && p.y_m <= height_m_;
  }
  /// The walls of the plan in its order, then the four sides of each barrier.
  std::span<const Segment> segments() const { return segments_; }
  /// Whether the segment is there: a wall, or of a barrier that is up.
  bool stands(int segment) const {
    const auto i = static_cast<std::size_t>(segment);
    return i < walls_ || up_[(i - walls_) / 4] != 0;
  }

  double cell_m() const { return cell_m_; }
  int columns() const { return columns_; }
  int rows() const { return rows_; }
  /// Where a coordinate is, also beyond the plan: −1 … columns(), rows().
  int column(double x_m) const { return along(x_m, columns_); }
  int row(double y_m) const { return along(y_m, rows_); }

  /// A segment and its number.
  struct Entry {
    Segment segment;
    int number;
  };
  /// What passes through a cell or within 1e-6 of its side by it, standing or not.
  std::span<const Entry> in_cell(int column, int row) const {
    const auto cell = static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                      static_cast<std::size_t>(column);
    return std::span(entries_).subspan(begins_[cell], begins_[cell + 1] - begins_[cell]);
  }

  /// Calls f(segment) for all that stand and pass through the cells of a box, some of them more
  /// than once.
  template <typename F>
  void for_each_in(Point low, Point high, F&& f) const {
    const int c0 = std::max(0, column(low.x_m)), c1 = std::min(columns_ - 1, column(high.x_m));
    const int r0 = std::max(0, row(low.y_m)), r1 = std::min(rows_ - 1, row(high.y_m));
    for (int r = r0; r <= r1; ++r) {
      for (int c = c0; c <= c1; ++c) {
        for (const Entry& entry : in_cell(c, r)) {
          if (stands(entry.number)) f(entry.segment);
        }
      }
    }
  }

 private:
  int along(double at_m, int count) const {
    return static_cast<int>(std::clamp(std::floor(at_m * per_m_), -1.0, count + 0.0));
  }
  void set(std::size_t barrier, std::uint8_t up);
  void size_cells(double cell_m);
  std::size_t fill();

  double width_m_, height_m_;
  double cell_m_ = 1.0, per_m_ = 1.0;
  int columns_ = 1, rows_ = 1;
  std::size_t walls_;
  std::vector<Segment> segments_;
  std::vector<std::uint8_t> up_;
  std::vector<std::size_t> begins_;
  std::vector<Entry> entries_;
};

}  // namespace hearsay::plan
