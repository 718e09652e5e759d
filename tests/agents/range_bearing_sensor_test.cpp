#include "agents/sensors/range_bearing.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace hearsay {
namespace {

Stream draws_of(std::uint64_t count) {
  return Stream::at(5, Purpose("range-bearing test"), Entity::agent(0), count);
}

TEST(RangeBearingSensor, ItsErrorsAreWhatItClaims) {
  // NEES has mean 2 and variance 4: over n sightings a standard error of 2/√n.
  const RangeBearingSensor sensor({.sensor_m = {5.0, -3.0},
                                   .target_m = {-15.0, 12.0},
                                   .noise = {.sigma_range_m = 0.4,
                                             .sigma_bearing_rad = 0.02,
                                             .sigma_heading_rad = 0.01,
                                             .sigma_position_m = 0.2}});
  EXPECT_DOUBLE_EQ(sensor.distance_m(), 25.0);
  const gaussian::Vector truth = (gaussian::Vector(2) << -15.0, 12.0).finished();
  constexpr int sightings = 4000;
  double nees = 0;
  for (int i = 0; i < sightings; ++i) {
    Stream draws = draws_of(static_cast<std::uint64_t>(i));
    nees += *gaussian::nees(*sensor.measure(draws), truth) / sightings;
  }
  EXPECT_NEAR(nees, 2.0, 4 * 2 / std::sqrt(sightings));
}

TEST(RangeBearingSensor, WithHardlyAnyNoiseSeesTheTruthFromWhereItStands) {
  RangeBearingSensor sensor({.noise = {1e-9, 1e-9, 0.0, 0.0}});
  sensor.move_to({1.0, 2.0});
  sensor.look_towards({-2.0, 6.0});
  Stream draws = draws_of(0);
  const auto z = gaussian::state(*sensor.measure(draws));
  EXPECT_NEAR((*z)(0), -2.0, 1e-7);
  EXPECT_NEAR((*z)(1), 6.0, 1e-7);
}

TEST(RangeBearingSensor, ARangeThatNoiseMakesNegativeIsNoSighting) {
  const RangeBearingSensor sensor({.noise = {1.0, 0.1, 0.0, 0.0}});  // stands on its target
  int seen = 0;
  constexpr int sightings = 400;
  for (int i = 0; i < sightings; ++i) {
    Stream draws = draws_of(static_cast<std::uint64_t>(i));
    if (sensor.measure(draws)) ++seen;
  }
  EXPECT_NEAR(seen, sightings / 2, 4 * std::sqrt(sightings) / 2);
}

}  // namespace
}  // namespace hearsay
