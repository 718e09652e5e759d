// Gauss–Markov motion against its law, and as a path between mirrors.
#include <gtest/gtest.h>

#include <cmath>

#include "sim/world/motion.hpp"
#include "tests/sim/world/samples.hpp"

namespace hearsay::motion {
namespace {

constexpr GaussMarkov roam{.area = square,
                           .speed_mean_m_per_s = 30.0,
                           .speed_sigma_m_per_s = 4.0,
                           .direction_sigma_rad = 1.0,
                           .alpha = 0.8,
                           .update_period = 500_ms};

TEST(GaussMarkov, SpeedsAreNormalAndForgetAsAlphaToTheK) {
  const Sample first = sample(roam, 0.0, speed_of);
  for (const int k : {0, 1, 2, 5, 20}) {
    const Sample speeds = sample(roam, 0.5 * k, speed_of);
    const double expected = std::pow(0.8, k);
    // Fisher: the correlation of n normal pairs has the error (1 − ρ²)/√n.
    EXPECT_NEAR(correlation(first, speeds), expected,
                4.0 * (1.0 - expected * expected) / std::sqrt(agents) + 1e-12)
        << k;
    EXPECT_LT(
        distance(speeds, [](double v) { return 0.5 * std::erfc(-(v - 30) / 4 / std::sqrt(2.0)); }),
        distance_max)
        << k;
  }
}

TEST(GaussMarkov, DirectionsAreNormalAboutTheirMean) {
  // So far from walls that none is met.
  GaussMarkov free = roam;
  free.area = {{-1e6, -1e6}, {1e6, 1e6}};
  free.direction_mean_rad = 0.5;
  free.direction_sigma_rad = 0.4;
  const auto direction = [](const Leg& leg, const Point&) {
    return std::atan2(leg.velocity_m_per_s[1], leg.velocity_m_per_s[0]);
  };
  const Sample first = sample(free, 0.0, direction);
  for (const int k : {0, 3, 20}) {
    const Sample directions = sample(free, 0.5 * k, direction);
    EXPECT_LT(distance(directions,
                       [](double d) { return 0.5 * std::erfc(-(d - 0.5) / 0.4 / std::sqrt(2.0)); }),
              distance_max)
        << k;
    const double expected = std::pow(0.8, k);
    EXPECT_NEAR(correlation(first, directions), expected,
                4.0 * (1.0 - expected * expected) / std::sqrt(agents) + 1e-12);
  }
}

TEST(GaussMarkov, WithoutAMeanDirectionTurnsAtRandom) {
  GaussMarkov free = roam;
  free.area = {{-1e6, -1e6}, {1e6, 1e6}};
  Sample turned, cosines;
  for (AgentId a = 0; a < agents; ++a) {
    Path path(make(free, 1, a));
    const Point v = path.leg_at(Time()).velocity_m_per_s;
    const Point w = path.leg_at(at_s(2.0)).velocity_m_per_s;
    turned.push_back(std::atan2(v[1], v[0]));
    cosines.push_back((v[0] * w[0] + v[1] * w[1]) / length_m(v) / length_m(w));
  }
  EXPECT_LT(distance(turned, [](double d) { return (d + pi) / 2 / pi; }), distance_max);
  // Four turns of variance (1 − α²) σ²: E cos is exp of minus half of their sum.
  expect_mean(cosines, std::exp(-0.5 * 4 * 0.36));
}

TEST(GaussMarkov, WithoutAMeanDirectionPlacesAreEvenAtAnyTime) {
  for (const double time_s : {0.0, 1.2, 30.0}) {
    const Sample x = sample(roam, time_s, x_of);
    const Sample y = sample(roam, time_s, y_of);
    EXPECT_LT(distance(x, [](double u) { return u; }), distance_max) << time_s;
    EXPECT_LT(distance(y, [](double u) { return u; }), distance_max) << time_s;
    EXPECT_NEAR(correlation(x, y), 0.0, 4.0 / std::sqrt(agents)) << time_s;
  }
}

// Into [low, low + length], as light between two mirrors.
double folded(double x, double low, double length) {
  const double u = std::fmod(std::fmod(x - low, 2 * length) + 2 * length, 2 * length);
  return low + (u < length ? u : 2 * length - u);
}

TEST(GaussMarkov, IsThePathInTheOpenPlaneSeenBetweenMirrors) {
  // The draws are the same in a far larger area, where no wall is met.
  GaussMarkov open = roam, small = roam;
  open.area = {{-1e6, -1e6}, {1e6, 1e6}};
  small.area = {{3.0, -4.0}, {10.0, -1.0}};  // up to 15 walls an update
  std::size_t legs = 0;
  for (AgentId a = 0; a < 20; ++a) {
    Path free(make(open, 1, a)), mirrored(make(small, 1, a));
    const Point begin = mirrored.at(Time()), origin = free.at(Time());
    Time leg_begin;
    for (double time_s = 0.0; time_s < 100.0; time_s += 0.0625) {
      const Point p = free.at(at_s(time_s)), q = mirrored.at(at_s(time_s));
      // Each turn is up to a nanosecond early, at some 30 m/s.
      ASSERT_NEAR(q[0], folded(begin[0] + p[0] - origin[0], 3.0, 7.0), 1e-4) << time_s;
      ASSERT_NEAR(q[1], folded(begin[1] + p[1] - origin[1], -4.0, 3.0), 1e-4) << time_s;
      const Time here = mirrored.leg_at(at_s(time_s)).begin;
      legs += here != leg_begin;
      leg_begin = here;
    }
  }
  EXPECT_GT(legs, 20u * 500) << "walls were met";
}

TEST(GaussMarkov, WithoutSigmaFliesStraightAtItsMeanSpeed) {
  GaussMarkov still = roam;
  still.speed_sigma_m_per_s = still.direction_sigma_rad = 0.0;
  still.direction_mean_rad = pi / 2;
  Path path(make(still, 1, 0));
  const Point begin = path.at(Time());
  for (double time_s = 0.25; time_s < 50; time_s += 1.5) {
    const Point p = path.at(at_s(time_s));
    EXPECT_NEAR(p[0], begin[0], 1e-9);
    EXPECT_NEAR(p[1], folded(begin[1] + 30.0 * time_s, 200.0, 100.0), 1e-5);
  }
}

TEST(GaussMarkov, DependsOnSeedAndAgentAndNotOnWhoLooks) { expect_reproducible(roam); }

TEST(GaussMarkov, OfDifferentAgentsIsIndependent) {
  for (const double time_s : {0.0, 20.0}) expect_independent(roam, time_s);
}

}  // namespace
}  // namespace hearsay::motion
