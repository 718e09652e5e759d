#include "sim/kernel/callback.hpp"

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <type_traits>
#include <utility>

namespace hearsay {
namespace {

static_assert(!std::is_copy_constructible_v<Callback>);
static_assert(std::is_nothrow_move_constructible_v<Callback>);
static_assert(!std::is_constructible_v<Callback, int>);

TEST(Callback, IsEmptyUntilItHoldsSomething) {
  Callback callback;
  EXPECT_FALSE(callback);
  callback = [] {};
  EXPECT_TRUE(callback);
}

TEST(Callback, CanBeCalledSeveralTimes) {
  int calls = 0;
  Callback callback = [&calls, own = 0]() mutable { calls = ++own; };
  callback();
  callback();
  EXPECT_EQ(calls, 2);
}

TEST(Callback, HoldsFortyBytes) {
  std::array<long, 4> values = {1, 2, 3, 4};
  long sum = 0;
  Callback callback = [values, &sum] {
    for (const long value : values) sum += value;
  };
  Callback moved = std::move(callback);
  EXPECT_FALSE(callback);  // NOLINT: what a move leaves behind is what is tested
  moved();
  EXPECT_EQ(sum, 10);
}

TEST(Callback, DestroysWhatItHoldsExactlyOnce) {
  const auto held = std::make_shared<int>(7);
  {
    Callback first = [held] {};
    EXPECT_EQ(held.use_count(), 2);
    Callback second = std::move(first);
    EXPECT_EQ(held.use_count(), 2);
    first = std::move(second);
    EXPECT_EQ(held.use_count(), 2);
    first = [] {};
    EXPECT_EQ(held.use_count(), 1);
    second = [held] {};
    EXPECT_EQ(held.use_count(), 2);
  }
  EXPECT_EQ(held.use_count(), 1);
}

TEST(Callback, TakesWhatCanOnlyBeMoved) {
  int seen = 0;
  Callback callback = [own = std::make_unique<int>(9), &seen] { seen = *own; };
  Callback moved = std::move(callback);
  moved();
  EXPECT_EQ(seen, 9);
}

TEST(Callback, TakesAPlainFunction) {
  static int calls = 0;
  Callback callback = +[] { ++calls; };
  callback();
  EXPECT_EQ(calls, 1);
}

}  // namespace
}  // namespace hearsay
