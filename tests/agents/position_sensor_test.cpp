#include "agents/sensors/position.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

TEST(PositionSensor, SeesWellAcrossItsLineOfSightAndBadlyAlongIt) {
  // Looking along +y: the y axis is along, the x axis across.
  const PositionSensor sensor({.sensor_m = {0.0, -7.0},
                               .target_m = {0.0, 3.0},
                               .sigma_along_m = 10,
                               .sigma_across_m = 1.5});
  EXPECT_NEAR(sensor.covariance()(0, 0), 2.25, 1e-12);
  EXPECT_NEAR(sensor.covariance()(1, 1), 100.0, 1e-12);
  EXPECT_NEAR(sensor.covariance()(0, 1), 0.0, 1e-12);
}

TEST(PositionSensor, TurnsItsCovarianceWithTheLineOfSight) {
  // At 45°: S = ½[[a + c, a − c], [a − c, a + c]] for variances a along and c across.
  const PositionSensor sensor(
      {.sensor_m = {1.0, 1.0}, .target_m = {5.0, 5.0}, .sigma_along_m = 10, .sigma_across_m = 1.5});
  EXPECT_NEAR(sensor.covariance()(0, 0), 0.5 * (100 + 2.25), 1e-12);
  EXPECT_NEAR(sensor.covariance()(0, 1), 0.5 * (100 - 2.25), 1e-12);
}

TEST(PositionSensor, ItsMeasurementsScatterAsItsCovarianceSays) {
  const PositionSensor sensor({.sensor_m = {-30, 40},
                               .target_m = {12.0, -5.0},
                               .sigma_along_m = 10,
                               .sigma_across_m = 1.5});
  Stream draws(3, Purpose("test"), Entity::agent(0));
  constexpr int n = 20000;
  double mean[2] = {}, xx = 0, yy = 0, xy = 0;
  for (int i = 0; i < n; ++i) {
    const gaussian::Belief b = sensor.measure(draws);
    const gaussian::Vector z = *gaussian::state(b);
    const double dx = z(0) - 12.0, dy = z(1) + 5.0;
    mean[0] += dx / n, mean[1] += dy / n;
    xx += dx * dx / n, yy += dy * dy / n, xy += dx * dy / n;
  }
  // Four standard errors: σ/√n for means, S_ii √(2/n) for variances.
  const gaussian::Matrix& S = sensor.covariance();
  EXPECT_NEAR(mean[0], 0.0, 4 * std::sqrt(S(0, 0) / n));
  EXPECT_NEAR(mean[1], 0.0, 4 * std::sqrt(S(1, 1) / n));
  EXPECT_NEAR(xx, S(0, 0), 4 * S(0, 0) * std::sqrt(2.0 / n));
  EXPECT_NEAR(yy, S(1, 1), 4 * S(1, 1) * std::sqrt(2.0 / n));
  EXPECT_NEAR(xy, S(0, 1), 4 * std::sqrt((S(0, 0) * S(1, 1) + S(0, 1) * S(0, 1)) / n));
}

TEST(PositionSensor, WithALineOfSightItMayNotStandOnItsTarget) {
  EXPECT_THROW(PositionSensor({.sigma_along_m = 2, .sigma_across_m = 1}), BrokenInvariant);
  EXPECT_NO_THROW(PositionSensor({.sigma_along_m = 2, .sigma_across_m = 2}));
}

}  // namespace
}  // namespace hearsay
