// Runs that believe in the robots of a log, who move: world.log.subjects = "robots".
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/scenarios/log_bed.hpp"

namespace hearsay {
namespace {

// Robot 1 drives along +x at 0.5 m/s, robot 2 stands at (5, 5) and faces −1 rad; time 0 is 12 s,
// when robot 1 is at (1, 0). They see each other at full and half seconds, exactly.
class LogRobots : public LogBed {
 protected:
  LogRobots() {
    write("Robot1_Groundtruth.dat", "10 0 0 0\n30 10 0 0\n");
    write("Robot2_Groundtruth.dat", "10 5 5 -1\n26 5 5 -1\n");
    std::string one, two;
    for (int k = 0; k < 30; ++k) {
      const double time = 12.0 + 0.5 * k, x = 0.5 * (time - 10.0);
      one += line_of(time, 14, std::hypot(5.0 - x, 5.0), std::atan2(5.0, 5.0 - x));
      if (k % 3 == 0)
        two += line_of(time, 5, std::hypot(x - 5.0, 5.0), std::atan2(-5.0, x - 5.0) + 1.0);
    }
    one += line_of(28.0, 63, 1.0, 0.0);  // a landmark
    write("Robot1_Measurement.dat", one);
    write("Robot2_Measurement.dat", two);
  }
  std::string scenario() const {
    return "[world]\nstep_s = 0.5\n[world.log]\ndirectory = \"" + directory_ +
           R"("
truth_gap_max_s = 30
subjects = "robots"
[radio]
topology = "full"
[[agents]]
count = 2
sensor = { kind = "log" }
estimator = { kind = "moving-gaussian", fusion = "naive", acceleration_psd_m2_per_s3 = 0.01 }
talk = { period_s = 1, phase = "staggered" }
[record]
series = ["rms_error_m", "claimed_sigma_m", "x_m"]
series_period_s = 2
ledger = "off"
)";
  }
};

TEST_F(LogRobots, SubjectsAreTheRobotsWithPositionAndVelocityAtEachStep) {
  const auto p = prepared(scenario());
  EXPECT_EQ(p->end, Time() + 14_s);  // robot 2's truth ends before the log does
  ASSERT_EQ(p->subjects.size(), 2U);
  EXPECT_EQ(p->subjects[0].name, "robot1");
  EXPECT_EQ(p->subjects[1].name, "robot2");
  ASSERT_EQ(p->subjects[0].truth.size(), 4U * 29U);
  for (std::size_t k = 0; k < 29; ++k) {
    const double* const state = &p->subjects[0].truth[4 * k];
    EXPECT_NEAR(state[0], 1.0 + 0.25 * static_cast<double>(k), 1e-12);
    EXPECT_NEAR(state[1], 0.0, 1e-12);
    EXPECT_NEAR(state[2], 0.5, 1e-12);  // also at the end, where there is but half a second
    EXPECT_NEAR(state[3], 0.0, 1e-12);
    EXPECT_EQ(p->subjects[1].truth[4 * k], 5.0);
    EXPECT_EQ(p->subjects[1].truth[4 * k + 2], 0.0);
  }
  EXPECT_EQ(p->observations[0].size(), 30U);
  EXPECT_EQ(p->observations[0][0].subject, 1);
  EXPECT_EQ(p->observations[1].size(), 10U);
  EXPECT_EQ(p->observations[1][0].subject, 0);
}

TEST_F(LogRobots, ExactSightingsOfWhatMovesSteadilyAreFollowedExactly) {
  for (const char* subject : {"robot1", "robot2"}) {
    const Values values = run(scenario(), subject);
    EXPECT_EQ(values.end, Time() + 14_s);
    for (const AgentId agent : {central_agent, 0, 1}) {
      const auto& errors = values.series.at({agent, "rms_error_m"});
      EXPECT_LT(errors.at(14.0), 1e-6) << subject << ", agent " << agent;
    }
    EXPECT_NEAR(values.series.at({0, "x_m"}).at(14.0), subject == std::string("robot1") ? 8.0 : 5.0,
                1e-6);
    EXPECT_EQ(values.scalar(0, "log_skipped_landmark_sighting"), 1.0);
    EXPECT_EQ(values.scalar(0, "log_skipped_robot_sighting"), 0.0);
    EXPECT_GT(values.scalar(0, "fusions"), 5.0);
  }
}

TEST_F(LogRobots, TheSameSeedGivesTheSameRun) {
  const std::string random = with(scenario(), "\"staggered\"", "\"random\"");
  const Values first = run(random);
  EXPECT_GT(first.digested.size(), 1000U);
  EXPECT_TRUE(first.digested == run(random).digested);
  EXPECT_FALSE(first.digested == run(with(random, "\"naive\"", "\"ci-half\"")).digested);
}

TEST_F(LogRobots, ARunDoesNotGoOnBeyondTheTruthOfARobot) {
  EXPECT_EQ(error("duration_s = 14\n" + scenario()), "no error");
  EXPECT_EQ(
      error("duration_s = 14.5\n" + scenario()),
      "s.toml: duration_s: with world.log.subjects = \"robots\" a run cannot go on beyond the "
      "truth of a robot; that of robot 2 ends after 14.000000 s");
}

TEST_F(LogRobots, NorBeginsItBefore) {
  const std::string late =
      "s.toml: world.log.subjects = \"robots\" believes in robots from the start on, but the truth "
      "of robot 1 is not known then";
  write("Robot1_Groundtruth.dat", "12.001 0 0 0\n30 10 0 0\n");
  EXPECT_EQ(error(scenario()), late);
}

TEST_F(LogRobots, NorAfterIt) {
  write("Robot2_Groundtruth.dat", "10 5 5 -1\n11.999 5 5 -1\n");
  EXPECT_EQ(error(scenario()),
            "s.toml: world.log.subjects = \"robots\" believes in robots from the start on, but the "
            "truth of robot 2 is not known then");
}

TEST_F(LogRobots, WhatDoesNotGoTogetherIsRefused) {
  EXPECT_EQ(error(with(scenario(), "step_s = 0.5", "step_s = 1e-5")),
            "s.toml: world.step_s: the run would have more than 1000000 steps");
  EXPECT_EQ(error("duration_s = 14\n" + with(scenario(), "step_s = 0.5", "step_s = 1e-5")),
            "s.toml:3: world.step_s: the run would have more than 1000000 steps");
  EXPECT_EQ(error(with(scenario(), "step_s = 0.5", "")),
            "s.toml:1: world.step_s: missing; the robots of [world.log] move, and are believed in "
            "at its multiples");
  EXPECT_EQ(error(with(scenario(), "subjects = \"robots\"", "")),
            "s.toml:2: world.step_s: not with the landmarks of [world.log], which stand still");
  EXPECT_EQ(error(with(with(scenario(), "subjects = \"robots\"", ""), "step_s = 0.5", "")),
            "s.toml:12: agents[0].estimator.kind: kind \"moving-gaussian\" does not go with the "
            "landmarks of [world.log], which stand still; take world.log.subjects = \"robots\"");
  EXPECT_EQ(error(with(scenario(),
                       "kind = \"moving-gaussian\", fusion = \"naive\", "
                       "acceleration_psd_m2_per_s3 = 0.01",
                       "kind = \"static-gaussian\"")),
            "s.toml:12: agents[0].estimator.kind: \"static-gaussian\" believes that all stands "
            "still, but the robots of [world.log] move; take \"moving-gaussian\" or "
            "\"trajectory-gaussian\"");
  EXPECT_EQ(error(with(scenario(), "\"robots\"", "\"walls\"")),
            "s.toml:6: world.log.subjects = \"walls\": unknown; allowed: landmarks, robots");
}

}  // namespace
}  // namespace hearsay
