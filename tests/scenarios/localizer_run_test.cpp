// Whole runs of robots that localize themselves, on a small data set: robot 1 drives along +x at
// 0.5 m/s, robot 2 stands. What they see is exact.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/scenarios/elsewhere_bed.hpp"
#include "tests/scenarios/log_bed.hpp"

namespace hearsay {
namespace {

class LocalizerRun : public LogBed {
 protected:
  LocalizerRun() {
    write("Robot1_Groundtruth.dat", "10 0 0 0\n30 10 0 0\n");
    write("Robot2_Groundtruth.dat", "10 5 5 -1\n26 5 5 -1\n");
    // Robot 1 is at (x, 0) and faces +x. The log begins at 12 s and ends at 28.5 s.
    std::string one, two;
    for (const double time : {12.0, 15.0, 20.0}) one += seen_by_1(time, 63, 1.5, -2.0);
    one += seen_by_1(21.0, 81, 3.0, 4.0) + seen_by_1(22.25, 14, 5.0, 5.0);
    one += seen_by_1(25.0, 14, 5.0, 5.0);
    two += line_of(28.5, 99, 1.0, 0.0);  // no such barcode
    write("Robot1_Measurement.dat", one);
    write("Robot2_Measurement.dat", two);
    std::string odometry = "# t v w\n", still;
    for (int k = 0; k <= 40; ++k) {
      odometry += std::to_string(11.0 + 0.5 * k) + " 0.5 0\n";
      still += std::to_string(11.0 + 0.5 * k) + " 0 0\n";
    }
    write("Robot1_Odometry.dat", odometry);
    write("Robot2_Odometry.dat", still);
  }
  static std::string seen_by_1(double time_s, int barcode, double x, double y) {
    const double dx = x - 0.5 * (time_s - 10.0);
    return line_of(time_s, barcode, std::hypot(dx, y), std::atan2(y, dx));
  }
  std::string scenario() const {
    return "[world.log]\ndirectory = \"" + directory_ +
           R"("
truth_gap_max_s = 30
[radio]
topology = "full"
[[agents]]
name = "robot"
count = 2
kind = "localizer"
sensor = { kind = "log", sigma_range_m = 0.1, sigma_bearing_rad = 0.05 }
localizer = { fusion = "naive" }
talk = { period_s = 1, phase = "staggered" }
[record]
series = ["rms_error_m", "claimed_sigma_m", "nees", "x_m"]
series_period_s = 2
)";
  }
};

TEST_F(LocalizerRun, WhoseOdometryAndSightingsAreExactIsNeverWrong) {
  const Values values = run(scenario());
  EXPECT_EQ(values.end, Time() + 16'500_ms);
  for (const AgentId agent : {central_agent, 0, 1}) {
    EXPECT_LT(values.scalar(agent, "position_error_mean_m"), 1e-9);
    EXPECT_LT(values.scalar(agent, "heading_error_rms_rad"), 1e-9);
    EXPECT_LT(values.scalar(agent, "pose_anees"), 1e-9);
  }
  EXPECT_EQ(values.scalar(0, "measurements"), 6.0);
  EXPECT_EQ(values.scalar(1, "measurements"), 0.0);
  EXPECT_EQ(values.scalar(1, "fusions"), 2.0);  // seen twice, and told
  EXPECT_EQ(values.scalar(0, "fusions"), 2.0);  // it knew where the other said that it was
  EXPECT_EQ(values.scalar(1, "log_skipped_unknown_barcode"), 1.0);
  for (const char* name : {"outside_gate", "messages_refused", "news_late", "fusions_skipped",
                           "log_skipped_robot_sighting", "log_skipped_landmark_sighting"}) {
    EXPECT_EQ(values.scalar(0, name) + values.scalar(1, name), 0.0) << name;
  }
}

TEST_F(LocalizerRun, SamplesGoOnToTheEndOfTheRunOrOfTheTruth) {
  const Values one = run(scenario(), "robot0"), two = run(scenario(), "robot1");
  const auto& drives = one.series.at({0, "x_m"});
  ASSERT_EQ(drives.size(), 10U);  // 0, 2, …, 16 and 16.5
  EXPECT_NEAR(drives.at(0.0), 1.0, 1e-9);
  EXPECT_NEAR(drives.at(16.5), 9.25, 1e-9);
  EXPECT_EQ(one.series.at({central_agent, "x_m"}).size(), 10U);
  const auto& stands = two.series.at({1, "x_m"});
  EXPECT_EQ(stands.size(), 8U);  // its truth ends at 14 s
  EXPECT_EQ(stands.rbegin()->first, 14.0);
}

TEST_F(LocalizerRun, ThereIsALastSampleAlsoWhereNobodyTalks) {
  write("Robot2_Measurement.dat", "# nothing\n");
  const Values values =
      run("duration_s = 16.5\n" + with(scenario(), "\"naive\"", "\"none\""), "robot0");
  EXPECT_EQ(values.series.at({0, "x_m"}).count(16.5), 1U);
  EXPECT_EQ(values.scalar(0, "fusions"), 0.0);
  EXPECT_EQ(values.scalar(0, "packets"), 0.0);
}

// Robot 2 sees nothing: alone its variance grows with time as the odometry's does.
TEST_F(LocalizerRun, WhoIsSeenIsSurerThanAlone) {
  const Values told = run(scenario(), "robot1");
  const Values alone = run(with(scenario(), "\"naive\"", "\"none\""), "robot1");
  const auto sigma = [](const Values& values, AgentId agent) {
    return values.series.at({agent, "claimed_sigma_m"}).at(14.0);
  };
  EXPECT_NEAR(sigma(alone, 1), std::sqrt(0.0025 + 14.0 * (0.0004 + 0.000025) / 2.0), 1e-12);
  EXPECT_LT(sigma(told, 1), 0.9 * sigma(alone, 1));
  // The central filter hears of every sighting at once, whoever talks.
  EXPECT_EQ(sigma(told, central_agent), sigma(alone, central_agent));
  EXPECT_LT(sigma(alone, central_agent), sigma(alone, 1));
}

TEST_F(LocalizerRun, LandmarksThatItDoesNotKnowAreNoMeasurements) {
  const std::string few = with(scenario(), "fusion = ", "landmarks_known = 1, fusion = ");
  EXPECT_EQ(run(few).scalar(0, "measurements"), 5.0);
  EXPECT_EQ(run(with(few, "_known = 1", "_known = 0")).scalar(0, "measurements"), 2.0);
  EXPECT_EQ(run(with(few, "_known = 1", "_known = 99")).scalar(0, "measurements"), 6.0);
}

TEST_F(LocalizerRun, TheSameSeedGivesTheSameRunAndAnotherRuleAnother) {
  const std::string random = with(scenario(), "\"staggered\"", "\"random\"");
  const Values first = run(random), again = run(random);
  EXPECT_GT(first.digested.size(), 1000U);
  EXPECT_TRUE(first.digested == again.digested);
  EXPECT_FALSE(first.digested == run(with(random, "\"naive\"", "\"ci-trace\"")).digested);
}

TEST_F(LocalizerRun, RobotsInProcessesOfTheirOwnGiveTheSameRun) {
  expect_same(prepared(scenario()));
}

TEST_F(LocalizerRun, ATruthThatBeginsLateIsNamed) {
  write("Robot1_Groundtruth.dat", "12.5 1.25 0 0\n30 10 0 0\n");
  EXPECT_EQ(
      error(scenario()),
      "s.toml: a localizer begins where it truly is, but the truth of robot 1 is not known at "
      "the start");
}

TEST_F(LocalizerRun, AFileOfOdometryThatLacksIsNamed) {
  remove("Robot2_Odometry.dat");
  EXPECT_EQ(error(scenario()).substr(0, 21), "Robot2_Odometry.dat: ");
}

TEST_F(LocalizerRun, ThereAreNoMoreRobotsThanTheLogHas) {
  EXPECT_EQ(error(with(scenario(), "count = 2", "count = 6")),
            directory_ + ": 6 robots asked for; the data set has 1 … 5");
}

TEST_F(LocalizerRun, WhatDoesNotGoTogetherIsRefused) {
  const auto changed = [&](const std::string& from, const std::string& to) {
    return error(with(scenario(), from, to));
  };
  EXPECT_EQ(changed("[world.log]\ndirectory = \"" + directory_ + "\"\ntruth_gap_max_s = 30",
                    "duration_s = 9\n\n"),
            "s.toml:10: agents[0].sensor.kind: \"log\" needs a [world.log] to read");
  EXPECT_EQ(error("duration_s = 9\n[[agents]]\nkind = \"localizer\"\n"),
            "s.toml:3: agents[0].kind: \"localizer\" needs a [world.log] with odometry");
  EXPECT_EQ(changed("[record]", "[[agents]]\nkind = \"localizer\"\n[record]"),
            "s.toml:14: agents[1].sensor.kind: agents of kind \"localizer\" have a sensor of kind "
            "\"log\"; found \"none\"");
  EXPECT_EQ(changed("talk = ", "estimator = { fusion = \"naive\" }\ntalk = "),
            "s.toml:12: agents[0].estimator: without effect: kind = \"localizer\" has "
            "agents.localizer instead");
  EXPECT_EQ(changed("talk = { ", "talk = { policy = \"on-update\", "),
            "s.toml:12: agents[0].talk.policy: kind \"localizer\" knows \"periodic\" and \"never\" "
            "alone; found \"on-update\"");
  EXPECT_EQ(changed("talk = { ", "talk = { content = \"diagonal\", "),
            "s.toml:12: agents[0].talk.content: kind \"localizer\" says whole beliefs; found "
            "\"diagonal\"");
  EXPECT_EQ(changed("localizer = { ", "localizer = { memory_s = 3600.5, "),
            "s.toml:11: agents[0].localizer.memory_s: more than an hour (3600 s) is not kept");
  EXPECT_EQ(changed("localizer = { ", "localizer = { memory_s = 3600, "), "no error");
  EXPECT_EQ(changed("kind = \"localizer\"\n", "kind = \"source\"\n"),
            "s.toml:11: agents[0].localizer: only for kind = \"localizer\"; found \"source\"");
  EXPECT_EQ(changed("truth_gap_max_s = 30", "truth_gap_max_s = 30\nsubjects = \"robots\""),
            "s.toml:4: world.log.subjects: without effect: agents of kind \"localizer\" believe in "
            "their own poses alone");
}

TEST_F(LocalizerRun, ARunHasLocalizersOrEstimators) {
  const std::string estimator = "[[agents]]\nkind = \"estimator\"\nsensor = { kind = \"log\" }\n";
  EXPECT_EQ(error(with(scenario(), "[record]", estimator + "[record]")).substr(0, 25),
            "s.toml:14: agents[1].kind");
  EXPECT_EQ(error(with(scenario(), "[[agents]]", estimator + "[[agents]]")),
            "s.toml:12: agents[1].kind: a run has a central filter of poses or one of targets: not "
            "both \"localizer\" and \"estimator\"");
}

TEST_F(LocalizerRun, OnlyRulesThatCanFuseAPositionByWeightAreAllowed) {
  const auto rule = [&](const std::string& name) {
    return error(with(scenario(), "\"naive\"", "\"" + name + "\""));
  };
  for (const char* name :
       {"none", "naive", "ci-det", "ci-trace", "ci-half", "ci-niehsen", "ci-franken-huepper"}) {
    EXPECT_EQ(rule(name), "no error");
    EXPECT_GT(run(with(scenario(), "\"naive\"", std::string("\"") + name + "\"")).digested.size(),
              0U);
  }
  for (const char* name : {"ci-fixed", "most-certain", "channel", "local-update", "inverse-ci",
                           "ci-batch", "split-ci"}) {
    EXPECT_EQ(rule(name),
              std::string("s.toml:11: agents[0].localizer.fusion = \"") + name +
                  "\": unknown; allowed: none, naive, ci-det, ci-trace, ci-half, ci-niehsen, "
                  "ci-franken-huepper");
  }
}

}  // namespace
}  // namespace hearsay
