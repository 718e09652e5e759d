#include "filters/grid/area.hpp"

#include <cmath>

#include "sim/kernel/error.hpp"

namespace hearsay::grid {

Area::Area(const Options& options) : options_(options) {
  require(options.columns >= 1 && options.columns <= side_max && options.rows >= 1 &&
              options.rows <= side_max,
          "Area: 1 to 4096 columns and rows");
  require(options.cell_m > 0.0 && std::isfinite(options.cell_m),
          "Area: cells have a positive side");
  require(std::isfinite(options.x_m) && std::isfinite(options.y_m) &&
              std::isfinite(options.x_m + options.columns * options.cell_m) &&
              std::isfinite(options.y_m + options.rows * options.cell_m),
          "Area: corners must be finite");
}

int Area::number(Cell cell) const {
  require(has(cell), "Area: no such cell");
  return cell.row * columns() + cell.column;
}

Cell Area::cell(int number) const {
  require(has(number), "Area: no cell of this number");
  return {number % columns(), number / columns()};
}

Point Area::centre(int number) const {
  const Cell c = cell(number);
  return {options_.x_m + (c.column + 0.5) * cell_m(), options_.y_m + (c.row + 0.5) * cell_m()};
}

std::optional<int> Area::at(Point point) const {
  const double column = std::floor((point.x_m - options_.x_m) / cell_m());
  const double row = std::floor((point.y_m - options_.y_m) / cell_m());
  if (!(column >= 0.0 && column < columns() && row >= 0.0 && row < rows())) return std::nullopt;
  return static_cast<int>(row) * columns() + static_cast<int>(column);
}

Neighbours Area::neighbours(int number) const {
  const Cell middle = cell(number);
  Neighbours around;
  for (int row = middle.row - 1; row <= middle.row + 1; ++row) {
    for (int column = middle.column - 1; column <= middle.column + 1; ++column) {
      const Cell beside{column, row};
      if (beside == middle || !has(beside)) continue;
      around.numbers[static_cast<std::size_t>(around.count++)] = row * columns() + column;
    }
  }
  return around;
}

bool operator==(const Area& a, const Area& b) {
  return a.options_.columns == b.options_.columns && a.options_.rows == b.options_.rows &&
         a.options_.cell_m == b.options_.cell_m && a.options_.x_m == b.options_.x_m &&
         a.options_.y_m == b.options_.y_m;
}

}  // namespace hearsay::grid
