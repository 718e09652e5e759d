#include "filters/gaussian/nonlinear.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <string>

#include "sim/kernel/error.hpp"
#include "tests/filters/gaussian/samples.hpp"

namespace hearsay::gaussian {
namespace {

constexpr double pi = 3.14159265358979323846;

/// h(x) = Mx + b.
struct Affine {
  Matrix M;
  Vector b;
  std::optional<Vector> value(const Vector& x) const { return Vector(M * x + b); }
  std::optional<Matrix> jacobian(const Vector&) const { return M; }
  Vector difference(const Vector& a, const Vector& c) const { return a - c; }
};

TEST(NonLinear, OfALinearModelBothFiltersAddItsInformation) {
  Stream random = stream("affine");
  for (int n = 1; n <= dimension_max; ++n) {
    const int m = 1 + n / 3;
    const Affine model{random_matrix(random, m, n), random_vector(random, m)};
    const Matrix S = random_information(random, m);
    const Vector z = random_vector(random, m);
    const Belief belief = random_belief(random, n);
    const Belief exact = measurement_information(model.M, S, z - model.b);
    const Told extended = extended_information(belief, model, z, S);
    ASSERT_TRUE(extended.information);
    EXPECT_LT(relative(extended.information->omega, exact.omega), 1e-13);
    EXPECT_LT(relative(extended.information->xi, exact.xi), 1e-10);
    const Told unscented = unscented_information(belief, model, z, S, usual_kappa(n));
    ASSERT_TRUE(unscented.information);
    EXPECT_LT(relative(unscented.information->omega, exact.omega), 1e-9);
    EXPECT_LT(relative(unscented.information->xi, exact.xi), 1e-9);
    // Where to linearise makes no difference, nor does knowing nothing.
    const Told elsewhere =
        extended_information(Belief::unknown(n), model, z, S, random_vector(random, n));
    ASSERT_TRUE(elsewhere.information);
    EXPECT_LT(relative(elsewhere.information->xi, exact.xi), 1e-10);
  }
}

/// A belief about position and velocity in the plane, and a far observer of it.
const Moments prior{
    vector({30.0, 10.0, 1.0, -2.0}),
    matrix(
        {{9.0, 1.0, 0.5, 0.0}, {1.0, 6.0, 0.0, 0.4}, {0.5, 0.0, 1.0, 0.0}, {0.0, 0.4, 0.0, 1.0}})};
const RangeBearing radar{{vector({-5.0, 2.0}), 0.3}};
const Matrix radar_noise = diagonal({0.5, 0.002});

TEST(Extended, EqualsTheKalmanFilterInCovarianceForm) {
  const Vector z = vector({35.0, 0.1});
  Belief belief = Belief::from_moments(prior.mean, prior.covariance);
  const Told told = extended_information(belief, radar, z, radar_noise);
  ASSERT_TRUE(told.information);
  belief += *told.information;

  const Matrix H = *radar.jacobian(prior.mean), P = prior.covariance;
  const Eigen::MatrixXd K =
      P * H.transpose() * Eigen::MatrixXd(H * P * H.transpose() + radar_noise).inverse();
  EXPECT_LT(relative(*state(belief), prior.mean + K * (z - *radar.value(prior.mean))), 1e-12);
  EXPECT_LT(relative(*covariance(belief), P - K * H * P), 1e-12);
}

TEST(Unscented, EqualsTheUnscentedKalmanFilterInCovarianceForm) {
  const Vector z = vector({35.0, 0.1});
  for (const double kappa : {usual_kappa(4), 0.0, 1.0}) {
    Belief belief = Belief::from_moments(prior.mean, prior.covariance);
    const Told told = unscented_information(belief, radar, z, radar_noise, kappa);
    ASSERT_TRUE(told.information);
    belief += *told.information;

    // Points by another square root would give other moments: the same root, the rest anew.
    const Eigen::MatrixXd L = Eigen::LLT<Eigen::MatrixXd>(prior.covariance).matrixL();
    Eigen::MatrixXd X(4, 9), Z(2, 9);
    Eigen::VectorXd w = Eigen::VectorXd::Constant(9, 0.5 / (4 + kappa));
    w(0) = kappa / (4 + kappa);
    for (int i = 0; i < 9; ++i) {
      X.col(i) = prior.mean;
      if (i > 0) X.col(i) += (i <= 4 ? 1 : -1) * std::sqrt(4 + kappa) * L.col((i - 1) % 4);
      Z.col(i) << std::hypot(X(0, i) + 5, X(1, i) - 2), std::atan2(X(1, i) - 2, X(0, i) + 5) - 0.3;
    }
    const Eigen::VectorXd mean = Z * w;
    const Eigen::MatrixXd dZ = Z.colwise() - mean;
    const Eigen::MatrixXd dX = X.colwise() - Eigen::VectorXd(prior.mean);
    const Eigen::MatrixXd Szz = dZ * w.asDiagonal() * dZ.transpose() + radar_noise;
    const Eigen::MatrixXd K = dX * w.asDiagonal() * dZ.transpose() * Szz.inverse();
    EXPECT_LT(relative(*state(belief), prior.mean + K * (z - mean)), 1e-11) << kappa;
    EXPECT_LT(relative(*covariance(belief), prior.covariance - K * Szz * K.transpose()), 1e-11)
        << kappa;
  }
}

TEST(Extended, BearingsFromTwoPlacesConvergeToWhereTheirRaysMeet) {
  // Nothing is known beforehand; two exact bearings, linearised again and again where the last
  // round ended. From (0, 0) the object stands at 1 rad, from (100, 0) at 2 rad.
  const BearingOnly a{{vector({0.0, 0.0}), 0.0}}, b{{vector({100.0, 0.0}), 0.0}};
  const double away = 100 * std::sin(2.0) / std::sin(1.0);  // law of sines
  const Vector exact = vector({away * std::cos(1.0), away * std::sin(1.0)});
  const Matrix S = matrix({{1e-4}});
  Vector at = vector({60.0, 40.0});
  Belief belief;
  for (int round = 0; round < 12; ++round) {
    belief = Belief::unknown(2);
    for (const auto& [model, z] : {std::pair(a, vector({1.0})), std::pair(b, vector({2.0}))}) {
      const Told told = extended_information(belief, model, z, S, at);
      ASSERT_TRUE(told.information);
      belief += *told.information;
      EXPECT_EQ(definiteness(*told.information), Definiteness::singular);
    }
    ASSERT_EQ(definiteness(belief), Definiteness::positive);
    at = *state(belief);
  }
  EXPECT_LT(relative(at, exact), 1e-12);
  // Across each ray the spread is σ times the distance.
  const Vector across = vector({-std::sin(1.0), std::cos(1.0)});
  EXPECT_NEAR(across.dot(*covariance(belief) * across), 1e-4 * away * away, 1e-8);
}

TEST(Extended, BearingsFromThreeDirectionsFindAPointInSpace) {
  const Vector truth = vector({20.0, 30.0, 5.0});
  Vector at = vector({10.0, 40.0, 0.0});
  for (int round = 0; round < 15; ++round) {
    Belief belief = Belief::unknown(3);
    for (const Vector& place : {vector({0.0, 0.0, 40.0}), vector({60.0, 0.0, 35.0})}) {
      const BearingOnly model{{place, 0.2}};
      belief +=
          *extended_information(belief, model, *model.value(truth), diagonal({1e-4, 1e-4}), at)
               .information;
    }
    at = *state(belief);
  }
  EXPECT_LT(relative(at, truth), 1e-12);
}

TEST(NonLinear, ABearingAcrossTheCutPullsTheShortWay) {
  const BearingOnly model{{vector({0.0, 0.0}), 0.0}};
  for (const bool unscented : {false, true}) {
    Belief belief = Belief::from_moments(vector({-10.0, 0.1}), diagonal({0.01, 0.25}));
    const Vector z = vector({-pi + 0.01});  // seen just below the axis; believed just above
    const Told told = unscented ? unscented_information(belief, model, z, matrix({{1e-4}}), 1.0)
                                : extended_information(belief, model, z, matrix({{1e-4}}));
    ASSERT_TRUE(told.information);
    belief += *told.information;
    EXPECT_NEAR((*state(belief))(1), -0.1, 0.02) << unscented;
  }
}

TEST(NonLinear, WithoutAPointOrASightTheRefusalSaysWhy) {
  const BearingOnly model{{vector({0.0, 0.0}), 0.0}};
  const Matrix S = matrix({{0.01}});
  const Vector z = vector({0.5});
  const Told nowhere = extended_information(Belief::unknown(2), model, z, S);
  EXPECT_FALSE(nowhere.information);
  EXPECT_EQ(nowhere.refusal, Refusal::no_point);
  const Told here = extended_information(Belief::unknown(2), model, z, S, vector({0.0, 0.0}));
  EXPECT_FALSE(here.information);
  EXPECT_EQ(here.refusal, Refusal::not_seen);
  EXPECT_EQ(unscented_information(Belief::unknown(2), model, z, S, 1.0).refusal,
            Refusal::no_spread);
  const Belief negative{diagonal({1.0, -1.0}), vector({3.0, -3.0})};
  EXPECT_EQ(unscented_information(negative, model, z, S, 1.0).refusal, Refusal::no_spread);
  EXPECT_TRUE(extended_information(negative, model, z, S).information) << "it has a mean";
  const Belief overhead = Belief::from_moments(vector({0.0, 0.0}), Matrix::Identity(2, 2));
  EXPECT_EQ(unscented_information(overhead, model, z, S, 1.0).refusal, Refusal::not_seen);
  for (const Refusal r : {Refusal::none, Refusal::no_point, Refusal::not_seen, Refusal::no_spread,
                          Refusal::no_gaussian}) {
    EXPECT_NE(to_string(r), std::string("unknown"));
  }
}

/// Curved the same way along each axis.
struct Bowl {
  std::optional<Vector> value(const Vector& x) const { return Vector(vector({x.squaredNorm()})); }
  std::optional<Matrix> jacobian(const Vector& x) const { return Matrix(2 * x.transpose()); }
  Vector difference(const Vector& a, const Vector& b) const { return a - b; }
};

TEST(Unscented, ANegativeWeightThatLeavesNoGaussianIsRefused) {
  // n = 8, κ = −5: Var |x|² is 16, but by these points 8·(3 − 8) < 0.
  const Belief belief = Belief::from_moments(Vector::Zero(8), Matrix::Identity(8, 8));
  const Told told =
      unscented_information(belief, Bowl{}, vector({8.0}), matrix({{0.01}}), usual_kappa(8));
  EXPECT_FALSE(told.information);
  EXPECT_EQ(told.refusal, Refusal::no_gaussian);
  EXPECT_TRUE(
      unscented_information(belief, Bowl{}, vector({8.0}), matrix({{0.01}}), 1.0).information);
}

TEST(NonLinear, ShapesAndCovariancesThatAreNoneAreRefused) {
  const Belief belief = Belief::from_moments(prior.mean, prior.covariance);
  const Vector z = vector({35.0, 0.1});
  EXPECT_THROW(extended_information(belief, radar, z, diagonal({1.0, 0.0})), BrokenInvariant);
  EXPECT_THROW(unscented_information(belief, radar, z, diagonal({1.0, 0.0}), 0), BrokenInvariant);
  EXPECT_THROW(extended_information(belief, radar, vector({1.0}), radar_noise), BrokenInvariant);
  EXPECT_THROW(unscented_information(belief, radar, z, matrix({{1.0}}), 0), BrokenInvariant);
}

}  // namespace
}  // namespace hearsay::gaussian
