// Beliefs that were made smaller to be sent claim no more than before.
#include "filters/gaussian/content.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "tests/filters/gaussian/samples.hpp"

namespace hearsay::gaussian {
namespace {

using Dense = Eigen::MatrixXd;

/// The least generalised eigenvalue of a against b: a ≥ λb.
double least_ratio(const Dense& a, const Dense& b) {
  return Eigen::GeneralizedSelfAdjointEigenSolver<Dense>(a, b).eigenvalues()(0);
}

TEST(DiagonalPart, LiesBelowTheWholeAndTouchesIt) {
  Stream random = stream("diagonal");
  for (int trial = 0; trial < 400; ++trial) {
    const int n = 1 + trial % dimension_max;
    const Belief belief = random_belief(random, n);
    const Belief part = *diagonal_part(belief);
    EXPECT_TRUE(Dense(part.omega).isDiagonal(0.0));
    EXPECT_NEAR(least_ratio(belief.omega, part.omega), 1.0, 1e-9);
    EXPECT_GE(least_ratio(belief.omega, part.omega), 1.0);
    EXPECT_LT((*state(part) - *state(belief)).norm(), 1e-9 * state(belief)->norm());
  }
}

TEST(DiagonalPart, OfTwoIsTheClosedForm) {
  // λ = 1 − |r| with the correlation r of Ω.
  const Belief part = *diagonal_part({matrix({{4, -1}, {-1, 9}}), vector({1, 2})});
  EXPECT_NEAR(part.omega(0, 0), 4.0 * (1.0 - 1.0 / 6.0), 1e-10);
  EXPECT_NEAR(part.omega(1, 1), 9.0 * (1.0 - 1.0 / 6.0), 1e-10);
  const Matrix diagonal_already = diagonal({2, 1e-9});
  EXPECT_LT(relative(diagonal_part({diagonal_already, vector({1, 1})})->omega, diagonal_already),
            1e-11);
}

TEST(DiagonalPart, OfABeliefWithoutMeanIsNothing) {
  EXPECT_FALSE(diagonal_part(Belief::unknown(2)));
  EXPECT_FALSE(diagonal_part({diagonal({1, 0}), vector({1, 0})}));
  EXPECT_FALSE(diagonal_part({diagonal({1, -1}), vector({1, 0})}));
}

TEST(Quantised, ContainsTheCovarianceAndTheRoundingOfTheMean) {
  Stream random = stream("quantised");
  for (int trial = 0; trial < 1500; ++trial) {
    const int n = 1 + trial % dimension_max;
    const int bits = quantised_bits_min + trial % 13;
    Belief belief = random_belief(random, n);
    belief *= std::pow(10.0, random.uniform(-8, 8));
    const auto grid = quantise(belief, bits);
    ASSERT_TRUE(grid);
    const Belief sent = *belief_of(*grid, bits);
    const Dense P = Dense(belief.omega).inverse(), claimed = Dense(sent.omega).inverse();
    // The worst error: e = ±√P u along the rounding q, so that E(e+q)(e+q)ᵀ ≤ … for any pairing.
    const Vector q = *state(sent) - *state(belief);
    const double slack = 1.0 / 4096.0;
    const Dense moment = (1.0 + slack) * P + (1.0 + 1.0 / slack) * Dense(q * q.transpose());
    EXPECT_GE(least_ratio(claimed, moment), 1.0 - 1e-9) << n << " " << bits;
    EXPECT_GE(least_ratio(belief.omega, sent.omega), 1.0 - 1e-9);
    for (int i = 0; i < n; ++i) EXPECT_LE(std::fabs(q(i)), 1.01 * std::sqrt(P(i, i)) / 4096.0);
  }
}

TEST(Quantised, CostsLessTheMoreBitsItHas) {
  Stream random = stream("price");
  double before = 1e9;
  for (const int bits : {4, 8, 12, 16}) {
    double lost = 0.0;
    for (int trial = 0; trial < 100; ++trial) {
      const Belief belief = random_belief(random, 2);
      const auto sent = belief_of(*quantise(belief, bits), bits);
      lost += *entropy_nats(*sent) - *entropy_nats(belief);
    }
    EXPECT_GT(lost, 0.0);
    EXPECT_LT(lost, before);
    before = lost;
  }
  EXPECT_LT(before / 100.0, 0.01);  // nats a belief with 16 bits
}

TEST(Quantised, AFarMeanIsRoundedMoreAndPaidFor) {
  // 1e9 standard deviations from the origin: the grid is coarser than the belief.
  const Belief belief = Belief::from_moments(vector({1e6, -1e6}), diagonal({1e-6, 1e-6}));
  const Belief sent = *belief_of(*quantise(belief, 8), 8);
  const Vector q = *state(sent) - *state(belief);
  EXPECT_GE(1.0 / sent.omega(0, 0), 1e-6 + q(0) * q(0));
  EXPECT_LT(1.0 / sent.omega(0, 0), 10.0);
}

TEST(Quantised, WhatDoesNotFitIsNothing) {
  EXPECT_FALSE(quantise(Belief::unknown(2), 8));
  EXPECT_FALSE(quantise({diagonal({1, 0}), vector({1, 0})}, 8));
  EXPECT_FALSE(quantise(Belief::from_moments(vector({0}), diagonal({1e-90})), 8));
  EXPECT_FALSE(quantise(Belief::from_moments(vector({1e60}), diagonal({1})), 8));
  QuantisedBelief wild{.dimension = 2};
  wild.entries = {0, 0, 0};  // off the diagonal −1, on it 2^(1−bits)
  EXPECT_FALSE(belief_of(wild, 8));
}

TEST(Gain, TakesTheInformationVectorAlong) {
  Stream random = stream("gain");
  for (int trial = 0; trial < 100; ++trial) {
    const int n = 1 + trial % dimension_max;
    const Belief belief = random_belief(random, n);
    const Belief part = *diagonal_part(belief);
    const Matrix gain = gain_of(belief.omega, part.omega);
    EXPECT_LT(relative(gain * belief.xi, part.xi), 1e-8);
    EXPECT_LT(relative(gain * belief.omega, part.omega), 1e-10);
  }
}

}  // namespace
}  // namespace hearsay::gaussian
