// Whole runs of foragers, from their files: who dies, forgets, is put back, waits, or is in the
// way.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "sim/math/functions.hpp"
#include "sim/world/collision.hpp"
#include "tests/scenarios/forager_bed.hpp"

namespace hearsay {
namespace {

constexpr double radius_m = 0.25, speed_m_per_s = 0.25, tick_s = 0.1;

/// In a corridor with A at (4.75, 1.75) and B at (16.25, 1.75).
const std::string team = R"(duration_s = 600
[world.plan]
file = "plan.txt"
[radio]
topology = "full"
rate_bps = 1_000_000
[record]
series_period_s = 1
[[agents]]
kind = "forager"
count = 3
robot = { start = "A", scatter_m = 1.2, rays = 90 }
task = { events = ["A", "B"] }
trails = { exploration = "corridor" }
talk = { policy = "at-once" }
)";
const plan::Point a{4.75, 1.75};

class ForagerLife : public ForagerBed {
 protected:
  void SetUp() override {
    ForagerBed::SetUp();
    series_ = {"robot_x_m", "robot_y_m", "crumbs_alive", "trips_so_far", "trip_duration_s"};
    write("plan.txt", straight_corridor(40, 8));
  }
  /// With tables in front of the agents.
  static std::string and_also(const std::string& text, const std::string& tables) {
    return with(text, "[record]\n", tables + "[record]\n");
  }
  static std::map<double, plan::Point> way(const Values& values, AgentId id) {
    std::map<double, plan::Point> points;
    const auto y_m = values.over_time(id, "robot_y_m");
    for (const auto& [time, x_m] : values.over_time(id, "robot_x_m")) {
      points[time] = {x_m, y_m.at(time)};
    }
    return points;
  }
  static double apart(plan::Point p, plan::Point q) {
    return math::hypot(p.x_m - q.x_m, p.y_m - q.y_m);
  }
  /// How far it gets between two times.
  static double moved(const Values& values, AgentId id, double from_s, double to_s) {
    const auto points = way(values, id);
    double most = 0.0;
    for (const auto& [time, p] : points) {
      if (time >= from_s && time <= to_s) most = std::max(most, apart(p, points.at(from_s)));
    }
    return most;
  }
};

TEST_F(ForagerLife, ADeadRobotMovesNoMoreAndOthersGoOn) {
  const Values values =
      run(and_also(team, "[[dropouts]]\nagents = [1]\nkind = \"die\"\nfrom_s = 200\n"));
  double trips_of_others = 0.0;
  for (AgentId id = 0; id < 3; ++id) {
    EXPECT_GT(moved(values, id, 100.0, 199.0), 2.0) << id;
    const auto trips = values.over_time(id, "trips_so_far");
    if (id == 1) {
      EXPECT_EQ(moved(values, id, 200.0, 600.0), 0.0);
      EXPECT_EQ(trips.at(200.0), trips.at(600.0));
    } else {
      EXPECT_GT(moved(values, id, 200.0, 600.0), 2.0) << id;
      trips_of_others += trips.at(600.0) - trips.at(200.0);
    }
  }
  EXPECT_GE(trips_of_others, 5.0);
}

TEST_F(ForagerLife, CrumbsDoNotOutliveTheirAgeEvenWhereAllAreDead) {
  const std::string short_lived = with(team, "exploration", "age_max_s = 100, exploration");
  const Values values = run(and_also(short_lived, "[[dropouts]]\nkind = \"die\"\nfrom_s = 300\n"));
  for (AgentId id = 0; id < 3; ++id) {
    const auto alive = values.over_time(id, "crumbs_alive");
    EXPECT_GT(alive.at(300.0), 50.0) << id;
    // Each robot lays at most one in two seconds, and all three are heard.
    for (const auto& [time, crumbs] : alive) EXPECT_LE(crumbs, 3.0 * 51.0);
    for (const auto& [time, crumbs] : alive) {
      if (time <= 300.0) continue;
      EXPECT_LE(crumbs, time > 400.0 ? 0.0 : alive.at(time - 1.0)) << id << " at " << time;
    }
  }
}

TEST_F(ForagerLife, ARebootEmptiesTheMemoryUnlessItRemembers) {
  for (const bool remembers : {true, false}) {
    const std::string memory = remembers ? "memory = true\n" : "";
    const Values values =
        run(and_also(with(team, "count = 3", "count = 2"),
                     "[[dropouts]]\nagents = [0]\nkind = \"reboot\"\nfrom_s = 300\n"
                     "until_s = 310\n" +
                         memory));
    const auto alive = values.over_time(0, "crumbs_alive");
    EXPECT_GT(alive.at(299.0), 100.0);
    if (remembers) {
      EXPECT_GT(alive.at(311.0), 100.0);
    } else {
      // What it may have heard by then is what the other lays: one in two seconds.
      EXPECT_LE(alive.at(311.0), 3.0);
      // And what the other laid before does not come again: nobody passes it on.
      EXPECT_LT(alive.at(330.0), 0.5 * alive.at(299.0));
    }
    EXPECT_EQ(moved(values, 0, 301.0, 309.0), 0.0);
    EXPECT_GT(moved(values, 0, 310.0, 600.0), 2.0);
    if (!remembers) continue;
    EXPECT_GT(values.over_time(0, "trips_so_far").at(600.0),
              values.over_time(0, "trips_so_far").at(310.0) + 2.0);
  }
}

TEST_F(ForagerLife, RespawnPutsEachBackToItsStart) {
  const std::string respawned = with(with(team, "[\"A\", \"B\"]", "[\"B\"], respawn = true"),
                                     "trails = {", "trails = { navigation = \"explore\", ");
  const Values values = run(with(respawned, "at-once", "at-event"));
  for (AgentId id = 0; id < 3; ++id) {
    const auto points = way(values, id);
    EXPECT_LE(apart(points.at(0.0), a), 1.2);
    const std::vector<double> arrivals = values.times(id, "arrived");
    ASSERT_GE(arrivals.size(), 3U) << id;
    EXPECT_EQ(arrivals.size(), values.scalar(id, "trips"));
    std::vector<double> began = {0.0};
    const std::vector<double> durations = values.by_trip(id, "trip_duration_s");
    for (std::size_t i = 0; i < arrivals.size(); ++i) {
      // It may wait for room, for nobody stands at A for long.
      EXPECT_NEAR(arrivals[i] - durations[i], began.back(), i == 0 ? 1e-9 : 5.0) << id;
      EXPECT_GE(durations[i], (11.5 - 1.2 - 1.0) / speed_m_per_s) << "from A's scatter to B";
      began.push_back(arrivals[i]);
      const double sampled_s = std::ceil(arrivals[i]) - 1.0;
      if (sampled_s + 2.0 > 600.0) break;
      EXPECT_NEAR(points.at(sampled_s).x_m, 16.25, 1.0 + speed_m_per_s) << "at B";
      EXPECT_LE(apart(points.at(sampled_s + 2.0), a), 1.2 + 2.0 * speed_m_per_s)
          << "and at A again";
    }
  }
}

TEST_F(ForagerLife, WhatWasDrivenForATrailThatGrewTooLongIsPartOfNoTrip) {
  series_.push_back("trip_length_m");
  const std::string respawned =
      with(with(team, "[\"A\", \"B\"]", "[\"B\"], respawn = true"), "trails = {",
           "trails = { transform = \"as-is\", laying = \"completed\", interval_s = 2, "
           "trail_crumbs_max = 30, ");
  const Values values = run(with(respawned, "at-once", "at-event"));
  double abandoned = 0.0, trips = 0.0;
  for (AgentId id = 0; id < 3; ++id) {
    abandoned += values.scalar(id, "trails_abandoned");
    const std::vector<double> durations_s = values.by_trip(id, "trip_duration_s");
    ASSERT_EQ(values.scalar(id, "trips"), static_cast<double>(durations_s.size()));
    for (const double duration_s : durations_s) EXPECT_LE(duration_s, 31 * 2.0) << id;
    trips += static_cast<double>(durations_s.size());
    if (values.scalar(id, "trails_abandoned") == 0.0) continue;
    // A trail that is given up was laid for a minute, on the move.
    double trips_m = 0.0;
    for (const double length_m : values.by_trip(id, "trip_length_m")) trips_m += length_m;
    EXPECT_GE(values.scalar(id, "distance_driven_m"), trips_m + 5.0) << id;
  }
  EXPECT_GE(abandoned, 1.0);
  EXPECT_GE(trips, 3.0);
}

/// With respawn and without: a first trip ends, others' have to.
class ForagerWaits : public ForagerLife, public testing::WithParamInterface<std::string> {};

TEST_P(ForagerWaits, UntilAllHaveMadeATripAndThenSetsOff) {
  const std::string task = with(team, "[\"A\", \"B\"]", GetParam());
  const std::string laid =
      with(task, "trails = {", "trails = { laying = \"completed\", transform = \"as-is\", ");
  const std::string one_frame = with(laid, "rays = 90", "rays = 90, frame = \"shared\"");
  const Values values = run(with(one_frame, "at-once", "at-event"));
  double first_s = 600.0, all_s = 0.0;
  for (AgentId id = 0; id < 3; ++id) {
    const std::vector<double> arrivals = values.times(id, "arrived");
    ASSERT_GE(arrivals.size(), 2U) << id;
    first_s = std::min(first_s, arrivals[0]);
    all_s = std::max(all_s, arrivals[0]);
  }
  EXPECT_LT(first_s, all_s - 5.0) << "of another seed all come at once";
  for (AgentId id = 0; id < 3; ++id) {
    const std::vector<double> arrivals = values.times(id, "arrived");
    EXPECT_NEAR(arrivals[1] - values.by_trip(id, "trip_duration_s")[1], all_s, tick_s + 1e-9) << id;
    // Nobody stirs before the last has come.
    const double from_s = std::ceil(arrivals[0]) + 1.0, until_s = std::floor(all_s) - 1.0;
    if (from_s < until_s) {
      EXPECT_EQ(moved(values, id, from_s, until_s), 0.0) << id;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Tasks, ForagerWaits,
                         testing::Values("[\"B\"], respawn = true, wait_for_all = true",
                                         "[\"A\", \"B\"], wait_for_all = true"),
                         [](const auto& task) {
                           return task.index == 0 ? "respawn" : "to_and_fro";
                         });

TEST_F(ForagerLife, NobodyEverStandsInAWallOrInAnother) {
  const std::string cave = HEARSAY_SOURCE_DIR "/scenarios/lost/plans/cave.txt";
  for (const std::string exploration : {"roam", "wall", "corridor"}) {
    const std::string crowd = with(with(with(with(team, "plan.txt", cave), "\"A\"", "\"anywhere\""),
                                        "[\"anywhere\"", "[\"A\""),
                                   "count = 3", "count = 25");
    const Values values = run(with(with(crowd, "duration_s = 600", "duration_s = 100"),
                                   "\"corridor\"", "\"" + exploration + "\""));
    const plan::Plan plan(plan::read_text(cave, 0.5));
    const plan::WallIndex walls(plan);
    std::vector<std::map<double, plan::Point>> ways;
    double driven_m = 0.0;
    for (AgentId id = 0; id < 25; ++id) {
      ways.push_back(way(values, id));
      driven_m += values.scalar(id, "distance_driven_m");
      for (const auto& [time, p] : ways.back()) {
        ASSERT_GE(plan::clearance(walls, p, 1.0), radius_m - 1e-6) << id << " at " << time;
        for (AgentId other = 0; other < id; ++other) {
          const double gap = apart(p, ways[static_cast<std::size_t>(other)].at(time));
          ASSERT_GE(gap, 2.0 * radius_m - 1e-6) << id << ' ' << other << " at " << time;
        }
      }
    }
    EXPECT_GT(driven_m, 0.3 * 25 * 100.0 * speed_m_per_s) << exploration;
  }
}

TEST_F(ForagerLife, WhereThereIsNoRoomForAllIsTold) {
  write("s.toml", with(team, "count = 3", "count = 300"));
  const auto prepared =
      prepare(load_scenario("s.toml", {}, known_names(catalog_)), catalog_, logs_);
  const std::string error = error_of([&] { hearsay::Run(prepared, catalog_, {.seed = 3}).run(); });
  EXPECT_EQ(error.substr(0, error.find(" for robot")), "s.toml: agents[0].robot: no room is found");
  EXPECT_NE(error.find("m within scatter_m = 1.2"), std::string::npos) << error;
}

TEST_F(ForagerLife, WhoCannotMovePanicsHoweverItFindsItsWay) {
  write("cell.txt", "######\n#A##B#\n######\n");
  std::string shut = with(with(team, "plan.txt", "cell.txt"), "scatter_m = 1.2", "scatter_m = 0");
  shut = with(with(shut, "count = 3", "count = 1"), "duration_s = 600", "duration_s = 60");
  for (const std::string navigation : {"trails", "explore", "map"}) {
    const Values values =
        run(with(shut, "trails = {", "trails = { navigation = \"" + navigation + "\","));
    EXPECT_GT(values.scalar(0, "time_panicking_share"), 0.2) << navigation;
    EXPECT_NEAR(values.scalar(0, "time_panicking_share") + values.scalar(0, "time_exploring_share"),
                1.0, 1e-9)
        << navigation;
  }
}

// robot_world_test.cpp has barriers that come up in the course of a run.
TEST_F(ForagerLife, ABlockedCorridorIsNotPassedUntilItOpens) {
  const std::string longer = with(team, "duration_s = 600", "duration_s = 900");
  const std::string barrier =
      "barriers = [{ corner_m = [10, 0.5], opposite_m = [11, 3.5], until_s = 320 }]\n";
  const Values values = run(with(longer, "[radio]\n", barrier + "[radio]\n"));
  EXPECT_EQ(values.times(no_agent, "barrier"), (std::vector<double>{0.0, 320.0}));
  const double edge_m = 10.0 - radius_m;
  double nearest_m = 10.0;
  int passed = 0;
  for (AgentId id = 0; id < 3; ++id) {
    for (const auto& [time, p] : way(values, id)) {
      if (time <= 320.0) {
        ASSERT_LE(p.x_m, edge_m + 1e-6) << id << " at " << time;
        nearest_m = std::min(nearest_m, edge_m - p.x_m);
      }
      passed += p.x_m > 11.0 + radius_m;
    }
    EXPECT_GT(values.scalar(id, "recovery_s"), (11.5 - 2.0) / speed_m_per_s) << id;
  }
  EXPECT_LT(nearest_m, 1.0) << "they came near it";
  EXPECT_GT(passed, 100);
  // The last change is the opening, after which half of them at least make a trip.
  EXPECT_LT(values.scalar(central_agent, "recovery_s"), 580.0);
}

TEST_F(ForagerLife, ASourceThatRunsDryIsVisitedAsOftenAsItHasUnits) {
  const std::string dry = with(team, "[world.plan]",
                               "[[world.sources]]\nname = \"B\"\nunits = 4\nevent_radius_m = 1.5\n"
                               "[world.plan]");
  const Values values = run(dry);
  int visits = 0;
  double last_s = 0.0;
  for (const Event& event : values.events) {
    if (event.kind != "arrived" || event.detail[0] != 'B') continue;
    ++visits;
    last_s = event.time_s;
  }
  EXPECT_EQ(visits, 4);
  EXPECT_EQ(values.times(no_agent, "source"), std::vector<double>{last_s});
}

}  // namespace
}  // namespace hearsay
