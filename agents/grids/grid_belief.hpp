// A certainty grid of either kind, as agents hold it.
#pragma once

#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "filters/grid/bernoulli.hpp"
#include "filters/grid/beta.hpp"
#include "filters/grid/codec.hpp"
#include "filters/grid/fusion.hpp"
#include "filters/grid/regions.hpp"
#include "filters/grid/sensors.hpp"

namespace hearsay {

class GridBelief {
 public:
  using Options = std::variant<grid::BernoulliGrid::Options, grid::BetaGrid::Options>;
  /// Knows nothing but the prior. @throws BrokenInvariant for options out of range.
  GridBelief(const grid::Area& area, const Options& options);

  const grid::Area& area() const;
  grid::Shape shape() const;
  /// Of all cells by number, layers numbers a cell.
  std::span<const float> evidence() const;
  /// In place of what it believes: evidence of a grid of the same shape. @throws BrokenInvariant
  /// for another number of numbers.
  void assign(std::span<const float> evidence);

  void add(std::span<const grid::CellLook> looks);
  void fuse(grid::Rule rule, const grid::Heard& heard, double omega);
  /// The shares with which fuse() of the same arguments makes each number; see filters/grid.
  void shares(grid::Rule rule, const grid::Heard& heard, double omega,
              std::span<grid::Shares> out) const;
  void clear();

  /// What a look at these cells is expected to tell, nats.
  double expected_gain(std::span<const grid::CellInView> cells) const;
  /// Of a cell; of a Beta cell the mean, nothing where it is lawless.
  std::optional<double> probability(int cell) const;
  /// Parameters of a Beta cell; nothing of a Bernoulli cell.
  std::optional<grid::Beta> beta(int cell) const;
  /// Σ over cells, nats; nothing if a Beta cell has no distribution.
  std::optional<double> total_entropy() const;
  std::optional<double> divergence(const GridBelief& other) const;
  /// Marks the cells whose probability is over the threshold; returns how many there are.
  int mark_above(double threshold, std::vector<unsigned char>& marks) const;
  std::span<const grid::Region> regions(grid::RegionFinder& finder, double threshold) const;

 private:
  std::variant<grid::BernoulliGrid, grid::BetaGrid> grid_;
};

}  // namespace hearsay
