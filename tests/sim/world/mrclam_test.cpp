#include "sim/world/mrclam.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"
#include "tests/sim/world/small_dataset.hpp"

namespace hearsay::mrclam {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class Mrclam : public SmallDataset {
 protected:
  Dataset load_with_gap(Duration gap, int robots = 2) const {
    return load(directory_, robots, gap);
  }
  /// Robot 1's poses for landmark sightings at `times`, under a truth file of this content.
  std::vector<PoseSample> poses(const std::string& truth, const std::vector<std::string>& times) {
    write("Robot1_Groundtruth.dat", truth);
    std::string lines;
    for (const std::string& time : times) lines += time + " 63 1.0 0.0\n";
    write("Robot1_Measurement.dat", lines);
    const Dataset set = load_with_gap(10_s, 1);
    std::vector<PoseSample> out;
    for (const Sighting& s : set.robots[0].sightings) out.push_back(s.pose);
    return out;
  }
};

void expect_sum_of_lines(const Robot& robot) {
  const Skips& skips = robot.skips;
  EXPECT_EQ(skips.lines, robot.sightings.size() + robot.companions.size() + skips.truth_gap +
                             skips.unknown_barcode + skips.robot_sighting + skips.bad_range);
}

TEST_F(Mrclam, ASightingCarriesLandmarkRangeBearingAndTheInterpolatedPose) {
  const Dataset set = load_with_gap(10_s);
  ASSERT_EQ(set.landmarks.size(), 2U);
  EXPECT_EQ(set.landmarks[0].subject, 6);
  EXPECT_EQ(set.landmarks[0].x_m, 1.5);
  EXPECT_EQ(set.landmarks[0].y_m, -2.0);
  EXPECT_EQ(set.landmarks[1].subject, 7);
  ASSERT_EQ(set.robots.size(), 2U);
  EXPECT_EQ(set.robots[0].subject, 1);
  ASSERT_EQ(set.robots[0].sightings.size(), 1U);
  const Sighting& first = set.robots[0].sightings[0];
  EXPECT_EQ(first.time, Time());
  EXPECT_EQ(first.landmark, 0);
  EXPECT_EQ(first.range_m, 2.25);
  EXPECT_EQ(first.bearing_rad, -0.5);
  EXPECT_EQ(first.pose.time, first.time);
  EXPECT_DOUBLE_EQ(first.pose.x_m, 2.5);  // a quarter of the way from (0, 0, 0) to (10, 20, 1)
  EXPECT_DOUBLE_EQ(first.pose.y_m, 5.0);
  EXPECT_DOUBLE_EQ(first.pose.heading_rad, 0.25);
  ASSERT_EQ(set.robots[1].sightings.size(), 1U);
  EXPECT_EQ(set.robots[1].sightings[0].landmark, 1);
  EXPECT_EQ(set.robots[1].sightings[0].time, Time() + 500_ms);
}

TEST_F(Mrclam, LandmarksComeBySubjectWhateverTheirOrderInTheFile) {
  write("Landmark_Groundtruth.dat", "7 3 4 0 0\n6 1 2 0 0\n");
  const Dataset set = load_with_gap(10_s);
  EXPECT_EQ(set.landmarks[0].subject, 6);
  EXPECT_EQ(set.robots[0].sightings[0].landmark, 0);
  EXPECT_EQ(set.robots[1].sightings[0].landmark, 1);
}

TEST_F(Mrclam, TimeIsCountedFromTheFirstMeasurementLineOfAnyRobotEvenASkippedOne) {
  write("Robot2_Measurement.dat", "11.25 99 1.0 0.0\n13.0 81 1.0 0.25\n19.75 99 1.0 0.0\n");
  const Dataset set = load_with_gap(10_s);
  EXPECT_EQ(set.robots[0].sightings[0].time, Time() + 1250_ms);
  EXPECT_EQ(set.span, 8500_ms);
}

TEST_F(Mrclam, OnlyTheRobotsAskedForAreRead) {
  remove("Robot2_Groundtruth.dat");
  remove("Robot2_Measurement.dat");
  const Dataset set = load_with_gap(10_s, 1);
  EXPECT_EQ(set.robots.size(), 1U);
  EXPECT_EQ(set.span, Duration());
}

TEST_F(Mrclam, TimesOfTheUnixEpochAreExactToTheNanosecond) {
  write("Robot1_Groundtruth.dat", "1248444175.103 0 0 0\n1248444175.115000001 1 0 0\n");
  write("Robot1_Measurement.dat",
        "1248444175.103 63 1 0\n1248444175.109 63 1 0\n1248444175.1090000004 63 1 0\n"
        "1248444175.1090000005 63 1 0\n1248444175.115000001 63 1 0\n");
  const Dataset set = load_with_gap(1_s, 1);
  std::vector<std::int64_t> times;
  for (const Sighting& s : set.robots[0].sightings) times.push_back(s.time.nanoseconds());
  EXPECT_THAT(times, ElementsAre(0, 6'000'000, 6'000'000, 6'000'001, 12'000'001));
  EXPECT_EQ(set.span.nanoseconds(), 12'000'001);
}

TEST_F(Mrclam, ATimeMayLackDecimals) {
  const auto found = poses("0 0 0 0\n4. 4 8 0\n", {"0", "1.", "2.5", "4"});
  ASSERT_EQ(found.size(), 4U);
  EXPECT_DOUBLE_EQ(found[1].x_m, 1.0);
  EXPECT_DOUBLE_EQ(found[2].x_m, 2.5);
  EXPECT_DOUBLE_EQ(found[3].y_m, 8.0);
}

TEST_F(Mrclam, HeadingsAreUnwrappedAcrossPlusAndMinusPi) {
  // 3.1 → −3.1 is a turn of +0.083 rad to the left, not of −6.2 to the right; and back.
  const auto found =
      poses("0 0 0 3.1\n1 0 0 -3.1\n2 0 0 -3.0\n3 0 0 3.0\n", {"0", "0.5", "1", "2", "2.5", "3"});
  ASSERT_EQ(found.size(), 6U);
  const double turn = 2.0 * math::pi;
  EXPECT_DOUBLE_EQ(found[0].heading_rad, 3.1);
  EXPECT_DOUBLE_EQ(found[1].heading_rad, math::pi);
  EXPECT_DOUBLE_EQ(found[2].heading_rad, turn - 3.1);
  EXPECT_DOUBLE_EQ(found[3].heading_rad, turn - 3.0);
  EXPECT_DOUBLE_EQ(found[4].heading_rad, math::pi);
  EXPECT_DOUBLE_EQ(found[5].heading_rad, 3.0);
}

TEST_F(Mrclam, ManyTurnsOneWayAddUpWithoutDrift) {
  std::string truth;
  std::vector<std::string> times;
  for (int i = 0; i <= 3000; ++i) {  // a right angle each second, as the tracker gives it
    const char* const raw[] = {"0.5", "-1.0707963267948966", "-2.641592653589793",
                               "2.0707963267948966"};
    truth += std::to_string(i) + " 0 0 " + raw[i % 4] + "\n";
  }
  const auto found = poses(truth, {"3000"});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].heading_rad, 0.5 - 3000 * math::pi / 2.0, 1e-11);
}

TEST_F(Mrclam, OfTruthSamplesAtOneTimeTheLastHolds) {
  const auto found = poses("0 0 0 0\n1 7 7 3\n1 1 2 -3\n2 3 2 -3\n", {"0.5", "1", "1.5"});
  ASSERT_EQ(found.size(), 3U);
  EXPECT_DOUBLE_EQ(found[0].x_m, 0.5);
  EXPECT_DOUBLE_EQ(found[0].heading_rad, -1.5);
  EXPECT_DOUBLE_EQ(found[1].x_m, 1.0);
  EXPECT_DOUBLE_EQ(found[1].y_m, 2.0);
  EXPECT_DOUBLE_EQ(found[1].heading_rad, -3.0);
  EXPECT_DOUBLE_EQ(found[2].x_m, 2.0);
}

TEST_F(Mrclam, MeasurementsOfOneInstantAreAllKeptInFileOrder) {
  write("Robot1_Measurement.dat", "12.5 63 2 0\n12.5 81 3 0\n12.5 63 4 0\n");
  const Dataset set = load_with_gap(10_s);
  std::vector<double> ranges;
  for (const Sighting& s : set.robots[0].sightings) ranges.push_back(s.range_m);
  EXPECT_THAT(ranges, ElementsAre(2.0, 3.0, 4.0));
}

TEST_F(Mrclam, AGapOfTheTruthAsWideAsPermittedIsUsedAndAWiderOneIsCounted) {
  write("Robot1_Groundtruth.dat", "10 0 0 0\n11 1 0 0\n12.5 2 0 0\n13 3 0 0\n");
  write("Robot1_Measurement.dat", "10.5 63 1 0\n11 63 1 0\n12 63 1 0\n12.5 63 1 0\n12.75 63 1 0\n");
  const Robot wide = load_with_gap(1500_ms).robots[0];
  EXPECT_EQ(wide.skips.truth_gap, 0U);
  EXPECT_EQ(wide.sightings.size(), 5U);
  const Robot narrow = load_with_gap(1499_ms).robots[0];
  EXPECT_EQ(narrow.skips.truth_gap, 1U);
  EXPECT_EQ(narrow.sightings.size(), 4U);  // 11 and 12.5 have a sample at their very time
  expect_sum_of_lines(narrow);
}

TEST_F(Mrclam, BeforeTheFirstAndAfterTheLastTruthSampleThereIsNoPose) {
  write("Robot1_Measurement.dat",
        "9.999 63 1 0\n10 63 1 0\n20.000 63 1 0\n20.001 63 1 0\n21 63 1 0\n");
  const Robot robot = load_with_gap(10_s).robots[0];
  EXPECT_EQ(robot.skips.truth_gap, 3U);
  EXPECT_EQ(robot.sightings.size(), 2U);
  expect_sum_of_lines(robot);
}

TEST_F(Mrclam, EverySkipIsCountedUnderItsReason) {
  write("Robot1_Measurement.dat",
        "12 63 1 0\n12 14 1 0\n12 5 1 0\n12 43 1 0\n12 34 1 0\n12 43 -1 0\n12 63 0 0\n"
        "12 81 -0.5 0\n12 14 0 0\n30 81 1 0\n30 63 0 0\n");
  const Robot robot = load_with_gap(10_s).robots[0];
  EXPECT_EQ(robot.skips.lines, 11U);
  EXPECT_EQ(robot.skips.robot_sighting, 1U);  // itself
  EXPECT_EQ(robot.companions.size(), 1U);
  EXPECT_EQ(robot.skips.unknown_barcode, 3U);
  EXPECT_EQ(robot.skips.bad_range, 4U);
  EXPECT_EQ(robot.skips.truth_gap, 1U);
  EXPECT_EQ(robot.sightings.size(), 1U);
  EXPECT_THAT(robot.unknown_barcodes, ElementsAre(34, 43));
  expect_sum_of_lines(robot);
}

TEST_F(Mrclam, ASightingOfACompanionCarriesItAndThePoseOfTheOneThatLooks) {
  write("Robot1_Measurement.dat", "10 63 1 0\n12.5 14 2.25 -0.5\n");
  const Dataset set = load_with_gap(10_s);
  ASSERT_EQ(set.robots[0].companions.size(), 1U);
  const CompanionSighting& seen = set.robots[0].companions[0];
  EXPECT_EQ(seen.robot, 1);
  EXPECT_EQ(seen.time, Time() + 2500_ms);
  EXPECT_EQ(seen.range_m, 2.25);
  EXPECT_EQ(seen.bearing_rad, -0.5);
  EXPECT_DOUBLE_EQ(seen.pose.x_m, 2.5);
  const Robot alone = load_with_gap(10_s, 1).robots[0];  // robot 2 was not asked for
  EXPECT_EQ(alone.skips.robot_sighting, 1U);
  EXPECT_THAT(alone.companions, IsEmpty());
  expect_sum_of_lines(alone);
}

TEST_F(Mrclam, ThePoseAtATimeIsInterpolatedAcrossAnyGapAndEndsWithTheTruth) {
  const std::vector<PoseSample> truth = load_with_gap(1_s).robots[0].truth;
  ASSERT_EQ(truth.size(), 2U);
  EXPECT_EQ(truth[0].time, Time() - 2500_ms);  // the first measurement is at 12.5
  const auto pose = pose_at(truth, Time() + 2500_ms);
  ASSERT_TRUE(pose);
  EXPECT_DOUBLE_EQ(pose->x_m, 5.0);
  EXPECT_DOUBLE_EQ(pose->heading_rad, 0.5);
  EXPECT_EQ(pose_at(truth, Time() + 7500_ms)->y_m, 20.0);
  EXPECT_FALSE(pose_at(truth, Time() + 7501_ms));
  EXPECT_FALSE(pose_at(truth, Time() - 2501_ms));
}

TEST_F(Mrclam, OdometryIsReadWhereAskedForAndOfWhatWasBeforeTheStartTheLastIsKept) {
  EXPECT_THAT(load_with_gap(10_s).robots[0].odometry, IsEmpty());
  write("Robot1_Odometry.dat", "# t v w\n11 0.1 0\n12 0.2 -0.5\n13 0.3 0.25\n");
  write("Robot2_Odometry.dat", "14 0 0\n");
  const Dataset set = load(directory_, 2, 10_s, Odometry::read);
  const std::vector<OdometrySample>& odometry = set.robots[0].odometry;
  ASSERT_EQ(odometry.size(), 2U);
  EXPECT_EQ(odometry[0].time, Time());
  EXPECT_EQ(odometry[0].forward_m_per_s, 0.2);
  EXPECT_EQ(odometry[0].turn_rad_per_s, -0.5);
  EXPECT_EQ(odometry[1].time, Time() + 500_ms);
  remove("Robot2_Odometry.dat");
  EXPECT_THROW(load(directory_, 2, 10_s, Odometry::read), InputError);
}

TEST_F(Mrclam, ARobotWithoutMeasurementsIsThereAndSilent) {
  write("Robot2_Measurement.dat", "# nothing seen\n");
  const Dataset set = load_with_gap(10_s);
  EXPECT_THAT(set.robots[1].sightings, IsEmpty());
  EXPECT_EQ(set.robots[1].skips.lines, 0U);
}

TEST_F(Mrclam, CommentsBlankLinesAndCarriageReturnsDoNotCount) {
  write("Robot1_Measurement.dat",
        "# head\r\n\r\n   # indented\r\n12.5\t63 \t 2.25 -0.5 \r\n\n\t\n");
  const Robot robot = load_with_gap(10_s).robots[0];
  EXPECT_EQ(robot.skips.lines, 1U);
  ASSERT_EQ(robot.sightings.size(), 1U);
  EXPECT_EQ(robot.sightings[0].bearing_rad, -0.5);
}

// The numbers below were counted by a separate script, with numpy's unwrap and interp.
class RealLogs : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::is_directory(directory_)) {
      GTEST_SKIP() << "the MRCLAM data set 6 is not at " << directory_;
    }
  }
  const std::string directory_ = HEARSAY_SOURCE_DIR "/../shared/data/mrclam6";
};

TEST_F(RealLogs, CountsAgreeWithAnIndependentCount) {
  const Dataset set = load(directory_, 5, 500_ms);
  ASSERT_EQ(set.landmarks.size(), 15U);
  EXPECT_EQ(set.span, 886'067_ms);
  const std::uint64_t lines[] = {1942, 4031, 5627, 2399, 5378};
  const std::size_t robots[] = {407, 792, 1277, 370, 1139};
  const std::uint64_t gaps[] = {0, 0, 0, 3, 0};
  const std::uint64_t unknown[] = {1, 0, 2, 3, 0};
  const std::size_t sightings[] = {1534, 3239, 4348, 2023, 4239};
  const std::vector<int> barcodes[] = {{43}, {}, {34}, {50}, {}};
  for (std::size_t i = 0; i < 5; ++i) {
    SCOPED_TRACE("robot " + std::to_string(i + 1));
    const Robot& robot = set.robots[i];
    EXPECT_EQ(robot.skips.lines, lines[i]);
    EXPECT_EQ(robot.companions.size(), robots[i]);
    EXPECT_EQ(robot.skips.robot_sighting, 0U);
    EXPECT_EQ(robot.skips.unknown_barcode, unknown[i]);
    EXPECT_EQ(robot.skips.bad_range, 0U);
    EXPECT_EQ(robot.skips.truth_gap, gaps[i]);
    EXPECT_EQ(robot.sightings.size(), sightings[i]);
    EXPECT_EQ(robot.unknown_barcodes, barcodes[i]);
    expect_sum_of_lines(robot);
  }
}

TEST_F(RealLogs, ANarrowPermittedGapSkipsAsManyAsAnIndependentCount) {
  const Dataset at_100_ms = load(directory_, 5, 100_ms);
  const Dataset at_20_ms = load(directory_, 5, 20_ms);
  const std::uint64_t gaps_100_ms[] = {4, 7, 15, 4, 27};
  const std::uint64_t gaps_20_ms[] = {711, 1250, 2082, 761, 1896};
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(at_100_ms.robots[i].skips.truth_gap, gaps_100_ms[i]);
    EXPECT_EQ(at_20_ms.robots[i].skips.truth_gap, gaps_20_ms[i]);
    expect_sum_of_lines(at_20_ms.robots[i]);
  }
}

TEST_F(RealLogs, CompanionsAndOdometryAgreeWithAnIndependentReading) {
  const Dataset set = load(directory_, 5, 500_ms, Odometry::read);
  const double mean_x[] = {2.1364745966688976, 2.3957767519490623, 2.423855272591029,
                           2.6439956269896396, 2.2903079135539937};
  const double speeds[] = {3074.089, 4149.025, 3811.343, 2199.231, 3506.992};  // after the start
  const std::size_t samples[] = {61739, 65004, 61111, 52906, 60563};  // … at distinct times
  for (std::size_t i = 0; i < 5; ++i) {
    const Robot& robot = set.robots[i];
    double x = 0.0, speed = 0.0;
    std::size_t count = 0;
    for (const CompanionSighting& s : robot.companions) x += s.pose.x_m;
    for (const OdometrySample& s : robot.odometry) {
      if (s.time == Time()) continue;
      speed += s.forward_m_per_s;
      ++count;
    }
    EXPECT_NEAR(x / static_cast<double>(robot.companions.size()), mean_x[i], 1e-10);
    EXPECT_NEAR(speed, speeds[i], 1e-6);
    EXPECT_EQ(count, samples[i]);
  }
  const CompanionSighting& middle = set.robots[4].companions[569];
  EXPECT_EQ(middle.time, Time() + 463'499_ms);
  EXPECT_EQ(middle.robot, 1);
  EXPECT_EQ(middle.range_m, 1.91);
  EXPECT_EQ(middle.bearing_rad, -0.213);
}

TEST_F(RealLogs, PosesAgreeWithAnIndependentInterpolation) {
  const Dataset set = load(directory_, 5, 500_ms);
  const double mean_x[] = {1.860922789793857, 2.0429139395637614, 2.310421152536921,
                           2.2332454351825106, 2.1524492170979808};
  const double mean_y[] = {0.4408211115623357, -0.2898528646026055, -0.188835488162551,
                           0.7475554471839607, 0.0999426940110436};
  const double mean_heading[] = {6.303260268429863, -0.07105706224106863, 9.382313104701263,
                                 4.407484504551155, 11.867869377096095};
  for (std::size_t i = 0; i < 5; ++i) {
    double x = 0.0, y = 0.0, heading = 0.0;
    for (const Sighting& s : set.robots[i].sightings) {
      x += s.pose.x_m;
      y += s.pose.y_m;
      heading += s.pose.heading_rad;
    }
    const auto n = static_cast<double>(set.robots[i].sightings.size());
    EXPECT_NEAR(x / n, mean_x[i], 1e-10);
    EXPECT_NEAR(y / n, mean_y[i], 1e-10);
    EXPECT_NEAR(heading / n, mean_heading[i], 1e-10);
  }
  const Sighting& middle = set.robots[4].sightings[2119];
  EXPECT_EQ(middle.time, Time() + 463'255_ms);
  EXPECT_EQ(set.landmarks[static_cast<std::size_t>(middle.landmark)].subject, 14);
  EXPECT_EQ(middle.range_m, 3.083);
  EXPECT_EQ(middle.bearing_rad, -0.386);
  EXPECT_NEAR(middle.pose.x_m, 2.547525163636364, 1e-12);
  EXPECT_NEAR(middle.pose.heading_rad, 21.078078648811488, 1e-12);
}

}  // namespace
}  // namespace hearsay::mrclam
