// What no motion can be made of.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "sim/kernel/error.hpp"
#include "sim/world/motion.hpp"

namespace hearsay::motion {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr Rectangle field{{0.0, 0.0}, {10.0, 20.0}};

template <class Options, class... Who>
std::string error(const Options& options, Who... who) {
  try {
    make(options, who...);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}
template <class Options>
std::string error_of_random(const Options& options) {
  return error(options, std::uint64_t{1}, AgentId{0});
}

TEST(MotionErrors, CoordinatesAreWithinATeraMetre) {
  EXPECT_EQ(error(Hover{{1e12, -1e12}}), "");
  EXPECT_EQ(error(Hover{{2e12, 0}}),
            "position_m must be between -1e+12 and 1e+12, not 2000000000000");
  EXPECT_NE(error(Hover{{0, std::nan("")}}), "");
  EXPECT_EQ(error(Hover{{0, 0}, infinity}), "altitude_m must be between -1e+12 and 1e+12, not inf");
  EXPECT_NE(error(Waypoints{.points_m = {{0, 0}, {0, infinity}}}), "");
  EXPECT_NE(error(Waypoints{.points_m = {{0, 0}}, .start_m = PlanePoint{-2e12, 0}}), "");
  EXPECT_NE(error(Track{{{Time(), {0, 2e12}}}}), "");
}

TEST(MotionErrors, WaypointsNeedPointsASpeedAndToRepeatTwoPlaces) {
  EXPECT_EQ(error(Waypoints{}), "waypoints: there are no points_m");
  const std::vector<PlanePoint> points = {{0, 0}, {1, 0}};
  EXPECT_EQ(error(Waypoints{points, 0.0}), "speed_m_per_s must be above 0 and finite, not 0");
  EXPECT_NE(error(Waypoints{points, infinity}), "");
  EXPECT_NE(error(Waypoints{points, std::nan("")}), "");
  EXPECT_EQ(error(Waypoints{points, 1.0, -1_s}), "pause in s must be between 0 and 9e+09, not -1");
  const std::vector<PlanePoint> same = {{1, 1}, {1, 1}};
  EXPECT_EQ(error(Waypoints{same}), "");
  EXPECT_EQ(error(Waypoints{same, 1.0, 1_s, Repeat::loop}),
            "waypoints: to repeat, points_m must hold at least two different points");
  EXPECT_NE(error(Waypoints{{{1, 1}}, 1.0, 1_s, Repeat::back_and_forth}), "");
}

TEST(MotionErrors, ALawnMowerNeedsAnAreaAndLanes) {
  EXPECT_EQ(error(LawnMower{}),
            "the length of a side of the area must be above 0 and finite, not 0");
  EXPECT_NE(error(LawnMower{{{0, 0}, {1, -1}}}), "");
  EXPECT_EQ(error(LawnMower{field, 0.0}), "lane_spacing_m must be above 0 and finite, not 0");
  EXPECT_EQ(error(LawnMower{field, 1e-6}), "the number of lanes must be at most 1e6, not 20000000");
  EXPECT_NE(error(LawnMower{field, 1.0, -1.0}), "");
}

TEST(MotionErrors, RandomWaypointNeedsASpeedAboveZero) {
  EXPECT_EQ(error_of_random(RandomWaypoint{field, 0.0, 1.0}),
            "speed_min_m_per_s must be above 0 and finite, not 0");
  EXPECT_NE(error_of_random(RandomWaypoint{field, 2.0, 1.0}), "");
  EXPECT_NE(error_of_random(RandomWaypoint{field, 1.0, infinity}), "");
  EXPECT_NE(error_of_random(RandomWaypoint{{{0, 0}, {0, 1}}, 1.0, 1.0}), "");
  EXPECT_NE(error_of_random(RandomWaypoint{field, 1.0, 1.0, -1_s, 1_s}), "");
  EXPECT_EQ(error_of_random(RandomWaypoint{field, 1.0, 1.0, 2_s, 1_s}),
            "pause_max in s must be between 2 and 9e+09, not 1");
}

TEST(MotionErrors, GaussMarkovNeedsMemoryBelowOneAndRoom) {
  const GaussMarkov good{.area = field, .speed_sigma_m_per_s = 1.0, .alpha = 0.9};
  const auto error_with = [&](auto change) {
    GaussMarkov bad = good;
    change(bad);
    return error_of_random(bad);
  };
  EXPECT_EQ(error_of_random(good), "");
  EXPECT_EQ(error_with([](auto& o) { o.alpha = 1.0; }), "alpha must be at least 0 and below 1");
  EXPECT_NE(error_with([](auto& o) { o.alpha = -0.1; }), "");
  EXPECT_NE(error_with([](auto& o) { o.alpha = std::nan(""); }), "");
  EXPECT_NE(error_with([](auto& o) { o.speed_mean_m_per_s = -1.0; }), "");
  EXPECT_NE(error_with([](auto& o) { o.speed_sigma_m_per_s = infinity; }), "");
  EXPECT_NE(error_with([](auto& o) { o.direction_sigma_rad = -1.0; }), "");
  EXPECT_NE(error_with([](auto& o) { o.direction_mean_rad = infinity; }), "");
  EXPECT_EQ(error_with([](auto& o) { o.update_period = {}; }), "update_period must be above 0 s");
  EXPECT_EQ(error_with([](auto& o) { o.speed_mean_m_per_s = 2e7; }),
            "the area must not be crossed in less than a microsecond, 10 sigmas above the mean "
            "speed");
}

TEST(MotionErrors, TimesOfATrackGoUpFromZero) {
  EXPECT_EQ(error(Track{}), "track: there are no samples");
  EXPECT_EQ(error(Track{{{Time::nanoseconds(-1), {0, 0}}}}),
            "the time of a sample must be at least 0 s, not -1.0000000000000001e-09");
  const TrackSample a{Time::at(2_s), {0, 0}};
  EXPECT_EQ(error(Track{{a, a}}),
            "the time of a sample must be after that of the sample before, not 2");
}

}  // namespace
}  // namespace hearsay::motion
