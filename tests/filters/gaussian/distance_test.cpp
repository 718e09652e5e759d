// Distances against the dense formulas, which invert whatever they need.
#include "filters/gaussian/distance.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "dense_trajectory.hpp"
#include "samples.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay::gaussian {
namespace {

using Dense = Eigen::MatrixXd;

double quadratic(const Eigen::VectorXd& v, const Dense& covariance) {
  return v.dot(covariance.inverse() * v);
}

TEST(Nis, IsTheDenseFormula) {
  Stream random = stream("nis");
  for (int n = 1; n <= 6; ++n) {
    for (int m = 1; m <= 3; ++m) {
      const Belief belief = random_belief(random, n);
      const Matrix M = random_matrix(random, m, n), S = random_information(random, m);
      const Vector z = random_vector(random, m);
      const Dense sigma = Dense(belief.omega).inverse();
      const Eigen::VectorXd v = z - M * (sigma * belief.xi);
      const double dense = quadratic(v, M * sigma * M.transpose() + Dense(S));
      EXPECT_NEAR(*nis(belief, M, S, z), dense, 1e-10 * dense);
    }
  }
}

TEST(Nis, OfInformationIsThatOfTheMeasurement) {
  Stream random = stream("nis of information");
  for (int trial = 0; trial < 200; ++trial) {
    const int n = 1 + trial % 6, m = 1 + trial % std::min(n, 3);
    const Belief belief = random_belief(random, n);
    const Belief seen = random_belief(random, m);
    const Dense S = Dense(seen.omega).inverse(), sigma = Dense(belief.omega).inverse();
    const Eigen::VectorXd v = S * seen.xi - (sigma * belief.xi).head(m);
    const double dense = quadratic(v, sigma.topLeftCorner(m, m) + S);
    EXPECT_NEAR(*nis(belief, seen), dense, 1e-9 * dense) << n << m;
  }
}

TEST(Nis, OfInformationDoesNotDependOnUnits) {
  Stream random = stream("nis units");
  const Eigen::Vector2d units(1e-70, 1e60);
  for (int trial = 0; trial < 50; ++trial) {
    const Belief belief = random_belief(random, 2), seen = random_belief(random, 2);
    const auto scaled = [&](const Belief& b) {
      return Belief{Matrix(units.asDiagonal() * b.omega * units.asDiagonal()),
                    Vector(units.asDiagonal() * b.xi)};
    };
    const double expected = *nis(belief, seen);
    EXPECT_NEAR(*nis(scaled(belief), scaled(seen)), expected, 1e-11 * expected);
  }
}

TEST(Nis, OfInformationIsNothingWhereEitherIsSingular) {
  Stream random = stream("nis singular");
  const Belief good = random_belief(random, 2);
  const double inf = std::numeric_limits<double>::infinity();
  const Matrix line = matrix({{1, 3}, {3, 9}});
  for (const Matrix& bad : {Matrix(Matrix::Zero(2, 2)), line, diagonal({1, -1}), diagonal({0, 1}),
                            diagonal({inf, 1}), diagonal({std::nan(""), 1}), diagonal({-1, -1})}) {
    EXPECT_FALSE(nis({bad, vector({0, 0})}, good)) << bad;
    EXPECT_FALSE(nis(good, {bad, vector({0, 0})})) << bad;
  }
  EXPECT_FALSE(nis(good, {diagonal({1, 1}), vector({inf, 0})}));
  EXPECT_FALSE(nis(random_belief(random, 4), {line, vector({0, 0})}));
  EXPECT_THROW(nis(good, random_belief(random, 3)), BrokenInvariant);
}

// The mean of 4000 draws of χ² with m degrees of freedom is m ± √(2m/4000).
TEST(Nis, IsOnAverageTheDimensionOfTheMeasurement) {
  Stream random = stream("nis draws");
  const Matrix P = random_information(random, 4), S = random_information(random, 2);
  const Matrix M = random_matrix(random, 2, 4);
  const Matrix P_root = Eigen::LLT<Matrix>(P).matrixL(), S_root = Eigen::LLT<Matrix>(S).matrixL();
  const Vector truth = random_vector(random, 4);
  double sum = 0;
  const int draws = 4000;
  for (int i = 0; i < draws; ++i) {
    const Belief belief = Belief::from_moments(truth + P_root * random_vector(random, 4), P);
    sum += *nis(belief, M, S, M * truth + S_root * random_vector(random, 2));
  }
  EXPECT_NEAR(sum / draws, 2.0, 4 * std::sqrt(4.0 / draws));
}

TEST(Nis, IsNothingWhereTheBeliefDoesNotDetermineTheState) {
  Belief belief = Belief::unknown(2);
  belief.omega(0, 0) = 1.0;
  EXPECT_FALSE(nis(belief, matrix({{1, 0}}), matrix({{1}}), vector({0})));
  EXPECT_THROW(expected(belief, matrix({{1, 0, 0}})), BrokenInvariant);
}

TEST(Mahalanobis, OfTwoBeliefsIsTheDenseFormula) {
  Stream random = stream("mahalanobis");
  for (int n = 1; n <= 8; ++n) {
    const Belief a = random_belief(random, n), b = random_belief(random, n);
    const Dense Pa = Dense(a.omega).inverse(), Pb = Dense(b.omega).inverse();
    const double dense = quadratic(Pa * a.xi - Pb * b.xi, Pa + Pb);
    EXPECT_NEAR(*mahalanobis_squared(a, b), dense, 1e-10 * dense);
    EXPECT_NEAR(*mahalanobis_squared(b, a), dense, 1e-10 * dense);
  }
  EXPECT_FALSE(mahalanobis_squared(Belief::unknown(2), random_belief(random, 2)));
}

TEST(Mahalanobis, DoesNotDependOnUnits) {
  Stream random = stream("units");
  const Belief a = random_belief(random, 3), b = random_belief(random, 3);
  const Matrix D = diagonal({1e-6, 1.0, 1e5});
  const auto changed = [&](const Belief& x) { return Belief{D * x.omega * D, Vector(D * x.xi)}; };
  const double d2 = *mahalanobis_squared(a, b);
  EXPECT_NEAR(*mahalanobis_squared(changed(a), changed(b)), d2, 1e-10 * d2);
  const double h = *hellinger(a, b);
  EXPECT_NEAR(*hellinger(changed(a), changed(b)), h, 1e-10);
}

Trajectory random_trajectory(Stream& random, int axes, const std::vector<Stamp>& stamps) {
  Trajectory t(2 * axes, stamps.front());
  for (std::size_t k = 0; k < stamps.size(); ++k) {
    if (k > 0) {
      const auto dt = static_cast<double>(stamps[k] - stamps[k - 1]);
      t.augment(stamps[k], white_noise_acceleration(axes, dt, 0.3));
    }
    if (k > 1 && random.bernoulli(0.3)) continue;
    Matrix M = Matrix::Zero(axes, 2 * axes);
    M.leftCols(axes).setIdentity();
    t.update(static_cast<int>(k), measurement_information(M, random_information(random, axes, 1.0),
                                                          10 * random_vector(random, axes)));
  }
  return t;
}

/// Mean and covariance of the states at `stamps`, from the inverse of the whole matrix.
struct Moments {
  Eigen::VectorXd mean;
  Dense covariance;
};
Moments dense_moments(const Trajectory& t, const std::vector<Stamp>& stamps) {
  const int n = t.dimension();
  const Dense sigma = dense(t).inverse();
  const Eigen::VectorXd mu = sigma * dense_vector(t);
  const auto size = static_cast<Eigen::Index>(stamps.size());
  Moments out{Eigen::VectorXd(n * size), Dense(n * size, n * size)};
  for (Eigen::Index i = 0; i < size; ++i) {
    const int k = *t.find(stamps[static_cast<std::size_t>(i)]);
    out.mean.segment(n * i, n) = mu.segment(n * k, n);
    for (Eigen::Index j = 0; j < size; ++j) {
      const int l = *t.find(stamps[static_cast<std::size_t>(j)]);
      out.covariance.block(n * i, n * j, n, n) = sigma.block(n * k, n * l, n, n);
    }
  }
  return out;
}

TEST(Mahalanobis, OfTwoTrajectoriesIsTheDenseFormulaOverCommonStamps) {
  Stream random = stream("trajectories");
  for (int trial = 0; trial < 20; ++trial) {
    const Trajectory a = random_trajectory(random, 2, {0, 1, 2, 4, 5, 7, 8, 9});
    const Trajectory b = random_trajectory(random, 2, {1, 3, 4, 5, 6, 8, 10, 12, 13});
    const std::vector<Stamp> common{1, 4, 5, 8};
    const Moments ma = dense_moments(a, common), mb = dense_moments(b, common);
    const double dense = quadratic(ma.mean - mb.mean, ma.covariance + mb.covariance);
    const auto d2 = mahalanobis_squared(a, b);
    ASSERT_TRUE(d2);
    EXPECT_EQ(d2->steps, 4);
    EXPECT_NEAR(d2->squared, dense, 1e-8 * dense);
  }
}

TEST(Mahalanobis, OfTrajectoriesWithoutCommonStampsIsNothing) {
  Stream random = stream("apart");
  const Trajectory a = random_trajectory(random, 1, {0, 2, 4});
  EXPECT_FALSE(mahalanobis_squared(a, random_trajectory(random, 1, {1, 3, 5})));
  // Seen once: the velocity is unknown.
  Trajectory once(2, 0);
  once.update(0, measurement_information(matrix({{1, 0}}), matrix({{1}}), vector({1})));
  EXPECT_FALSE(mahalanobis_squared(a, once));
}

// (μ_a − μ_b) of independent errors: mean n·steps, standard deviation √(2n·steps).
TEST(Mahalanobis, OfTrajectoriesOfIndependentErrorsIsChiSquared) {
  Stream random = stream("chi squared");
  const int draws = 1500;
  double sum = 0;
  for (int i = 0; i < draws; ++i) {
    // A tiny q leaves no error in common.
    Trajectory t[2] = {{2, 0}, {2, 0}};
    const double place = random.normal(0, 100), speed = random.normal();
    for (Trajectory& one : t) {
      for (int k = 0; k < 4; ++k) {
        if (k > 0) one.augment(k, white_noise_acceleration(1, 1.0, 1e-4));
        const double z = place + speed * k + random.normal();
        one.update(k, measurement_information(matrix({{1, 0}}), matrix({{1}}), vector({z})));
      }
    }
    sum += mahalanobis_squared(t[0], t[1])->squared;
  }
  // Of the 8 dimensions only two, place and speed at the start, have errors of their own.
  EXPECT_NEAR(sum / draws, 2.0, 4 * std::sqrt(4.0 / draws) + 0.01);
}

TEST(Hellinger, OfOneDimensionIsTheClosedForm) {
  const Belief p = Belief::from_moments(vector({1.0}), matrix({{4.0}}));
  const Belief q = Belief::from_moments(vector({3.0}), matrix({{0.25}}));
  const double overlap = std::sqrt(2 * 2 * 0.5 / (4 + 0.25)) * std::exp(-0.25 * 4 / (4 + 0.25));
  EXPECT_NEAR(*hellinger(p, q), std::sqrt(1 - overlap), 1e-14);
}

TEST(Hellinger, IsTheDenseFormula) {
  Stream random = stream("hellinger");
  for (int n = 1; n <= 8; ++n) {
    const Belief p = random_belief(random, n), q = random_belief(random, n);
    const Dense Pp = Dense(p.omega).inverse(), Pq = Dense(q.omega).inverse();
    const Dense middle = 0.5 * (Pp + Pq);
    const double overlap = std::pow(Pp.determinant() * Pq.determinant(), 0.25) /
                           std::sqrt(middle.determinant()) *
                           std::exp(-quadratic(Pp * p.xi - Pq * q.xi, middle) / 8);
    EXPECT_NEAR(*hellinger(p, q), std::sqrt(1 - overlap), 1e-11);
    EXPECT_NEAR(*hellinger(q, p), *hellinger(p, q), 1e-12);
  }
}

// √(δ²/8) for a shift of δ standard deviations, |ε|/4 for variances that differ by a factor 1 + ε.
TEST(Hellinger, OfNearlyEqualBeliefsLosesNothing) {
  const Belief p = Belief::from_moments(vector({0.0}), matrix({{1.0}}));
  EXPECT_EQ(*hellinger(p, p), 0.0);
  const Belief shifted = Belief::from_moments(vector({1e-9}), matrix({{1.0}}));
  EXPECT_NEAR(*hellinger(p, shifted), 1e-9 / std::sqrt(8.0), 1e-15);
  const Belief wider{matrix({{1.0 + 1e-9}}), vector({0.0})};
  EXPECT_NEAR(*hellinger(p, wider), 0.25e-9, 1e-15);
}

TEST(Hellinger, IsOneForBeliefsThatShareNothing) {
  const Belief p = Belief::from_moments(vector({0.0}), matrix({{1.0}}));
  const Belief far = Belief::from_moments(vector({1e6}), matrix({{1.0}}));
  EXPECT_EQ(*hellinger(p, far), 1.0);
  EXPECT_FALSE(hellinger(p, Belief::unknown(1)));
}

}  // namespace
}  // namespace hearsay::gaussian
