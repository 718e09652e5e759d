#include "filters/trails/laying.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/filters/trails/samples.hpp"

namespace hearsay::trails {
namespace {

using Temporary = TemporaryTrail<Point>;

TEST(TemporaryTrail, CountsDBackFromTheEvent) {
  Temporary trail({.interval_s = 2.0});
  Numbering numbers(7, 3);
  numbers.take();
  for (int step = 0; step <= 100; ++step) {  // 10 s at 0.1 s
    const double now_s = 50.0 + 0.1 * step;
    trail.lay(now_s, point(0.25 * step, 0.0));
  }
  EXPECT_EQ(trail.size(), 6u);
  const auto crumbs = trail.complete(4, 61.0, numbers);
  ASSERT_EQ(crumbs.size(), 6u);
  for (std::size_t i = 0; i < crumbs.size(); ++i) {
    EXPECT_EQ(crumbs[i].event, 4u);
    EXPECT_NEAR(crumbs[i].created_s, 50.0 + 2.0 * static_cast<double>(i), 1e-9);
    EXPECT_NEAR(crumbs[i].created_s + crumbs[i].distance_s, 61.0, 1e-5);
    EXPECT_NEAR(crumbs[i].position.x_m, 5.0 * static_cast<double>(i), 1e-5);
    EXPECT_EQ(crumbs[i].identity, (Identity{7, 3, static_cast<std::uint32_t>(i) + 1}));
  }
  EXPECT_EQ(trail.size(), 0u);
  EXPECT_TRUE(trail.complete(4, 62.0, numbers).empty());
}

TEST(TemporaryTrail, ATrailThatGrowsTooLongIsAbandoned) {
  Temporary trail({.interval_s = 1.0, .crumbs_max = 5});
  Numbering numbers(0);
  for (int i = 0; i < 5; ++i) EXPECT_EQ(trail.lay(i, {}), Laid::crumb);
  EXPECT_EQ(trail.lay(4.5, {}), Laid::nothing);
  EXPECT_EQ(trail.lay(5.0, {}), Laid::abandoned);
  EXPECT_EQ(trail.size(), 0u);
  EXPECT_EQ(trail.abandoned(), 1u);
  EXPECT_EQ(trail.lay(5.1, {}), Laid::crumb);  // it begins anew
  EXPECT_EQ(trail.complete(0, 6.0, numbers).size(), 1u);
}

TEST(TemporaryTrail, DCountsWhateverTheWayCounts) {
  Temporary trail({.interval_s = 1.0});
  Numbering numbers(0);
  trail.lay(0.0, {}, 0.0);
  trail.lay(1.0, {}, 1.0);
  trail.lay(2.0, {}, 1.0);  // a turn
  trail.lay(3.0, {}, 2.0);
  const auto crumbs = trail.complete(0, 3.0, numbers);
  ASSERT_EQ(crumbs.size(), 4u);
  EXPECT_EQ(crumbs[0].distance_s, 3.0F);
  EXPECT_EQ(crumbs[1].distance_s, 2.0F);
  EXPECT_EQ(crumbs[2].distance_s, 2.0F);
  EXPECT_EQ(crumbs[3].distance_s, 1.0F);
}

TEST(TemporaryTrail, APauseLaysNothingAndIsPartOfD) {
  Temporary trail({.interval_s = 2.0});
  Numbering numbers(0);
  trail.lay(0.0, {});
  trail.lay(2.0, {});
  EXPECT_EQ(trail.lay(31.0, {}), Laid::crumb);  // it stood for 29 s
  EXPECT_EQ(trail.lay(32.0, {}), Laid::nothing);
  EXPECT_EQ(trail.lay(33.0, {}), Laid::crumb);
  EXPECT_EQ(trail.complete(0, 34.0, numbers)[0].distance_s, 34.0F);
}

TEST(TemporaryTrail, SumsOfStepsThatFallShortByRoundingAreInTime) {
  Temporary trail({.interval_s = 1.0});
  Numbering numbers(0);
  double now_s = 0.0;  // 10 · 0.1 adds up to less than 1
  for (int i = 0; i <= 100; ++i, now_s += 0.1) trail.lay(now_s, {});
  const auto crumbs = trail.complete(0, 20.0, numbers);
  ASSERT_EQ(crumbs.size(), 11u);
  for (std::size_t i = 0; i < 11; ++i) {
    EXPECT_NEAR(crumbs[i].created_s, static_cast<double>(i), 1e-9);
  }
}

TEST(TemporaryTrail, StepsThatDoNotDivideTheIntervalDoNotSlowItDown) {
  Temporary trail({.interval_s = 1.0});
  for (int i = 0; i <= 1000; ++i) trail.lay(0.3 * i, {});
  EXPECT_NEAR(static_cast<double>(trail.size()), 301.0, 1.0);
}

TEST(TemporaryTrail, TimeDoesNotGoBack) {
  Temporary trail({});
  Numbering numbers(0);
  trail.lay(5.0, {});
  EXPECT_THROW(trail.lay(4.0, {}), BrokenInvariant);
  EXPECT_THROW(trail.complete(0, 4.0, numbers), BrokenInvariant);
  EXPECT_THROW(trail.lay(std::numeric_limits<double>::infinity(), {}), BrokenInvariant);
  EXPECT_THROW(Temporary({.interval_s = 0.0}), BrokenInvariant);
  EXPECT_THROW(Temporary({.crumbs_max = 0}), BrokenInvariant);
}

TEST(ReturnTrail, LeadsBackToTheEventThatTheRobotCameFrom) {
  ReturnTrail<Point> trail(2.0);
  Numbering numbers(5);
  EXPECT_FALSE(trail.lay(0.0, {}, 9, numbers));  // it was nowhere yet
  trail.visit(3, 10.0);
  std::vector<Crumb> crumbs;
  for (int now_s = 10; now_s <= 16; ++now_s) {
    if (const auto crumb = trail.lay(now_s, point(now_s, 0.0), 9, numbers))
      crumbs.push_back(*crumb);
  }
  ASSERT_EQ(crumbs.size(), 4u);
  for (std::size_t i = 0; i < crumbs.size(); ++i) {
    EXPECT_EQ(crumbs[i].event, 3u);
    EXPECT_EQ(crumbs[i].goal, 9u);
    EXPECT_EQ(crumbs[i].distance_s, 2.0F * static_cast<float>(i));  // grows on the way
    EXPECT_EQ(crumbs[i].created_s, 10.0 + 2.0 * static_cast<double>(i));
    EXPECT_EQ(crumbs[i].identity.number, i);
  }
  trail.visit(9, 17.0);
  const auto next = trail.lay(18.0, {}, 3, numbers);
  ASSERT_TRUE(next);
  EXPECT_EQ(next->event, 9u);
  EXPECT_EQ(next->distance_s, 1.0F);
  EXPECT_THROW(trail.lay(16.0, {}, 3, numbers), BrokenInvariant);
}

}  // namespace
}  // namespace hearsay::trails
