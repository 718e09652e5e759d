#include "agents/behaviours/free_directions.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"

namespace hearsay {
namespace {

constexpr double whole = 2.0 * math::pi, range = 5.0;
constexpr int n = FreeDirections::sectors;

double off(double a, double b) { return std::fabs(math::wrap_angle(a - b)); }

/// A scan in which a few rays hit something.
std::vector<double> scattered(Stream& draws, std::size_t rays) {
  std::vector<double> scan(rays, range);
  for (std::uint64_t i = draws.below(6); i > 0; --i) {
    scan[draws.below(rays)] = draws.uniform(0.1, 4.0);
  }
  return scan;
}

TEST(FreeDirections, SectorsGoAroundCounterClockwise) {
  for (int s = 0; s < n; ++s) {
    EXPECT_EQ(FreeDirections::sector(FreeDirections::bearing_rad(s)), s);
    EXPECT_EQ(FreeDirections::sector(FreeDirections::bearing_rad(s) + whole), s);
  }
  EXPECT_LT(FreeDirections::bearing_rad(0), FreeDirections::bearing_rad(1));
  EXPECT_NEAR(FreeDirections::bearing_rad(n - 1), math::pi, whole / n);
}

TEST(FreeDirections, BlockedIsWhatComesTooNearByArcSine) {
  const plan::Fan fan(n, whole);
  FreeDirections eyes(fan, range);
  Stream draws(1, Purpose("scans"), Entity::agent(0));
  int blocked = 0;
  for (int round = 0; round < 200; ++round) {
    const std::vector<double> scan = scattered(draws, n);
    const double clearance = draws.uniform(0.2, 0.6), within = draws.uniform(0.5, 3.0);
    eyes.look(scan);
    eyes.block(clearance, within);
    for (int s = 0; s < n; ++s) {
      // Of a scan with as many rays as sectors; how near the nearest edge of a cone is.
      double inside = -math::pi;
      for (int ray = 0; ray < n; ++ray) {
        const double d = scan[static_cast<std::size_t>(ray)];
        if (d >= within) continue;
        const double half = math::asin(std::min(1.0, clearance / d));
        const double away =
            off(fan.angle_rad(static_cast<std::size_t>(ray)), FreeDirections::bearing_rad(s));
        inside = std::max(inside, half - away);
      }
      // To a sector, and what is lost by the table where the arc sine is steep.
      if (inside > 0.08) {
        EXPECT_FALSE(eyes.free(s)) << round << " " << s << " " << inside;
      }
      if (inside < -0.08) {
        EXPECT_TRUE(eyes.free(s)) << round << " " << s << " " << inside;
      }
      blocked += !eyes.free(s);
    }
  }
  EXPECT_GT(blocked, 1000);
}

TEST(FreeDirections, TheNearestFreeOneIsOfLeastCost) {
  const plan::Fan fan(n, whole);
  FreeDirections eyes(fan, range);
  Stream draws(2, Purpose("scans"), Entity::agent(0));
  for (int round = 0; round < 200; ++round) {
    const std::vector<double> scan = scattered(draws, n);
    eyes.look(scan);
    eyes.block(0.4, 3.0);
    const double wanted = draws.uniform(-math::pi, math::pi);
    const auto choice = eyes.nearest({.bearing_rad = wanted});
    ASSERT_TRUE(choice) << "a few things do not close the circle";
    EXPECT_TRUE(eyes.free(FreeDirections::sector(choice->bearing_rad)));
    if (eyes.free(FreeDirections::sector(wanted))) {
      EXPECT_EQ(choice->bearing_rad, wanted);
      continue;
    }
    double least = std::numeric_limits<double>::infinity();
    for (int s = 0; s < n; ++s) {
      if (eyes.free(s)) least = std::min(least, off(FreeDirections::bearing_rad(s), wanted));
    }
    // What is farther to go must turn less from where it heads, or be to the right.
    EXPECT_LE(off(choice->bearing_rad, wanted), (1.15 * least + 0.1 * math::pi) / 0.9 + 1e-9);
  }
}

TEST(FreeDirections, ItPassesOnTheRightAndThenSticksToItsSide) {
  const plan::Fan fan(n + 1, whole);
  FreeDirections eyes(fan, range);
  std::vector<double> scan(n + 1, range);
  scan[n / 2] = 1.0;  // straight on
  ASSERT_NEAR(fan.angle_rad(n / 2), 0.0, 1e-12);
  eyes.look(scan);
  eyes.block(0.5, 2.0);
  const double half = math::asin(0.5);
  const auto right = eyes.nearest({.bearing_rad = 0.0});
  ASSERT_TRUE(right);
  EXPECT_NEAR(right->bearing_rad, -half, 0.06);
  const auto left = eyes.nearest({.bearing_rad = 0.0, .before_rad = half});
  ASSERT_TRUE(left);
  EXPECT_NEAR(left->bearing_rad, half, 0.06);
}

TEST(FreeDirections, SidesAreSearchedInTurn) {
  const plan::Fan fan(n, whole);
  FreeDirections eyes(fan, range);
  std::vector<double> scan(n, range);
  // A wall along the left, 0.5 m away.
  for (std::size_t ray = 0; ray < n; ++ray) {
    const double sine = math::sin(fan.angle_rad(ray));
    if (sine > 0.1) scan[ray] = 0.5 / sine;
  }
  eyes.look(scan);
  eyes.block(0.5, 2.0);
  const auto ahead = eyes.first(true, 0.5 * math::pi, false),
             back = eyes.first(true, 0.5 * math::pi, true);
  ASSERT_TRUE(ahead && back);
  EXPECT_NEAR(*ahead, 0.0, 0.06) << "along the wall";
  EXPECT_NEAR(off(*back, math::pi), 0.0, 0.06);
}

TEST(FreeDirections, ADiscGetsAsFarAsItsEdgesLet) {
  const plan::Fan fan(720, whole);
  FreeDirections eyes(fan, range);
  std::vector<double> scan(720, range);
  eyes.look(scan);
  EXPECT_EQ(eyes.ahead_m(0.3), range);
  // A point 1.0 m ahead and 0.24 m aside: a disc of 0.3 touches it 0.18 m before it is abreast.
  const double angle = math::atan2(0.24, 1.0);
  const auto ray = static_cast<std::size_t>((angle / whole + 0.5) * 720);
  scan[ray] = math::hypot(1.0, 0.24);
  const double a = fan.angle_rad(ray), x = scan[ray] * math::cos(a), y = scan[ray] * math::sin(a);
  EXPECT_NEAR(eyes.ahead_m(0.3), x - std::sqrt(0.09 - y * y), 1e-4);
  EXPECT_EQ(eyes.ahead_m(0.2), range) << "a smaller one passes";
}

TEST(FreeDirections, ADrawIsInProportionToHowFarItIsOpen) {
  const plan::Fan fan(n, whole);
  FreeDirections eyes(fan, range);
  std::vector<double> scan(n, 1.0);
  std::fill_n(scan.begin(), n / 4, 3.0);
  eyes.look(scan);
  Stream draws(3, Purpose("draws"), Entity::agent(0));
  int far = 0;
  constexpr int rounds = 4000;
  for (int i = 0; i < rounds; ++i) far += eyes.any(draws, math::pi).value() < -0.5 * math::pi;
  // A quarter of weight 3, three quarters of weight 1: 0.5, with a deviation of 0.008.
  EXPECT_NEAR(far / static_cast<double>(rounds), 0.5, 0.03);
  EXPECT_LT(eyes.most_open(), -0.5 * math::pi);
}

TEST(FreeDirections, WhatIsNotInViewIsNotKnown) {
  const plan::Fan fan(60, math::pi / 2.0);
  FreeDirections eyes(fan, range);
  const std::vector<double> scan(60, 1.0);
  eyes.look(scan);
  EXPECT_FALSE(eyes.seen(FreeDirections::sector(1.0)));
  EXPECT_TRUE(eyes.seen(FreeDirections::sector(0.5)));
  EXPECT_EQ(eyes.ray_m(scan, 0.5), 1.0);
  EXPECT_EQ(eyes.ray_m(scan, 1.0), range);
  eyes.block(0.4, 2.0);
  EXPECT_FALSE(eyes.nearest({.bearing_rad = 0.0})) << "all that is seen is blocked";
  ASSERT_TRUE(eyes.nearest({.bearing_rad = 2.0}));
  EXPECT_EQ(eyes.nearest({.bearing_rad = 2.0})->bearing_rad, 2.0);
}

TEST(FreeDirections, FewRaysStandForAllOfTheirShare) {
  const plan::Fan fan(8, whole);
  FreeDirections eyes(fan, range);
  std::vector<double> scan(8, range);
  scan[3] = 1.0;  // −45° … 0
  eyes.look(scan);
  for (const double bearing : {-0.75, -0.4, -0.05}) {
    EXPECT_EQ(eyes.open_m(FreeDirections::sector(bearing)), 1.0) << bearing;
  }
  EXPECT_EQ(eyes.open_m(FreeDirections::sector(0.05)), range);
  EXPECT_EQ(eyes.open_m(FreeDirections::sector(-0.83)), range);
}

TEST(FreeDirections, MisuseIsRefused) {
  const plan::Fan fan(8, whole), blind(8, 0.0);
  EXPECT_THROW(FreeDirections(fan, 0.0), BrokenInvariant);
  EXPECT_THROW(FreeDirections(blind, range), BrokenInvariant);
  FreeDirections eyes(fan, range);
  EXPECT_THROW(eyes.look(std::vector<double>(7, 1.0)), BrokenInvariant);
  EXPECT_THROW(eyes.look(std::vector<double>(8, -1.0)), BrokenInvariant);
  EXPECT_THROW(eyes.block(0.0, 1.0), BrokenInvariant);
  EXPECT_THROW(eyes.block(1.0, 0.0), BrokenInvariant);
}

}  // namespace
}  // namespace hearsay
