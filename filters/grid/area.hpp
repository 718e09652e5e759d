// A rectangle of the plane, cut into square cells.
//
// Cell (column, row) covers [x + column·cell, x + (column+1)·cell) along x, and so along y with its
// row. Cells are numbered row by row: number = row·columns + column, the order in which all grids
// of this family keep their values.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

namespace hearsay::grid {

struct Cell {
  int column = 0, row = 0;
  friend bool operator==(const Cell&, const Cell&) = default;
};
struct Point {
  double x_m = 0.0, y_m = 0.0;
};

/// Numbers of the cells around one: up to 8, rising.
struct Neighbours {
  std::array<int, 8> numbers{};
  int count = 0;
  const int* begin() const { return numbers.data(); }
  const int* end() const { return numbers.data() + count; }
};

class Area {
 public:
  /// Cells a side.
  static constexpr int side_max = 4096;

  struct Options {
    int columns = 1, rows = 1;    ///< 1 … side_max
    double cell_m = 1.0;          ///< side of a cell, > 0
    double x_m = 0.0, y_m = 0.0;  ///< the corner of least x and y
  };
  /// @throws BrokenInvariant outside these ranges, or if the far corner is not finite.
  explicit Area(const Options& options);

  int columns() const { return options_.columns; }
  int rows() const { return options_.rows; }
  int cells() const { return options_.columns * options_.rows; }
  double cell_m() const { return options_.cell_m; }
  /// The corner of least x and y.
  Point origin() const { return {options_.x_m, options_.y_m}; }

  bool has(Cell cell) const {
    return cell.column >= 0 && cell.column < columns() && cell.row >= 0 && cell.row < rows();
  }
  bool has(int number) const { return number >= 0 && number < cells(); }

  /// @throws BrokenInvariant for a cell that is not there, as all that follow.
  int number(Cell cell) const;
  Cell cell(int number) const;
  Point centre(int number) const;
  /// The number of the cell that a point lies in; nothing outside.
  std::optional<int> at(Point point) const;
  /// The cells that share a side or a corner with it.
  Neighbours neighbours(int number) const;

  friend bool operator==(const Area& a, const Area& b);

 private:
  Options options_;
};

}  // namespace hearsay::grid
