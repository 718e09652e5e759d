#include "filters/grid/bernoulli.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sim/kernel/error.hpp"
#include "tests/filters/grid/samples.hpp"

namespace hearsay::grid {
namespace {

double logit(double p) { return std::log(p / (1.0 - p)); }

TEST(BernoulliGrid, KnowsThePriorAtFirst) {
  const BernoulliGrid grid(square(3), {.prior = 0.2});
  for (int i = 0; i < 9; ++i) {
    EXPECT_NEAR(grid.probability(i), 0.2, 1e-15);
    EXPECT_NEAR(grid.entropy(i), -0.2 * std::log(0.2) - 0.8 * std::log(0.8), 1e-15);
  }
  EXPECT_NEAR(BernoulliGrid(square(10)).total_entropy(), 100 * std::log(2.0), 1e-12);
}

TEST(BernoulliGrid, ALookIsBayesRule) {
  Stream random = stream("bayes");
  for (int i = 0; i < 200; ++i) {
    const double prior = random.uniform(0.05, 0.95);
    const double p_d = random.uniform(0.5, 0.99), p_f = random.uniform(0.01, 0.5);
    BernoulliGrid grid(square(1), {.prior = prior});
    grid.add(0, std::log(p_d / p_f));
    EXPECT_NEAR(grid.probability(0), p_d * prior / (p_d * prior + p_f * (1 - prior)), 1e-7);
    grid.add(0, std::log((1 - p_d) / (1 - p_f)));
    const double yes = p_d * (1 - p_d) * prior, no = p_f * (1 - p_f) * (1 - prior);
    EXPECT_NEAR(grid.probability(0), yes / (yes + no), 4e-7);
  }
}

TEST(BernoulliGrid, StaysWithinItsLimitAndCanBeOverruled) {
  BernoulliGrid grid(square(1), {.prior = 0.1, .limit = 5.0});
  for (int i = 0; i < 100; ++i) grid.add(0, 3.0);
  EXPECT_LE(grid.log_odds(0), 5.0);
  EXPECT_NEAR(grid.log_odds(0), 5.0, 1e-6);
  grid.add(0, -4.0);
  EXPECT_NEAR(grid.log_odds(0), 1.0, 1e-6);
  grid.add(0, -HUGE_VAL);
  EXPECT_GE(grid.log_odds(0), -5.0);
  EXPECT_NEAR(grid.log_odds(0), -5.0, 1e-6);
  grid.clear();
  EXPECT_NEAR(grid.probability(0), 0.1, 1e-15);
}

TEST(BernoulliGrid, AnyOrderOfLooksGivesTheSame) {
  // Within rounding: a float below 16 is known to 2^-21, so 200 additions to 1e-4.
  Stream random = stream("order");
  std::vector<double> looks(200);
  for (double& look : looks) look = random.normal(0.0, 0.5);
  BernoulliGrid forth(square(1)), back(square(1));
  double sum = 0.0;
  for (const double look : looks) sum += look;
  for (const double look : looks) forth.add(0, look);
  std::reverse(looks.begin(), looks.end());
  for (const double look : looks) back.add(0, look);
  EXPECT_NEAR(forth.log_odds(0), sum, 1e-4);
  EXPECT_NEAR(back.log_odds(0), sum, 1e-4);
}

TEST(BernoulliGrid, AThousandLooksInFloatKeepTheProbability) {
  // What float costs: probabilities after 1000 looks beside sums in double.
  Stream random = stream("float");
  double worst = 0.0;
  for (int trial = 0; trial < 50; ++trial) {
    BernoulliGrid grid(square(1), {.limit = 64.0});
    double sum = 0.0;
    for (int i = 0; i < 1000; ++i) {
      const double look = random.normal(0.0, 0.2);
      grid.add(0, look);
      sum += look;
    }
    worst = std::max(worst, std::fabs(grid.probability(0) - 1.0 / (1.0 + std::exp(-sum))));
  }
  EXPECT_LT(worst, 1e-5);
}

TEST(BernoulliGrid, EntropyIsAccurateOverAllLogOdds) {
  for (double l = -60.0; l <= 60.0; l += 0.37) {
    const long double p = 1.0L / (1.0L + std::exp(-static_cast<long double>(l)));
    const long double q = 1.0L / (1.0L + std::exp(static_cast<long double>(l)));
    const long double h = -p * (p > 0.5L ? std::log1p(-q) : std::log(p)) -
                          q * (q > 0.5L ? std::log1p(-p) : std::log(q));
    EXPECT_NEAR(bernoulli_entropy(l) / static_cast<double>(h), 1.0, 1e-12) << l;
  }
  EXPECT_EQ(bernoulli_entropy(0.0), bernoulli_entropy(-0.0));
  EXPECT_EQ(bernoulli_entropy(1000.0), 0.0);
}

TEST(BernoulliGrid, DivergenceHasThePublishedValues) {
  EXPECT_NEAR(bernoulli_divergence(logit(0.8), logit(0.5)), 0.192745, 5e-7);
  EXPECT_NEAR(bernoulli_divergence(logit(0.9), logit(0.1)), 1.757780, 5e-7);
}

TEST(BernoulliGrid, DivergenceIsItsDefinitionAndNeverNegative) {
  Stream random = stream("divergence");
  for (int i = 0; i < 1000; ++i) {
    const double l = random.normal(0.0, 6.0);
    const double m = random.bernoulli(0.3) ? l + 1e-3 * random.normal() : random.normal(0.0, 6.0);
    const long double L = l, M = m;
    const long double p = 1.0L / (1.0L + std::exp(-L)), q = 1.0L / (1.0L + std::exp(L));
    const long double r = 1.0L / (1.0L + std::exp(-M)), s = 1.0L / (1.0L + std::exp(M));
    const auto d = static_cast<double>(p * std::log(p / r) + q * std::log(q / s));
    EXPECT_NEAR(bernoulli_divergence(l, m), d, 1e-14 + 1e-12 * d);
    EXPECT_GE(bernoulli_divergence(l, m), 0.0);
    EXPECT_EQ(bernoulli_divergence(l, l), 0.0);
  }
}

TEST(BernoulliGrid, DivergenceOfGridsIsTheSumOverCells) {
  const Area area({.columns = 5, .rows = 2});
  BernoulliGrid central(area), local(area, {.prior = 0.3});
  EXPECT_NEAR(central.divergence(local),
              10 * (0.5 * std::log(0.5 / 0.3) + 0.5 * std::log(0.5 / 0.7)), 1e-12);
  BernoulliGrid a(area), b(area);
  a.add(3, logit(0.8));
  a.add(7, logit(0.9));
  b.add(7, logit(0.1));
  EXPECT_NEAR(a.divergence(b), 0.192745 + 1.757780, 1e-6);
  EXPECT_THROW(a.divergence(BernoulliGrid(Area({.columns = 2, .rows = 5}))), BrokenInvariant);
}

TEST(BernoulliGrid, MarksWhatIsOverAThreshold) {
  BernoulliGrid grid(Area({.columns = 4, .rows = 1}), {.prior = 0.3});
  grid.add(1, 1.0);
  grid.add(2, -1.0);
  grid.add(3, 4.0);
  std::vector<unsigned char> marks;
  for (const double threshold : {0.0, 0.1, 0.4, 0.9, 0.99, 1.0}) {
    int count = 0;
    const int told = grid.mark_above(threshold, marks);
    for (int i = 0; i < 4; ++i) {
      EXPECT_EQ(marks[static_cast<std::size_t>(i)], grid.probability(i) > threshold ? 1 : 0);
      count += grid.probability(i) > threshold ? 1 : 0;
    }
    EXPECT_EQ(told, count);
  }
}

TEST(BernoulliGrid, RefusesWhatIsNoBelief) {
  const Area area = square(2);
  EXPECT_THROW(BernoulliGrid(area, {.prior = 0.0}), BrokenInvariant);
  EXPECT_THROW(BernoulliGrid(area, {.prior = 1.0}), BrokenInvariant);
  EXPECT_THROW(BernoulliGrid(area, {.prior = NAN}), BrokenInvariant);
  EXPECT_THROW(BernoulliGrid(area, {.limit = 0.0}), BrokenInvariant);
  EXPECT_THROW(BernoulliGrid(area, {.limit = 65.0}), BrokenInvariant);
  EXPECT_THROW(BernoulliGrid(area, {.prior = 0.999, .limit = 2.0}), BrokenInvariant);
  BernoulliGrid grid(area);
  EXPECT_THROW(grid.add(0, NAN), BrokenInvariant);
  EXPECT_THROW(grid.add(4, 1.0), BrokenInvariant);
  EXPECT_THROW(grid.log_odds(-1), BrokenInvariant);
  std::vector<unsigned char> marks;
  EXPECT_THROW(grid.mark_above(1.5, marks), BrokenInvariant);
}

}  // namespace
}  // namespace hearsay::grid
