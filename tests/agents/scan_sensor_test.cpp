// What a scan holds, counted over many.
#include "agents/sensors/scan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

using Place = std::array<double, 2>;
const std::vector<Place> one{{30.0, 40.0}};  // 50 m away

TEST(ScanSensor, SeesATargetWithItsProbability) {
  const ScanSensor sensor({.range_max_m = 60, .detection_probability = 0.7});
  const int scans = 20000;
  int seen = 0;
  for (int k = 0; k < scans; ++k) {
    seen += static_cast<int>(sensor.scan({0, 0}, one, 1, 0, static_cast<std::uint64_t>(k)).size());
  }
  EXPECT_NEAR(seen, 0.7 * scans, 4 * std::sqrt(scans * 0.7 * 0.3));
}

TEST(ScanSensor, SeesNothingBeyondItsRange) {
  EXPECT_EQ(ScanSensor({.range_max_m = 50.0}).scan({0, 0}, one, 1, 0, 0).size(), 1u);
  EXPECT_EQ(ScanSensor({.range_max_m = 49.9}).scan({0, 0}, one, 1, 0, 0).size(), 0u);
}

// Variances of n draws are off by √(2/n) of themselves.
TEST(ScanSensor, ItsNoiseIsWhatItSays) {
  const ScanSensor sensor({.sigma_along_m = 5, .sigma_across_m = 2});
  const int scans = 20000;
  double xx = 0, xy = 0, yy = 0;
  gaussian::Matrix S;
  for (int k = 0; k < scans; ++k) {
    const auto plots = sensor.scan({0, 0}, one, 1, 0, static_cast<std::uint64_t>(k));
    ASSERT_EQ(plots.size(), 1u);
    const double x = plots[0].z(0) - 30, y = plots[0].z(1) - 40;
    xx += x * x / scans;
    xy += x * y / scans;
    yy += y * y / scans;
    S = plots[0].S;
  }
  // Along (0.6, 0.8): 25·(0.36, 0.48, 0.64) + 4·(0.64, −0.48, 0.36).
  EXPECT_NEAR(S(0, 0), 11.56, 1e-12);
  EXPECT_NEAR(S(0, 1), 10.08, 1e-12);
  EXPECT_NEAR(S(1, 1), 17.44, 1e-12);
  const double share = 4 * std::sqrt(2.0 / scans);
  EXPECT_NEAR(xx, S(0, 0), share * S(0, 0));
  EXPECT_NEAR(yy, S(1, 1), share * S(1, 1));
  EXPECT_NEAR(xy, S(0, 1), share * 17.44);
}

// 100 a km² within 200 m: 4π on average. Half of them lie within 200/√2 m, and half to the east.
TEST(ScanSensor, FalseAlarmsAreUniformWithinRange) {
  const ScanSensor sensor({.range_max_m = 200, .false_alarms_per_km2 = 100});
  const double mean = 4 * std::acos(-1.0);
  EXPECT_NEAR(sensor.false_alarms(), mean, 1e-12);
  const int scans = 3000;
  double number = 0, squares = 0, inner = 0, east = 0;
  for (int k = 0; k < scans; ++k) {
    const auto plots = sensor.scan({1000, 0}, {}, 1, 0, static_cast<std::uint64_t>(k));
    number += static_cast<double>(plots.size());
    squares += static_cast<double>(plots.size() * plots.size());
    for (const auto& plot : plots) {
      const double r = std::sqrt((plot.z(0) - 1000) * (plot.z(0) - 1000) + plot.z(1) * plot.z(1));
      EXPECT_LE(r, 200.0);
      inner += r < 200 / std::sqrt(2.0) ? 1 : 0;
      east += plot.z(0) > 1000 ? 1 : 0;
    }
  }
  EXPECT_NEAR(number, mean * scans, 4 * std::sqrt(mean * scans));
  EXPECT_NEAR(inner, number / 2, 2 * std::sqrt(number));
  EXPECT_NEAR(east, number / 2, 2 * std::sqrt(number));
  const double variance = squares / scans - number / scans * (number / scans);
  EXPECT_NEAR(variance, mean, 4 * mean * std::sqrt(2.0 / scans) + 0.1);
}

// What becomes of one target is the same whoever else is there, and the order says nothing.
TEST(ScanSensor, TargetsHaveDrawsOfTheirOwn) {
  const ScanSensor sensor({.range_max_m = 500, .detection_probability = 0.8});
  for (std::uint64_t k = 0; k < 200; ++k) {
    const auto both = sensor.scan({0, 0}, std::vector<Place>{{30, 40}, {-100, 0}}, 1, 0, k);
    const auto alone = sensor.scan({0, 0}, one, 1, 0, k);
    EXPECT_TRUE(std::is_sorted(both.begin(), both.end(),
                               [](const auto& a, const auto& b) { return a.z(0) < b.z(0); }));
    if (alone.empty()) {
      EXPECT_LE(both.size(), 1u);
    } else {
      EXPECT_EQ(both.back().z, alone.front().z);
    }
  }
}

TEST(ScanSensor, RefusesOptionsOutOfRange) {
  EXPECT_THROW(ScanSensor({.sigma_along_m = 0}), BrokenInvariant);
  EXPECT_THROW(ScanSensor({.detection_probability = 1.1}), BrokenInvariant);
  EXPECT_THROW(ScanSensor({.false_alarms_per_km2 = 1}), BrokenInvariant);
}

}  // namespace
}  // namespace hearsay
