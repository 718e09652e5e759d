#include "filters/gaussian/belief.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>

#include "sim/kernel/error.hpp"
#include "tests/filters/gaussian/samples.hpp"

namespace hearsay::gaussian {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

Belief normal(double mean, double variance) {
  return Belief::from_moments(vector({mean}), matrix({{variance}}));
}

TEST(GaussianBelief, MomentsComeBack) {
  Stream random = stream("moments");
  for (int n = 1; n <= dimension_max; ++n) {
    const Matrix covariance_in = random_information(random, n);
    const Vector mean = random_vector(random, n);
    const Belief belief = Belief::from_moments(mean, covariance_in);
    EXPECT_EQ(belief.dimension(), n);
    EXPECT_LT(relative(*state(belief), mean), 1e-12);
    EXPECT_LT(relative(*covariance(belief), covariance_in), 1e-12);
    EXPECT_LT(relative(belief.omega * covariance_in, Matrix::Identity(n, n)), 1e-11);
    EXPECT_EQ(belief.omega, Matrix(belief.omega.transpose()));
  }
}

TEST(GaussianBelief, AnUpdateEqualsTheTextbookKalmanFilter) {
  Stream random = stream("kalman");
  for (int trial = 0; trial < 200; ++trial) {
    const int n = 1 + static_cast<int>(random.below(dimension_max));
    const int m = 1 + static_cast<int>(random.below(static_cast<std::uint64_t>(n)));
    const Eigen::MatrixXd P = random_information(random, n, 1.0);
    const Eigen::VectorXd x = random_vector(random, n);
    const Eigen::MatrixXd H = random_matrix(random, m, n);
    const Eigen::MatrixXd S = random_information(random, m, 1.0);
    const Eigen::VectorXd z = random_vector(random, m);

    const Eigen::MatrixXd K =
        P * H.transpose() * (H * P * H.transpose() + S).partialPivLu().inverse();
    const Eigen::VectorXd mean = x + K * (z - H * x);
    const Eigen::MatrixXd updated = (Eigen::MatrixXd::Identity(n, n) - K * H) * P;

    Belief belief = Belief::from_moments(x, P);
    belief += measurement_information(H, S, z);
    EXPECT_LT(relative(*state(belief), mean), 1e-10);
    EXPECT_LT(relative(*covariance(belief), updated), 1e-10);
  }
}

TEST(GaussianBelief, WhatWasAddedCanBeTakenOutAgain) {
  Stream random = stream("subtract");
  const Belief a = random_belief(random, 3);
  const Belief b = random_belief(random, 3);
  Belief sum = a;
  sum += b;
  sum -= b;
  EXPECT_LT(relative(sum.omega, a.omega), 1e-12);
  EXPECT_LT(relative(sum.xi, a.xi), 1e-12);
}

TEST(GaussianBelief, KnowingNothingIsLegalAndHasNoMoments) {
  const Belief belief = Belief::unknown(2);
  EXPECT_EQ(definiteness(belief), Definiteness::singular);
  EXPECT_FALSE(state(belief));
  EXPECT_FALSE(covariance(belief));
  EXPECT_FALSE(entropy_nats(belief));
  EXPECT_FALSE(log_determinant(belief.omega));
  EXPECT_FALSE(nees(belief, vector({0, 0})));
  EXPECT_FALSE(claimed_sigma(belief));
  EXPECT_FALSE(kl_divergence_nats(belief, belief));
}

TEST(GaussianBelief, ASingularPriorBecomesOrdinaryOnceEveryDirectionIsMeasured) {
  Belief belief = Belief::unknown(2);
  belief += measurement_information(matrix({{1, 1}}), matrix({{4}}), vector({6}));
  EXPECT_EQ(definiteness(belief), Definiteness::singular);
  EXPECT_FALSE(state(belief));
  belief += measurement_information(matrix({{1, -1}}), matrix({{4}}), vector({2}));
  EXPECT_EQ(definiteness(belief), Definiteness::positive);
  EXPECT_NEAR((*state(belief))(0), 4.0, 1e-14);
  EXPECT_NEAR((*state(belief))(1), 2.0, 1e-14);
  EXPECT_NEAR((*covariance(belief))(0, 0), 2.0, 1e-14);
  EXPECT_NEAR(*claimed_sigma(belief), std::sqrt(2.0), 1e-14);
}

TEST(GaussianBelief, NegativeInformationIsIndefiniteButItsStateIsWhatAUserWouldCompute) {
  const Belief belief{matrix({{2, 0}, {0, -1}}), vector({4, 3})};
  EXPECT_EQ(definiteness(belief), Definiteness::indefinite);
  EXPECT_NEAR((*state(belief))(0), 2.0, 1e-15);
  EXPECT_NEAR((*state(belief))(1), -3.0, 1e-15);
  EXPECT_FALSE(covariance(belief));
  EXPECT_FALSE(entropy_nats(belief));
  EXPECT_FALSE(claimed_sigma(belief));
  EXPECT_DOUBLE_EQ(*nees(belief, vector({2, 0})), -9.0);
}

TEST(GaussianBelief, AnIndefiniteMatrixWithPositiveDiagonalIsFoundOut) {
  const Belief belief{matrix({{1, 3}, {3, 1}}), vector({4, 4})};
  EXPECT_EQ(definiteness(belief), Definiteness::indefinite);
  EXPECT_NEAR((*state(belief))(0), 1.0, 1e-15);
  EXPECT_EQ(definiteness(Belief{matrix({{0, 1}, {1, 0}}), vector({1, 1})}),
            Definiteness::indefinite);
  EXPECT_EQ(definiteness(Belief{matrix({{-1e-6}}), vector({1})}), Definiteness::indefinite);
}

TEST(GaussianBelief, OverflowYieldsNothingAnywhere) {
  for (const double bad : {infinity, -infinity, std::numeric_limits<double>::quiet_NaN()}) {
    const Belief in_omega{matrix({{bad, 0}, {0, 1}}), vector({0, 0})};
    const Belief in_xi{matrix({{1, 0}, {0, 1}}), vector({0, bad})};
    const Belief good{matrix({{1, 0}, {0, 1}}), vector({0, 0})};
    for (const Belief& belief : {in_omega, in_xi}) {
      EXPECT_EQ(definiteness(belief), Definiteness::overflow);
      EXPECT_FALSE(state(belief));
      EXPECT_FALSE(covariance(belief));
      EXPECT_FALSE(entropy_nats(belief));
      EXPECT_FALSE(nees(belief, vector({0, 0})));
      EXPECT_FALSE(claimed_sigma(belief));
      EXPECT_FALSE(kl_divergence_nats(belief, good));
      EXPECT_FALSE(kl_divergence_nats(good, belief));
    }
    EXPECT_FALSE(log_determinant(in_omega.omega));
  }
}

TEST(GaussianBelief, NothingDependsOnTheSizeOfTheInformation) {
  Stream random = stream("size");
  const Belief one = random_belief(random, 3);
  const Vector truth = random_vector(random, 3);
  for (const double factor : {1e-300, 1e-85, 1e-6, 1e85, 1e300}) {
    Belief belief = one;
    belief *= factor;
    EXPECT_EQ(definiteness(belief), Definiteness::positive);
    EXPECT_LT(relative(*state(belief), *state(one)), 1e-13);
    EXPECT_NEAR(*claimed_sigma(belief) * std::sqrt(factor), *claimed_sigma(one), 1e-13);
    EXPECT_NEAR(*nees(belief, truth) / factor, *nees(one, truth), 1e-12);
    EXPECT_NEAR(*log_determinant(belief.omega), *log_determinant(one.omega) + 3 * std::log(factor),
                1e-11);
    EXPECT_EQ(definiteness(Belief{factor * matrix({{1, 2}, {2, 1}}), vector({0, 0})}),
              Definiteness::indefinite);
    EXPECT_EQ(definiteness(Belief{factor * matrix({{1, 2}, {2, 4}}), vector({0, 0})}),
              Definiteness::singular);
  }
}

TEST(GaussianBelief, NothingDependsOnTheUnitsOfTheAxes) {
  // The same belief about (position in m, angle in rad) with the position in µm, and in parsecs.
  const Matrix omega = matrix({{2, 0.6}, {0.6, 0.5}});
  for (const double unit : {1e-6, 1.0, 3e16}) {
    Belief belief{omega, vector({0, 0})};
    belief.omega(0, 0) *= unit * unit;
    belief.omega(0, 1) *= unit;
    belief.omega(1, 0) *= unit;
    EXPECT_EQ(definiteness(belief), Definiteness::positive);
    EXPECT_NEAR((*covariance(belief))(1, 1), 2.0 / (2 * 0.5 - 0.36), 1e-12);
  }
}

TEST(GaussianBelief, DivergencesOfTwoNormalsAsTabulated) {
  EXPECT_NEAR(*kl_divergence_nats(normal(0, 1), normal(0, 4)), 0.318147, 5e-7);
  EXPECT_NEAR(*kl_divergence_nats(normal(0, 4), normal(0, 1)), 0.806853, 5e-7);
  EXPECT_NEAR(*kl_divergence_nats(normal(3, 1), normal(1, 1)), 2.0, 1e-14);
  const Belief p = Belief::from_moments(vector({1, -2}), diagonal({3, 0.4}));
  const Belief q = Belief::from_moments(vector({-2, -1}), matrix({{2, -0.8}, {-0.8, 1}}));
  EXPECT_NEAR(*kl_divergence_nats(p, q), 2.739052159712297, 1e-13);
  EXPECT_NEAR(*kl_divergence_nats(p, p), 0.0, 1e-14);
}

TEST(GaussianBelief, DivergenceFromABeliefOfAbsurdConfidenceIsFinite) {
  Belief absurd = Belief::from_moments(vector({1, 2}), diagonal({1, 1}));
  const Belief central = absurd;
  absurd *= 1e85;
  // ½(2·10⁸⁵ − 2 − 2·85·ln 10) and the reverse.
  EXPECT_NEAR(*kl_divergence_nats(central, absurd) / 1e85, 1.0, 1e-12);
  EXPECT_NEAR(*kl_divergence_nats(absurd, central), 85 * std::log(10.0) - 1.0, 1e-10);
}

TEST(GaussianBelief, EntropyInClosedForm) {
  EXPECT_NEAR(*entropy_nats(normal(7, 4)), 0.5 * std::log(2 * M_PI * M_E * 4), 1e-14);
  const Belief p = Belief::from_moments(vector({1, -2}), diagonal({3, 0.4}));
  EXPECT_NEAR(*entropy_nats(p), 2.929037844806323, 1e-13);
}

TEST(GaussianBelief, NeesIsTheSquaredErrorInSigmas) {
  const Belief p = Belief::from_moments(vector({1, -2}), diagonal({9, 0.25}));
  EXPECT_NEAR(*nees(p, vector({4, -3})), 1.0 + 4.0, 1e-13);
}

TEST(GaussianBelief, NeesOfConsistentBeliefsAveragesToTheDimension) {
  Stream random = stream("nees");
  const Matrix covariance_in = random_information(random, 3);
  const Matrix root = Eigen::MatrixXd(covariance_in).llt().matrixL();
  constexpr int draws = 20000;
  double sum = 0.0;
  for (int i = 0; i < draws; ++i) {
    const Vector mean = root * random_vector(random, 3);
    sum += *nees(Belief::from_moments(mean, covariance_in), Vector::Zero(3));
  }
  // χ² with 3 degrees of freedom has variance 6; five standard deviations of the mean.
  EXPECT_NEAR(sum / draws, 3.0, 5 * std::sqrt(6.0 / draws));
}

TEST(GaussianBelief, WhatACallerGetsWrongIsRefused) {
  EXPECT_THROW(Belief::unknown(0), BrokenInvariant);
  EXPECT_THROW(Belief::unknown(dimension_max + 1), BrokenInvariant);
  EXPECT_THROW(Belief::from_moments(vector({0, 0}), matrix({{1, 2}, {2, 1}})), BrokenInvariant);
  EXPECT_THROW(Belief::from_moments(vector({0, 0}), Matrix::Zero(2, 2)), BrokenInvariant);
  EXPECT_THROW(Belief::from_moments(vector({0, 0, 0}), Matrix::Identity(2, 2)), BrokenInvariant);
  EXPECT_THROW(measurement_information(matrix({{1, 0}}), matrix({{-1}}), vector({0})),
               BrokenInvariant);
  EXPECT_THROW(measurement_information(matrix({{1, 0}}), matrix({{1}}), vector({infinity})),
               BrokenInvariant);
  Belief belief = Belief::unknown(2);
  EXPECT_THROW(belief += Belief::unknown(3), BrokenInvariant);
  EXPECT_THROW(belief -= Belief::unknown(1), BrokenInvariant);
  EXPECT_THROW(nees(belief, vector({1})), BrokenInvariant);
  EXPECT_THROW(kl_divergence_nats(belief, Belief::unknown(1)), BrokenInvariant);
}

TEST(GaussianBelief, EveryDefinitenessHasAName) {
  EXPECT_STREQ(to_string(Definiteness::positive), "positive");
  EXPECT_STREQ(to_string(Definiteness::singular), "singular");
  EXPECT_STREQ(to_string(Definiteness::indefinite), "indefinite");
  EXPECT_STREQ(to_string(Definiteness::overflow), "overflow");
}

}  // namespace
}  // namespace hearsay::gaussian
