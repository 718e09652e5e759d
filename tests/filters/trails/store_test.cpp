#include "filters/trails/store.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "sim/math/functions.hpp"
#include "tests/filters/trails/samples.hpp"

namespace hearsay::trails {
namespace {

constexpr double never_s = std::numeric_limits<double>::infinity();

Crumb crumb_at(float x_m, float distance_s, double created_s, std::uint32_t number,
               EventId event = 1) {
  return {.event = event,
          .goal = no_event,
          .position = {x_m, 0.0F},
          .distance_s = distance_s,
          .created_s = created_s,
          .identity = {0, 0, number}};
}
Place place_at(EventId event, float x_m, double time_s, std::uint32_t number) {
  return {.event = event, .position = {x_m, 0.0F}, .time_s = time_s, .identity = {9, 0, number}};
}
MetricReach around(float x_m, double radius_m) { return {{x_m, 0.0F}, radius_m, std::nullopt}; }

TEST(TrailStore, FollowsTheCrumbOfLeastDistanceInReach) {
  MetricStore store({.age_max_s = never_s});
  store.merge(crumb_at(0.0F, 30.0F, 0.0, 0), 1.0);
  store.merge(crumb_at(0.5F, 20.0F, 0.0, 1), 1.0);
  store.merge(crumb_at(0.9F, 25.0F, 0.0, 2), 1.0);
  store.merge(crumb_at(1.5F, 10.0F, 0.0, 3), 1.0);    // out of reach
  store.merge(crumb_at(0.1F, 5.0F, 0.0, 4, 2), 1.0);  // of another event
  const Crumb* best = store.best(1, around(0.0F, 1.0), 1.0);
  ASSERT_NE(best, nullptr);
  EXPECT_EQ(best->identity.number, 1u);
  EXPECT_EQ(store.best(3, around(0.0F, 1.0), 1.0), nullptr);
  EXPECT_EQ(store.best(1, around(-5.0F, 1.0), 1.0), nullptr);
  EXPECT_EQ(store.best(1, around(0.6F, 1.0), 1.0)->identity.number, 3u);
}

TEST(TrailStore, OfEqualDistancesTheYoungerIsFollowed) {
  MetricStore store({});
  store.merge(crumb_at(0.0F, 7.0F, 3.0, 0), 5.0);
  store.merge(crumb_at(0.0F, 7.0F, 4.0, 1), 5.0);
  store.merge(crumb_at(0.0F, 7.0F, 2.0, 2), 5.0);
  EXPECT_EQ(store.best(1, around(0.0F, 1.0), 5.0)->identity.number, 1u);
}

/// By comparison with each of them; by angles.
bool near(const MetricReach& reach, const Point& p) {
  const double x = double{p.x_m} - reach.at.x_m, y = double{p.y_m} - reach.at.y_m;
  if (!(x * x + y * y < reach.radius_m * reach.radius_m)) return false;
  return !reach.field || (x == 0.0 && y == 0.0) ||
         std::fabs(math::wrap_angle(math::atan2(y, x) - reach.field->heading_rad)) <=
             0.5 * reach.field->width_rad;
}

TEST(TrailStore, QueriesFindWhatAComparisonWithEveryCrumbFinds) {
  Stream random = stream("queries");
  for (int round = 0; round < 5; ++round) {
    MetricStore store({.age_max_s = 40.0});
    const auto crumbs = random_crumbs(random, 1500, 12.0, 60.0);
    for (const Crumb& crumb : crumbs) store.merge(crumb, 60.0);
    std::size_t found = 0;
    for (int i = 0; i < 200; ++i) {
      const double now_s = 60.0 + 0.1 * i;
      MetricReach reach{random_point(random, 12.0), random.uniform(0.1, 4.0), std::nullopt};
      if (i % 2 == 0) reach.field = Field{random.uniform(-3.1, 3.1), random.uniform(0.2, 6.28)};
      const auto event = static_cast<EventId>(random.below(3));
      std::vector<Crumb> expected;
      const Crumb* opposing = nullptr;
      for (const Crumb& crumb : crumbs) {
        if (now_s - crumb.created_s > 40.0 || !near(reach, crumb.position)) continue;
        if (crumb.event == event) expected.push_back(crumb);
        if (crumb.goal == event || crumb.goal == no_event) continue;
        if (opposing == nullptr || age_of(*opposing) < age_of(crumb)) opposing = &crumb;
      }
      std::sort(expected.begin(), expected.end(), follows_before<Point>);
      std::vector<Crumb> all(3);
      store.within(event, reach, now_s, all);
      ASSERT_EQ(all, expected);
      const Crumb* best = store.best(event, reach, now_s);
      ASSERT_EQ(best != nullptr, !expected.empty());
      if (best != nullptr) {
        ASSERT_EQ(*best, expected.front());
      }
      const Crumb* other = store.opposing(event, reach, now_s);
      ASSERT_EQ(other != nullptr, opposing != nullptr);
      if (other != nullptr) {
        ASSERT_EQ(*other, *opposing);
      }
      found += expected.size();
    }
    EXPECT_GT(found, 700u);
  }
}

TEST(TrailStore, ACrumbHeardAgainIsOneCrumb) {
  MetricStore store({});
  EXPECT_EQ(store.merge(crumb_at(0.0F, 7.0F, 3.0, 0), 5.0), Fate::taken);
  Crumb moved = crumb_at(0.0F, 7.0F, 3.0, 0);
  moved.position.x_m = 0.5F;  // as another relay has it
  EXPECT_EQ(store.merge(moved, 6.0, 4), Fate::known);
  EXPECT_EQ(store.size(), 1u);
  EXPECT_EQ(store.best(1, around(0.0F, 9.0), 6.0)->position.x_m, 0.0F);
}

TEST(TrailStore, NoCrumbOutlivesItsAge) {
  MetricStore store({.age_max_s = 240.0});
  store.merge(crumb_at(0.0F, 7.0F, 10.0, 0), 10.0);
  store.merge(crumb_at(0.0F, 9.0F, 20.0, 1), 20.0);
  EXPECT_EQ(store.best(1, around(0.0F, 1.0), 250.0)->identity.number, 0u);
  EXPECT_EQ(store.best(1, around(0.0F, 1.0), 250.001)->identity.number, 1u);
  EXPECT_EQ(store.size(), 1u);
  EXPECT_EQ(store.merge(crumb_at(0.0F, 7.0F, 10.0, 0), 250.001), Fate::late);
  EXPECT_EQ(store.best(1, around(0.0F, 1.0), 261.0), nullptr);
  EXPECT_EQ(store.size(), 0u);
  EXPECT_EQ(store.counts().vanished, 2u);
  EXPECT_THROW(store.advance(200.0), BrokenInvariant);
}

TEST(TrailStore, CrumbsOfAnyAgesNeverOutliveTheirs) {
  Stream random = stream("ages");
  MetricStore store({.crumbs_max = 300, .age_max_s = 25.0});
  std::vector<Crumb> all;
  std::size_t seen = 0;
  for (std::uint32_t i = 0; i < 4000; ++i) {
    const double now_s = 0.1 * i;
    Crumb crumb = random_crumb(random, i, 5.0, 1.0);
    crumb.created_s = std::max(0.0, now_s - random.uniform(0.0, 40.0));
    store.merge(crumb, now_s);
    store.within(no_event, {random_point(random, 5.0), 3.0, std::nullopt}, now_s, all);
    for (const Crumb& found : all) ASSERT_LE(now_s - found.created_s, 25.0);
    ASSERT_LE(store.size(), 300u);
    seen += all.size();
  }
  EXPECT_GT(seen, 10000u);
  const TrailCounts& counts = store.counts();
  EXPECT_EQ(counts.taken, store.size() + counts.vanished + counts.dropped);
  EXPECT_EQ(counts.taken + counts.late + counts.no_room + counts.known + counts.refused, 4000u);
  EXPECT_GT(counts.late, 0u);
}

TEST(TrailStore, AFullStoreDropsTheOldestAndDoesNotLetThemInAgain) {
  MetricStore store({.crumbs_max = 3, .age_max_s = never_s});
  for (std::uint32_t i = 0; i < 3; ++i) store.merge(crumb_at(0.0F, 1.0F, 10.0 + i, i, i), 20.0);
  EXPECT_EQ(store.merge(crumb_at(0.0F, 1.0F, 9.0, 7), 20.0), Fate::no_room);  // older than all
  EXPECT_EQ(store.merge(crumb_at(0.0F, 1.0F, 15.0, 8), 20.0), Fate::taken);
  EXPECT_EQ(store.size(), 3u);
  EXPECT_EQ(store.counts().dropped, 1u);
  EXPECT_EQ(store.best(0, around(0.0F, 1.0), 20.0), nullptr);  // of another event: the oldest
  EXPECT_EQ(store.merge(crumb_at(0.0F, 1.0F, 10.0, 0, 0), 20.0), Fate::no_room);
  EXPECT_EQ(store.size(), 3u);
  EXPECT_EQ(store.counts().no_room, 2u);
}

TEST(TrailStore, WhatWasDroppedDoesNotComeBackWhenThereIsRoom) {
  MetricStore store({.crumbs_max = 2, .age_max_s = never_s, .life_arrivals = 1});
  store.merge(crumb_at(0.0F, 1.0F, 1.0, 0, 1), 20.0);
  store.merge(crumb_at(0.0F, 1.0F, 2.0, 1, 2), 20.0);
  store.merge(crumb_at(0.0F, 1.0F, 3.0, 2, 2), 20.0);
  EXPECT_EQ(store.counts().dropped, 1u);
  store.merge(place_at(2, 0.0F, 4.0, 0), 20.0);
  EXPECT_EQ(store.size(), 0u);
  EXPECT_EQ(store.merge(crumb_at(0.0F, 1.0F, 1.0, 0, 1), 20.0), Fate::no_room);
  EXPECT_EQ(store.merge(crumb_at(0.0F, 1.0F, 1.5, 3, 1), 20.0), Fate::taken);
  store.clear();
  EXPECT_EQ(store.merge(crumb_at(0.0F, 1.0F, 1.0, 0, 1), 20.0), Fate::taken);
}

TEST(TrailStore, ItsMemoryDoesNotGrowWithWhatIsHeard) {
  Stream random = stream("flood");
  MetricStore store({.crumbs_max = 100, .events_max = 2, .age_max_s = never_s});
  for (std::uint32_t i = 0; i < 20000; ++i) {
    Crumb crumb = random_crumb(random, i, 50.0, 100.0);
    crumb.event = i;
    EXPECT_EQ(store.merge(crumb, 100.0), i < 2 ? Fate::taken : Fate::no_room);
    store.merge(Place{i, {}, 1.0, {0, 0, i}}, 100.0);
  }
  EXPECT_EQ(store.places().size(), 2u);
  for (std::uint32_t i = 0; i < 20000; ++i) {
    Crumb crumb = random_crumb(random, 20000 + i, 50.0, 100.0);
    crumb.event = i % 2;
    store.merge(crumb, 100.0);
    ASSERT_LE(store.size(), 100u);
  }
  EXPECT_EQ(store.size(), 100u);
}

TEST(TrailStore, CrumbsVanishAfterArrivalsAtTheirEvent) {
  MetricStore store({.age_max_s = never_s, .life_arrivals = 3});
  store.merge(crumb_at(0.0F, 7.0F, 5.0, 0), 30.0);
  store.merge(crumb_at(0.0F, 7.0F, 12.0, 1), 30.0);
  store.merge(crumb_at(0.0F, 7.0F, 5.0, 2, 2), 30.0);
  EXPECT_TRUE(store.merge(place_at(1, 0.0F, 10.0, 0), 30.0));
  EXPECT_TRUE(store.merge(place_at(1, 0.0F, 25.0, 1), 30.0));
  EXPECT_FALSE(store.merge(place_at(1, 0.0F, 25.0, 1), 30.0));  // heard again: the same arrival
  EXPECT_EQ(store.size(), 3u);
  EXPECT_FALSE(store.merge(place_at(1, 0.0F, 20.0, 2), 30.0));  // heard late: an arrival
  EXPECT_EQ(store.size(), 2u);
  EXPECT_EQ(store.best(1, around(0.0F, 1.0), 30.0)->identity.number, 1u);
  EXPECT_NE(store.best(2, around(0.0F, 1.0), 30.0), nullptr);  // the other event had none
  EXPECT_EQ(store.merge(crumb_at(0.0F, 7.0F, 5.0, 0), 30.0), Fate::late);
  store.merge(place_at(1, 0.0F, 29.0, 3), 30.0);
  EXPECT_EQ(store.size(), 1u);
}

TEST(TrailStore, ACrumbIsWornByAgeOrByArrivalsWhicheverIsMore) {
  MetricStore by_age({.age_max_s = 200.0});
  const Crumb crumb = crumb_at(0.0F, 7.0F, 10.0, 0);
  by_age.merge(crumb, 10.0);
  for (const double share : {0.0, 0.3, 1.0}) {
    by_age.advance(10.0 + 200.0 * share);
    EXPECT_DOUBLE_EQ(by_age.worn(crumb), share);
  }
  by_age.advance(1000.0);
  EXPECT_EQ(by_age.worn(crumb), 1.0);
  EXPECT_EQ(by_age.worn(crumb_at(0.0F, 7.0F, 1010.0, 0)), 0.0) << "by a clock that is ahead";

  MetricStore both({.age_max_s = 200.0, .life_arrivals = 4});
  both.merge(crumb, 10.0);
  EXPECT_EQ(both.worn(crumb), 0.0);
  both.merge(place_at(1, 0.0F, 9.0, 0), 20.0);   // before it was laid
  both.merge(place_at(2, 0.0F, 15.0, 1), 20.0);  // of another event
  EXPECT_DOUBLE_EQ(both.worn(crumb), 0.05) << "10 of 200 s";
  both.merge(place_at(1, 0.0F, 20.0, 2), 20.0);
  EXPECT_DOUBLE_EQ(both.worn(crumb), 0.25) << "one arrival of four";
  both.advance(130.0);
  EXPECT_DOUBLE_EQ(both.worn(crumb), 0.6);
  both.merge(place_at(1, 0.0F, 30.0, 3), 130.0);
  both.merge(place_at(1, 0.0F, 40.0, 4), 130.0);
  EXPECT_DOUBLE_EQ(both.worn(crumb), 0.75);

  MetricStore lasting({.age_max_s = never_s});
  lasting.merge(crumb, 1e6);
  EXPECT_EQ(lasting.worn(crumb), 0.0);
}

TEST(TrailStore, TheLatestPlaceOfAnEventReplacesTheOneBefore) {
  MetricStore store({});
  EXPECT_TRUE(store.merge(place_at(2, 1.0F, 10.0, 0), 50.0));
  EXPECT_TRUE(store.merge(place_at(1, 2.0F, 5.0, 1), 50.0));
  EXPECT_FALSE(store.merge(place_at(2, 3.0F, 9.0, 2), 50.0));
  EXPECT_TRUE(store.merge(place_at(2, 4.0F, 11.0, 3), 50.0));
  ASSERT_EQ(store.places().size(), 2u);
  EXPECT_EQ(store.places()[0].event, 1u);
  EXPECT_EQ(store.place(2)->position.x_m, 4.0F);
  EXPECT_EQ(store.place(3), nullptr);
  EXPECT_FALSE(store.merge(place_at(2, 4.0F, 51.0, 4), 50.0));  // in the future
}

TEST(TrailStore, WhatCannotBeIsRefused) {
  MetricStore store({.ahead_max_s = 1.0});
  const float nan = std::numeric_limits<float>::quiet_NaN();
  Crumb bad = crumb_at(nan, 1.0F, 1.0, 0);
  EXPECT_EQ(store.merge(bad, 5.0), Fate::refused);
  EXPECT_EQ(store.merge(crumb_at(0.0F, -1.0F, 1.0, 0), 5.0), Fate::refused);
  EXPECT_EQ(store.merge(crumb_at(0.0F, nan, 1.0, 0), 5.0), Fate::refused);
  EXPECT_EQ(store.merge(crumb_at(0.0F, 1.0F, 6.5, 0), 5.0), Fate::refused);
  EXPECT_EQ(store.merge(crumb_at(0.0F, 1.0F, 1.0, 0, no_event), 5.0), Fate::refused);
  EXPECT_EQ(store.merge(crumb_at(0.0F, 1.0F, 6.0, 0), 5.0), Fate::taken);
  EXPECT_EQ(store.counts().refused, 5u);
  EXPECT_FALSE(store.merge(place_at(1, nan, 1.0, 0), 5.0));
  EXPECT_THROW(MetricStore({.crumbs_max = 0}), BrokenInvariant);
  EXPECT_THROW(MetricStore({.events_max = 0}), BrokenInvariant);
  EXPECT_THROW(MetricStore({.age_max_s = -1.0}), BrokenInvariant);
  EXPECT_THROW(MetricStore({.life_arrivals = 65}), BrokenInvariant);
  EXPECT_THROW(MetricStore({.ahead_max_s = -1.0}), BrokenInvariant);
}

std::vector<std::uint32_t> told(MetricStore& store, Cursor& cursor, const News& what,
                                double now_s) {
  std::vector<Crumb> crumbs;
  store.news(cursor, what, now_s, crumbs);
  std::vector<std::uint32_t> numbers;
  for (const Crumb& crumb : crumbs) numbers.push_back(crumb.identity.number);
  return numbers;
}

TEST(TrailStore, TellsWhatWasLearnedSinceInThatOrder) {
  using Numbers = std::vector<std::uint32_t>;
  MetricStore store({.robot = 0, .age_max_s = 45.0});
  double now_s = 10.0;
  const auto heard = [&](RobotId by, std::uint32_t number, RobotId from, double created_s) {
    Crumb crumb = crumb_at(0.0F, 1.0F, created_s, number);
    crumb.identity.robot = by;
    store.merge(crumb, now_s, from);
  };
  heard(0, 1, no_robot, 8.0);
  heard(1, 2, 1, 9.0);
  heard(0, 3, no_robot, 7.0);
  heard(2, 4, 1, 6.0);
  Cursor all, own, to_one, to_two;
  EXPECT_EQ(told(store, all, {.crumbs_max = 3}, now_s), (Numbers{1, 2, 3}));
  EXPECT_EQ(told(store, own, {.own_only = true}, now_s), (Numbers{1, 3}));
  EXPECT_EQ(told(store, to_one, {.to = 1}, now_s), (Numbers{1, 3}));  // it laid 2, and told of 4
  EXPECT_EQ(told(store, to_two, {.to = 2}, now_s), (Numbers{1, 2, 3}));
  now_s = 48.0;
  heard(1, 2, 2, 9.0);  // known: no news
  heard(3, 5, 3, 10.0);
  heard(3, 6, 3, 4.0);  // vanishes before it is told
  EXPECT_EQ(store.size(), 6u);
  now_s = 50.0;
  EXPECT_EQ(told(store, all, {}, now_s), (Numbers{4, 5}));
  EXPECT_EQ(told(store, all, {}, now_s), Numbers{});
  EXPECT_EQ(told(store, own, {.own_only = true}, now_s), Numbers{});
  EXPECT_EQ(told(store, to_one, {.to = 1}, now_s), Numbers{5});
}

TEST(TrailStore, ForgetsAllWhenItIsCleared) {
  MetricStore store({});
  Cursor cursor;
  store.merge(crumb_at(0.0F, 1.0F, 1.0, 0), 10.0);
  store.merge(crumb_at(0.0F, 1.0F, 2.0, 1), 10.0);
  store.merge(place_at(1, 0.0F, 1.0, 0), 10.0);
  EXPECT_EQ(told(store, cursor, {}, 50.0).size(), 2u);
  store.clear();
  EXPECT_EQ(store.size(), 0u);
  EXPECT_TRUE(store.places().empty());
  EXPECT_EQ(store.best(1, around(0.0F, 1.0), 50.0), nullptr);
  EXPECT_EQ(store.merge(crumb_at(0.0F, 1.0F, 1.0, 0), 50.0), Fate::taken);
  EXPECT_EQ(told(store, cursor, {}, 50.0).size(), 1u);
}

}  // namespace
}  // namespace hearsay::trails
