#include "filters/localization/relative.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "sim/math/functions.hpp"
#include "tests/filters/localization/dense_filter.hpp"

namespace hearsay::localization {
namespace {

using gaussian::Rule;

constexpr Fusion naive{Rule::naive, 1e12};
constexpr Fusion ci{Rule::ci_det, 1e12};

Stream stream(std::string_view purpose, int run = 0) {
  return Stream(1, Purpose(purpose), Entity::agent(run));
}

PoseFilter::Options options_at(const Pose& pose) {
  PoseFilter::Options options;
  options.start = {pose};
  options.start_sigma_m = 0.2;
  options.start_sigma_rad = 0.1;
  options.odometry = {0.03, 0.01, 0.05};
  options.gate = 1e12;
  return options;
}

/// A filter, and the dense one, of a robot that drove a while, so that all of P is correlated.
struct Driven {
  PoseFilter filter;
  DenseFilter dense;
  explicit Driven(const Pose& start = {1.0, 2.0, 0.5})
      : filter(options_at(start)), dense(options_at(start)) {
    for (int i = 0; i < 40; ++i) {
      filter.drive(0, 0.3, 0.1, 0.2);
      dense.drive(0, 0.3, 0.1, 0.2);
    }
  }
  double difference() const {
    const Pose& pose = filter.pose(0);
    const double of_means = std::abs(pose.x_m - dense.x(0)) + std::abs(pose.y_m - dense.x(1)) +
                            std::abs(folded(pose.heading_rad - dense.x(2)));
    return of_means + (filter.covariance(0) - dense.P).cwiseAbs().maxCoeff();
  }
};

const Place said{{2.5, 3.1}, (Eigen::Matrix2d() << 0.04, 0.01, 0.01, 0.09).finished()};

TEST(Relative, APlaceSeenHasTheCovarianceOfTheNumericalJacobian) {
  const Driven driven;
  const Eigen::Matrix3d P = driven.filter.covariance(0);
  const Pose pose = driven.filter.pose(0);
  const RelativeSighting seen{3.0, -1.2, 0.15, 0.08};
  using Parameters = Eigen::Matrix<double, 5, 1>;
  const auto place = [](const Parameters& p) {
    return Eigen::Vector2d(p(0) + p(3) * std::cos(p(2) + p(4)),
                           p(1) + p(3) * std::sin(p(2) + p(4)));
  };
  const Parameters at{pose.x_m, pose.y_m, pose.heading_rad, seen.range_m, seen.bearing_rad};
  Eigen::Matrix<double, 2, 5> J;
  for (int k = 0; k < 5; ++k) {
    const Parameters h = 1e-5 * Parameters::Unit(k);
    J.col(k) = (place(at + h) - place(at - h)) / 2e-5;
  }
  Eigen::Matrix<double, 5, 5> all = Eigen::Matrix<double, 5, 5>::Zero();
  all.topLeftCorner<3, 3>() = P;
  all(3, 3) = 0.15 * 0.15;
  all(4, 4) = 0.08 * 0.08;
  const Place found = place_of(pose, P, seen);
  EXPECT_LT((found.mean - place(at)).norm(), 1e-14);
  EXPECT_LT((found.covariance - J * all * J.transpose()).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(Relative, APlaceSeenAgreesWithMonteCarloForSmallNoise) {
  PoseFilter::Options small = options_at({1.0, 2.0, 0.5});
  small.start_sigma_m = 0.02;
  small.start_sigma_rad = 0.01;
  small.odometry = {0.005, 0.002, 0.004};
  PoseFilter filter(small);
  for (int i = 0; i < 20; ++i) filter.drive(0, 0.3, 0.1, 0.2);
  const Eigen::Matrix3d P = filter.covariance(0), L = P.llt().matrixL();
  const Pose pose = filter.pose(0);
  const RelativeSighting seen{3.0, -1.2, 0.05, 0.01};
  const Place found = place_of(pose, P, seen);
  Stream random = stream("place");
  constexpr int draws = 40'000;
  Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
  for (int i = 0; i < draws; ++i) {
    const Eigen::Vector3d white(random.normal(), random.normal(), random.normal());
    const Eigen::Vector3d e = L * white;
    const double range = seen.range_m + random.normal(0, 0.05);
    const double direction = pose.heading_rad + e.z() + seen.bearing_rad + random.normal(0, 0.01);
    const Eigen::Vector2d off = Eigen::Vector2d(pose.x_m + e.x() + range * std::cos(direction),
                                                pose.y_m + e.y() + range * std::sin(direction)) -
                                found.mean;
    sum += off * off.transpose();
  }
  sum /= draws;
  const Eigen::Matrix2d& S = found.covariance;
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) {
      const double sd = std::sqrt((S(i, i) * S(j, j) + S(i, j) * S(i, j)) / draws);
      EXPECT_NEAR(sum(i, j), S(i, j), 5 * sd);
    }
  }
}

TEST(Relative, AFreshIndependentPositionIsAnUpdateOfTheKalmanFilter) {
  Driven driven;
  EXPECT_EQ(take_position(driven.filter, naive, said, {0.0, 0.0}, 0.0, {}), Taken::fused);
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(2, 3);
  H(0, 0) = H(1, 1) = 1.0;
  driven.dense.update(H, said.covariance, said.mean - driven.dense.x.head<2>());
  EXPECT_LT(driven.difference(), 1e-10);
}

// The position then is p + R(θ)b: differentiated here by differences.
TEST(Relative, AnOldPositionIsAnUpdateOfWhereItWasThen) {
  Driven driven;
  const Eigen::Vector2d behind(-1.5, 0.4);
  const OdometryNoise drift{0.03, 0.01, 0.05};
  const double age_s = 5.0;
  const auto then = [&](const Eigen::Vector3d& x) {
    const double c = std::cos(x(2)), s = std::sin(x(2));
    return Eigen::Vector2d(x(0) + c * behind.x() - s * behind.y(),
                           x(1) + s * behind.x() + c * behind.y());
  };
  const Eigen::Vector3d x = driven.dense.x;
  Eigen::MatrixXd H(2, 3);
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d h = 1e-5 * Eigen::Vector3d::Unit(k);
    H.col(k) = (then(x + h) - then(x - h)) / 2e-5;
  }
  const Eigen::Vector2d way = then(x) - x.head<2>(), across(-way.y(), way.x());
  const Eigen::Matrix2d R = said.covariance +
                            age_s * (0.03 * 0.03 + 0.01 * 0.01) * Eigen::Matrix2d::Identity() +
                            0.05 * 0.05 * age_s / 3.0 * across * across.transpose();
  EXPECT_EQ(take_position(driven.filter, naive, said, behind, age_s, drift), Taken::fused);
  driven.dense.update(H, R, said.mean - then(x));
  EXPECT_LT(driven.difference(), 1e-9);
}

// What is added for an old position covers what odometry is off by on a straight drive.
TEST(Relative, WhatOdometryIsOffBySinceIsAddedForAStraightDrive) {
  const OdometryNoise noise{0.02, 0.02, 0.02};
  constexpr int draws = 20'000, steps = 100;
  constexpr double dt_s = 0.1, speed = 0.5, age_s = steps * dt_s;
  Stream random = stream("drift");
  Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
  for (int i = 0; i < draws; ++i) {
    Pose pose{0.0, 0.0, 0.0};
    for (int k = 0; k < steps; ++k) pose = truly_driven(pose, speed, 0.0, dt_s, noise, random);
    // Where it began, in its present frame, less where odometry says.
    const double c = std::cos(pose.heading_rad), s = std::sin(pose.heading_rad);
    const Eigen::Vector2d off(-c * pose.x_m - s * pose.y_m + speed * age_s,
                              s * pose.x_m - c * pose.y_m);
    sum += off * off.transpose();
  }
  sum /= draws;
  const double length = speed * age_s;
  const double along = 2.0 * 0.02 * 0.02 * age_s;  // of both, as it is not known which way it went
  const double across = along + 0.02 * 0.02 * age_s * length * length / 3.0;
  EXPECT_LT(sum(0, 0), along);
  EXPECT_LT(sum(1, 1), across);
  // The heading's part, measured: across less the sideways noise itself. 2 %: 20,000 draws, and
  // the heading drifts by 0.06 rad.
  const double turned = sum(1, 1) - 0.02 * 0.02 * age_s;
  EXPECT_NEAR(turned, across - along, 0.05 * (across - along));
}

TEST(Relative, ASightingOfACompanionIsAnUpdateOfTheKalmanFilterWithAnUncertainPlace) {
  Driven driven;
  const RelativeSighting seen{3.2, 0.3, 0.15, 0.08};
  const double dx = said.mean.x() - driven.dense.x(0), dy = said.mean.y() - driven.dense.x(1);
  const double r = std::hypot(dx, dy);
  Eigen::MatrixXd H(2, 3);
  H << -dx / r, -dy / r, 0.0, dy / (r * r), -dx / (r * r), -1.0;
  const Eigen::Matrix2d by_place = -H.leftCols<2>();
  Eigen::Matrix2d R = by_place * said.covariance * by_place.transpose();
  R(0, 0) += 0.15 * 0.15;
  R(1, 1) += 0.08 * 0.08;
  EXPECT_EQ(take_sighting(driven.filter, naive, said, seen), Taken::fused);
  driven.dense.update(H, R, {3.2 - r, folded(0.3 - std::atan2(dy, dx) + driven.dense.x(2))});
  EXPECT_LT(driven.difference(), 1e-10);
}

// det(ωA + (1−ω)B) with a B that says nothing of one direction out of three grows from ω = 1 down
// only if tr(A⁻¹B) > 3: else the intersection is the own belief, and nothing is taken in.
TEST(Relative, IntersectionNeverClaimsMoreThanOneOfTheTwoInAnyDirection) {
  Stream random = stream("directions");
  int fused_count = 0;
  for (int i = 0; i < 100; ++i) {
    Driven driven;
    const Eigen::Matrix3d P = driven.filter.covariance(0), own = P.inverse();
    Place place = said;
    place.covariance *= std::pow(10.0, random.uniform(-2.0, 2.0));
    const Eigen::Vector2d behind(random.normal(), random.normal());
    const Pose pose = driven.filter.pose(0);
    const double c = std::cos(pose.heading_rad), s = std::sin(pose.heading_rad);
    Eigen::Matrix<double, 2, 3> H;
    H << 1.0, 0.0, -s * behind.x() - c * behind.y(), 0.0, 1.0, c * behind.x() - s * behind.y();
    const Eigen::Matrix3d told = H.transpose() * place.covariance.inverse() * H;
    const Taken taken = take_position(driven.filter, ci, place, behind, 0.0, {});
    EXPECT_EQ(taken, (P * told).trace() > 3.0 ? Taken::fused : Taken::skipped);
    if (taken == Taken::skipped) {
      EXPECT_EQ(driven.filter.covariance(0), P);
      continue;
    }
    ++fused_count;
    const Eigen::Matrix3d fused = driven.filter.covariance(0).inverse();
    EXPECT_GT(fused.determinant(), own.determinant());
    for (int k = 0; k < 100; ++k) {
      const Eigen::Vector3d u(random.normal(), random.normal(), random.normal());
      EXPECT_LE(u.dot(fused * u), std::max(u.dot(own * u), u.dot(told * u)) * (1.0 + 1e-9));
    }
  }
  EXPECT_GT(fused_count, 30);
  EXPECT_LT(fused_count, 70);
}

/// Mean eᵀP⁻¹e, and its standard error, of a pose that is told the same `times` times.
struct Mean {
  double value, error;
};
Mean told_again(const Fusion& fusion, int times) {
  constexpr int runs = 1000;
  const Driven known;
  const Pose believed = known.filter.pose(0);
  const Eigen::Matrix3d P = known.filter.covariance(0), L = P.llt().matrixL();
  const Eigen::Matrix2d M = said.covariance.llt().matrixL();
  double sum = 0.0, squares = 0.0;
  for (int run = 0; run < runs; ++run) {
    Stream random = stream("told again", run);
    const Eigen::Vector3d e =
        L * Eigen::Vector3d(random.normal(), random.normal(), random.normal());
    const Pose truth{believed.x_m + e.x(), believed.y_m + e.y(), believed.heading_rad + e.z()};
    const Place heard{Eigen::Vector2d(truth.x_m, truth.y_m) +
                          M * Eigen::Vector2d(random.normal(), random.normal()),
                      said.covariance};
    PoseFilter filter = known.filter;
    for (int i = 0; i < times; ++i) take_position(filter, fusion, heard, {0.0, 0.0}, 0.0, {});
    const double nees = pose_nees(filter.pose(0), filter.covariance(0), truth);
    sum += nees;
    squares += nees * nees;
  }
  const double mean = sum / runs;
  return {mean, std::sqrt((squares / runs - mean * mean) / runs)};
}

TEST(Relative, WhoIsToldTheSameAgainAndAgainStaysConsistentByIntersection) {
  Driven driven;
  ASSERT_EQ(take_position(driven.filter, ci, said, {0.0, 0.0}, 0.0, {}), Taken::fused);
  for (const int times : {1, 5, 30}) {
    const Mean mean = told_again(ci, times);
    EXPECT_LT(mean.value, 3.0 + 3.0 * mean.error) << times;
  }
}

// Naively told k times: Ω = Ω_a + kΩ_b, but the error's covariance is Ω⁻¹(Ω_a + k²Ω_b)Ω⁻¹.
TEST(Relative, WhoIsToldTheSameAgainAndAgainBecomesOverconfidentNaively) {
  const Eigen::Matrix3d own = Driven().filter.covariance(0).inverse();
  Eigen::Matrix3d told = Eigen::Matrix3d::Zero();
  told.topLeftCorner<2, 2>() = said.covariance.inverse();
  for (const int k : {1, 5, 30}) {
    const Mean mean = told_again(naive, k);
    const Eigen::Matrix3d fused = own + k * told;
    const double expected = (fused.inverse() * (own + k * k * told)).trace();
    EXPECT_NEAR(mean.value, expected, 4.0 * mean.error) << k;
    if (k == 30) {
      EXPECT_GT(expected, 30.0);
    }
  }
}

TEST(Relative, HeadingsMeetAcrossPlusAndMinusPi) {
  // It thinks that it faces almost −x; the companion says it is on a line that turns it past π.
  PoseFilter filter(options_at({0.0, 0.0, math::pi - 0.02}));
  const Place companion{{-5.0, 0.0}, 1e-4 * Eigen::Matrix2d::Identity()};
  // Heading −π + 0.05, so the companion, in direction π, bears −0.05.
  EXPECT_EQ(take_sighting(filter, naive, companion, {5.0, -0.05, 0.15, 1e-3}), Taken::fused);
  EXPECT_LE(std::abs(filter.pose(0).heading_rad), math::pi);
  EXPECT_LT(filter.pose(0).heading_rad, 0.0);
  // A bearing across ±π: the companion is behind one that faces +x.
  PoseFilter ahead(options_at({0.0, 0.0, 0.0}));
  EXPECT_EQ(take_sighting(ahead, {Rule::naive, 4.0}, {{-5.0, -0.01}, companion.covariance},
                          {5.0, math::pi - 0.01, 0.15, 0.08}),
            Taken::fused);
  EXPECT_LT(std::abs(ahead.pose(0).heading_rad), 0.02);
}

TEST(Relative, BeyondTheGateNothingIsTakenIn) {
  const Pose origin{0.0, 0.0, 0.0};
  // Along an axis the innovation's variance is 0.2² + 0.1².
  const double sigma = std::sqrt(0.04 + 0.01);
  for (const Rule rule : {Rule::naive, Rule::ci_det}) {
    PoseFilter filter(options_at(origin));
    const Place far{{2.001 * sigma, 0.0}, 0.01 * Eigen::Matrix2d::Identity()};
    EXPECT_EQ(take_position(filter, {rule, 4.0}, far, {0.0, 0.0}, 0.0, {}), Taken::outside_gate);
    EXPECT_EQ(filter.pose(0).x_m, 0.0);
    EXPECT_EQ(filter.covariance(0), PoseFilter(options_at(origin)).covariance(0));
    const Place near{{1.999 * sigma, 0.0}, far.covariance};
    EXPECT_EQ(take_position(filter, {rule, 4.0}, near, {0.0, 0.0}, 0.0, {}), Taken::fused);
    EXPECT_GT(filter.pose(0).x_m, 0.0);
  }
}

TEST(Relative, WhatTheRuleCannotUseIsSkipped) {
  PoseFilter filter(options_at({0.0, 0.0, 0.0}));
  EXPECT_EQ(take_position(filter, {Rule::none, 1e12}, said, {0.0, 0.0}, 0.0, {}), Taken::skipped);
  const Place none{said.mean, -Eigen::Matrix2d::Identity()};
  EXPECT_EQ(take_position(filter, naive, none, {0.0, 0.0}, 0.0, {}), Taken::skipped);
  const Place here{{0.0, 0.0}, said.covariance};
  EXPECT_EQ(take_sighting(filter, naive, here, {1.0, 0.0, 0.1, 0.1}), Taken::skipped);
  EXPECT_EQ(filter.covariance(0), PoseFilter(options_at({0.0, 0.0, 0.0})).covariance(0));
}

TEST(Relative, TheCovarianceStaysSymmetricToTheLastBit) {
  Driven driven;
  Stream random = stream("symmetric");
  for (int i = 0; i < 2000; ++i) {
    driven.filter.drive(0, 0.3, random.uniform(-1.0, 1.0), 0.2);
    const Pose& pose = driven.filter.pose(0);
    const Place place{{pose.x_m + random.normal(0, 0.1), pose.y_m + random.normal(0, 0.1)},
                      said.covariance};
    take_position(driven.filter, i % 2 == 0 ? ci : naive, place, {-0.3, 0.1}, 1.0, {});
    const Eigen::Matrix3d P = driven.filter.covariance(0);
    ASSERT_EQ(P, P.transpose()) << i;
    ASSERT_EQ(P.llt().info(), Eigen::Success) << i;
  }
}

}  // namespace
}  // namespace hearsay::localization
