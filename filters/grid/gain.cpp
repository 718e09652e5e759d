#include "filters/grid/gain.hpp"

#include <cmath>
#include <cstddef>

#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"

namespace hearsay::grid {

namespace {

/// Of a choice of two, nats; their probabilities add up to 1.
double entropy_of(double p, double q) { return -p * math::log(p) - q * math::log(q); }

}  // namespace

// The fall of the cell's entropy by the answer is that of the answer's entropy by the cell: both
// are their mutual information. So there are fewer logarithms, and none of them of odds.
double expected_gain(double log_odds, const Detector& detector) {
  const double small = math::exp(-std::fabs(log_odds));
  const double likely = 1.0 / (1.0 + small), unlikely = small / (1.0 + small);
  const double p = log_odds < 0.0 ? unlikely : likely, q = log_odds < 0.0 ? likely : unlikely;
  const double detect = detector.p_detect * p + detector.p_false * q;
  const double none = (1.0 - detector.p_detect) * p + (1.0 - detector.p_false) * q;
  const double gain = entropy_of(detect, none) -
                      p * entropy_of(detector.p_detect, 1.0 - detector.p_detect) -
                      q * entropy_of(detector.p_false, 1.0 - detector.p_false);
  return gain > 0.0 ? gain : 0.0;
}

double expected_gain(const Beta& belief, const BetaCounts& counts) {
  require(counts.m >= 0.0 && counts.n >= 0.0 && std::isfinite(counts.m) && std::isfinite(counts.n),
          "gain: counts of a look are finite and not negative");
  const double detect = mean(belief);
  return entropy(belief) - detect * entropy({belief.alpha + counts.m, belief.beta}) -
         (1.0 - detect) * entropy({belief.alpha, belief.beta + counts.n});
}

double expected_gain(const BernoulliGrid& grid, std::span<const CellInView> cells) {
  double sum = 0.0;
  for (const CellInView& c : cells) sum += expected_gain(grid.log_odds(c.cell), c.detector);
  return sum;
}

double expected_gain(const BetaGrid& grid, std::span<const CellInView> cells,
                     const BetaCounts& counts) {
  double sum = 0.0;
  for (const CellInView& c : cells) {
    const Beta belief = grid.at(c.cell);
    if (belief.exists()) sum += expected_gain(belief, counts);
  }
  return sum;
}

int best_move(std::span<const Move> moves, const MoveWeights& weights) {
  require(!moves.empty(), "best move: there are no moves");
  const auto worth = [&](const Move& m) { return weights.gain * m.gain - weights.cost * m.cost; };
  std::size_t best = 0;
  for (std::size_t i = 1; i < moves.size(); ++i) {
    if (worth(moves[i]) > worth(moves[best])) best = i;
  }
  return static_cast<int>(best);
}

}  // namespace hearsay::grid
