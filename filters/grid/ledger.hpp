// The rumour ledger of grids: how often each look at a cell is counted in its evidence.
//
// Look k at a cell adds e_k to each number of it: log p(z|x)/p(z|x̄) to a Bernoulli cell, m and n
// to the two layers of a Beta cell. Out of band, beside each grid, the simulator carries for every
// number the weight w_k of every look at its cell: 1 when used once, 2 when it came on two ways,
// fractions under rules that weigh, negative when a rule took away what was never there. Weights
// are combined with the shares with which the fusion rule combines the evidence (shares() in
// filters/grid/fusion.hpp), so that
//     evidence = Σ w_k e_k
// holds for every rule, number by number. One thing alone breaks it: the limit of the grid. A
// number that reached it has lost what went beyond, its weights have not; from then on they tell
// how often looks were counted, no more what the evidence is made of. (Evidence and weights are
// float: the rest is rounding, a few 1e-8 of the largest sum on the way for each fusion.)
//
// Compare filters/ledger/ledger.hpp, that of Gaussian beliefs: there is one list of measurements,
// here each cell has its own, and no true variance comes of it, since a cell is there or not.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "filters/grid/codec.hpp"
#include "filters/grid/fusion.hpp"
#include "filters/grid/sensors.hpp"

namespace hearsay::grid {

/// All looks of a run at the cells of a grid of one shape, cell by cell in the order in which they
/// were made. A number of the grid is cell·layers + layer.
class LookBook {
 public:
  /// @throws BrokenInvariant unless there are 1 or 2 layers and no fewer than 0 cells.
  explicit LookBook(const Shape& shape);
  /// @return the look's index within its cell, from 0. @throws BrokenInvariant for a cell that is
  /// not there, as all that follow, or evidence that is not finite.
  std::uint32_t add(const CellLook& look);
  std::span<const CellLook> looks(int cell) const;
  /// At all cells.
  std::size_t size() const { return size_; }
  const Shape& shape() const { return shape_; }

  /// What a look adds to a layer of its cell: its ratio (one layer), or m and n.
  double added(const CellLook& look, std::size_t layer) const;
  /// Σ w_k e_k of a number of the grid. Weights beyond the cell's looks are not looked at, looks
  /// beyond the weights have none.
  double weighted_sum(std::size_t number, std::span<const float> weights) const;

 private:
  Shape shape_;
  std::size_t size_ = 0;
  std::vector<std::vector<CellLook>> looks_;
};

/// The weights of one grid, or of a message about it. A number's weights are one row, as long as
/// the latest look that it has met; rows that copies have in common are stored once. A copy
/// costs one pointer for 32 numbers; whoever changes a row then makes one of its own (the only
/// allocation, but for rows that grow).
///
/// Weights are float, of 1e-30 to 1e30: what is less counts as 0, what is more stays there (loops
/// double weights without end).
class LookLedger {
 public:
  /// Has met no look. @throws BrokenInvariant as LookBook.
  explicit LookLedger(const Shape& shape = {});

  /// Look `index` at the cell was used once, directly: its weight in every layer grows by one.
  /// @throws BrokenInvariant for a cell that is not there, as all that follow.
  void looked(int cell, std::uint32_t index);

  /// Of the numbers of the cells from `first_cell` on, as fuse() does with their evidence:
  /// this = own·this + heard·heard − common·common. `heard`: of the message. `common`: of what was
  /// handed to fuse() as common; nullptr if that was 0.
  /// @throws BrokenInvariant for ledgers of another shape or this one, or shares of part of a cell.
  void combine(int first_cell, std::span<const Shares> shares, const LookLedger& heard,
               const LookLedger* common = nullptr);
  /// this = own − heard, everywhere: of what less_heard() makes. Rows that stay what they were
  /// stay shared. @throws BrokenInvariant as combine().
  void difference(const LookLedger& own, const LookLedger& heard);
  /// Takes `count` cells from `first_cell` on from another ledger.
  void copy_range(int first_cell, int count, const LookLedger& from);
  void clear();  ///< back to no look
  /// Of a number, in place of what they were, by index of the look.
  void assign(std::size_t number, std::span<const float> weights);

  /// Of a number (cell·layers + layer), by index of the look.
  std::span<const float> weights(std::size_t number) const;
  const Shape& shape() const { return shape_; }

 private:
  using Row = std::shared_ptr<std::vector<float>>;
  static constexpr std::size_t page_rows = 32;
  using Page = std::array<Row, page_rows>;
  inline static const Row no_row{};
  struct Term {
    double share = 0.0;
    std::span<const float> weights;
  };
  using Terms = std::array<Term, 3>;
  static constexpr std::size_t block = 64;  // of weights summed at a time
  using Block = std::array<float, block>;

  std::size_t numbers() const { return static_cast<std::size_t>(shape_.cells) * shape_.layers; }
  const Row& row(std::size_t number) const;
  Row& slot(std::size_t number);
  void take(std::size_t number, const Row& other);
  void put(std::size_t number, const Terms& terms);
  static std::span<const float> sum(const Terms& terms, std::size_t from, std::size_t size,
                                    Block& out);
  static bool are_sum(std::span<const float> weights, const Terms& terms);
  static void write_sum(const Terms& terms, std::span<float> out);

  Shape shape_;
  std::vector<std::shared_ptr<Page>> pages_;  // none: no row in it
};

/// Over all looks in the book and all layers, each a weight; but those are left out to which the
/// look added 0 (n = 0, or a detector faded to ½): no evidence has it, whatever its weight.
struct LookMultiplicity {
  double mean = 0.0;  ///< of those with |w| > 1e-6; NaN if there is none
  double max = 0.0;   ///< of the same
  /// Of the same, the share with w > 1 + 1e-4. Float weights that should be 1 are off it by
  /// roundings, 6e-8 a fusion, which thousands of fusions under rules that weigh may add up to
  /// 1e-5 and more; what was counted twice is farther off.
  double share_above_one = 0.0;
  /// Of all, the share with |w| ≤ 1e-6: never heard of here, or lost; 0 if there are no looks.
  double share_missing = 0.0;
  std::size_t looks = 0;  ///< with |w| > 1e-6
};
/// @throws BrokenInvariant for shapes that differ, as the next.
LookMultiplicity multiplicity(const LookLedger& ledger, const LookBook& book);

/// The largest |evidence − Σ w_k e_k| over the numbers of a grid, or of what was sent: rounding, as
/// long as no number has reached its limit.
double largest_gap(const LookLedger& ledger, const LookBook& book, std::span<const float> evidence);

}  // namespace hearsay::grid
