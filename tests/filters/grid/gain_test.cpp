#include "filters/grid/gain.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/kernel/error.hpp"
#include "tests/filters/grid/samples.hpp"

namespace hearsay::grid {
namespace {

double binary_entropy(double p) {
  return p <= 0.0 || p >= 1.0 ? 0.0 : -p * std::log(p) - (1 - p) * std::log1p(-p);
}

TEST(GridGain, IsTheInformationThatALookHasAboutACell) {
  // Symmetric in cell and look: H(Z) − p·H(Z|x) − (1−p)·H(Z|x̄).
  Stream random = stream("mutual information");
  for (int i = 0; i < 500; ++i) {
    const double p = random.uniform(0.01, 0.99);
    const Detector d{random.uniform(0.05, 0.95), random.uniform(0.05, 0.95)};
    const double information = binary_entropy(p * d.p_detect + (1 - p) * d.p_false) -
                               p * binary_entropy(d.p_detect) - (1 - p) * binary_entropy(d.p_false);
    EXPECT_NEAR(expected_gain(std::log(p / (1 - p)), d), information, 1e-13);
  }
  EXPECT_EQ(expected_gain(1.3, {0.5, 0.5}), 0.0);
}

TEST(GridGain, IsTheMeanFallOfEntropyOverSimulatedLooks) {
  Stream random = stream("simulated looks");
  constexpr int draws = 40000;
  for (const double p : {0.5, 0.1, 0.85}) {
    for (const Detector& d : {Detector{0.962, 0.045}, Detector{0.7, 0.4}}) {
      double sum = 0.0, squares = 0.0;
      for (int i = 0; i < draws; ++i) {
        BernoulliGrid grid(square(1), {.prior = p});
        const double before = grid.total_entropy();
        const bool there = random.bernoulli(p);
        const bool seen = random.bernoulli(there ? d.p_detect : d.p_false);
        grid.add(0, log_likelihood_ratio(d, seen ? 1.0 : 0.0));
        const double fall = before - grid.total_entropy();
        sum += fall;
        squares += fall * fall;
      }
      const double mean = sum / draws, variance = squares / draws - mean * mean;
      const BernoulliGrid grid(square(1), {.prior = p});
      const std::vector<CellInView> cells{{0, d}};
      EXPECT_NEAR(expected_gain(grid, cells), mean, 4.5 * std::sqrt(variance / draws) + 1e-7);
    }
  }
}

TEST(GridGain, OfBetaIsTheInformationThatALookHasAboutTheProbability) {
  // H(Z) − E[H(Z|X)] over X ~ B(α, β), by the midpoint rule.
  Stream random = stream("beta information");
  for (int i = 0; i < 40; ++i) {
    const Beta b{random.uniform(1.0, 12.0), random.uniform(1.0, 12.0)};
    const double norm = std::lgamma(b.alpha + b.beta) - std::lgamma(b.alpha) - std::lgamma(b.beta);
    constexpr int steps = 200000;
    double inside = 0.0;
    for (int k = 0; k < steps; ++k) {
      const double x = (k + 0.5) / steps;
      inside += std::exp(norm + (b.alpha - 1) * std::log(x) + (b.beta - 1) * std::log1p(-x)) *
                binary_entropy(x) / steps;
    }
    EXPECT_NEAR(expected_gain(b), binary_entropy(mean(b)) - inside, 1e-8);
  }
}

TEST(GridGain, OfBetaIsTheMeanFallOfEntropyOverSimulatedLooks) {
  Stream random = stream("simulated beta looks");
  constexpr int draws = 40000;
  for (const BetaCounts& counts : {BetaCounts{1.0, 1.0}, BetaCounts{0.1, 1.0}}) {
    BetaGrid prior(square(1), {.prior = {2.0, 3.0}});
    double sum = 0.0, squares = 0.0;
    for (int i = 0; i < draws; ++i) {
      BetaGrid grid = prior;
      random.bernoulli(0.4) ? grid.add(0, counts.m, 0.0) : grid.add(0, 0.0, counts.n);
      const double fall = *prior.total_entropy() - *grid.total_entropy();
      sum += fall;
      squares += fall * fall;
    }
    const double mean = sum / draws, variance = squares / draws - mean * mean;
    const std::vector<CellInView> cells{{0, {0.9, 0.1}}};
    EXPECT_NEAR(expected_gain(prior, cells, counts), mean,
                4.5 * std::sqrt(variance / draws) + 1e-7);
  }
}

TEST(GridGain, OfALookIsTheSumOverItsCells) {
  BernoulliGrid grid(square(2));
  grid.add(1, 2.0);
  const std::vector<CellInView> cells{{0, {0.9, 0.1}}, {1, {0.8, 0.3}}};
  EXPECT_NEAR(expected_gain(grid, cells),
              expected_gain(0.0, {0.9, 0.1}) + expected_gain(2.0, {0.8, 0.3}), 1e-15);
  EXPECT_EQ(expected_gain(grid, {}), 0.0);
  BetaGrid beta(square(2));
  beta.evidence_mutable()[0] = -2.0F;  // no Beta in cell 0
  EXPECT_EQ(expected_gain(beta, cells), expected_gain(Beta{1, 1}));
  const std::vector<CellInView> outside{{4, {0.9, 0.1}}};
  EXPECT_THROW(expected_gain(grid, outside), BrokenInvariant);
  EXPECT_THROW(expected_gain(Beta{1, 1}, BetaCounts{-1.0, 1.0}), BrokenInvariant);
}

TEST(GridGain, TheBestMoveWeighsGainAndCost) {
  const std::vector<Move> moves{{1.0, 0.0}, {3.0, 1.0}, {3.0, 1.0}, {3.5, 2.0}};
  EXPECT_EQ(best_move(moves, {1.0, 0.0}), 3);
  EXPECT_EQ(best_move(moves, {1.0, 1.0}), 1);
  EXPECT_EQ(best_move(moves, {1.0, 5.0}), 0);
  EXPECT_THROW(best_move({}, {1.0, 0.0}), BrokenInvariant);
}

}  // namespace
}  // namespace hearsay::grid
