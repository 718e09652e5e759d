#include "agents/behaviours/pilot.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "tests/agents/behaviours/pilot_bed.hpp"
#include "tools/memory/memory.hpp"

namespace hearsay {
namespace {

using Exploring = Pilot::Exploring;

plan::Drawing shipped(const std::string& name) {
  return plan::read_text(HEARSAY_SOURCE_DIR "/scenarios/lost/plans/" + name + ".txt", 0.5);
}

/// Two rooms with a door of 1 m, an island, a dead end.
plan::Drawing rooms() {
  return plan::parse_text(
      "#####################\n"
      "#         #         #\n"
      "#         #         #\n"
      "#   ##    #         #\n"
      "#   ##              #\n"
      "#                   #\n"
      "# A       #      B  #\n"
      "#         #         #\n"
      "#         #   ##### #\n"
      "#         #         #\n"
      "#####################\n",
      "rooms", 0.5);
}

/// Steps until a robot is within 1 m of a place while it explores, or the most.
int steps_to(PilotBed& bed, plan::Point place, int most) {
  int steps = 0;
  while (steps < most && bed.distance_m(0, place) > 1.0) {
    bed.explore(0);
    bed.pass();
    ++steps;
  }
  return steps;
}

TEST(Pilot, ItReachesAPointInSightInAboutTheTimeOfGeometry) {
  Stream draws(1, Purpose("starts"), Entity::agent(0));
  for (const char* name : {"office", "cave"}) {
    for (int round = 0; round < 25; ++round) {
      const Pilot::Options options{.speed_m_per_s = 0.5};
      PilotBed bed(shipped(name), options);
      bed.add_anywhere(draws);
      const drive::Pose from = bed.pose(0);
      plan::Point to;
      double ideal_s = 0.0;
      do {
        const double angle = draws.uniform(-math::pi, math::pi), far = draws.uniform(0.5, 6.0);
        to = {from.x_m + far * math::cos(angle), from.y_m + far * math::sin(angle)};
        ideal_s = far / 0.5 + std::fabs(math::wrap_angle(angle - from.heading_rad)) / 1.0;
      } while (plan::advance(bed.walls(), {from.x_m, from.y_m}, to, 0.27).blocked);
      while (bed.distance_m(0, to) > 0.1 && bed.now_s() < 1.2 * ideal_s + 1.0) {
        bed.towards(0, to);
        EXPECT_FALSE(bed.pilot(0).panicking());
        bed.pass();
      }
      EXPECT_LE(bed.distance_m(0, to), 0.1) << name << round << " " << from.x_m << " " << from.y_m;
      EXPECT_GE(bed.now_s(), (ideal_s - 0.1 / 0.5) * 0.7) << "no magic";
    }
  }
}

TEST(Pilot, AtItsTargetItStands) {
  PilotBed bed(shipped("square"), {});
  bed.add({5.0, 5.0, 0.0});
  const auto command = bed.pilot(0).towards(bed.senses(0), {5.01, 5.0}, bed.draws(0));
  EXPECT_EQ(command.forward_m_per_s, 0.0);
  EXPECT_EQ(command.turn_rad_per_s, 0.0);
  for (int step = 0; step < 100; ++step) {
    bed.towards(0, {5.0, 5.0});
    bed.pass();
    EXPECT_FALSE(bed.pilot(0).panicking()) << "who is there has no reason to";
  }
}

TEST(Pilot, ItGoesAroundWhatIsInTheWay) {
  PilotBed bed(rooms(), {});
  bed.add({1.25, 3.25, 0.0});  // an island between it and its target
  int blocked = 0;
  while (bed.distance_m(0, {4.2, 3.25}) > 0.1 && bed.now_s() < 30.0) {
    const auto senses = bed.senses(0);
    const auto command = bed.pilot(0).towards(senses, {4.2, 3.25}, bed.draws(0));
    blocked += bed.drive(0, command).blocked;
    bed.pass();
  }
  EXPECT_LT(bed.now_s(), 25.0) << "3 m at 0.25 m/s, and what is around";
  EXPECT_EQ(blocked, 0) << "it touches nothing";
}

TEST(Pilot, ItKeepsItsMarginWhereThereIsRoom) {
  PilotBed bed(shipped("square"), {.margin_m = 0.2});
  bed.add({3.0, 3.0, 0.0});
  bed.add({6.0, 3.05, 0.0});
  double least_m = 10.0;
  while (bed.distance_m(0, {9.0, 3.0}) > 0.1 && bed.now_s() < 60.0) {
    bed.towards(0, {9.0, 3.0});
    bed.pass();
    least_m = std::min(least_m, bed.distance_m(0, {6.0, 3.05}) - 0.5);
  }
  EXPECT_LT(bed.now_s(), 35.0);
  EXPECT_GT(least_m, 0.09) << "half of it at least, where the whole would be a long way round";
}

class Explores : public testing::TestWithParam<Exploring> {};

TEST_P(Explores, ThroughADoorAndEverywhere) {
  PilotBed bed(rooms(), {.speed_m_per_s = 0.5, .exploring = GetParam()}, 90);
  const plan::Point a = bed.plan().place("A"), b = bed.plan().place("B");
  bed.add({a.x_m, a.y_m, 0.3});
  constexpr int most = 15000;
  for (int i = 0; i < 2; ++i) {
    EXPECT_LT(steps_to(bed, b, most), most) << "to B " << i;
    EXPECT_LT(steps_to(bed, a, most), most) << "to A " << i;
  }
}

TEST_P(Explores, NeverForLongInOnePlace) {
  Stream draws(4, Purpose("starts"), Entity::agent(0));
  PilotBed bed(shipped("office"), {.speed_m_per_s = 0.5, .exploring = GetParam()}, 90);
  for (int i = 0; i < 4; ++i) bed.add_anywhere(draws);
  std::vector<plan::Point> since_at(4);
  std::vector<double> since_s(4);
  std::set<std::pair<int, int>> cells;
  for (int step = 0; step < 2000; ++step) {
    for (int robot = 0; robot < 4; ++robot) {
      bed.explore(robot);
      const auto i = static_cast<std::size_t>(robot);
      const drive::Pose& pose = bed.pose(robot);
      cells.insert({static_cast<int>(pose.x_m), static_cast<int>(pose.y_m)});
      if (bed.distance_m(robot, since_at[i]) > 0.5) {
        since_at[i] = {pose.x_m, pose.y_m};
        since_s[i] = bed.now_s();
      }
      ASSERT_LT(bed.now_s() - since_s[i], 45.0) << robot << " " << pose.x_m << " " << pose.y_m;
    }
    bed.pass();
  }
  EXPECT_GT(cells.size(), 60u) << "square metres, of 400 that four robots saw in 200 s";
}

INSTANTIATE_TEST_SUITE_P(Manners, Explores,
                         testing::Values(Exploring::roam, Exploring::wall, Exploring::corridor));

TEST(Pilot, AWallIsFollowedCloseBy) {
  PilotBed bed(shipped("square"),
               {.speed_m_per_s = 0.5, .follow_s = 1e6, .exploring = Exploring::wall});
  bed.add({3.0, 1.0, 0.0});
  for (int step = 0; step < 400; ++step) {
    bed.explore(0);
    bed.pass();
  }
  int beside = 0;
  for (int step = 0; step < 1000; ++step) {
    bed.explore(0);
    bed.pass();
    const plan::Point here{bed.pose(0).x_m, bed.pose(0).y_m};
    beside += plan::clearance(bed.walls(), here, 1.0) < 0.65;
  }
  EXPECT_GT(beside, 950) << "the walls of a square have no ends";
}

TEST(Pilot, CorridorsAreFollowedToTheirEnds) {
  PilotBed bed(shipped("corridor"),
               {.speed_m_per_s = 0.5, .follow_s = 1e6, .exploring = Exploring::corridor});
  const plan::Point a = bed.plan().place("A");
  bed.add({a.x_m, a.y_m, 0.0});
  // 27 m at 0.5 m/s take 54 s: there, and back from the dead end behind it.
  EXPECT_LT(steps_to(bed, bed.plan().place("B"), 3000), 1500);
  EXPECT_LT(steps_to(bed, a, 3000), 2000);
}

TEST(Pilot, ASearchStaysWithinItsRadius) {
  PilotBed bed(shipped("square"), {.speed_m_per_s = 0.5});
  bed.add({10.0, 10.0, 0.0});
  const plan::Point centre{10.0, 11.0};
  std::set<std::pair<int, int>> cells;
  for (int step = 0; step < 3000; ++step) {
    bed.drive(0, bed.pilot(0).search(bed.senses(0), centre, 2.0, bed.draws(0)));
    bed.pass();
    ASSERT_LT(bed.distance_m(0, centre), 2.01);
    cells.insert({static_cast<int>(bed.pose(0).x_m), static_cast<int>(bed.pose(0).y_m)});
  }
  EXPECT_GE(cells.size(), 12u) << "of the 12.6 m² of the disc";
}

TEST(Pilot, WhoDoesNotMovePanicsAfterAWhileAndForAWhile) {
  PilotBed bed(shipped("square"), {});
  bed.add({10.0, 10.0, 0.0});
  // Its wheels turn nothing, whatever they are told.
  int first = -1, last = -1;
  for (int step = 0; step < 100; ++step) {
    bed.pilot(0).towards(bed.senses(0), {15.0, 10.0}, bed.draws(0));
    if (bed.pilot(0).panicking()) {
      if (first < 0) first = step;
      last = step;
    }
    bed.pass();
    if (step - first > 55 && first >= 0 && !bed.pilot(0).panicking()) break;
  }
  EXPECT_NEAR(first, 20, 1);
  EXPECT_NEAR(last, 79, 1);
}

TEST(Pilot, TurningIsMotionButNotForEver) {
  const Pilot::Options options;
  const plan::Fan fan(180, 2.0 * math::pi);
  Pilot pilot(options, fan);
  Stream draws(1, Purpose("turning"), Entity::agent(0));
  const std::vector<double> scan(180, 0.26);  // nothing is free
  double heading = 0.0;
  int first = -1;
  for (int step = 0; step < 200 && first < 0; ++step) {
    const auto command = pilot.towards({0.1 * step, scan, {0.0, 0.0, heading}}, {5.0, 0.0}, draws);
    EXPECT_EQ(command.forward_m_per_s, 0.0) << step;
    if (pilot.panicking()) first = step;
    heading = math::wrap_angle(heading + 0.1 * command.turn_rad_per_s);
  }
  EXPECT_NEAR(first, 20 + 63, 2) << "once around takes 6.28 s";
}

TEST(Pilot, AnotherOneInADoorIsNoDeadlock) {
  PilotBed bed(rooms(), {});
  const plan::Point door{5.25, 3.0};
  bed.add({4.0, door.y_m, 0.0});
  bed.add({6.5, door.y_m, math::pi});
  // They cannot pass each other in it.
  const plan::Point right{8.0, 3.0}, left{2.0, 2.6};
  bool there = false, back = false;
  while (!(there && back) && bed.now_s() < 300.0) {
    bed.towards(0, right);
    bed.towards(1, left);
    bed.pass();
    there = there || bed.distance_m(0, right) < 0.6;
    back = back || bed.distance_m(1, left) < 0.6;
  }
  EXPECT_TRUE(there && back);
}

TEST(Pilot, CrowdsThatGoToAndFroKeepMoving) {
  Stream draws(6, Purpose("starts"), Entity::agent(0));
  PilotBed bed(shipped("square"), {.speed_m_per_s = 0.5}, 45);
  constexpr int robots = 25;
  for (int i = 0; i < robots; ++i) bed.add_anywhere(draws);
  const plan::Point places[] = {bed.plan().place("A"), bed.plan().place("B")};
  std::vector<int> trips(robots);
  for (int step = 0; step < 1600; ++step) {
    for (int robot = 0; robot < robots; ++robot) {
      int& n = trips[static_cast<std::size_t>(robot)];
      const plan::Point& goal = places[(robot + n) % 2];
      bed.towards(robot, goal);
      n += bed.distance_m(robot, goal) < 1.0;
    }
    bed.pass();
  }
  // 17 m at 0.5 m/s, and a turn: at most 4.3 trips in 160 s.
  for (int robot = 0; robot < robots; ++robot)
    EXPECT_GE(trips[static_cast<std::size_t>(robot)], 2) << robot;
}

TEST(Pilot, ANarrowViewReachesWhatItSeesAndTurnsToWhatItDoesNot) {
  PilotBed bed(shipped("square"), {}, 60, math::pi / 3.0);
  bed.add({10.0, 10.0, 0.0});
  const auto turning = bed.pilot(0).towards(bed.senses(0), {5.0, 10.0}, bed.draws(0));
  EXPECT_EQ(turning.forward_m_per_s, 0.0);
  EXPECT_EQ(std::fabs(turning.turn_rad_per_s), 1.0);
  while (bed.distance_m(0, {5.0, 10.0}) > 0.1 && bed.now_s() < 60.0) {
    bed.towards(0, {5.0, 10.0});
    bed.pass();
  }
  EXPECT_LT(bed.now_s(), 1.1 * (5.0 / 0.25 + math::pi));
}

TEST(Pilot, WhoTouchesWhatHeDoesNotSeeComesFree) {
  PilotBed bed(shipped("square"), {}, 60, 1.5);
  // Headed towards the wall beside it by less than shows it.
  bed.add({10.0, 0.75 + 1e-6, -0.3});
  const plan::Point to{13.0, 2.5};
  int stood = 0;
  while (bed.distance_m(0, to) > 0.1 && bed.now_s() < 40.0) {
    const auto senses = bed.senses(0);
    const auto command = bed.pilot(0).towards(senses, to, bed.draws(0));
    stood += bed.drive(0, command).blocked;
    bed.pass();
  }
  EXPECT_GT(stood, 0) << "else this tests nothing";
  EXPECT_LT(bed.now_s(), 20.0) << "3.5 m at 0.25 m/s";
}

TEST(Pilot, EqualSensesAndDrawsGiveEqualCommands) {
  std::vector<double> ways[2];
  for (auto& way : ways) {
    PilotBed bed(rooms(), {.speed_m_per_s = 0.5, .exploring = Exploring::wall});
    bed.add({1.5, 2.0, 0.0});
    for (int step = 0; step < 500; ++step) {
      bed.explore(0);
      bed.pass();
      way.push_back(bed.pose(0).x_m);
    }
  }
  EXPECT_EQ(ways[0], ways[1]);
}

TEST(Pilot, NoCallAllocates) {
  for (const Exploring manner : {Exploring::roam, Exploring::wall, Exploring::corridor}) {
    PilotBed bed(rooms(), {.exploring = manner}, 60);
    bed.add({1.5, 2.0, 0.0});
    std::size_t allocated = 0;
    for (int step = 0; step < 300; ++step) {
      const auto senses = bed.senses(0);
      const std::size_t before = memory::allocations();
      const auto command = step % 100 < 20 ? bed.pilot(0).search(senses, {}, 1.0, bed.draws(0))
                           : step % 100 < 40
                               ? bed.pilot(0).towards(senses, {8.0, 2.0}, bed.draws(0))
                               : bed.pilot(0).explore(senses, bed.draws(0));
      allocated += memory::allocations() - before;
      bed.drive(0, command);
      bed.pass();
    }
    EXPECT_EQ(allocated, 0u);
  }
}

TEST(Pilot, FreeDistancesAreThoseOfTheScan) {
  PilotBed bed(shipped("square"), {});
  bed.add({10.0, 2.0, 0.0});
  const auto senses = bed.senses(0);
  EXPECT_NEAR(bed.pilot(0).free_m(senses, -0.5 * math::pi), 1.5, 1e-3);
  EXPECT_EQ(bed.pilot(0).free_m(senses, 0.5 * math::pi), 5.0);
}

TEST(Pilot, BadOptionsAndSensesAreRefused) {
  const plan::Fan fan(8, 2.0 * math::pi), blind(8, 0.0);
  const auto refused = [&](void (*change)(Pilot::Options&)) {
    Pilot::Options options;
    change(options);
    EXPECT_THROW(Pilot(options, fan), BrokenInvariant);
  };
  refused([](Pilot::Options& o) { o.radius_m = 0.0; });
  refused([](Pilot::Options& o) { o.speed_m_per_s = -1.0; });
  refused([](Pilot::Options& o) { o.turn_rad_per_s = 0.0; });
  refused([](Pilot::Options& o) { o.range_m = std::numeric_limits<double>::infinity(); });
  refused([](Pilot::Options& o) { o.margin_m = -0.1; });
  refused([](Pilot::Options& o) { o.look_ahead_m = 0.0; });
  refused([](Pilot::Options& o) { o.panic_after_s = 0.0; });
  refused([](Pilot::Options& o) { o.panic_s = 0.0; });
  refused([](Pilot::Options& o) { o.hold_s = 0.0; });
  refused([](Pilot::Options& o) { o.follow_s = 0.0; });
  EXPECT_THROW(Pilot({}, blind), BrokenInvariant);
  Pilot pilot({}, fan);
  Stream draws(1, Purpose("bad"), Entity::agent(0));
  const std::vector<double> scan(8, 1.0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(pilot.towards({0.0, scan, {}}, {nan, 0.0}, draws), BrokenInvariant);
  EXPECT_THROW(pilot.explore({nan, scan, {}}, draws), BrokenInvariant);
  EXPECT_THROW(pilot.explore({0.0, {}, {}}, draws), BrokenInvariant);
  EXPECT_THROW(pilot.search({0.0, scan, {}}, {}, 0.0, draws), BrokenInvariant);
}

}  // namespace
}  // namespace hearsay
