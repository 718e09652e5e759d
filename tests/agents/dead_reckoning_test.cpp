#include "agents/dead_reckoning.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <new>
#include <vector>

#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

constexpr Duration dt = 10_ms;

/// Drives with these velocities from `from`, in steps of 10 ms.
Time drive(DeadReckoning& reckoning, Time from, Duration span, double forward, double turn) {
  const Time end = from + span;
  for (Time now = from; now < end;) {
    now = now + dt;
    reckoning.drive(now, forward, turn, dt.seconds());
  }
  return end;
}

/// How far an arc is from its chord at most where samples are 50 ms apart: vωs²/8.
double bound(double forward, double turn) { return std::abs(forward * turn) * 0.05 * 0.05 / 8.0; }

TEST(DeadReckoning, StraightAheadTheStartLiesBehind) {
  DeadReckoning reckoning(60_s, 50_ms);
  const Time now = drive(reckoning, Time(), 10_s, 0.3, 0.0);
  for (const Duration ago : {0_s, 10_ms, 1234_ms, 10_s}) {
    const auto behind = reckoning.behind(now - ago);
    ASSERT_TRUE(behind);
    EXPECT_NEAR(behind->x(), -0.3 * ago.seconds(), 1e-12);
    EXPECT_NEAR(behind->y(), 0.0, 1e-12);
  }
}

// Going back along an arc: x = −(v/ω) sin ωτ, y = (v/ω)(1 − cos ωτ).
TEST(DeadReckoning, OnAnArcWhatLiesBehindIsOnTheCircle) {
  for (const double turn : {0.8, -0.5}) {
    DeadReckoning reckoning(60_s, 50_ms);
    const Time now = drive(reckoning, Time(), 20_s, 0.3, turn);
    for (int ms = 0; ms <= 20'000; ms += 37) {
      const auto behind = reckoning.behind(now - 1_ms * ms);
      ASSERT_TRUE(behind);
      const double angle = turn * ms * 1e-3, radius = 0.3 / turn;
      const Eigen::Vector2d expected(-radius * std::sin(angle), radius * (1.0 - std::cos(angle)));
      // Between samples on the chord; and each step of odometry is one, 1e-6 of its length off.
      EXPECT_LT((*behind - expected).norm(), bound(0.3, turn) + 1e-5 * 0.3 * ms * 1e-3 + 1e-12);
    }
  }
}

TEST(DeadReckoning, WhatIsOlderThanItsMemoryIsForgottenAndNothingYounger) {
  DeadReckoning reckoning(2_s, 50_ms);
  Time now;
  for (int s = 0; s < 30; ++s) {  // the ring of 42 samples goes round fourteen times
    now = drive(reckoning, now, 1_s, 0.5, 0.0);
    if (s < 2) continue;
    EXPECT_FALSE(reckoning.behind(now - 2_s - Duration::nanoseconds(1)));
    for (const Duration ago : {2_s, 1990_ms, 1951_ms, 950_ms, 1_ms, 0_s}) {
      const auto behind = reckoning.behind(now - ago);
      ASSERT_TRUE(behind);
      EXPECT_NEAR(behind->x(), -0.5 * ago.seconds(), 1e-12);
    }
  }
}

// Whatever the steps of odometry: coarser than the samples kept, finer, or neither's multiple.
TEST(DeadReckoning, TheMemoryIsWholeHoweverOdometryComes) {
  for (const Duration step : {7_ms, 50_ms, 51_ms, 340_ms, 3_s}) {
    DeadReckoning reckoning(2_s, 50_ms);
    Time now;
    for (int k = 0; k < 2000; ++k) {
      now = now + step;
      reckoning.drive(now, 0.5, 0.0, step.seconds());
      if (now < Time::at(2_s)) continue;
      const auto oldest = reckoning.behind(now - 2_s);
      ASSERT_TRUE(oldest) << step.seconds() << " s, step " << k;
      EXPECT_NEAR(oldest->x(), -1.0, 1e-11);
    }
  }
}

TEST(DeadReckoning, TheFutureAndWhatWasBeforeTheStartAreUnknown) {
  DeadReckoning reckoning(2_s, 50_ms);
  ASSERT_TRUE(reckoning.behind(Time()));
  EXPECT_EQ(reckoning.behind(Time())->norm(), 0.0);
  EXPECT_FALSE(reckoning.behind(Time() - 1_ms));
  const Time now = drive(reckoning, Time(), 1_s, 0.5, 0.3);
  EXPECT_FALSE(reckoning.behind(now + Duration::nanoseconds(1)));
  EXPECT_FALSE(reckoning.behind(Time() - 1_ms));
  EXPECT_TRUE(reckoning.behind(Time()));
}

// Its frame begins at zero, not at what lay in memory: the digest of a run would show the rounding.
TEST(DeadReckoning, WhatLayInItsMemoryBeforeChangesNoBit) {
  std::vector<Eigen::Vector2d> found;
  for (const unsigned char filler : {0x00, 0x41, 0xc0}) {
    alignas(DeadReckoning) std::byte memory[sizeof(DeadReckoning)];
    for (std::byte& byte : memory) *static_cast<volatile std::byte*>(&byte) = std::byte{filler};
    DeadReckoning* const reckoning = new (memory) DeadReckoning(60_s, 50_ms);
    const Time now = drive(*reckoning, Time(), 3_s, 0.31, 0.7);
    found.push_back(reckoning->behind(now - 1234_ms).value());
    reckoning->~DeadReckoning();
  }
  EXPECT_EQ(found[0], found[1]);
  EXPECT_EQ(found[0], found[2]);
}

TEST(DeadReckoning, MemoryAndStepAreAboveZero) {
  EXPECT_THROW(DeadReckoning(Duration(), 50_ms), BrokenInvariant);
  EXPECT_THROW(DeadReckoning(1_s, Duration()), BrokenInvariant);
}

}  // namespace
}  // namespace hearsay
