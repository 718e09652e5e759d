#include "agents/trails/trail_follower.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"
#include "tests/filters/trails/samples.hpp"

namespace hearsay {
namespace {

using trails::EventId;
using Way = TrailFollower::Way;
using End = TrailFollower::TrailEnd;
using Lanes = TrailFollower::Lanes;

constexpr EventId goal = 0, other = 1;

/// A robot's trails, and what it makes of them at the origin.
class Follower : public testing::Test {
 protected:
  /// To `event`, laid now by a robot after `after`.
  void crumb(double x_m, double y_m, double distance_s, EventId event = goal,
             EventId after = trails::no_event) {
    store_.merge({.event = event,
                  .goal = after,
                  .position = trails::point(x_m, y_m),
                  .distance_s = static_cast<float>(distance_s),
                  .created_s = now_s_,
                  .identity = {0, 0, crumbs_++}},
                 now_s_);
  }
  /// One that leads back to the goal, by a robot that comes from there.
  void opposing(double x_m, double y_m, double distance_s) {
    crumb(x_m, y_m, distance_s, goal, other);
  }
  TrailFollower::Choice choose(TrailFollower& follower, double free_left_m = 10.0,
                               double heading_rad = 0.0) {
    return follower.choose(store_, goal, {0.0, 0.0, heading_rad}, now_s_, free_left_m, draws_);
  }
  TrailFollower::Choice choose(const TrailFollower::Options& options, double free_left_m = 10.0,
                               double heading_rad = 0.0) {
    TrailFollower follower(options);
    return choose(follower, free_left_m, heading_rad);
  }
  static void expect_target(const TrailFollower::Choice& choice, double x_m, double y_m) {
    EXPECT_EQ(choice.way, Way::follow);
    EXPECT_NEAR(choice.target.x_m, x_m, 1e-6);
    EXPECT_NEAR(choice.target.y_m, y_m, 1e-6);
  }

  double now_s_ = 5.0;
  std::uint32_t crumbs_ = 0;
  trails::MetricStore store_{{.age_max_s = std::numeric_limits<double>::infinity()}};
  Stream draws_ = trails::stream("follower");
};

TEST_F(Follower, TakesTheCrumbOfLeastDistanceInReach) {
  EXPECT_EQ(choose(TrailFollower::Options{}).way, Way::explore) << "nothing there";
  crumb(0.5, 0.5, 8.0);
  crumb(-0.7, 0.0, 6.0);
  crumb(0.1, 0.0, 7.0);
  crumb(1.2, 0.0, 3.0);
  crumb(0.2, 0.0, 1.0, other);
  expect_target(choose(TrailFollower::Options{}), -0.7, 0.0);
  expect_target(choose({.sense_radius_m = 1.25, .field_rad = {}, .trail_end_s = {}}), 1.2, 0.0);
  EXPECT_EQ(choose({.sense_radius_m = 0.05, .field_rad = {}, .trail_end_s = {}}).way, Way::explore);
}

TEST_F(Follower, FindsNothingWhereItsOdometryIsBeyondAllPositions) {
  crumb(0.5, 0.0, 8.0);
  TrailFollower follower{TrailFollower::Options{}};
  const double lost_m = 2.0 * trails::MetricSpace::position_max_m;
  EXPECT_EQ(follower.choose(store_, goal, {lost_m, 0.0, 0.0}, now_s_, 1.0, draws_).way,
            Way::explore);
}

TEST_F(Follower, SeesCrumbsInItsFieldOfViewAlone) {
  const auto at = [&](double bearing, double distance_s) {
    crumb(0.8 * math::cos(bearing), 0.8 * math::sin(bearing), distance_s);
  };
  const double heading = 2.8;  // the field reaches over ±π
  at(heading + 0.49, 9.0);
  at(heading + 0.51, 4.0);
  at(heading - 0.51, 3.0);
  at(heading + math::pi, 2.0);
  TrailFollower::Options blinkered;
  blinkered.field_rad = 1.0;
  const double left = heading + 0.49;
  expect_target(choose(blinkered, 10.0, heading), 0.8 * math::cos(left), 0.8 * math::sin(left));
  blinkered.field_rad = 1.04;
  const double right = heading - 0.51;
  expect_target(choose(blinkered, 10.0, heading), 0.8 * math::cos(right), 0.8 * math::sin(right));
}

TEST_F(Follower, AtTheEndOfATrailItDoesAsItIsTold) {
  for (const double d : {2.0, 2.01}) {
    store_.clear();
    crumb(0.5, 0.3, d);
    TrailFollower::Options options;
    options.trail_end_s = 2.0;
    options.trail_end = End::explore;
    EXPECT_EQ(choose(options).way, d > 2.0 ? Way::follow : Way::explore);
    options.trail_end = End::search;
    const auto choice = choose(options);
    EXPECT_EQ(choice.way, d > 2.0 ? Way::follow : Way::search);
    EXPECT_EQ(choice.target, trails::point(0.5, 0.3)) << "the crumb, or the centre of the search";
    options.trail_end = End::none;
    expect_target(choose(options), 0.5, 0.3);
    options.trail_end = End::explore;
    options.trail_end_s.reset();
    expect_target(choose(options), 0.5, 0.3);
  }
}

TEST_F(Follower, KeepsToTheLeftOfThoseWhoComeByHalfOfWhatIsFree) {
  TrailFollower::Options so_lost;
  so_lost.lanes = Lanes::so_lost;
  Stream random = trails::stream("lanes");
  for (int trial = 0; trial < 50; ++trial) {
    store_.clear();
    const double bearing = random.uniform(-math::pi, math::pi), away = random.uniform(0.2, 0.99);
    const double x = away * math::cos(bearing), y = away * math::sin(bearing);
    crumb(x, y, 20.0);
    expect_target(choose(so_lost), x, y);  // nobody comes
    const double from = random.uniform(-math::pi, math::pi);
    opposing(1.99 * math::cos(from), 1.99 * math::sin(from), 30.0);
    expect_target(choose(TrailFollower::Options{}), x, y);
    for (const double free_m : {-0.1, 0.0, 0.5, 1.3, 2.0, 7.0}) {
      const double shift = 0.5 * std::fmin(2.0, std::fmax(free_m, 0.0));
      const double left = bearing + 0.5 * math::pi;
      const double heading = random.uniform(-3.0, 3.0);  // of no concern
      expect_target(choose(so_lost, free_m, heading), x + shift * math::cos(left),
                    y + shift * math::sin(left));
    }
  }
}

TEST_F(Follower, ThereAreNoLanesNearAnEventOrWhereNobodyComes) {
  TrailFollower::Options so_lost;
  so_lost.lanes = Lanes::so_lost;
  struct Case {
    double d_s, opposing_d_s, opposing_at_m;
    bool shifted;
  };
  for (const Case& c : {Case{2.01, 30.0, 1.5, true}, Case{2.0, 30.0, 1.5, false},
                        Case{20.0, 2.0, 1.5, false}, Case{20.0, 2.01, 1.5, true},
                        Case{20.0, 30.0, 1.999, true}, Case{20.0, 30.0, 2.001, false}}) {
    store_.clear();
    // Laid by one who is after the same, and by one who does not say: they are no hindrance.
    crumb(0.6, 0.0, c.d_s, goal, goal);
    crumb(-0.6, 0.0, 40.0, goal);
    crumb(-0.5, 0.0, 1.0, other, goal);
    expect_target(choose(so_lost), 0.6, 0.0);
    crumb(0.0, -c.opposing_at_m, c.opposing_d_s, other, other);
    expect_target(choose(so_lost), 0.6, c.shifted ? 1.0 : 0.0);
  }
}

TEST_F(Follower, OnAHighwayLanesAreDrawnAboutEvenly) {
  TrailFollower::Options options;
  options.lanes = Lanes::highway;
  TrailFollower follower(options);
  crumb(0.6, 0.0, 20.0);
  opposing(1.0, 0.0, 30.0);
  constexpr int n = 2000;
  int inner = 0, outer = 0, changes = 0;
  double before = 0.0;
  for (int trip = 0; trip < n; ++trip) {
    follower.arrived(draws_);
    const double y = choose(follower).target.y_m;
    for (int look = 0; look < 3; ++look) EXPECT_EQ(choose(follower).target.y_m, y) << "all the way";
    inner += std::fabs(y - 0.5) < 1e-6;
    outer += std::fabs(y - 1.5) < 1e-6;
    changes += y != before;
    before = y;
  }
  EXPECT_EQ(inner + outer, n) << "λ/4 or 3λ/4, λ = 2 m";
  EXPECT_NEAR(inner, 0.5 * n, 2.0 * std::sqrt(n)) << "four standard deviations";
  EXPECT_NEAR(changes, 0.5 * n, 2.0 * std::sqrt(n)) << "trip by trip anew";
}

/// Local search: a crumb for ever near, looked at ten times a second.
class LocalSearch : public Follower {
 protected:
  static TrailFollower::Options searching(double chance, double falls_by = 0.0,
                                          trails::Fading fading = trails::Fading::per_success) {
    TrailFollower::Options options;
    options.random_chance = chance;
    options.random_falls_by = falls_by;
    options.fading = fading;
    return options;
  }
  /// The seconds of so many in which it moves at random; never for a part of one.
  int random_seconds(TrailFollower& follower, int seconds) {
    int count = 0;
    for (int second = 0; second < seconds; ++second) {
      int explores = 0;
      for (int tenth = 0; tenth < 10; ++tenth) {
        explores += choose(follower).way == Way::explore;
        now_s_ = 5.0 + 0.1 * ++tenths_;
      }
      EXPECT_TRUE(explores == 0 || explores == 10) << explores;
      count += explores == 10;
    }
    return count;
  }
  int tenths_ = 0;
};

TEST_F(LocalSearch, AsOftenAsItsChanceSaysItMovesAtRandom) {
  crumb(0.5, 0.0, 20.0);
  constexpr int n = 3000;
  for (const double chance : {0.1, 0.6, 1.0}) {
    TrailFollower follower(searching(chance));
    const double sigma = std::sqrt(n * chance * (1.0 - chance));
    EXPECT_NEAR(random_seconds(follower, n), n * chance, 4.0 * sigma) << chance;
    EXPECT_EQ(follower.random_chance(), chance);
  }
}

TEST_F(LocalSearch, WithoutAChanceNothingIsDrawn) {
  crumb(0.5, 0.0, 20.0);
  TrailFollower follower(TrailFollower::Options{});
  for (int i = 0; i < 20; ++i) choose(follower);
  EXPECT_EQ(draws_.bits(), trails::stream("follower").bits());
}

TEST_F(LocalSearch, RandomMovesFadeWithSuccessOrWithTime) {
  crumb(0.5, 0.0, 20.0);
  TrailFollower by_success(searching(0.3, 0.01));
  random_seconds(by_success, 50);
  EXPECT_EQ(by_success.random_chance(), 0.3) << "none yet";
  for (int k = 1; k <= 40; ++k) {
    by_success.arrived(draws_);
    EXPECT_NEAR(by_success.random_chance(), std::fmax(0.0, 0.3 - 0.01 * k), 1e-12);
  }
  EXPECT_EQ(random_seconds(by_success, 200), 0);

  TrailFollower by_time(searching(0.6, 0.001, trails::Fading::per_iteration));
  by_time.arrived(draws_);
  EXPECT_EQ(by_time.random_chance(), 0.6);
  // A draw a second: Σ (0.6 − 0.001 k) over 600 of them, and the sum of their variances.
  double mean = 0.0, variance = 0.0;
  for (int k = 0; k < 600; ++k) {
    const double p = 0.6 - 0.001 * k;
    mean += p, variance += p * (1.0 - p);
  }
  EXPECT_NEAR(random_seconds(by_time, 600), mean, 4.0 * std::sqrt(variance));
  EXPECT_NEAR(by_time.random_chance(), 0.0, 1e-9);
  EXPECT_EQ(random_seconds(by_time, 200), 0);
}

TEST_F(LocalSearch, ItStopsBeforeWhatIsFollowedVanishes) {
  store_ = trails::MetricStore({.age_max_s = 100.0});
  crumb(0.5, 0.0, 20.0);
  TrailFollower follower(searching(1.0));
  EXPECT_EQ(random_seconds(follower, 70), 70) << "worn by less than 0.7";
  EXPECT_EQ(random_seconds(follower, 30), 0);
  now_s_ = 105.5;
  EXPECT_EQ(choose(follower).way, Way::explore) << "it has vanished";
}

TEST_F(LocalSearch, ArrivalsWearACrumbAsWell) {
  store_ = trails::MetricStore(
      {.age_max_s = std::numeric_limits<double>::infinity(), .life_arrivals = 10});
  crumb(0.5, 0.0, 20.0);
  TrailFollower follower(searching(1.0));
  for (std::uint32_t arrivals = 0; arrivals < 10; ++arrivals) {
    EXPECT_EQ(random_seconds(follower, 2), arrivals < 7 ? 2 : 0) << arrivals;
    store_.merge(trails::Place{goal, {}, now_s_, {1, 0, arrivals}}, now_s_);
  }
  EXPECT_EQ(choose(follower).way, Way::explore) << "it has vanished";
  EXPECT_EQ(store_.size(), 0U);
}

TEST(TrailFollower, OptionsHaveRanges) {
  for (const double radius : {0.0, -1.0, std::numeric_limits<double>::infinity()}) {
    TrailFollower::Options options;
    options.sense_radius_m = radius;
    EXPECT_THROW(TrailFollower{options}, BrokenInvariant);
  }
  for (const double chance : {-0.1, 1.1}) {
    TrailFollower::Options options;
    options.random_chance = chance;
    EXPECT_THROW(TrailFollower{options}, BrokenInvariant);
  }
  TrailFollower::Options grows;
  grows.random_falls_by = -0.01;
  EXPECT_THROW(TrailFollower{grows}, BrokenInvariant);
}

}  // namespace
}  // namespace hearsay
