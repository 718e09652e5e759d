#include "agents/robots/robot_world.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"
#include "tests/sim/world/floors.hpp"

namespace hearsay {
namespace {

using plan::Plan;

std::shared_ptr<const Plan> room(double width_m, double height_m,
                                 std::vector<plan::Segment> walls = {}) {
  return std::make_shared<const Plan>(width_m, height_m, std::move(walls));
}

double apart(const drive::Pose& a, plan::Point b) {
  return math::hypot(a.x_m - b.x_m, a.y_m - b.y_m);
}

/// A floor, and what a run on it leaves.
class Floor : public testing::Test {
 protected:
  explicit Floor(Duration end = 30_s) : simulation_({.end = Time::at(end)}) {}

  RobotWorld& world(RobotWorld::Options options) {
    options.floor.radius_m = radius_m;
    options.floor.limits = {.speed_max_m_per_s = 5.0, .turn_max_rad_per_s = 5.0};
    world_ = std::make_unique<RobotWorld>(simulation_, std::move(options));
    return *world_;
  }
  Stream draws(std::uint64_t n = 0) const {
    return Stream::at(1, Purpose("start"), Entity::agent(0), n);
  }
  int robot_at(double x_m, double y_m, double heading_rad = 0.0) {
    return world_->add({.at = plan::Point{x_m, y_m}, .heading_rad = heading_rad}, draws());
  }
  void at(Duration time, std::function<void()> what, Phase phase = Phase::act) {
    simulation_.schedule(Time::at(time), phase, std::move(what));
  }
  void run() {
    world_->start();
    const RunEnd end = simulation_.run();
    EXPECT_TRUE(end.ok()) << end.message;
  }
  /// "time kind detail" of each event.
  std::vector<std::string> events() const {
    std::vector<std::string> rows;
    for (const EventRow& row : simulation_.record().events()) {
      EXPECT_EQ(row.agent, no_agent);
      rows.push_back(std::to_string(row.time.nanoseconds() / 1'000'000) + "ms " +
                     simulation_.record().text(row.kind) + ": " + row.detail);
    }
    return rows;
  }

  static constexpr double radius_m = 0.25;
  Simulation simulation_;
  std::unique_ptr<RobotWorld> world_;
};

using Rows = std::vector<std::string>;

/// One drives along a corridor at 0.5 m/s from x = 1 m on; a barrier fills 4 … 5 m of it.
class Barrier : public Floor {
 protected:
  /// Where it is after each tenth of a second.
  std::vector<double> driven(Time from, Time until) {
    world({.plan = room(20.0, 2.0),
           .barriers = {{.area = {{4.0, 0.0}, {5.0, 2.0}}, .from = from, .until = until}},
           .sources = {},
           .floor = {}});
    const int robot = robot_at(1.0, 1.0);
    std::vector<double> x_m;
    for (int k = 0; k < 300; ++k) {
      at(100_ms * k, [this, robot, &x_m] {
        world_->floor().drive(robot, {0.5, 0.0}, 0.1);
        x_m.push_back(world_->pose(robot).x_m);
      });
    }
    run();
    return x_m;
  }
};

TEST_F(Barrier, StopsWhoComesWhileItIsUpAndLetsPassAfterwards) {
  const std::vector<double> x_m = driven(Time::at(2_s), Time::at(20_s));
  const double edge_m = 4.0 - radius_m;
  for (int k = 0; k < 300; ++k) {
    // The step that begins at k tenths ends with k + 1 of them driven.
    const double free_m = 1.0 + 0.05 * (k + 1);
    const double expected = k < 200 ? std::min(free_m, edge_m) : edge_m + 0.05 * (k - 199);
    ASSERT_NEAR(x_m[static_cast<std::size_t>(k)], expected, 1e-8) << k;
  }
  EXPECT_EQ(events(), (Rows{"2000ms barrier: up 0", "20000ms barrier: down 0"}));
  EXPECT_EQ(world_->changed(), Time::at(20_s));
}

TEST_F(Barrier, DoesNotStopWhoHasPassed) {
  const std::vector<double> x_m = driven(Time::at(9_s), Time::never());
  for (int k = 0; k < 300; ++k) {
    ASSERT_NEAR(x_m[static_cast<std::size_t>(k)], 1.0 + 0.05 * (k + 1), 1e-8) << k;
  }
  EXPECT_EQ(events(), Rows{"9000ms barrier: up 0"}) << "it stays";
}

TEST_F(Barrier, StandsOnTheFloorInTheirOrder) {
  world({.plan = room(20.0, 2.0),
         .barriers = {{.area = {{4.0, 0.0}, {5.0, 2.0}}, .from = Time::at(3_s)},
                      {.area = {{8.0, 0.0}, {9.0, 2.0}}, .from = Time()}},
         .sources = {{.name = "B", .at = {6.5, 1.0}, .units = {}, .moves = {}},
                     {.name = "C", .at = {19.0, 1.0}, .units = {}, .moves = {}}},
         .floor = {}});
  const int robot = robot_at(1.0, 1.0);
  EXPECT_FALSE(world_->changed());
  at(1_s, [&] {
    EXPECT_NEAR(world_->way(robot, 0)->length_m, 5.5, 1e-9);
    EXPECT_FALSE(world_->way(robot, 1)) << "behind the second barrier, up from the beginning";
  });
  at(4_s, [&] { EXPECT_FALSE(world_->way(robot, 0)); });
  run();
  EXPECT_EQ(events(), (Rows{"0ms barrier: up 1", "3000ms barrier: up 0"}));
}

TEST_F(Barrier, IsNoPlaceToStartWhileItIsUp) {
  // Both have room for many within.
  world({.plan = room(20.0, 4.0),
         .barriers = {{.area = {{2.0, 0.0}, {10.0, 4.0}}, .from = Time(), .until = Time::at(5_s)},
                      {.area = {{10.0, 0.0}, {18.0, 4.0}}, .from = Time::at(5_s)}},
         .sources = {},
         .floor = {}});
  for (std::uint64_t n = 0; n < 4; ++n) {
    const int robot = world_->add({.at = {}}, draws(n));
    EXPECT_FALSE(world_->pose(robot).x_m > 2.0 && world_->pose(robot).x_m < 10.0);
  }
  EXPECT_THROW(world_->add({.at = plan::Point{6.0, 2.0}, .scatter_m = 1.0}, draws()), InputError);
  at(6_s, [&] {
    EXPECT_TRUE(world_->carry(0, {.at = plan::Point{6.0, 2.0}}, draws())) << "it is down";
    EXPECT_FALSE(world_->carry(1, {.at = plan::Point{14.0, 2.0}}, draws()));
    for (std::uint64_t n = 0; n < 50; ++n) {
      ASSERT_TRUE(world_->carry(2, {.at = {}}, draws(10 + n)));
      EXPECT_FALSE(world_->pose(2).x_m > 10.0 && world_->pose(2).x_m < 18.0);
    }
  });
  run();
}

TEST_F(Floor, BarriersLieWithinThePlan) {
  EXPECT_THROW(world({.plan = room(20.0, 2.0),
                      .barriers = {{.area = {{4.0, 0.0}, {5.0, 2.1}}, .from = Time()}},
                      .sources = {},
                      .floor = {}}),
               InputError);
}

TEST_F(Floor, AnEventHappensWithinItsRadiusAlone) {
  world({.plan = room(10.0, 10.0),
         .barriers = {},
         .sources = {{.name = "A", .at = {4.0, 5.0}, .radius_m = 1.5, .units = {}, .moves = {}},
                     {.name = "B", .at = {6.0, 5.0}, .radius_m = 0.5, .units = {}, .moves = {}}},
         .floor = {}});
  const int robot = robot_at(5.5, 5.0);
  EXPECT_TRUE(world_->happens(robot, 0)) << "at the very radius";
  EXPECT_TRUE(world_->happens(robot, 1));
  EXPECT_THROW(world_->happens(robot, 2), BrokenInvariant);
  const double third = math::pi / 3.0;
  for (const double away_m : {1.5 - 1e-6, 1.5 + 1e-6}) {
    const plan::Point p{4.0 + away_m * math::cos(third), 5.0 - away_m * math::sin(third)};
    ASSERT_TRUE(world_->carry(robot, {.at = p}, draws()));
    EXPECT_EQ(world_->happens(robot, 0), away_m < 1.5);
    EXPECT_FALSE(world_->happens(robot, 1));
  }
  EXPECT_EQ(world_->events(), 2U);
  EXPECT_EQ(world_->name_of(1), "B");
}

TEST_F(Floor, ASourceBearsAsManyVisitsAsItHasUnits) {
  world({.plan = room(10.0, 10.0),
         .barriers = {},
         .sources = {{.name = "A", .at = {2.0, 2.0}, .units = 3, .moves = {}},
                     {.name = "B", .at = {2.0, 2.0}, .units = {}, .moves = {}}},
         .floor = {}});
  const int near = robot_at(2.0, 2.5), far = robot_at(2.0, 4.0);
  std::vector<int> happened;
  for (int k = 1; k <= 6; ++k) {
    at(1_s * k, [&, k] {
      EXPECT_FALSE(world_->happens(far, 0)) << "who is not there takes nothing";
      EXPECT_TRUE(world_->happens(near, 1)) << "there is enough";
      if (world_->happens(near, 0)) happened.push_back(k);
    });
  }
  run();
  EXPECT_EQ(happened, (std::vector<int>{1, 2, 3}));
  EXPECT_EQ(events(), Rows{"3000ms source: A is dry"});
  EXPECT_EQ(world_->changed(), Time::at(3_s));
}

TEST_F(Floor, ASourceMovesAtItsTimes) {
  world(
      {.plan = room(10.0, 10.0),
       .barriers = {},
       .sources = {{.name = "A",
                    .at = {2.0, 2.0},
                    .units = {},
                    .moves = {{Time::at(5_s), {8.0, 2.0}, "C"}, {Time::at(7_s), {2.0, 8.0}, "D"}}}},
       .floor = {}});
  const std::vector<int> robots = {robot_at(2.0, 2.0), robot_at(8.0, 2.0), robot_at(2.0, 8.0)};
  std::string where;
  for (const Duration time : {4999_ms, 5000_ms, 6999_ms, 7000_ms, 9000_ms}) {
    at(time, [&] {
      for (const int robot : robots) where += world_->happens(robot, 0) ? 'x' : '-';
      where += ' ';
      EXPECT_NEAR(world_->way(robots[0], 0)->length_m,
                  simulation_.now() < Time::at(5_s) ? 0.0 : 6.0, 1e-9);
    });
  }
  run();
  EXPECT_EQ(where, "x-- -x- -x- --x --x ");
  EXPECT_EQ(events(), (Rows{"5000ms source: A moves to C", "7000ms source: A moves to D"}));
}

TEST_F(Floor, InAnEmptySquareTheWayIsTheStraightLine) {
  world({.plan = room(20.0, 20.0),
         .barriers = {},
         .sources = {{.name = "A", .at = {17.3, 11.9}, .units = {}, .moves = {}}},
         .floor = {}});
  Stream places = draws(7);
  const int robot = robot_at(1.0, 1.0);
  for (int i = 0; i < 20; ++i) {
    const plan::Point p{places.uniform(0.5, 19.5), places.uniform(0.5, 19.5)};
    ASSERT_TRUE(world_->carry(robot, {.at = p}, draws()));
    EXPECT_NEAR(world_->way(robot, 0)->length_m, apart(world_->pose(robot), {17.3, 11.9}), 1e-9);
  }
}

TEST_F(Floor, RobotsStartWhereThereIsRoomNearTheirStartAndOnItsSideOfWalls) {
  const std::vector<plan::Segment> walls = {{{5.0, 3.0}, {5.0, 7.0}}, {{3.0, 5.8}, {6.5, 5.8}}};
  world({.plan = room(10.0, 10.0, walls), .barriers = {}, .sources = {}, .floor = {}});
  const plan::Point start{4.5, 5.0};
  double left_m = 0.0, right_m = 0.0;
  for (std::uint64_t n = 0; n < 8; ++n) {
    const int robot = world_->add({.at = start, .scatter_m = 2.0}, draws(n));
    EXPECT_EQ(robot, static_cast<int>(n));
  }
  for (std::uint64_t n = 0; n < 400; ++n) {
    ASSERT_TRUE(world_->carry(3, {.at = start, .scatter_m = 2.0}, draws(100 + n)));
    for (int robot = 0; robot < 8; ++robot) {
      const drive::Pose& pose = world_->pose(robot);
      const plan::Point p{pose.x_m, pose.y_m};
      ASSERT_LE(apart(pose, start), 2.0);
      ASSERT_GE(static_cast<double>(plan::distance(p, walls)), radius_m - 1e-9);
      for (int other = 0; other < robot; ++other) {
        const drive::Pose& o = world_->pose(other);
        ASSERT_GE(apart(pose, {o.x_m, o.y_m}), 2.0 * radius_m - 1e-9);
      }
      // The straight way to the start crosses no wall.
      const double length_m = apart(pose, start);
      const plan::Point towards{(start.x_m - p.x_m) / length_m, (start.y_m - p.y_m) / length_m};
      for (const plan::Segment& wall : walls) {
        const auto hit = plan::crossing(p, towards, wall);
        ASSERT_FALSE(hit && *hit < static_cast<plan::Real>(length_m)) << p.x_m << ' ' << p.y_m;
      }
    }
    left_m = std::max(left_m, start.x_m - world_->pose(3).x_m);
    right_m = std::max(right_m, world_->pose(3).x_m - start.x_m);
  }
  EXPECT_GT(left_m, 1.8) << "they do scatter";
  EXPECT_LE(right_m, 0.5 - radius_m) << "its ends are farther than 2 m";
}

TEST_F(Floor, StartsAreDrawnEvenlyOverTheDiscAndHeadingsOverTheCircle) {
  world({.plan = room(20.0, 20.0), .barriers = {}, .sources = {}, .floor = {}});
  const plan::Point start{10.0, 10.0};
  const int robot = robot_at(10.0, 10.0, 0.5);
  EXPECT_DOUBLE_EQ(world_->pose(robot).heading_rad, 0.5);
  ASSERT_TRUE(world_->carry(robot, {.at = start, .heading_rad = 5.0}, draws()));
  EXPECT_DOUBLE_EQ(world_->pose(robot).heading_rad, 5.0 - 2.0 * math::pi);
  constexpr int n = 4000;
  int inner = 0, above = 0, ahead = 0;
  for (std::uint64_t i = 0; i < n; ++i) {
    ASSERT_TRUE(world_->carry(robot, {.at = start, .scatter_m = 3.0}, draws(i)));
    const drive::Pose& pose = world_->pose(robot);
    inner += apart(pose, start) < 3.0 / std::sqrt(2.0);
    above += pose.y_m > 10.0;
    ahead += std::fabs(pose.heading_rad) < 0.5 * math::pi;
  }
  // Half of the area is within 1/√2 of the radius. Four standard deviations.
  const double sigma = 0.5 * std::sqrt(n);
  for (const int count : {inner, above, ahead}) EXPECT_NEAR(count, 0.5 * n, 4.0 * sigma);
}

TEST_F(Floor, WhetherRoomIsFoundIsNoMatterOfLuck) {
  // A closet in the corner of a large floor: one draw in 1e10 lies in it.
  const std::vector<plan::Segment> walls = {{{1.0, 0.0}, {1.0, 1.0}}, {{0.0, 1.0}, {1.0, 1.0}}};
  world({.plan = room(40.0, 40.0, walls), .barriers = {}, .sources = {}, .floor = {}});
  const RobotWorld::Start closet{.at = plan::Point{0.5, 0.5}, .scatter_m = 1e5, .heading_rad = 1.5};
  const drive::Pose first = world_->pose(world_->add(closet, draws(1)));
  EXPECT_EQ(first.x_m, 0.5);
  EXPECT_EQ(first.y_m, 0.5);
  EXPECT_EQ(first.heading_rad, 1.5);
  EXPECT_THROW(world_->add(closet, draws(2)), InputError) << "there is room for one";
  EXPECT_FALSE(world_->carry(0, closet, draws(3))) << "is not looked for so hard at each step";
  // In a corridor two metres wide, one draw in 1e5: it fills up to its ends.
  const std::vector<plan::Segment> sides = {{{0.0, 19.0}, {40.0, 19.0}},
                                            {{0.0, 21.0}, {40.0, 21.0}}};
  world({.plan = room(40.0, 40.0, sides), .barriers = {}, .sources = {}, .floor = {}});
  for (std::uint64_t n = 0; n < 12; ++n) {
    const drive::Pose pose =
        world_->pose(world_->add({.at = plan::Point{20.0, 20.0}, .scatter_m = 1200.0}, draws(n)));
    EXPECT_LE(std::fabs(pose.y_m - 20.0), 1.0 - radius_m);
  }
}

TEST_F(Floor, LookingForRoomKeepsWithinTheDisc) {
  world({.plan = room(20.0, 20.0), .barriers = {}, .sources = {}, .floor = {}, .tries = 0});
  const RobotWorld::Start start{.at = plan::Point{1.0, 1.0}, .scatter_m = 2.0};
  std::vector<drive::Pose> found;
  const auto fill = [&] {
    while (true) found.push_back(world_->pose(world_->add(start, draws(found.size()))));
  };
  EXPECT_THROW(fill(), InputError);
  EXPECT_GE(found.size(), 8U);
  double most_m = 0.0;
  for (const drive::Pose& pose : found) most_m = std::max(most_m, apart(pose, *start.at));
  EXPECT_LE(most_m, 2.0);
  EXPECT_GE(most_m, 1.5);
}

TEST_F(Floor, WhereThereIsNoRoomNobodyStarts) {
  world({.plan = room(4.0, 4.0), .barriers = {}, .sources = {}, .floor = {}});
  robot_at(2.0, 2.0);
  const RobotWorld::Start taken{.at = plan::Point{2.0, 2.0}, .scatter_m = 0.3};
  EXPECT_THROW(world_->add(taken, draws()), InputError);
  EXPECT_THROW(world_->add({.at = plan::Point{0.1, 2.0}}, draws()), InputError) << "in the wall";
  const int other = world_->add({.at = {}}, draws());
  const drive::Pose before = world_->pose(other);
  EXPECT_FALSE(world_->carry(other, taken, draws()));
  EXPECT_EQ(world_->pose(other).x_m, before.x_m);
  EXPECT_TRUE(world_->carry(0, taken, draws())) << "its own body is no hindrance";
  // Discs of 0.25 m cover at most 91 % of the plane: the floor fills up.
  const auto fill = [&] {
    while (true)
      world_->add({.at = {}}, draws(static_cast<std::uint64_t>(world_->floor().robots())));
  };
  EXPECT_THROW(fill(), InputError);
  EXPECT_LT(world_->floor().robots(), 0.91 * 16.0 / (math::pi * radius_m * radius_m));
  EXPECT_GT(world_->floor().robots(), 20);
}

}  // namespace
}  // namespace hearsay
