#include "agents/pose_witness.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "sim/math/functions.hpp"

namespace hearsay {
namespace {

using localization::Pose;
using localization::PoseFilter;
using localization::RelativeSighting;

/// What a robot believes, made by hand.
class Mind final : public PoseMind {
 public:
  explicit Mind(std::function<const PoseFilter&()> present) : present_(std::move(present)) {}
  std::optional<PoseBelief> own_pose() override {
    const PoseFilter& own = present_();
    return PoseBelief{own.pose(0), own.covariance(0)};
  }

 private:
  std::function<const PoseFilter&()> present_;
};

/// Robots that stand still for 10 s, and what the witness of them leaves.
class Watched : public testing::Test {
 protected:
  Watched() : simulation_({.end = Time::at(10_s)}) {}

  static Journey journey(const Pose& start, const std::vector<Duration>& truth) {
    Journey journey{.start = start};
    for (const Duration at : truth) journey.truth.push_back({Time::at(at), start});
    return journey;
  }
  PoseWitness& witness(std::vector<Journey> journeys, Duration period = 4_s) {
    journeys_ = std::move(journeys);
    PoseWitness::Options options;
    options.journeys = journeys_;
    for (const Journey& j : journeys_) {
      options.central.start.push_back(j.start);
      options.names.push_back("robot" + std::to_string(options.names.size() + 1));
    }
    options.series = {Metric::rms_error_m, Metric::claimed_sigma_m, Metric::nees,     Metric::x_m,
                      Metric::y_m,         Metric::x_error_m,       Metric::y_error_m};
    options.series_period = period;
    witness_ = std::make_unique<PoseWitness>(simulation_, options);
    return *witness_;
  }
  void watch(AgentId agent, std::function<const PoseFilter&()> present) {
    minds_.push_back(std::make_unique<Mind>(std::move(present)));
    witness_->watch(agent, *minds_.back());
  }
  void run() {
    witness_->start();
    EXPECT_TRUE(simulation_.run().ok());
    witness_->finish();
  }
  /// Of an agent, by time in seconds.
  std::map<double, double> series(AgentId agent, const std::string& name) const {
    std::map<double, double> values;
    for (const SeriesRow& row : simulation_.record().series()) {
      if (row.agent == agent && simulation_.record().text(row.name) == name) {
        values[row.time.seconds()] = row.value;
      }
    }
    return values;
  }
  double scalar(AgentId agent, const std::string& name) const {
    for (const ScalarRow& row : simulation_.record().scalars()) {
      if (row.agent == agent && simulation_.record().text(row.name) == name) return row.value;
    }
    ADD_FAILURE() << "no " << name;
    return 0.0;
  }

  Simulation simulation_;
  std::vector<Journey> journeys_;
  std::vector<std::unique_ptr<Mind>> minds_;
  std::unique_ptr<PoseWitness> witness_;
};

PoseFilter filter_at(const Pose& pose, const Eigen::Matrix3d& P) {
  PoseFilter::Options options;
  options.start = {pose};
  PoseFilter filter(options);
  filter.replace(pose, P);
  return filter;
}

// Samples at 0, 4, 8 and 10 s. From 5 s on the error is another.
TEST_F(Watched, SamplesOfAKnownErrorGiveWhatFollowsFromIt) {
  Eigen::Matrix3d P;
  P << 0.04, 0.01, 0.002, 0.01, 0.09, -0.003, 0.002, -0.003, 0.01;
  const PoseFilter first = filter_at({1.3, 1.6, -3.1}, P), then = filter_at({0.5, 2.0, 3.0}, P);
  witness({journey({1.0, 2.0, 3.1}, {0_s, 4_s, 8_s, 10_s})});
  watch(0, [&]() -> const PoseFilter& { return simulation_.now() < Time::at(5_s) ? first : then; });
  run();
  const double turn = 2.0 * math::pi - 6.2;  // from 3.1 on to −3.1
  const Eigen::Vector3d e1(0.3, -0.4, turn), e2(-0.5, 0.0, -0.1);
  const double nees1 = e1.dot(P.inverse() * e1), nees2 = e2.dot(P.inverse() * e2);
  const auto expect = [&](const char* name, double before, double after) {
    const std::map<double, double> values = series(0, name);
    ASSERT_EQ(values.size(), 4U) << name;
    for (const double time : {0.0, 4.0}) EXPECT_NEAR(values.at(time), before, 1e-12) << name;
    for (const double time : {8.0, 10.0}) EXPECT_NEAR(values.at(time), after, 1e-12) << name;
  };
  expect("rms_error_m", 0.5 / std::sqrt(2.0), 0.5 / std::sqrt(2.0));
  expect("claimed_sigma_m", std::sqrt(0.13 / 2.0), std::sqrt(0.13 / 2.0));
  expect("nees", nees1, nees2);
  expect("x_m", 1.3, 0.5);
  expect("y_m", 1.6, 2.0);
  expect("x_error_m", 0.3, -0.5);
  expect("y_error_m", -0.4, 0.0);
  EXPECT_NEAR(scalar(0, "position_error_mean_m"), 0.5, 1e-12);
  EXPECT_NEAR(scalar(0, "heading_error_rms_rad"), std::sqrt((turn * turn + 0.01) / 2.0), 1e-12);
  EXPECT_NEAR(scalar(0, "pose_anees"), (nees1 + nees2) / 6.0, 1e-12);
  EXPECT_EQ(scalar(central_agent, "state_dimension"), 3.0);
}

TEST_F(Watched, AfterTheTruthEndedThereIsNothingToCompareWith) {
  const Pose pose{1.0, 2.0, 0.0};
  const Eigen::Matrix3d P = Eigen::Matrix3d::Identity();
  const PoseFilter right = filter_at(pose, P), wrong = filter_at({9.0, 9.0, 1.0}, P);
  witness({journey(pose, {0_s, 4_s})});
  watch(0,
        [&]() -> const PoseFilter& { return simulation_.now() < Time::at(5_s) ? right : wrong; });
  run();
  EXPECT_EQ(series(0, "nees").size(), 2U);
  EXPECT_EQ(series(central_agent, "nees").size(), 2U);
  EXPECT_EQ(scalar(0, "position_error_mean_m"), 0.0);
  EXPECT_EQ(scalar(0, "pose_anees"), 0.0);
}

TEST_F(Watched, ASampleDueAtTheEndIsTakenOnce) {
  const Pose pose{1.0, 2.0, 0.0};
  witness({journey(pose, {0_s, 5_s, 10_s})}, 5_s);
  run();
  EXPECT_EQ(series(central_agent, "nees").size(), 3U);
  std::size_t rows = 0;
  for (const SeriesRow& row : simulation_.record().series()) rows += row.time == Time::at(10_s);
  EXPECT_EQ(rows, 7U);  // one a metric
}

// The central filter of one robot is that of the robot alone, whoever asks when.
TEST_F(Watched, TheCentralFilterOfOneRobotIsThatOfTheRobotAlone) {
  Journey one = journey({1.0, 2.0, 0.5}, {0_s, 1_s, 2_s, 3_s, 4_s, 5_s, 6_s, 7_s, 8_s, 9_s, 10_s});
  for (int ms = 0; ms < 10'000; ms += 20) one.drives.push_back({Time() + 1_ms * ms, 0.3, 0.2});
  PoseFilter::Options options;
  options.start = {one.start};
  PoseFilter alone(options);
  witness({one}, 1_s);
  Odometer odometer(journeys_[0].drives);
  const auto present = [&]() -> const PoseFilter& {
    odometer.advance(simulation_.now(), [&](Time, double forward, double turn, double dt_s) {
      alone.drive(0, forward, turn, dt_s);
    });
    return alone;
  };
  watch(0, present);
  const Eigen::Vector2d place(4.0, 1.0);
  for (int k = 1; k <= 12; ++k) {  // off the grid of the odometry; the last ones after its gap
    simulation_.schedule(Time() + 773_ms * k, Phase::measure, [&] {
      present();
      const RelativeSighting seen{3.0, -0.4, 0.3, 0.2};
      alone.saw_place(0, place, seen);
      witness_->saw_place(0, place, seen);
    });
  }
  run();
  for (const char* name : {"nees", "x_m", "y_m", "claimed_sigma_m"}) {
    const auto own = series(0, name), central = series(central_agent, name);
    EXPECT_EQ(own.size(), 11U);
    EXPECT_EQ(own, central) << name;
  }
}

// Two robots: what one sees of the other tells the central filter of both.
TEST_F(Watched, TheCentralFilterTakesInSightingsOfCompanions) {
  witness({journey({0.0, 0.0, 0.0}, {0_s, 4_s, 8_s, 10_s}),
           journey({4.0, 0.0, 1.0}, {0_s, 4_s, 8_s, 10_s})});
  PoseFilter::Options options;
  options.start = {journeys_[0].start, journeys_[1].start};
  PoseFilter both(options);
  const RelativeSighting seen{4.1, 0.05, 0.1, 0.05};
  simulation_.schedule(Time::at(2_s), Phase::measure, [&] { witness_->saw_robot(0, 1, seen); });
  run();
  for (const int robot : {0, 1}) both.drive(robot, 0.0, 0.0, 2.0);
  EXPECT_EQ(both.saw_robot(0, 1, seen), localization::Use::used);
  for (const int robot : {0, 1}) both.drive(robot, 0.0, 0.0, 2.0);
  double x = 0.0, y = 0.0;  // both robots leave rows of agent −1: the subject tells them apart
  for (const SeriesRow& row : simulation_.record().series()) {
    const Record& record = simulation_.record();
    if (row.time != Time::at(4_s) || record.text(row.subject) != "robot2") continue;
    if (record.text(row.name) == "x_m") x = row.value;
    if (record.text(row.name) == "y_m") y = row.value;
  }
  EXPECT_NEAR(x, both.pose(1).x_m, 1e-12);
  EXPECT_NEAR(y, both.pose(1).y_m, 1e-12);
  EXPECT_GT(x, 4.0);
}

}  // namespace
}  // namespace hearsay
