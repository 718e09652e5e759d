// A Bernoulli grid: in each cell there is something, or there is not. Merino 2007, section 4.1.
//
// A cell's belief is its log-odds l = log p/(1 − p) = l₀ + e: the prior's, the same for all cells,
// and the evidence e, what looks have added: e += log p(z|x) − log p(z|x̄) (Alg. 4.2). Evidence
// alone is kept, fused and sent: the prior is each agent's own and counted once.
//
// Evidence is float. It is half the bytes of double, in memory and on the air, where they are
// charged; and |l| ≤ limit ≤ 64 keeps one rounding below 4e-6 nats (below 1e-6 for |l| < 16), a
// change of a probability by less than 1e-6, far below what detectors are known to. What is derived
// from it (probabilities, entropies, divergences) is computed in double.
//
// Certainty is never reached: |l| stays within a limit, so that later looks can still overrule
// (section 4.1.3). Where evidence stands at the limit it has lost its count: sums there depend on
// the order of looks.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "filters/grid/area.hpp"

namespace hearsay::grid {

/// p = 1/(1 + exp(−l)), eq. 4.3, in [0, 1].
double probability_of(double log_odds);
/// l = log p/(1 − p); ±∞ at 1 and 0. @throws BrokenInvariant outside [0, 1].
double log_odds_of(double probability);
/// −p log p − (1−p) log(1−p), nats, eq. 4.21; accurate also where it is tiny.
double bernoulli_entropy(double log_odds);
/// D(p ‖ q) of two finite log-odds, nats, ≥ 0, eq. 4.25.
double bernoulli_divergence(double log_odds_p, double log_odds_q);

class BernoulliGrid {
 public:
  static constexpr double limit_max = 64.0;
  static constexpr std::size_t layers = 1;  ///< numbers a cell

  struct Options {
    double prior = 0.5;   ///< probability, the same for all cells, in (0, 1)
    double limit = 20.0;  ///< of |l|, nats, in (0, 64]; 20 is p = 1 − 2e-9
  };
  /// Knows nothing but the prior. @throws BrokenInvariant outside these ranges, or if the prior is
  /// beyond the limit.
  explicit BernoulliGrid(const Area& area) : BernoulliGrid(area, Options{}) {}
  BernoulliGrid(const Area& area, const Options& options);

  const Area& area() const { return area_; }
  double prior_log_odds() const { return prior_; }

  /// Of all cells by number, nats. Who writes through `evidence_mutable()` keeps to least() and
  /// greatest().
  std::span<const float> evidence() const { return evidence_; }
  std::span<float> evidence_mutable() { return evidence_; }
  /// The least and greatest evidence that the limit allows.
  float least() const { return least_; }
  float greatest() const { return greatest_; }

  /// One look at a cell, log p(z|x)/p(z|x̄) in nats; ±∞ ends at the limit. @throws BrokenInvariant
  /// for NaN, and for a cell that is not there, as all that follow.
  void add(int number, double log_likelihood_ratio);
  void clear();  ///< back to the prior

  double log_odds(int number) const;
  double probability(int number) const { return probability_of(log_odds(number)); }
  double entropy(int number) const { return bernoulli_entropy(log_odds(number)); }
  double total_entropy() const;  ///< nats, the sum over cells

  /// Σ D(this ‖ other) over cells, nats. @throws BrokenInvariant unless both have the same area.
  double divergence(const BernoulliGrid& other) const;

  /// For each cell 1 if its probability is over the threshold, else 0; returns how many are. In
  /// terms of evidence: e > log_odds_of(threshold) − l₀.
  int mark_above(double threshold, std::vector<unsigned char>& marks) const;

 private:
  Area area_;
  double prior_;
  float least_, greatest_;
  std::vector<float> evidence_;
};

}  // namespace hearsay::grid
