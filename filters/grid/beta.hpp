// A Beta grid: in each cell the probability X itself is uncertain, X ~ B(α, β). Merino 2007,
// sections 4.4 to 4.6.
//
// α = α₀ + m, β = β₀ + n: the prior's, the same for all cells, and how often something was seen
// and not seen there (eq. 4.30). Only the counts are kept, fused and sent. They are float, for the
// reasons given in filters/grid/bernoulli.hpp, cell by cell (m, n), and at most `limit`; up to 1e4
// an added 1/S is kept to 1e-3, up to 2^24 an added 1 is kept.
//
// Counts below zero are legal: rules that subtract leave them behind when messages cross or get
// lost. Where α ≤ 0 or β ≤ 0 there is no Beta distribution, hence no mean, entropy or divergence.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "filters/grid/area.hpp"
#include "filters/grid/bernoulli.hpp"

namespace hearsay::grid {

struct Beta {
  double alpha = 1.0, beta = 1.0;
  bool exists() const { return alpha > 0.0 && beta > 0.0; }
};
/// α/(α + β) and αβ/((α + β)²(α + β + 1)), eq. 4.28. These four ask for α, β > 0.
/// @throws BrokenInvariant otherwise.
double mean(const Beta& b);
double variance(const Beta& b);
/// Differential entropy, nats; 0 for B(1, 1). To about 1e-13·(α + β).
double entropy(const Beta& b);
/// D(p ‖ q), nats, ≥ 0.
double divergence(const Beta& p, const Beta& q);

class BetaGrid {
 public:
  static constexpr double limit_max = 16777216.0;  ///< 2^24: beyond it a float does not count
  static constexpr std::size_t layers = 2;         ///< numbers a cell

  struct Options {
    Beta prior{1.0, 1.0};  ///< the same for all cells, both > 0
    double limit = 1e6;    ///< of |m| and |n|, in (0, 2^24]
  };
  /// Knows nothing but the prior. @throws BrokenInvariant outside these ranges.
  explicit BetaGrid(const Area& area) : BetaGrid(area, Options{}) {}
  BetaGrid(const Area& area, const Options& options);

  const Area& area() const { return area_; }
  Beta prior() const { return prior_; }

  /// (m, n) of all cells by number: 2·cells numbers. Who writes through `evidence_mutable()` keeps
  /// to least() and greatest().
  std::span<const float> evidence() const { return evidence_; }
  std::span<float> evidence_mutable() { return evidence_; }
  float least() const { return -limit_; }
  float greatest() const { return limit_; }

  /// m detections and n non-detections, ≥ 0 and finite. @throws BrokenInvariant otherwise, and for
  /// a cell that is not there, as all that follow.
  void add(int number, double m, double n);
  void clear();  ///< back to the prior

  Beta at(int number) const;
  std::optional<double> mean(int number) const;
  std::optional<double> entropy(int number) const;
  /// Cells without a Beta distribution.
  int lawless() const;
  /// nats, the sum over cells; nothing if one has none.
  std::optional<double> total_entropy() const;
  /// Σ D(this ‖ other) over cells, nats; nothing if one of the cells has none. @throws
  /// BrokenInvariant unless both have the same area.
  std::optional<double> divergence(const BetaGrid& other) const;

  /// For each cell 1 if its mean is over the threshold, else 0 (also where there is no mean);
  /// returns how many are.
  int mark_above(double threshold, std::vector<unsigned char>& marks) const;

 private:
  Area area_;
  Beta prior_;
  float limit_;
  std::vector<float> evidence_;
};

/// The Bernoulli belief of the same mean, log α/β; where there is no Beta, the prior of `out`.
/// @throws BrokenInvariant unless both have the same area.
void convert(const BetaGrid& from, BernoulliGrid& out);
/// The Beta belief of the same mean whose counts add up to `strength` ≥ 0:
/// α = p·s, β = (1−p)·s with s = strength + α₀ + β₀. (A count below zero says that the prior leans
/// the other way.)
void convert(const BernoulliGrid& from, double strength, BetaGrid& out);

}  // namespace hearsay::grid
