// Whole runs of agents that track, and what their files may say.
#include <gtest/gtest.h>

#include <map>
#include <string>

#include "scenarios/run.hpp"
#include "sim/kernel/error.hpp"
#include "tests/scenarios/temp_files.hpp"

namespace hearsay {
namespace {

const std::string scenario =
    R"(duration_s = 60
[world]
step_s = 1
targets = [
  { name = "east", position_m = [0, 0])"
    R"(, motion = { kind = "waypoints", points_m = [[300, 0]], speed_m_per_s = 5 } },
  { name = "still", position_m = [150, 200] },
]
[radio]
topology = "full"
[record]
series = ["gospa_m", "missed_targets"]
series_period_s = 10
tracks = { order = 2, cutoff_m = 20 }
[[agents]]
kind = "tracker"
position_m = [0, 0]
sensor = { kind = "scan", sigma_m = 2, range_max_m = 160)"
    R"(, detection_probability = 0.95, false_alarms_per_km2 = 5 }
tracker = { fusion = "ci-det", acceleration_psd_m2_per_s3 = 0.05, )"
    R"(birth_speed_sigma_m_per_s = 5, sigma_max_m = 40 }
talk = { period_s = 2 }
[[agents]]
kind = "tracker"
position_m = [300, 100]
sensor = { kind = "scan", sigma_m = 2, range_max_m = 200)"
    R"(, detection_probability = 0.95, false_alarms_per_km2 = 5 }
tracker = { fusion = "ci-det", acceleration_psd_m2_per_s3 = 0.05, )"
    R"(birth_speed_sigma_m_per_s = 5, sigma_max_m = 40 }
talk = { period_s = 2 }
)";

class TrackerRun : public InTempDirectory {
 protected:
  std::shared_ptr<const PreparedScenario> prepared(const std::string& text) {
    write("s.toml", text);
    return prepare(load_scenario("s.toml", {}, known_names(catalog_)), catalog_, logs_);
  }
  static std::string with(const std::string& from, const std::string& to) {
    std::string text = scenario;
    for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
      text.replace(at, from.size(), to);
    }
    return text;
  }
  std::string error(const std::string& from, const std::string& to) {
    try {
      prepared(with(from, to));
    } catch (const InputError& e) {
      return e.what();
    }
    return "no error";
  }
  Catalog catalog_;
  LogCache logs_;
};

struct Values {
  double missed = 0;                      // by agent 0, mean of all samples after 10 s
  std::map<std::string, double> scalars;  // sums over agents
};

Values values_of(const std::shared_ptr<const PreparedScenario>& what) {
  const Catalog catalog;
  hearsay::Run run(what, catalog, {.seed = 3});
  const RunEnd end = run.run();
  EXPECT_TRUE(end.ok()) << end.message;
  Values values;
  int samples = 0;
  for (const SeriesRow& row : run.record().series()) {
    if (run.record().text(row.name) != std::string("missed_targets")) continue;
    if (row.agent != 0 || row.time <= Time::at(10_s)) continue;
    values.missed += row.value;
    ++samples;
  }
  EXPECT_EQ(samples, 5);
  values.missed /= samples;
  for (const ScalarRow& row : run.record().scalars()) {
    values.scalars[run.record().text(row.name)] += row.value;
  }
  return values;
}

// Agent 0 never comes near the target that stands still, and loses the other one after 32 s.
TEST_F(TrackerRun, WhoHearsOthersMissesLess) {
  const Values alone = values_of(prepared(with("\"ci-det\"", "\"none\"")));
  const Values together = values_of(prepared(scenario));
  EXPECT_GE(alone.missed, 1.0);
  EXPECT_LE(together.missed, 0.2);
  EXPECT_EQ(together.scalars.at("label_swaps"), 0.0);
  EXPECT_GT(together.scalars.at("tracks_of_hearsay"), 0.0);
  EXPECT_GT(together.scalars.at("fusions"), 20.0);
  EXPECT_EQ(alone.scalars.at("fusions"), 0.0);
}

TEST_F(TrackerRun, TargetsThatStandStillNeedNoStep) {
  std::string text = with("step_s = 1\n", "");
  const auto from = text.find(", motion = {"), to = text.find("5 } },");
  text.replace(from, to - from + 5, " }");
  EXPECT_LE(values_of(prepared(text)).missed, 0.2);
}

TEST_F(TrackerRun, TrailsCostBytesAndLeaveTheTracksRight) {
  const Values states = values_of(prepared(scenario));
  const Values trails =
      values_of(prepared(with("sigma_max_m = 40", "sigma_max_m = 40, trail_s = 20")));
  EXPECT_LE(trails.missed, 0.2);
  EXPECT_EQ(trails.scalars.at("label_swaps"), 0.0);
  EXPECT_GT(trails.scalars.at("fusions"), 20.0);
  EXPECT_GT(trails.scalars.at("bytes_sent"), 5.0 * states.scalars.at("bytes_sent"));
}

TEST_F(TrackerRun, WhatDoesNotGoTogetherIsRefused) {
  EXPECT_EQ(error("acceleration_psd_m2_per_s3 = 0.05, ", ""),
            "s.toml:18: agents[0].tracker: without acceleration_psd_m2_per_s3 it believes that "
            "targets stand still, but \"east\" moves");
  EXPECT_EQ(error("kind = \"tracker\"\nposition_m = [0, 0]\n", "kind = \"tracker\"\n"),
            "s.toml:16: agents[0].sensor.range_max_m: needs to know where the agent stands: "
            "position_m, circle or motion");
  EXPECT_EQ(error("range_max_m = 160, ", ""),
            "s.toml:17: agents[0].sensor.false_alarms_per_km2: needs range_max_m: false alarms lie "
            "within it");
  EXPECT_EQ(error("range_max_m = 160", "range_max_m = 1e5"),
            "s.toml:17: agents[0].sensor.false_alarms_per_km2: more than 1000 false alarms in a "
            "scan, on average, within range_max_m (1e+05 m)");
  EXPECT_EQ(error("sigma_max_m = 40", "confirm_hits = 5"),
            "s.toml:18: agents[0].tracker.confirm_hits: must not be more than confirm_scans (4)");
  EXPECT_EQ(
      error("kind = \"scan\", sigma_m = 2, range_max_m = 160", "kind = \"position\", sigma_m = 2"),
      "s.toml:17: agents[0].sensor.detection_probability: only for kind = \"scan\"; found "
      "\"position\"");
  EXPECT_EQ(
      error("sigma_m = 2, range_max_m = 160", "period_s = 0.5, sigma_m = 2, range_max_m = 160"),
      "s.toml:17: agents[0].sensor.period_s: must be a multiple of world.step_s (1.0 s), for "
      "targets that move are looked at there alone");
}

TEST_F(TrackerRun, TrailsAreOfTargetsThatMove) {
  EXPECT_EQ(error("acceleration_psd_m2_per_s3 = 0.05, ", "trail_s = 20, "),
            "s.toml:18: agents[0].tracker.trail_s: needs acceleration_psd_m2_per_s3: trails are of "
            "targets that move");
}

TEST_F(TrackerRun, KeysOfTrackersAreForTrackersAlone) {
  EXPECT_EQ(error("kind = \"tracker\"", "kind = \"source\""),
            "s.toml:18: agents[0].tracker: only for kind = \"tracker\"; found \"source\"");
  EXPECT_EQ(error("talk = ", "estimator = { fusion = \"naive\" }\ntalk = "),
            "s.toml:19: agents[0].estimator: without effect: kind = \"tracker\" has "
            "agents.tracker instead");
  EXPECT_EQ(error("\"ci-det\"", "\"channel\"").substr(0, 57),
            "s.toml:18: agents[0].tracker.fusion = \"channel\": unknown;");
}

}  // namespace
}  // namespace hearsay
