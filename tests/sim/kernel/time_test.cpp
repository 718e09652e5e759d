#include "sim/kernel/time.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <type_traits>

namespace hearsay {
namespace {

TEST(Duration, CountsNanosecondsExactly) {
  EXPECT_EQ(Duration::seconds(1.5), 1500_ms);
  EXPECT_EQ(Duration::seconds(0.1).nanoseconds(), 100'000'000);
  EXPECT_EQ(Duration::seconds(86'400.000'000'001).nanoseconds(), 86'400'000'000'001);
  EXPECT_EQ(Duration::seconds(-2.25), -(2250_ms));
  EXPECT_EQ(1_min, 60_s);
  EXPECT_EQ(1_ms, 1000_us);
  EXPECT_EQ(1_us, 1000_ns);
  EXPECT_DOUBLE_EQ((2500_ms).seconds(), 2.5);
}

TEST(Duration, RoundsToTheNearestNanosecondAndTiesAwayFromZero) {
  const double half = 0x1p-31;  // 0.4656… ns
  EXPECT_EQ(Duration::seconds(half).nanoseconds(), 0);
  EXPECT_EQ(Duration::seconds(0x1p-30).nanoseconds(), 1);       // 0.93 ns
  EXPECT_EQ(Duration::seconds(0x1p-10).nanoseconds(), 976563);  // 976562.5 ns
  EXPECT_EQ(Duration::seconds(-0x1p-10).nanoseconds(), -976563);
  EXPECT_EQ(Duration::seconds(0.9999999999).nanoseconds(), 1'000'000'000);
}

TEST(Duration, RefusesWhatCannotBeSimulated) {
  EXPECT_EQ(Duration::seconds(9e9).nanoseconds(), 9'000'000'000'000'000'000);
  EXPECT_THROW((void)Duration::seconds(9.1e9), std::out_of_range);
  EXPECT_THROW((void)Duration::seconds(-9.1e9), std::out_of_range);
  EXPECT_THROW((void)Duration::seconds(std::numeric_limits<double>::quiet_NaN()),
               std::out_of_range);
  try {
    (void)Duration::seconds(std::numeric_limits<double>::infinity());
    FAIL() << "an infinite span was accepted";
  } catch (const std::out_of_range& error) {
    EXPECT_NE(std::string(error.what()).find("9e9 s"), std::string::npos) << error.what();
  }
}

TEST(Duration, Computes) {
  EXPECT_EQ(3_s - 5_s, -(2_s));
  EXPECT_EQ(2_s * 3, 6_s);
  EXPECT_EQ(7_s / 2, 3500_ms);
  EXPECT_EQ(7_s / 2_s, 3);
  EXPECT_EQ(7_s % 2_s, 1_s);
  Duration span = 1_s;
  span += 2_s;
  span -= 500_ms;
  EXPECT_EQ(span, 2500_ms);
  EXPECT_LT(-(1_s), 0_s);
}

TEST(Time, IsAnInstantAndNotASpan) {
  const Time start;
  EXPECT_EQ((start + 3_s) - (start + 1_s), 2_s);
  EXPECT_EQ(Time::at(5_s) - 2_s, Time::at(3_s));
  EXPECT_EQ(Time::at(5_s).since_start(), 5_s);
  EXPECT_LT(Time::at(Duration::seconds(9e9)), Time::never());
  static_assert(!std::is_convertible_v<Duration, Time>);
  static_assert(!std::is_convertible_v<Time, Duration>);
  static_assert(!std::is_convertible_v<int, Duration>);
  static_assert(!std::is_convertible_v<double, Duration>);
}

}  // namespace
}  // namespace hearsay
