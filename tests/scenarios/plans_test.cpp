// world.plan, and all else that a scenario says of foragers: read, written, and read again.
#include "scenarios/plans.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "scenarios/study.hpp"
#include "tests/scenarios/temp_files.hpp"
#include "tests/scenarios/with.hpp"

namespace hearsay {
namespace {

const std::string floor_text =
    "########\n"
    "#A.#..B#\n"
    "#......#\n"
    "########\n";
const std::string scenario = R"(duration_s = 600
[world.plan]
file = "floor.txt"
[[agents]]
kind = "forager"
robot = { start = "A" }
task = { events = ["A", "B"] }
trails = {}
)";
/// No value is the default.
const std::string all = R"(duration_s = 600
[world.plan]
file = "floor.txt"
cell_m = 2.0
places = [{ name = "door", position_m = [3.0, 3.0] }]
barriers = [{ corner_m = [6, 2], opposite_m = [8, 4], from_s = 10, until_s = 20 }]
[[world.sources]]
name = "A"
units = 5
event_radius_m = 0.5
moves = [{ at_s = 60, place = "door" }, { at_s = 70, place = "B" }]
[[agents]]
kind = "forager"
count = 3
talk = { policy = "at-event" }
[agents.robot]
start = "anywhere"
scatter_m = 0.5
heading_rad = -1.5
radius_m = 0.125
speed_m_per_s = 0.75
turn_rad_per_s = 2.5
control_period_s = 0.25
rays = 90
view_rad = 3.5
range_m = 4.5
frame = "shared"
forward_bias = 0.03
turn_bias = 0.05
forward_m_per_sqrt_m = 0.01
turn_rad_per_sqrt_m = 0.02
turn_rad_per_sqrt_rad = 0.04
clock_offset_s = 0.5
[agents.task]
events = ["A", "door"]
wait_for_all = true
[agents.trails]
parameters = "thesis-2019-text"
navigation = "trails"
exploration = "wall"
laying = "at-once"
distance = "steps-without-turns"
sense_radius_m = 1.5
interval_s = 3.0
age_max_s = 100.0
life_arrivals = 7
trail_end_s = 2.5
trail_end = "search"
random_chance = 0.25
random_falls_by = 0.125
lanes = "highway"
field_rad = 2.0
transform = "optimistic"
scale = false
relay = true
crumbs_max = 50
packet_bytes_max = 500
[record]
crumbs = "on"
)";

class Plans : public InTempDirectory {
 protected:
  void SetUp() override {
    InTempDirectory::SetUp();
    write("floor.txt", floor_text);
  }
  static Scenario load(const std::string& text, const std::vector<std::string>& set = {}) {
    write("s.toml", text);
    return load_scenario("s.toml", sets(set), {});
  }
};

TEST_F(Plans, AreReadWithTheirPlaces) {
  const Scenario s = load(all);
  const plan::Plan& plan = *s.world.plan->plan;
  EXPECT_EQ(plan.width_m(), 16.0);
  EXPECT_EQ(plan.height_m(), 8.0);
  ASSERT_EQ(plan.places().size(), 3U);
  EXPECT_EQ(plan.place("A"), (plan::Point{3.0, 5.0}));
  EXPECT_EQ(plan.place("B"), (plan::Point{13.0, 5.0}));
  EXPECT_EQ(plan.place("door"), (plan::Point{3.0, 3.0}));
  EXPECT_EQ(load(scenario).world.plan->plan->width_m(), 4.0);  // cells of half a metre
}

TEST_F(Plans, AreFoundFromTheScenarioFile) {
  std::filesystem::create_directories("lost/plans");
  write("lost/plans/floor.txt", floor_text);
  write("lost/s.toml", with(scenario, "floor.txt", "plans/floor.txt"));
  EXPECT_EQ(load_scenario("lost/s.toml", {}, {}).world.plan->file, "lost/plans/floor.txt");
  const auto with_set = [](const std::string& file) {
    return load_scenario("lost/s.toml", sets({"world.plan.file=\"" + file + "\""}), {});
  };
  EXPECT_EQ(with_set("floor.txt").world.plan->file, "floor.txt");
  EXPECT_EQ(error_of([&] { with_set("plans/floor.txt"); }),
            "--set world.plan.file=\"plans/floor.txt\": world.plan.file: there is no file "
            "\"plans/floor.txt\"");
}

TEST_F(Plans, WhatIsNotGivenIsTheDefault) {
  const Scenario s = load(scenario);
  EXPECT_EQ(s.world.plan->cell_m, 0.5);
  EXPECT_TRUE(s.world.plan->barriers.empty());
  EXPECT_TRUE(s.world.sources.empty());
  const AgentSpec& agent = s.agents.at(0);
  EXPECT_EQ(agent.robot->control_period_s, 0.1);
  EXPECT_EQ(agent.robot->heading_rad, std::nullopt);
  EXPECT_EQ(agent.task->events, (std::vector<std::string>{"A", "B"}));
  EXPECT_FALSE(agent.task->respawn);
  EXPECT_EQ(agent.trails->parameters, "lost-2002");
  EXPECT_EQ(agent.trails->interval_s, std::nullopt);
  EXPECT_EQ(s.record.crumbs, "off");
}

TEST_F(Plans, AScenarioOfForagersIsReadAsItStands) {
  const Scenario s = load(all);
  const BarrierSpec& barrier = s.world.plan->barriers.at(0);
  EXPECT_EQ(barrier.corner_m, (std::vector<double>{6.0, 2.0}));
  EXPECT_EQ(barrier.opposite_m, (std::vector<double>{8.0, 4.0}));
  EXPECT_EQ(barrier.from_s, 10.0);
  EXPECT_EQ(barrier.until_s, 20.0);
  const SourceSpec& source = s.world.sources.at(0);
  EXPECT_EQ(source.name, "A");
  EXPECT_EQ(source.units, 5);
  EXPECT_EQ(source.event_radius_m, 0.5);
  ASSERT_EQ(source.moves.size(), 2U);
  EXPECT_EQ(source.moves[1].at_s, 70.0);
  EXPECT_EQ(source.moves[1].place, "B");
  EXPECT_EQ(s.agents.at(0).talk.policy, "at-event");
  EXPECT_EQ(s.agents.at(0).task->events, (std::vector<std::string>{"A", "door"}));
}

TEST_F(Plans, CanonicalTextReadsBackAsItself) {
  const auto read_back = [](const std::string& text) {
    const std::string canonical = canonical_text(load(text));
    write("t.toml", canonical);
    EXPECT_EQ(canonical_text(load_scenario("t.toml", {}, {})), canonical);
    return canonical;
  };
  // What does not go with the rest of `all`.
  const std::string carried =
      read_back(with(scenario, "events = [\"A\", \"B\"] }\ntrails = {}",
                     "events = [\"B\"], respawn = true }\n"
                     "trails = { laying = \"completed\", trail_crumbs_max = 70, "
                     "transform = \"as-is\" }"));
  EXPECT_NE(carried.find("respawn = true"), std::string::npos) << carried;
  EXPECT_NE(carried.find("trail_crumbs_max = 70"), std::string::npos) << carried;
  const std::string text = read_back(all);
  // Every line of the tables of an agent is in it, as it stands.
  std::size_t lines = 0;
  for (auto at = all.find("[agents.robot]"); at < all.find("[record]");) {
    const auto end = all.find('\n', at);
    const std::string line = all.substr(at, end - at);
    at = end + 1;
    if (line.starts_with('[')) continue;
    EXPECT_NE(text.find(" " + line), std::string::npos) << line << "\nin\n" << text;
    ++lines;
  }
  EXPECT_EQ(lines, 39U);
  EXPECT_NE(text.find("crumbs = \"on\""), std::string::npos);
  EXPECT_NE(text, canonical_text(load(with(all, "cell_m = 2.0", "cell_m = 1.9"))));
}

TEST_F(Plans, SetReachesAllOfIt) {
  const Scenario s = load(all, {"agents.trails.lanes=so-lost", "agents[0].robot.rays=32",
                                "world.sources[0].moves[1].at_s=80", "world.plan.cell_m=1.9",
                                "world.plan.barriers[0].until_s=30", "record.crumbs=off"});
  EXPECT_EQ(s.agents[0].trails->lanes, "so-lost");
  EXPECT_EQ(s.agents[0].robot->rays, 32);
  EXPECT_EQ(s.world.sources[0].moves[1].at_s, 80.0);
  EXPECT_EQ(s.world.plan->plan->width_m(), 8 * 1.9);
  EXPECT_EQ(s.world.plan->barriers[0].until_s, 30.0);
  EXPECT_EQ(s.record.crumbs, "off");
}

TEST_F(Plans, AreFoundFromTheStudyThatNamesThem) {
  std::filesystem::create_directories("lost/plans");
  write("lost/s.toml", scenario);
  write("lost/plans/other.txt", floor_text);
  write("lost/t.toml",
        "scenario = \"s.toml\"\n[axes]\nplan = { points = [{ label = \"other\", set = "
        "{ \"world.plan.file\" = \"plans/other.txt\" } }] }\n");
  const Study study = load_study("lost/t.toml", {});
  const Scenario s = load_scenario(study.scenario_file, cells(study)[0].set, {});
  EXPECT_EQ(s.world.plan->file, "lost/plans/other.txt");
}

}  // namespace
}  // namespace hearsay
