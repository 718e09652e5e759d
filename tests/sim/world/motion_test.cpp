// Motions without chance: where they are is worked out by hand.
#include "sim/world/motion.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/kernel/error.hpp"
#include "tests/sim/world/paths.hpp"

namespace hearsay::motion {
namespace {

constexpr Rectangle field{{-20.0, 10.0}, {80.0, 70.0}};

void expect_at(Path& path, double time_s, const Point& expected_m) {
  const Point p = path.at(at_s(time_s));
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(p[i], expected_m[i], 1e-9) << time_s << " s";
}

// Every kind, with what makes legs short: pauses, walls, many points.
std::vector<std::pair<const char*, std::unique_ptr<Motion>>> one_of_each() {
  std::vector<std::pair<const char*, std::unique_ptr<Motion>>> all;
  const std::vector<PlanePoint> points = {{0, 20}, {30, 60}, {30, 60}, {0.1, 20.3}};
  const GaussMarkov roaming{.area = field,
                            .speed_mean_m_per_s = 40.0,
                            .speed_sigma_m_per_s = 30.0,
                            .direction_sigma_rad = 2.0,
                            .alpha = 0.7,
                            .update_period = 700_ms,
                            .altitude_m = 5.0};
  all.emplace_back("hover", make(Hover{{1, 20}, 5.0}));
  for (const Repeat repeat : {Repeat::once, Repeat::loop, Repeat::back_and_forth}) {
    all.emplace_back("waypoints", make(Waypoints{points, 3.7, 2_s, repeat, PlanePoint{2, 22}, 5}));
    all.emplace_back("waypoints", make(Waypoints{points, 1e3, {}, repeat, {}, 5.0}));
    all.emplace_back("lawn mower", make(LawnMower{field, 7.0, 11.0, repeat, {}, 5.0}));
  }
  all.emplace_back("random waypoint", make(RandomWaypoint{field, 1, 20, 0_s, 3_s, 5.0}, 1, 2));
  all.emplace_back("random waypoint", make(RandomWaypoint{field, 9, 9, {}, {}, 5.0}, 1, 2));
  all.emplace_back("Gauss-Markov", make(roaming, 1, 2));
  all.emplace_back("track",
                   make(Track{{{at_s(1), {0, 20}}, {at_s(2), {0, 20}}, {at_s(9), {9, 70}}}, 5.0}));
  return all;
}

TEST(Motion, LegsFollowEachOtherInTimeAndPlace) {
  for (auto& [kind, motion] : one_of_each()) {
    Time end;
    Point here{};
    std::size_t count = 0;
    for (const Leg& leg : legs(*motion, at_s(600))) {
      ASSERT_EQ(leg.begin, end) << kind;
      ASSERT_GT(leg.end, leg.begin) << kind;
      if (count++ > 0) {
        ASSERT_LT(std::sqrt(squared_distance_m2(leg.from_m, here)), 1e-12) << kind;
      }
      end = leg.end;
      if (end < Time::never()) here = leg.at(end);
    }
    EXPECT_GE(end, at_s(600)) << kind;
  }
}

TEST(Motion, StaysInsideAtItsAltitude) {
  for (auto& [kind, motion] : one_of_each()) {
    Path path(std::move(motion));
    for (int k = 0; k < 6000; ++k) {
      const Point p = path.at(at_s(0.1 * k));
      for (const std::size_t axis : {0u, 1u}) {
        ASSERT_GE(p[axis], field.min_m[axis] - 1e-12) << kind << " at " << 0.1 * k << " s";
        ASSERT_LE(p[axis], field.max_m[axis] + 1e-12) << kind << " at " << 0.1 * k << " s";
      }
      ASSERT_EQ(p[2], 5.0) << kind;
    }
  }
}

TEST(Motion, AfterAnEndlessLegThereIsNone) {
  const std::vector<PlanePoint> points = {{0, 0}, {1, 0}};
  std::unique_ptr<Motion> all[] = {make(Hover{}), make(Waypoints{points}),
                                   make(Track{{{at_s(1), {0, 20}}}})};
  for (auto& motion : all) {
    while (motion->next().end < Time::never()) {
    }
    EXPECT_THROW(motion->next(), BrokenInvariant);
  }
}

TEST(Hover, StandsStillForEver) {
  const auto motion = make(Hover{{3.0, -4.0}, 50.0});
  const Leg leg = motion->next();
  EXPECT_EQ(leg.begin, Time());
  EXPECT_EQ(leg.end, Time::never());
  EXPECT_EQ(leg.at(at_s(1e6)), (Point{3.0, -4.0, 50.0}));
}

TEST(Waypoints, OnceEndAtTheLastPoint) {
  // 3-4-5: 5 m at 2 m/s are 2.5 s; then 6 m are 3 s. Pauses of 1 s before each.
  Path path(make(Waypoints{{{0, 0}, {3, 4}, {3, 10}}, 2.0, 1_s, Repeat::once, {}, 7.0}));
  expect_at(path, 0.0, {0, 0, 7});
  expect_at(path, 1.0, {0, 0, 7});
  expect_at(path, 2.25, {1.5, 2, 7});
  expect_at(path, 3.5, {3, 4, 7});
  expect_at(path, 4.5, {3, 4, 7});
  expect_at(path, 5.0, {3, 5, 7});
  expect_at(path, 7.5, {3, 10, 7});
  expect_at(path, 1e6, {3, 10, 7});
  EXPECT_EQ(path.leg_at(at_s(1e6)).end, Time::never());
}

TEST(Waypoints, InALoopGoStraightFromTheLastToTheFirst) {
  Path path(make(Waypoints{{{0, 0}, {4, 0}, {4, 3}}, 1.0, {}, Repeat::loop}));
  for (const double round_s : {0.0, 12.0, 1200.0}) {
    expect_at(path, round_s + 1, {1, 0, 0});
    expect_at(path, round_s + 5, {4, 1, 0});
    expect_at(path, round_s + 9.5, {2, 1.5, 0});
  }
}

TEST(Waypoints, BackAndForthPauseOnceAtTheEnds) {
  // Out: pause 1, 4 m, pause 1, 3 m; pause 1 at the end; back likewise. A round takes 18 s.
  Path path(make(Waypoints{{{0, 0}, {4, 0}, {4, 3}}, 1.0, 1_s, Repeat::back_and_forth}));
  for (const double round_s : {0.0, 18.0, 1800.0}) {
    expect_at(path, round_s + 3, {2, 0, 0});
    expect_at(path, round_s + 8, {4, 2, 0});
    expect_at(path, round_s + 9.5, {4, 3, 0});
    expect_at(path, round_s + 11, {4, 2, 0});
    expect_at(path, round_s + 13.5, {4, 0, 0});
    expect_at(path, round_s + 16, {2, 0, 0});
    expect_at(path, round_s + 18.5, {0, 0, 0});
  }
}

TEST(Waypoints, BeginAtTheStartOnce) {
  Path path(make(Waypoints{{{0, 0}, {4, 0}}, 1.0, {}, Repeat::back_and_forth, PlanePoint{0, -2}}));
  expect_at(path, 0, {0, -2, 0});
  expect_at(path, 1, {0, -1, 0});
  expect_at(path, 4, {2, 0, 0});
  expect_at(path, 12, {2, 0, 0});
  expect_at(path, 10, {0, 0, 0});
}

TEST(Waypoints, ThatCoincideCostNoTimeButTheirPause) {
  Path path(make(Waypoints{{{0, 0}, {0, 0}, {2, 0}}, 1.0, 1_s, Repeat::loop}));
  expect_at(path, 2, {0, 0, 0});
  expect_at(path, 3, {1, 0, 0});
  expect_at(path, 7, {0, 0, 0});
  expect_at(path, 10, {1, 0, 0});
}

TEST(Waypoints, OfWhateverSpeedTakeATimeThatExists) {
  const std::vector<PlanePoint> points = {{0, 0}, {1e-3, 0}};
  const auto fast = legs(make(Waypoints{points, 1e9, {}, Repeat::loop}), Time::nanoseconds(10));
  EXPECT_EQ(fast.size(), 10u);
  EXPECT_EQ(fast.back().at(fast.back().end)[0], 0.0);
  const auto slow = make(Waypoints{points, 1e-300, {}, Repeat::loop});
  EXPECT_EQ(slow->next().end, Time::never());
  const auto late = legs(make(Waypoints{points, 1e-12, {}, Repeat::loop}), Time::never());
  EXPECT_EQ(late.size(), 10u) << "292 years are a little more than 9 legs of 1e9 s";
}

TEST(Waypoints, KeepTheirSpeedToANanosecond) {
  for (const Leg& leg :
       legs(make(Waypoints{{{0, 0}, {1, 2}, {7, 7.7}}, 3.3, {}, Repeat::loop}), at_s(100))) {
    const double speed = std::sqrt(squared_distance_m2(leg.velocity_m_per_s, {}));
    EXPECT_NEAR(speed, 3.3, 3.3 * 0.6e-9 / (leg.end - leg.begin).seconds());
  }
}

TEST(LawnMower, CoversTheRectangleInLanesToAndFro) {
  // 60 m in lanes of at most 25 m: three of 20 m, at 20, 40 and 60 m, 100 m long.
  Path path(make(LawnMower{field, 25.0, 10.0, Repeat::loop, {}, 3.0}));
  expect_at(path, 0, {-20, 20, 3});
  expect_at(path, 4, {20, 20, 3});
  expect_at(path, 11, {80, 30, 3});
  expect_at(path, 12, {80, 40, 3});
  expect_at(path, 17, {30, 40, 3});
  expect_at(path, 24, {-20, 60, 3});
  expect_at(path, 34, {80, 60, 3});
  const double home_s = std::sqrt(100.0 * 100 + 40 * 40) / 10;
  expect_at(path, 34 + home_s / 2, {30, 40, 3});
  expect_at(path, 34 + home_s + 4, {20, 20, 3});
}

TEST(LawnMower, ASpacingThatDividesTheHeightIsTaken) {
  // 0.3 / 0.1 is a little less than 3, and (0.1 + 0.2) / 0.1 a little more.
  for (const double height_m : {0.3, 0.1 + 0.2}) {
    Path path(make(LawnMower{{{0, 0}, {1, height_m}}, 0.1, 1.0, Repeat::once}));
    expect_at(path, 100, {1, height_m * 5 / 6, 0});
  }
}

TEST(LawnMower, LeavesNoPlaceFartherThanHalfALane) {
  const auto path = legs(make(LawnMower{field, 7.0, 11.0, Repeat::once}), at_s(1e6));
  for (double y_m = field.min_m[1]; y_m <= field.max_m[1]; y_m += 0.01) {
    double nearest_m = 1e9;
    for (const Leg& leg : path) nearest_m = std::min(nearest_m, std::fabs(leg.from_m[1] - y_m));
    ASSERT_LE(nearest_m, 3.5);
  }
}

TEST(Track, IsStraightBetweenSamplesAndStillOutside) {
  Path path(make(
      Track{{{at_s(2), {1, 1}}, {at_s(4), {3, 0}}, {at_s(5), {3, 0}}, {at_s(9), {-1, 8}}}, 12.0}));
  expect_at(path, 0, {1, 1, 12});
  expect_at(path, 2, {1, 1, 12});
  expect_at(path, 3, {2, 0.5, 12});
  expect_at(path, 4.75, {3, 0, 12});
  expect_at(path, 6, {2, 2, 12});
  expect_at(path, 9, {-1, 8, 12});
  expect_at(path, 1000, {-1, 8, 12});
}

TEST(Track, MayBeginAtOnceAndMayBeOneSample) {
  Path path(make(Track{{{Time(), {1, 1}}, {at_s(2), {3, 1}}}}));
  expect_at(path, 1, {2, 1, 0});
  for (const double begin_s : {0.0, 5.0}) {
    Path still(make(Track{{{at_s(begin_s), {7, 8}}}}));
    expect_at(still, 0, {7, 8, 0});
    expect_at(still, 100, {7, 8, 0});
  }
}

}  // namespace
}  // namespace hearsay::motion
