#include "sim/world/target_states.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace hearsay {
namespace {

const Duration half = Duration::seconds(0.5);

TEST(TargetStates, FollowAPathWithItsVelocity) {
  const auto path =
      motion::make(motion::Waypoints{.points_m = {{0, 0}, {3, 0}, {3, 4}}, .speed_m_per_s = 2.0});
  const auto states = target_states(*path, half, 8);
  ASSERT_EQ(states.size(), 32u);
  const auto at = [&](std::size_t k) {
    return TargetState{states[4 * k], states[4 * k + 1], states[4 * k + 2], states[4 * k + 3]};
  };
  EXPECT_EQ(at(0), (TargetState{0, 0, 2, 0}));
  EXPECT_EQ(at(3), (TargetState{3, 0, 0, 2}));  // at the corner: on from there
  EXPECT_EQ(at(4), (TargetState{3, 1, 0, 2}));
  EXPECT_EQ(at(7), (TargetState{3, 4, 0, 0}));  // it has arrived
}

TEST(TargetStates, WithoutNoiseGoStraightOn) {
  const auto states = target_states({1, 2, 3, -4}, 0.0, half, 3, 1, 0);
  EXPECT_EQ(states, (std::vector<double>{1, 2, 3, -4, 2.5, 0, 3, -4, 4, -2, 3, -4}));
}

// After t s of white-noise acceleration of density q an axis has covariance
// q (t³/3, t²/2; t²/2, t), however many steps that are.
TEST(TargetStates, HaveTheCovarianceOfWhiteNoiseAcceleration) {
  const double q = 0.7, t = 2.0;
  const int n = 20'000;
  double xx = 0, xv = 0, vv = 0, cross = 0;
  for (int target = 0; target < n; ++target) {
    const auto s = target_states({}, q, half, 5, 3, target);
    xx += s[16] * s[16] / n;
    xv += s[16] * s[18] / n;
    vv += s[18] * s[18] / n;
    cross += s[16] * s[17] / n;
  }
  const double pxx = q * t * t * t / 3, pxv = q * t * t / 2, pvv = q * t;
  EXPECT_NEAR(xx, pxx, 4 * pxx * std::sqrt(2.0 / n));
  EXPECT_NEAR(vv, pvv, 4 * pvv * std::sqrt(2.0 / n));
  EXPECT_NEAR(xv, pxv, 4 * std::sqrt((pxx * pvv + pxv * pxv) / n));
  EXPECT_NEAR(cross, 0.0, 4 * pxx / std::sqrt(double(n)));
}

TEST(TargetStates, ALongerRunBeginsAsAShorterOne) {
  const auto some = target_states({}, 1.0, half, 5, 9, 2);
  const auto more = target_states({}, 1.0, half, 50, 9, 2);
  EXPECT_TRUE(std::equal(some.begin(), some.end(), more.begin()));
  EXPECT_NE(some, target_states({}, 1.0, half, 5, 9, 3));
}

}  // namespace
}  // namespace hearsay
