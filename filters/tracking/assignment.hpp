// Costs of pairs, and the assignment that costs least.
#pragma once

#include <cstddef>
#include <vector>

#include "sim/kernel/error.hpp"

namespace hearsay::tracking {

/// A table of numbers, rows × columns; either may be 0.
class Table {
 public:
  Table() = default;
  /// All entries `value`. @throws BrokenInvariant for a negative size.
  Table(int rows, int columns, double value = 0.0) { reset(rows, columns, value); }
  /// The same, reusing the storage.
  void reset(int rows, int columns, double value = 0.0) {
    require(rows >= 0 && columns >= 0, "Table: sizes must not be negative");
    rows_ = rows;
    columns_ = columns;
    values_.assign(static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns), value);
  }

  int rows() const { return rows_; }
  int columns() const { return columns_; }
  double& operator()(int row, int column) { return values_[at(row, column)]; }
  double operator()(int row, int column) const { return values_[at(row, column)]; }

 private:
  std::size_t at(int row, int column) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(column);
  }
  int rows_ = 0;
  int columns_ = 0;
  std::vector<double> values_;
};

/// In place of a column: none.
inline constexpr int unassigned = -1;

/// The column of each row in an assignment of least total cost: no column is used twice, and as
/// many rows as possible have one (all, if there are no more rows than columns). Of assignments
/// that cost the same it is always the same one. O(min² · max) by shortest augmenting paths.
/// @throws BrokenInvariant unless all costs are finite.
/// Jonker & Volgenant, Computing 38, 1987.
std::vector<int> assign(const Table& costs);

/// The least possible largest cost in an assignment of all rows of a square table; 0 if it is
/// empty. O(n³ log n). @throws BrokenInvariant unless the table is square and all costs are finite.
double bottleneck(const Table& costs);

}  // namespace hearsay::tracking
