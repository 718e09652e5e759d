#include "filters/grid/beta.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/kernel/error.hpp"
#include "tests/filters/grid/samples.hpp"

namespace hearsay::grid {
namespace {

/// ∫ f over (0, 1) by the tanh-sinh rule: poles at the ends, as of small α, do no harm.
template <typename F>
double integral(const F& f) {
  const double step = 1.0 / 64;
  double sum = 0.0;
  for (int k = -64 * 4; k <= 64 * 4; ++k) {
    const double t = k * step, s = std::acos(-1.0) * std::sinh(t);
    const double x = 1.0 / (1.0 + std::exp(-s)), y = 1.0 / (1.0 + std::exp(s));
    sum += f(x, y) * std::acos(-1.0) * std::cosh(t) * x * y * step;
  }
  return sum;
}

/// log of the density at x = 1 − y.
double log_density(const Beta& b, double x, double y) {
  return std::lgamma(b.alpha + b.beta) - std::lgamma(b.alpha) - std::lgamma(b.beta) +
         (b.alpha - 1) * std::log(x) + (b.beta - 1) * std::log(y);
}

TEST(BetaBelief, MomentsOfEquation428) {
  EXPECT_EQ(mean({2.0, 6.0}), 0.25);
  EXPECT_NEAR(variance({2.0, 6.0}), 12.0 / (64.0 * 9.0), 1e-17);
  EXPECT_NEAR(variance({1.0, 1.0}), 1.0 / 12.0, 1e-16);
}

TEST(BetaBelief, EntropyAndDivergenceHaveThePublishedValues) {
  EXPECT_NEAR(entropy({4.0, 12.0}), -0.868649, 5e-7);
  EXPECT_NEAR(entropy({8.0, 2.0}), -0.794920, 5e-7);
  EXPECT_NEAR(entropy({1.0, 1.0}), 0.0, 1e-13);
  EXPECT_NEAR(divergence({2.0, 2.0}, {1.0, 1.0}), 0.125093, 5e-7);
  EXPECT_NEAR(divergence({5.0, 2.0}, {2.0, 5.0}), 3.25, 1e-12);
}

TEST(BetaBelief, EntropyAndDivergenceEqualTheirIntegrals) {
  Stream random = stream("beta integrals");
  for (int i = 0; i < 30; ++i) {
    const Beta p{random.uniform(0.6, 20.0), random.uniform(0.6, 20.0)};
    const Beta q{random.uniform(0.6, 20.0), random.uniform(0.6, 20.0)};
    const double h = integral([&](double x, double y) {
      const double l = log_density(p, x, y);
      return x > 0 && y > 0 ? -std::exp(l) * l : 0.0;
    });
    const double d = integral([&](double x, double y) {
      const double l = log_density(p, x, y);
      return x > 0 && y > 0 ? std::exp(l) * (l - log_density(q, x, y)) : 0.0;
    });
    EXPECT_NEAR(entropy(p), h, 1e-8) << p.alpha << " " << p.beta;
    EXPECT_NEAR(divergence(p, q), d, 1e-8 * (1 + d)) << p.alpha << " " << p.beta;
    EXPECT_NEAR(divergence(p, p), 0.0, 1e-12);
  }
}

TEST(BetaGrid, CountsLooks) {
  BetaGrid grid(square(2), {.prior = {2.0, 3.0}});
  grid.add(1, 1.0, 0.0);
  grid.add(1, 0.25, 0.75);
  grid.add(2, 0.0, 1.0);
  EXPECT_EQ(grid.at(0).alpha, 2.0);
  EXPECT_EQ(grid.at(0).beta, 3.0);
  EXPECT_EQ(grid.at(1).alpha, 3.25);
  EXPECT_EQ(grid.at(1).beta, 3.75);
  EXPECT_EQ(*grid.mean(2), 2.0 / 6.0);
  EXPECT_NEAR(*grid.total_entropy(), 2 * entropy({2, 3}) + entropy({3.25, 3.75}) + entropy({2, 4}),
              1e-12);
  BetaGrid other(square(2), {.prior = {2.0, 3.0}});
  EXPECT_NEAR(*grid.divergence(other),
              divergence({3.25, 3.75}, {2, 3}) + divergence({2, 4}, {2, 3}), 1e-12);
  grid.clear();
  EXPECT_EQ(*grid.divergence(other), 0.0);
}

TEST(BetaGrid, CountsUpToItsLimit) {
  BetaGrid grid(square(1), {.limit = 10.0});
  for (int i = 0; i < 100; ++i) grid.add(0, 1.0, 0.5);
  EXPECT_EQ(grid.at(0).alpha, 11.0);
  EXPECT_EQ(grid.at(0).beta, 11.0);
}

TEST(BetaGrid, WhatIsNoBetaHasNoMean) {
  BetaGrid grid(square(2));
  grid.evidence_mutable()[2] = -1.5F;
  EXPECT_EQ(grid.lawless(), 1);
  EXPECT_FALSE(grid.mean(1));
  EXPECT_FALSE(grid.entropy(1));
  EXPECT_FALSE(grid.total_entropy());
  EXPECT_FALSE(grid.divergence(BetaGrid(square(2))));
  EXPECT_FALSE(BetaGrid(square(2)).divergence(grid));
  EXPECT_TRUE(grid.mean(0));
  std::vector<unsigned char> marks;
  EXPECT_EQ(grid.mark_above(0.4, marks), 3);
  EXPECT_EQ(marks, (std::vector<unsigned char>{1, 0, 1, 1}));
  BernoulliGrid bernoulli(square(2), {.prior = 0.3});
  convert(grid, bernoulli);
  EXPECT_NEAR(bernoulli.probability(1), 0.3, 1e-15);
  EXPECT_NEAR(bernoulli.probability(0), 0.5, 1e-7);
}

TEST(BetaGrid, ConversionsKeepTheMean) {
  Stream random = stream("beta conversion");
  BetaGrid beta(square(8), {.prior = {1.0, 2.0}}), back(square(8), {.prior = {1.0, 2.0}});
  set(beta, random_counts(random, beta.evidence().size()));
  BernoulliGrid bernoulli(square(8), {.prior = 0.2});
  convert(beta, bernoulli);
  convert(bernoulli, 12.0, back);
  for (int i = 0; i < 64; ++i) {
    EXPECT_NEAR(bernoulli.probability(i), *beta.mean(i), 1e-6);
    EXPECT_NEAR(*back.mean(i), *beta.mean(i), 1e-6);
    EXPECT_NEAR(back.at(i).alpha + back.at(i).beta, 15.0, 1e-5);
  }
}

TEST(BetaGrid, RefusesWhatIsNoBelief) {
  EXPECT_THROW(BetaGrid(square(2), {.prior = {0.0, 1.0}}), BrokenInvariant);
  EXPECT_THROW(BetaGrid(square(2), {.prior = {1.0, HUGE_VAL}}), BrokenInvariant);
  EXPECT_THROW(BetaGrid(square(2), {.limit = 0.0}), BrokenInvariant);
  EXPECT_THROW(BetaGrid(square(2), {.limit = 1e9}), BrokenInvariant);
  BetaGrid grid(square(2));
  EXPECT_THROW(grid.add(4, 1.0, 0.0), BrokenInvariant);
  EXPECT_THROW(grid.add(0, -1.0, 0.0), BrokenInvariant);
  EXPECT_THROW(grid.add(0, 0.0, NAN), BrokenInvariant);
  EXPECT_THROW(grid.at(-1), BrokenInvariant);
  EXPECT_THROW(mean(Beta{0.0, 1.0}), BrokenInvariant);
  EXPECT_THROW(entropy(Beta{1.0, -1.0}), BrokenInvariant);
  EXPECT_THROW(grid.divergence(BetaGrid(square(3))), BrokenInvariant);
}

}  // namespace
}  // namespace hearsay::grid
