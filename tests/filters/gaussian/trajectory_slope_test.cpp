// The sweep over two trajectories, and the weight it leads to, against the dense matrix, at every
// size and balance.
#include "filters/gaussian/trajectory_slope.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "dense_trajectory.hpp"
#include "filters/gaussian/trajectory_factor.hpp"
#include "samples.hpp"

namespace hearsay::gaussian {
namespace {

using Dense = Eigen::MatrixXd;

/// Of the size n with any motion, seen at every step; `share` multiplies what is seen.
Trajectory random_trajectory(Stream& random, int n, int steps, double share) {
  Trajectory t(n, 0);
  for (int k = 0; k < steps; ++k) {
    if (k > 0) {
      const Matrix A = Matrix::Identity(n, n) + 0.3 * random_matrix(random, n, n);
      t.augment(k, {A, random_information(random, n, 1.0)});
    }
    Belief seen = random_belief(random, n);
    seen *= share;
    t.update(k, seen);
  }
  return t;
}

std::optional<TrajectorySlope> slope_of(const Trajectory& a, const Trajectory& b, double omega) {
  return SlopeSweep<0>(a, b).at(omega);
}

TEST(TrajectorySlope, IsThatOfTheDenseLogDeterminant) {
  Stream random = stream("slope");
  for (int n = 1; n <= dimension_max; ++n) {
    for (int steps = 1; steps <= 5; ++steps) {
      const Trajectory a = random_trajectory(random, n, steps, 1.0);
      const Trajectory b = random_trajectory(random, n, steps, 1.0);
      for (const double omega : {0.0, 0.2, 0.5, 1.0}) {
        const Dense mixed = omega * dense(a) + (1.0 - omega) * dense(b);
        const Dense change = mixed.fullPivLu().solve(dense(a) - dense(b));
        const double second = -(change * change).trace();
        const auto slope = slope_of(a, b, omega);
        ASSERT_TRUE(slope);
        EXPECT_NEAR(slope->first, change.trace(), 1e-10 * std::sqrt(-second * n * steps));
        EXPECT_NEAR(slope->second, second, -1e-10 * second);
      }
    }
  }
}

template <int N>
void expect_same_bits() {
  Stream random = stream("bits");
  const Trajectory a = random_trajectory(random, N, 9, 1.0);
  const Trajectory b = random_trajectory(random, N, 9, 3.0);
  for (const double omega : {0.0, 0.3, 1.0}) {
    const auto known = SlopeSweep<N>(a, b).at(omega), any = SlopeSweep<0>(a, b).at(omega);
    ASSERT_TRUE(known && any);
    EXPECT_EQ(known->first, any->first);
    EXPECT_EQ(known->second, any->second);
  }
}

TEST(TrajectorySlope, IsTheSameToTheBitWhetherTheSizeIsKnownWhenCompiledOrNot) {
  expect_same_bits<2>();
  expect_same_bits<4>();
  expect_same_bits<6>();
}

/// The same trajectory with its i-th number in units of 2^-exponents[i].
Trajectory in_units(const Trajectory& t, const std::vector<int>& exponents) {
  const int n = t.dimension();
  const auto scaled = [&](Matrix m) {
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) {
        m(i, j) = std::ldexp(m(i, j), exponents[static_cast<std::size_t>(i)] +
                                          exponents[static_cast<std::size_t>(j)]);
      }
    }
    return m;
  };
  Trajectory out(n, t.stamps()[0]);
  out.update(0, {scaled(t.omega(0)), Vector::Zero(n)});
  for (int k = 1; k < t.steps(); ++k) {
    out.append(t.stamps()[static_cast<std::size_t>(k)], scaled(t.omega_next(k - 1)),
               {scaled(t.omega(k)), Vector::Zero(n)});
  }
  return out;
}

TEST(TrajectoryIntersection, DoesNotDependOnUnitsInAnyBit) {
  Stream random = stream("units");
  const Trajectory a = random_trajectory(random, 4, 7, 1.0);
  const Trajectory b = random_trajectory(random, 4, 7, 2.0);
  const double omega = intersect_det(a, b).value();
  EXPECT_GT(omega, 0.0);
  EXPECT_LT(omega, 1.0);
  for (const std::vector<int>& units :
       {std::vector<int>{300, 300, 300, 300}, {-300, -300, -300, -300}, {200, -200, 0, 17}}) {
    EXPECT_EQ(intersect_det(in_units(a, units), in_units(b, units)).value(), omega);
  }
}

// From equals to one that saw a hundred thousand times more, when the best weight lies at an end
// or close to it.
TEST(TrajectoryIntersection, FindsTheLargestDeterminantAtEverySizeAndBalance) {
  Stream random = stream("balance");
  int inside = 0, near_an_end = 0;
  for (int n = 1; n <= dimension_max; ++n) {
    for (const double share : {1e-5, 1e-2, 0.2, 0.5, 1.0, 2.0, 5.0, 1e2, 1e5}) {
      const Trajectory a = random_trajectory(random, n, 4, 1.0);
      const Trajectory b = random_trajectory(random, n, 4, share);
      const Dense A = dense(a), B = dense(b);
      const double expected = zero_of_falling([&](double omega) {
        return Dense(omega * A + (1.0 - omega) * B).fullPivLu().solve(A - B).trace();
      });
      EXPECT_NEAR(intersect_det(a, b).value(), expected, 1e-9) << n << " " << share;
      inside += expected > 0.0 && expected < 1.0;
      near_an_end += std::min(expected, 1.0 - expected) < 0.05;
    }
  }
  EXPECT_GT(inside, 30);
  EXPECT_GT(near_an_end, 10);
}

TEST(TrajectorySlope, IsNothingWhereNoMixtureIsPositive) {
  Trajectory known(2, 0), worse(2, 0);
  known.update(0, {diagonal({1.0, 2.0}), Vector::Zero(2)});
  worse.update(0, {diagonal({1.0, -2.0}), Vector::Zero(2)});
  EXPECT_FALSE(slope_of(known, worse, 0.5));
  EXPECT_FALSE(slope_of(known, worse, 0.25));
  EXPECT_TRUE(slope_of(known, worse, 0.75));
  worse.update(0, {diagonal({1.0, std::numeric_limits<double>::infinity()}), Vector::Zero(2)});
  EXPECT_FALSE(slope_of(known, worse, 0.5));
}

}  // namespace
}  // namespace hearsay::gaussian
