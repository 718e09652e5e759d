#include "sim/world/robot_floor.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "sim/kernel/error.hpp"
#include "sim/kernel/random.hpp"
#include "sim/math/functions.hpp"

namespace hearsay::plan {
namespace {

/// A room of 10 × 6 m with a wall that stands in it.
const Plan& room() {
  static const Plan plan(10.0, 6.0, {{{4.0, 2.0}, {4.0, 6.0}}});
  return plan;
}

double gap(const drive::Pose& a, const drive::Pose& b) {
  return math::hypot(a.x_m - b.x_m, a.y_m - b.y_m);
}

TEST(RobotFloor, ARobotDrivesAsItsWheelsTurnUntilAWall) {
  const WallIndex walls(room());
  RobotFloor floor(walls, {.radius_m = 0.25, .limits = {.speed_max_m_per_s = 0.5}});
  const int robot = floor.add({1.0, 4.0, 0.0});
  const RobotFloor::Step free = floor.drive(robot, {2.0, 0.0}, 1.0);
  EXPECT_FALSE(free.blocked);
  EXPECT_DOUBLE_EQ(free.done.forward_m_per_s, 0.5) << "no faster than it can";
  EXPECT_DOUBLE_EQ(floor.pose(robot).x_m, 1.5);
  RobotFloor::Step step;
  for (int i = 0; i < 10; ++i) step = floor.drive(robot, {0.5, 0.0}, 1.0);
  EXPECT_TRUE(step.blocked);
  EXPECT_NEAR(step.done.forward_m_per_s, 0.0, 1e-9) << "wheels stand where the robot does";
  EXPECT_NEAR(floor.pose(robot).x_m, 4.0 - 0.25, 1e-8);
  EXPECT_FALSE(floor.drive(robot, {0.0, 1.0}, 1.0).blocked) << "it turns on the spot";
  EXPECT_NEAR(floor.pose(robot).heading_rad, 1.0, 1e-12);
}

TEST(RobotFloor, RobotsStopEachOther) {
  const WallIndex walls(room());
  RobotFloor floor(walls, {.radius_m = 0.25});
  const int left = floor.add({1.0, 1.0, 0.0}), right = floor.add({3.0, 1.0, math::pi});
  EXPECT_TRUE(floor.drive(left, {1.0, 0.0}, 5.0).blocked);
  EXPECT_NEAR(floor.pose(left).x_m, 2.5, 1e-8);
  EXPECT_TRUE(floor.drive(right, {1.0, 0.0}, 1.0).blocked);
  EXPECT_NEAR(floor.pose(right).x_m, 3.0, 1e-8);
  EXPECT_FALSE(floor.drive(right, {-1.0, 0.0}, 1.0).blocked) << "away from the other";
}

TEST(RobotFloor, ThereMustBeRoom) {
  const WallIndex walls(room());
  RobotFloor floor(walls, {.radius_m = 0.25});
  floor.add({1.0, 1.0, 0.0});
  EXPECT_THROW(floor.add({1.4, 1.0, 0.0}), InputError);
  EXPECT_THROW(floor.add({0.1, 3.0, 0.0}), InputError);
  EXPECT_THROW(floor.add({-1.0, 3.0, 0.0}), InputError);
  const int other = floor.add({6.0, 3.0, 0.0});
  EXPECT_FALSE(floor.carry(other, {4.1, 3.0, 0.0})) << "across the wall";
  EXPECT_DOUBLE_EQ(floor.pose(other).x_m, 6.0);
  EXPECT_TRUE(floor.carry(other, {6.1, 3.0, 1.0})) << "its own body is no hindrance";
  EXPECT_THROW(floor.pose(2), BrokenInvariant);
}

TEST(RobotFloor, HasRoomWhereADiscTouchesNothing) {
  const WallIndex walls(room());
  RobotFloor floor(walls, {.radius_m = 0.25});
  const int robot = floor.add({1.0, 1.0, 0.0});
  for (const double off : {-1e-6, 1e-6}) {
    const bool free = off > 0.0;
    EXPECT_EQ(floor.has_room({1.0 + 0.3 + off, 1.4, 0.0}), free) << "the other, 0.5 m away";
    EXPECT_EQ(floor.has_room({0.25 + off, 4.0, 0.0}), free) << "the side of the plan";
    EXPECT_EQ(floor.has_room({4.25 + off, 4.0, 0.0}), free) << "the wall";
    EXPECT_EQ(floor.has_room({4.15, 1.8 - off, 0.0}), free) << "its end, by 15 and 20 cm";
  }
  EXPECT_TRUE(floor.has_room({1.2, 1.0, 0.0}, robot)) << "itself is no hindrance";
  EXPECT_FALSE(floor.has_room({1.2, 1.0, 0.0}));
  EXPECT_FALSE(floor.has_room({-1.0, 1.0, 0.0}));
  EXPECT_FALSE(floor.has_room({5.0, 1.0, std::nan("")}));
}

TEST(RobotFloor, AScanSeesWallsAndOthersButNotItself) {
  const WallIndex walls(room());
  RobotFloor floor(walls, {.radius_m = 0.25});
  const int robot = floor.add({1.0, 4.0, 0.5 * math::pi});
  floor.add({1.0, 5.2, 0.0});
  const Fan fan(4, 2.0 * math::pi);
  std::vector<double> distances(4);
  floor.scan(robot, fan, 8.0, distances);
  // Rays of four eighths, odd ones of a circle: none of them straight on.
  for (std::size_t ray = 0; ray < 4; ++ray) {
    const double angle = 0.5 * math::pi + fan.angle_rad(ray);
    const Point d{math::cos(angle), math::sin(angle)};
    const Disc other{{1.0, 5.2}, 0.25};
    EXPECT_NEAR(distances[ray], cast(walls, {1.0, 4.0}, d, 8.0, {&other, 1}).distance_m, 1e-12)
        << ray;
  }
  const Fan straight(1, 0.0);
  floor.scan(robot, straight, 8.0, std::span(distances).first(1));
  EXPECT_NEAR(distances[0], 1.2 - 0.25, 1e-12) << "the other, straight on";
}

/// Many robots that drive at random.
class Crowd : public ::testing::Test {
 protected:
  Crowd() {
    for (int i = 0; i < 40; ++i) {
      drive::Pose pose{draws.uniform(0.3, 9.7), draws.uniform(0.3, 5.7), draws.uniform(-3.0, 3.0)};
      try {
        floor.add(pose);
      } catch (const InputError&) {
      }
    }
  }
  void drive_all() {
    for (int robot = 0; robot < floor.robots(); ++robot) {
      floor.drive(robot, {draws.uniform(-1.0, 3.0), draws.uniform(-2.0, 2.0)}, 0.1);
    }
  }
  const WallIndex walls{room()};
  RobotFloor floor{walls, {.radius_m = 0.25, .limits = {3.0, 2.0}, .cell_m = 1.0}};
  Stream draws{5, Purpose("crowd"), Entity::agent(0)};
};

TEST_F(Crowd, NobodyIsEverInAWallOrInAnother) {
  ASSERT_GT(floor.robots(), 20);
  for (int step = 0; step < 400; ++step) {
    drive_all();
    for (int a = 0; a < floor.robots(); ++a) {
      const drive::Pose& pose = floor.pose(a);
      const double free = clearance(walls, {pose.x_m, pose.y_m}, 1.0);
      ASSERT_GE(free, 0.25 - 1e-9) << "robot " << a << " at step " << step;
      for (int b = 0; b < a; ++b) ASSERT_GE(gap(pose, floor.pose(b)), 0.5 - 1e-9) << a << b;
    }
  }
}

TEST_F(Crowd, WhoIsNearIsWhoeverLooksAtAllFinds) {
  for (int step = 0; step < 50; ++step) {
    drive_all();
    const Point from{draws.uniform(-1.0, 11.0), draws.uniform(-1.0, 7.0)};
    const double within = draws.uniform(0.0, 4.0);
    const auto found = floor.near(from, within, 3);
    std::vector<drive::Pose> expected;
    for (int robot = 0; robot < floor.robots(); ++robot) {
      const double away = gap(floor.pose(robot), {from.x_m, from.y_m, 0.0});
      if (robot != 3 && away <= within + 0.25) expected.push_back(floor.pose(robot));
    }
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) EXPECT_EQ(found[i].at.x_m, expected[i].x_m);
  }
}

}  // namespace
}  // namespace hearsay::plan
