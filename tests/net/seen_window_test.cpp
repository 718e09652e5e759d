#include "net/seen_window.hpp"

#include <gtest/gtest.h>

#include <set>

#include "sim/kernel/random.hpp"

namespace hearsay {
namespace {

using Place = SeenWindow::Place;

TEST(SeenWindow, OfNumbersInOrderRemembersAllInNoSpace) {
  SeenWindow window;
  for (std::uint32_t n = 0; n < 5000; ++n) {
    ASSERT_EQ(window.place(n), Place::fresh);
    window.mark(n);
    ASSERT_EQ(window.place(n), Place::seen);
    ASSERT_EQ(window.base(), n + 1);
    ASSERT_EQ(window.words_used(), 0u);
  }
  for (std::uint32_t n = 0; n < 5000; ++n) ASSERT_EQ(window.place(n), Place::seen);
}

// Beside a set that remembers everything: never calls a number fresh that was seen, and calls fresh
// whatever is neither seen nor before a number more than a window ahead.
TEST(SeenWindow, AgreesWithASetThatRemembersAll) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Stream draws(seed, Purpose("seen window test"), Entity::agent(0));
    // Some seeds mostly in order, some all over, some with jumps beyond the window.
    const std::uint64_t spread = seed % 3 == 0 ? 8 : seed % 3 == 1 ? 200 : 700;
    SeenWindow window;
    std::set<std::uint32_t> seen;
    std::uint32_t given_up_before = 0;
    for (std::uint32_t step = 0; step < 800; ++step) {
      const auto n = static_cast<std::uint32_t>(step / 2 + draws.below(spread));
      const Place place = window.place(n);
      if (seen.contains(n)) {
        ASSERT_NE(place, Place::fresh) << "seed " << seed << ", number " << n;
      } else {
        ASSERT_EQ(place == Place::fresh, n >= given_up_before) << "seed " << seed << ", " << n;
        ASSERT_NE(place, Place::seen) << "seed " << seed << ", number " << n;
      }
      if (place != Place::fresh) continue;
      if (n >= window.base() + SeenWindow::span) {
        given_up_before = std::max(given_up_before, n - SeenWindow::span + 1);
      }
      window.mark(n);
      seen.insert(n);
      // What goes over the air says the same, apart from where old ones can be told apart.
      const SeenWindow copy = SeenWindow::of(window.base(), window.bits());
      for (std::uint32_t m = n < 40 ? 0 : n - 40; m < n + 40; ++m) {
        ASSERT_EQ(copy.place(m) == Place::fresh, window.place(m) == Place::fresh);
      }
    }
  }
}

TEST(SeenWindow, GivesUpWhatItIsTold) {
  SeenWindow window;
  window.mark(3);
  window.mark(70);
  window.give_up_before(3);
  EXPECT_EQ(window.base(), 4u);  // 3 was seen
  EXPECT_EQ(window.place(0), Place::behind);
  EXPECT_EQ(window.place(3), Place::behind);  // no longer told apart
  EXPECT_EQ(window.place(4), Place::fresh);
  EXPECT_EQ(window.place(70), Place::seen);
  window.give_up_before(2);  // nothing new
  EXPECT_EQ(window.base(), 4u);
  window.give_up_before(100'000);
  EXPECT_EQ(window.base(), 100'000u);
  EXPECT_EQ(window.words_used(), 0u);
}

TEST(SeenWindow, ReachesTheLastNumber) {
  SeenWindow window;
  window.mark(UINT32_MAX - 1);
  EXPECT_EQ(window.place(UINT32_MAX - 1), Place::seen);
  EXPECT_EQ(window.place(UINT32_MAX - 2), Place::fresh);
  EXPECT_EQ(window.place(0), Place::behind);
  window.give_up_before(UINT32_MAX);
  EXPECT_EQ(window.place(UINT32_MAX - 2), Place::behind);
}

}  // namespace
}  // namespace hearsay
