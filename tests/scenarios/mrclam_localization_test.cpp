// Robots that localize themselves on the real logs, against a filter in numpy written from the
// equations alone, with whole matrices, Joseph's form, and times exact to the nanosecond: mean
// position errors, ANEES of the pose, and outliers of each robot.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <filesystem>
#include <string>

#include "scenarios/localizers.hpp"
#include "sim/math/functions.hpp"

namespace hearsay {
namespace {

constexpr Duration step = 1_s;
constexpr Time end = Time::at(735_s);

struct Outcome {
  double position_error_m = 0.0, anees = 0.0;
  int outliers = 0;
};

/// A robot alone that knows all landmarks, sampled each second.
Outcome alone(const Journey& journey, const std::vector<Eigen::Vector2d>& landmarks) {
  localization::PoseFilter filter({.start = {journey.start},
                                   .start_sigma_m = 0.05,
                                   .start_sigma_rad = 0.02,
                                   .odometry = {0.02, 0.005, 0.05},
                                   .gate = 13.8});
  Odometer odometer(journey.drives);
  Outcome outcome;
  std::size_t next = 0;
  for (const TruePose& truth : journey.truth) {
    const auto drive_to = [&](Time time) {
      odometer.advance(time, [&](Time, double forward, double turn, double dt_s) {
        filter.drive(0, forward, turn, dt_s);
      });
    };
    for (; next < journey.encounters.size() && journey.encounters[next].time <= truth.time;
         ++next) {
      const Encounter& seen = journey.encounters[next];
      if (seen.companion) continue;
      drive_to(seen.time);
      const auto use = filter.saw_place(0, landmarks[static_cast<std::size_t>(seen.subject)],
                                        {seen.range_m, seen.bearing_rad, 0.15, 0.08});
      outcome.outliers += use == localization::Use::outside_gate;
    }
    drive_to(truth.time);
    if (truth.time == Time()) continue;  // it begins where it truly is
    const localization::Pose& pose = filter.pose(0);
    const Eigen::Vector3d e(pose.x_m - truth.pose.x_m, pose.y_m - truth.pose.y_m,
                            math::wrap_angle(pose.heading_rad - truth.pose.heading_rad));
    outcome.position_error_m += e.head<2>().norm();
    outcome.anees += e.dot(filter.covariance(0).llt().solve(e)) / 3.0;
  }
  const auto n = static_cast<double>(journey.truth.size() - 1);
  outcome.position_error_m /= n;
  outcome.anees /= n;
  return outcome;
}

TEST(RealLogs, ARobotAloneLocalizesItselfAsInAnIndependentFilter) {
  const std::string directory = HEARSAY_SOURCE_DIR "/../shared/data/mrclam6";
  if (!std::filesystem::is_directory(directory)) {
    GTEST_SKIP() << "the MRCLAM data set 6 is not at " << directory;
  }
  const mrclam::Dataset log = mrclam::load(directory, 5, 500_ms, mrclam::Odometry::read);
  const std::vector<Journey> journeys = journeys_of(log, step, end, "s.toml");
  const std::vector<Eigen::Vector2d> landmarks = landmarks_of(log);
  const double errors_m[] = {.1661712, .2150354, .1833774, .3053361, .1844269};
  const double anees[] = {2.976526, 7.145601, 10.036080, 6.504690, 11.695419};
  const int outliers[] = {7, 4, 34, 9, 72};
  for (std::size_t i = 0; i < 5; ++i) {
    SCOPED_TRACE("robot " + std::to_string(i + 1));
    const Outcome outcome = alone(journeys[i], landmarks);
    EXPECT_NEAR(outcome.position_error_m, errors_m[i], 1e-7);
    EXPECT_NEAR(outcome.anees, anees[i], 1e-6);
    EXPECT_EQ(outcome.outliers, outliers[i]);
  }
}

}  // namespace
}  // namespace hearsay
