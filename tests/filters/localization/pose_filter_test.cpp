#include "filters/localization/pose_filter.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <vector>

#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"
#include "tests/filters/localization/dense_filter.hpp"

namespace hearsay::localization {
namespace {

constexpr double all_pass = 1e12;  // a gate that nothing fails
const std::vector<Eigen::Vector2d> landmarks = {{4.0, 1.0}, {-3.0, 5.0}, {0.5, -6.0}};

Stream stream(std::string_view purpose, int run = 0) {
  return Stream(1, Purpose(purpose), Entity::agent(run));
}

PoseFilter::Options options(int robots, double gate = all_pass) {
  PoseFilter::Options options;
  options.odometry = {0.03, 0.01, 0.05};
  options.gate = gate;
  const std::vector<Pose> start = {{0.0, 0.0, 3.0}, {2.0, -1.0, -1.5}, {-2.0, 1.5, 0.4}};
  options.start.assign(start.begin(), start.begin() + robots);
  return options;
}

/// The last two poses and covariances differ by this much at most.
double difference(const PoseFilter& filter, const DenseFilter& dense) {
  double most = 0.0;
  for (int robot = 0; robot < filter.robots(); ++robot) {
    const Pose& pose = filter.pose(robot);
    const Eigen::Vector3d expected = dense.x.segment<3>(3 * robot);
    most = std::max({most, std::abs(pose.x_m - expected.x()), std::abs(pose.y_m - expected.y()),
                     std::abs(folded(pose.heading_rad - expected.z())),
                     (filter.covariance(robot) - dense.P.block<3, 3>(3 * robot, 3 * robot))
                         .cwiseAbs()
                         .maxCoeff()});
  }
  return most;
}

class AgainstTheDenseFilter : public testing::TestWithParam<int> {};

TEST_P(AgainstTheDenseFilter, ARandomDriveWithSightingsGivesTheSame) {
  const int robots = GetParam();
  PoseFilter filter(options(robots));
  DenseFilter dense(options(robots));
  std::vector<Pose> truth = options(robots).start;
  Stream random = stream("random drive");
  int of_places = 0, of_robots = 0;
  double worst = 0.0;
  for (int step = 0; step < 2000; ++step) {
    const auto robot = static_cast<int>(random.below(static_cast<std::uint64_t>(robots)));
    Pose& there = truth[static_cast<std::size_t>(robot)];
    const double forward = random.uniform(-0.2, 0.5), turn = random.uniform(-1.0, 1.5);
    const double dt_s = random.uniform(0.01, 0.3);
    filter.drive(robot, forward, turn, dt_s);
    dense.drive(robot, forward, turn, dt_s);
    there = truly_driven(there, forward, turn, dt_s, options(1).odometry, random);
    if (random.below(3) == 0) {
      const Eigen::Vector2d& place = landmarks[random.below(landmarks.size())];
      const RelativeSighting seen = sighting_of(there, place, 0.1, 0.03, random);
      EXPECT_EQ(filter.saw_place(robot, place, seen), Use::used);
      dense.saw(robot, place, seen);
      ++of_places;
    } else if (robots > 1 && random.below(2) == 0) {
      const int other = (robot + 1 + static_cast<int>(random.below(2))) % robots;
      const Pose& seen_there = truth[static_cast<std::size_t>(other)];
      const RelativeSighting seen =
          sighting_of(there, {seen_there.x_m, seen_there.y_m}, 0.1, 0.03, random);
      EXPECT_EQ(filter.saw_robot(robot, other, seen), Use::used);
      dense.saw_robot(robot, other, seen);
      ++of_robots;
    }
    worst = std::max(worst, difference(filter, dense));
  }
  EXPECT_LT(worst, 1e-10);
  EXPECT_GT(of_places, 500);
  EXPECT_EQ(of_robots > 500, robots > 1);
}

INSTANTIATE_TEST_SUITE_P(Robots, AgainstTheDenseFilter, testing::Values(1, 3));

// Sightings far better than the odometry press the covariance flat, which rounding would show.
TEST(PoseFilter, TheCovarianceStaysSymmetricToTheLastBitAndPositiveDefinite) {
  PoseFilter filter(options(3));
  std::vector<Pose> truth = options(3).start;
  Stream random = stream("long drive");
  for (int step = 0; step < 10'000; ++step) {
    const int robot = step % 3, other = (step + 1) % 3;
    Pose& there = truth[static_cast<std::size_t>(robot)];
    const double forward = random.uniform(0.0, 0.4), turn = random.uniform(-0.8, 1.0);
    filter.drive(robot, forward, turn, 0.05);
    there = truly_driven(there, forward, turn, 0.05, {0.0, 0.0, 0.0}, random);
    const Pose& seen_there = truth[static_cast<std::size_t>(other)];
    if (step % 5 == 0) {
      const Eigen::Vector2d& place = landmarks[random.below(landmarks.size())];
      filter.saw_place(robot, place, sighting_of(there, place, 1e-4, 1e-5, random));
    } else {
      filter.saw_robot(robot, other,
                       sighting_of(there, {seen_there.x_m, seen_there.y_m}, 1e-3, 1e-4, random));
    }
    for (int i = 0; i < 3; ++i) {
      const Eigen::Matrix3d P = filter.covariance(i);
      ASSERT_EQ(P, P.transpose()) << "robot " << i << ", step " << step;
      ASSERT_EQ(P.llt().info(), Eigen::Success) << "robot " << i << ", step " << step;
    }
  }
  EXPECT_LT(std::hypot(filter.pose(0).x_m - truth[0].x_m, filter.pose(0).y_m - truth[0].y_m), 0.1);
}

TEST(PoseFilter, TheViewChangesAsItsDerivativesSay) {
  Stream random = stream("views");
  constexpr double h = 1e-6;
  for (int i = 0; i < 200; ++i) {
    const Pose pose{random.normal(0, 3), random.normal(0, 3), random.uniform(-3.1, 3.1)};
    const Eigen::Vector2d place(random.normal(0, 3), random.normal(0, 3));
    const auto at = [&](int k, double by) {
      Pose p = pose;
      Eigen::Vector2d z = place;
      double* const numbers[] = {&p.x_m, &p.y_m, &p.heading_rad, &z.x(), &z.y()};
      *numbers[k] += by;
      return view(p, z).value().value;
    };
    const View seen = view(pose, place).value();
    EXPECT_NEAR(seen.value.x(), std::hypot(place.x() - pose.x_m, place.y() - pose.y_m), 1e-12);
    EXPECT_NEAR(folded(seen.value.y() + pose.heading_rad -
                       std::atan2(place.y() - pose.y_m, place.x() - pose.x_m)),
                0.0, 1e-12);
    Eigen::Matrix<double, 2, 5> all;
    all << seen.by_pose, seen.by_place;
    for (int k = 0; k < 5; ++k) {
      Eigen::Vector2d slope = at(k, h) - at(k, -h);
      slope.y() = folded(slope.y());
      slope /= 2.0 * h;
      // Third derivatives over r³ bound what the difference leaves.
      const double bound = 1e-8 + 10.0 * h * h / std::pow(seen.value.x(), 3);
      EXPECT_NEAR(all(0, k), slope.x(), bound);
      EXPECT_NEAR(all(1, k), slope.y(), bound);
    }
  }
}

TEST(PoseFilter, WhatStandsWhereTheRobotIsHasNoDirection) {
  PoseFilter filter(options(2));
  const Pose& pose = filter.pose(1);
  const Eigen::Matrix3d before = filter.covariance(1);
  EXPECT_EQ(filter.saw_place(1, {pose.x_m + 0.5e-3, pose.y_m}, {0.1, 0.0, 0.1, 0.1}),
            Use::no_direction);
  EXPECT_EQ(filter.covariance(1), before);
  EXPECT_EQ(filter.pose(1).x_m, 2.0);
  EXPECT_EQ(filter.saw_place(1, {pose.x_m + 2e-3, pose.y_m}, {0.1, 0.0, 0.1, 0.1}), Use::used);
  PoseFilter::Options same = options(2);
  same.start[1] = same.start[0];
  PoseFilter together(same);
  EXPECT_EQ(together.saw_robot(0, 1, {0.1, 0.0, 0.1, 0.1}), Use::no_direction);
}

TEST(PoseFilter, BeyondTheGateNothingIsTakenIn) {
  // Straight ahead: variances of range 0.05² + 0.1², of the bearing 0.05²/4² + 0.02² + 0.03².
  PoseFilter::Options alone = options(1, 4.0);
  alone.start = {{0.0, 0.0, 0.0}};
  const double sigma = std::sqrt(0.05 * 0.05 + 0.1 * 0.1);
  PoseFilter filter(alone);
  const Eigen::Matrix3d before = filter.covariance(0);
  EXPECT_EQ(filter.saw_place(0, {4.0, 0.0}, {4.0 + 2.001 * sigma, 0.0, 0.1, 0.03}),
            Use::outside_gate);
  EXPECT_EQ(filter.covariance(0), before);
  EXPECT_EQ(filter.pose(0).x_m, 0.0);
  EXPECT_EQ(filter.saw_place(0, {4.0, 0.0}, {4.0 + 1.999 * sigma, 0.0, 0.1, 0.03}), Use::used);
  EXPECT_NEAR(filter.pose(0).x_m, -1.999 * sigma * 0.0025 / 0.0125, 1e-12);
  PoseFilter again(alone);
  const double turn = std::sqrt(0.05 * 0.05 / 16.0 + 0.02 * 0.02 + 0.03 * 0.03);
  EXPECT_EQ(again.saw_place(0, {4.0, 0.0}, {4.0, -2.001 * turn, 0.1, 0.03}), Use::outside_gate);
  EXPECT_EQ(again.saw_place(0, {4.0, 0.0}, {4.0, -1.999 * turn, 0.1, 0.03}), Use::used);
}

TEST(PoseFilter, HeadingsAndBearingsMeetAcrossPlusAndMinusPi) {
  PoseFilter::Options alone = options(1);
  alone.start = {{0.0, 0.0, math::pi - 0.01}};
  alone.start_sigma_rad = 0.2;
  PoseFilter filter(alone);
  filter.drive(0, 0.0, 0.1, 0.5);
  EXPECT_NEAR(filter.pose(0).heading_rad, -math::pi + 0.04, 1e-12);
  // It faces −x; what lies on +x is behind, a little to the left of dead astern or to the right.
  const double before = filter.pose(0).heading_rad;
  EXPECT_EQ(filter.saw_place(0, {3.0, 0.0}, {3.0, -math::pi + 0.01, 0.1, 0.01}), Use::used);
  // Bearing = direction − heading: −π + 0.01 says the heading is π − 0.01 = −π − 0.01.
  EXPECT_LT(std::abs(folded(filter.pose(0).heading_rad - (math::pi - 0.01))),
            std::abs(folded(before - (math::pi - 0.01))) / 10.0);
  EXPECT_LE(std::abs(filter.pose(0).heading_rad), math::pi);
  EXPECT_LT(std::abs(filter.pose(0).y_m), 0.05);
  filter.replace({1.0, 2.0, 7.0}, Eigen::Matrix3d::Identity());
  EXPECT_NEAR(filter.pose(0).heading_rad, 7.0 - 2.0 * math::pi, 1e-12);
}

TEST(PoseFilter, WhatIsOutsideItsRangesIsRefused) {
  const auto refuses = [](auto change) {
    PoseFilter::Options wrong = options(1);
    change(wrong);
    EXPECT_THROW(PoseFilter{wrong}, BrokenInvariant);
  };
  refuses([](auto& o) { o.start.clear(); });
  refuses([](auto& o) { o.start_sigma_m = 0.0; });
  refuses([](auto& o) { o.start_sigma_rad = -1.0; });
  refuses([](auto& o) { o.odometry.forward_m_per_sqrt_s = -0.1; });
  refuses([](auto& o) { o.odometry.sideways_m_per_sqrt_s = -0.1; });
  refuses([](auto& o) { o.odometry.turn_rad_per_sqrt_s = 0.0; });
  refuses([](auto& o) { o.gate = std::numeric_limits<double>::infinity(); });
  PoseFilter two(options(2));
  EXPECT_THROW(two.replace({0, 0, 0}, Eigen::Matrix3d::Identity()), BrokenInvariant);
}

// Means over runs of a sum of squares of 3 normals lie in a band of χ² with 3N degrees of freedom:
// 95 % over all the instants looked at (Wilson and Hilferty's approximation, good to 1e-3 here).
struct Band {
  double low, high;
};
Band band(int runs, double z) {
  const double k = 3.0 * runs, a = 2.0 / (9.0 * k);
  const auto at = [&](double u) { return 3.0 * std::pow(1.0 - a + u * std::sqrt(a), 3); };
  return {at(-z), at(z)};
}

TEST(PoseFilter, IsConsistentWhereTheNoiseIsSmallAndAsModelled) {
  constexpr int runs = 400, steps = 200;
  const OdometryNoise noise{0.01, 0.005, 0.01};
  double nees[3][4] = {};
  for (int run = 0; run < runs; ++run) {
    Stream random = stream("anees", run);
    PoseFilter::Options three = options(3);
    three.odometry = noise;
    std::vector<Pose> truth = three.start;
    for (Pose& pose : truth) {
      pose.x_m += random.normal(0.0, three.start_sigma_m);
      pose.y_m += random.normal(0.0, three.start_sigma_m);
      pose.heading_rad += random.normal(0.0, three.start_sigma_rad);
    }
    PoseFilter filter(three);
    for (int step = 0; step < steps; ++step) {
      for (int robot = 0; robot < 3; ++robot) {
        Pose& there = truth[static_cast<std::size_t>(robot)];
        const double turn = 0.3 * (robot - 1) + 0.1;
        filter.drive(robot, 0.2, turn, 0.1);
        there = truly_driven(there, 0.2, turn, 0.1, noise, random);
      }
      const int robot = step % 3, other = (step + 1) % 3;
      const Pose& seer = truth[static_cast<std::size_t>(robot)];
      const Pose& seen = truth[static_cast<std::size_t>(other)];
      if (step % 4 == 0) {
        const Eigen::Vector2d& place = landmarks[random.below(landmarks.size())];
        filter.saw_place(robot, place, sighting_of(seer, place, 0.05, 0.01, random));
      } else {
        filter.saw_robot(robot, other, sighting_of(seer, {seen.x_m, seen.y_m}, 0.05, 0.01, random));
      }
      if (step % 50 != 49) continue;
      for (int i = 0; i < 3; ++i) {
        nees[i][step / 50] +=
            pose_nees(filter.pose(i), filter.covariance(i), truth[static_cast<std::size_t>(i)]);
      }
    }
  }
  const Band inside = band(runs, 2.87);  // two-sided 0.05/12
  for (const auto& robot : nees) {
    for (const double sum : robot) {
      EXPECT_GT(sum / runs, inside.low);
      EXPECT_LT(sum / runs, inside.high);
    }
  }
}

}  // namespace
}  // namespace hearsay::localization
