// Trails that went over the air: whatever the order, the repetitions and the cuts, what arrives is
// the same trail; and teams that share no frame share their trails.
#include <gtest/gtest.h>

#include <limits>

#include "filters/trails/codec.hpp"
#include "filters/trails/frames.hpp"
#include "filters/trails/laying.hpp"
#include "filters/trails/store.hpp"
#include "sim/math/functions.hpp"
#include "tests/filters/trails/samples.hpp"

namespace hearsay::trails {
namespace {

template <typename S>
void hear(TrailStore<S>& store, std::span<const std::byte> bytes, double now_s) {
  const auto packet = Packet<S>::parse(bytes);
  ASSERT_TRUE(packet);
  for (std::size_t i = 0; i < packet->places(); ++i) store.merge(packet->place(i), now_s);
  for (std::size_t i = 0; i < packet->crumbs(); ++i) {
    store.merge(packet->crumb(i), now_s, packet->head().sender);
  }
}

/// All crumbs in messages of random lengths, each with one or two of the places.
std::vector<std::vector<std::byte>> messages(Stream& random, std::span<const Crumb> crumbs,
                                             const std::vector<Place>& places) {
  std::vector<std::vector<std::byte>> packets;
  MetricEncoder encoder;
  std::size_t place = 0;
  while (!crumbs.empty() || place < places.size()) {
    const std::size_t count = std::min<std::size_t>(crumbs.size(), random.below(40));
    const std::size_t told = std::min<std::size_t>(1, places.size() - place);
    const std::size_t mtu = 150 + random.below(800);
    const auto message =
        encoder.encode({1, 0, 0, std::span(places).subspan(place, told), crumbs.first(count)}, mtu);
    packets.insert(packets.end(), message.begin(), message.end());
    crumbs = crumbs.subspan(count);
    place += told;
  }
  return packets;
}

void expect_the_same_in_any_order(const StoreOptions& options, std::size_t expected_dropped_least) {
  Stream random = stream("recompose");
  const std::vector<Crumb> crumbs = random_crumbs(random, 600, 30.0, 100.0);
  std::vector<Place> places;
  for (std::uint32_t i = 0; i < 25; ++i) {
    places.push_back({static_cast<EventId>(i % 3),
                      random_point(random, 30.0),
                      10.0 * std::floor(random.uniform(0.0, 5.0)),
                      {i % 4, 0, i}});
  }
  std::vector<Crumb> first;
  std::vector<Place> first_places;
  for (int round = 0; round < 12; ++round) {
    std::vector<Crumb> order = crumbs;
    std::vector<Place> place_order = places;
    if (round > 0) {
      shuffle(order, random);
      shuffle(place_order, random);
    }
    auto packets = messages(random, order, place_order);
    const std::size_t once = packets.size();
    for (std::size_t i = 0; i < once / 2; ++i) packets.push_back(packets[random.below(once)]);
    if (round > 0) shuffle(packets, random);
    MetricStore store(options);
    double now_s = 100.0;
    for (const auto& packet : packets) hear(store, packet, now_s += 1e-3);
    store.advance(102.0);
    if (round == 0) {
      first = content(store);
      first_places = {store.places().begin(), store.places().end()};
      EXPECT_GT(first.size(), 50u);
      EXPECT_GE(crumbs.size() - first.size(), expected_dropped_least);
      EXPECT_EQ(first_places.size(), 3u);
    }
    ASSERT_EQ(content(store), first) << round;
    ASSERT_TRUE(std::ranges::equal(store.places(), first_places)) << round;
  }
}

TEST(Recomposed, ATrailIsTheSameInAnyOrderRepetitionAndCut) {
  expect_the_same_in_any_order({.robot = 9, .age_max_s = 1000.0}, 0);
}
TEST(Recomposed, AlsoWhereCrumbsGrowOld) {
  expect_the_same_in_any_order({.robot = 9, .age_max_s = 60.5}, 50);
}
TEST(Recomposed, AlsoWhereTheStoreIsFull) {
  expect_the_same_in_any_order({.robot = 9, .crumbs_max = 123, .age_max_s = 1000.0}, 477);
}
TEST(Recomposed, AlsoWhereCrumbsVanishAfterArrivals) {
  expect_the_same_in_any_order({.robot = 9, .age_max_s = 1000.0, .life_arrivals = 5}, 20);
}

TEST(Recomposed, ALostPacketLeavesJustItsCrumbsUnsaid) {
  Stream random = stream("lost");
  const auto crumbs = random_crumbs(random, 100, 30.0, 100.0);
  MetricEncoder encoder;
  const auto packets = encoder.encode({1, 0, 0, {}, crumbs}, 400);
  ASSERT_GE(packets.size(), 4u);
  const std::size_t fit = crumbs_that_fit(2, 0, 400);
  MetricStore store({});
  for (std::size_t part = 0; part < packets.size(); ++part) {
    if (part != 2) hear(store, packets[part], 100.0);
  }
  std::vector<Crumb> expected = crumbs;
  expected.erase(expected.begin() + static_cast<std::ptrdiff_t>(2 * fit),
                 expected.begin() + static_cast<std::ptrdiff_t>(3 * fit));
  std::sort(expected.begin(), expected.end(),
            [](const Crumb& a, const Crumb& b) { return a.identity < b.identity; });
  EXPECT_EQ(content(store), expected);
}

TEST(Recomposed, ATrailOfViewsNeedsNoFrames) {
  TemporaryTrail<ViewSpace::Position> trail({.interval_s = 1.0});
  Numbering numbers(1);
  for (int i = 0; i < 20; ++i) {
    const double angle_rad = 0.1 * i;
    trail.lay(i, {static_cast<float>(math::cos(angle_rad)),
                  static_cast<float>(math::sin(angle_rad)), 0.1F});
  }
  Encoder<ViewSpace> encoder;
  TrailStore<ViewSpace> store({.robot = 2});
  for (const auto& packet : encoder.encode({1, 0, 0, {}, trail.complete(5, 20.0, numbers)}, 300)) {
    hear(store, packet, 20.0);
  }
  EXPECT_EQ(store.size(), 20u);
  // A look ahead: of the similar ones, the farthest on. cos 0.4 < 0.95 < cos 0.3.
  const auto* best = store.best(5, {{1.0F, 0.0F, 0.1F}, 0.95}, 20.0);
  ASSERT_NE(best, nullptr);
  EXPECT_EQ(best->distance_s, 17.0F);
  EXPECT_EQ(store.best(5, {{0.0F, 0.0F, -1.0F}, 0.95}, 20.0), nullptr);
}

/// Robot 1 walks from A to B and tells; robot 2 has another frame.
struct Team {
  Similarity into_two{1.1 * math::cos(2.0), 1.1 * math::sin(2.0), 30.0, -5.0};
  MetricStore one{{.robot = 1}}, two{{.robot = 2}};
  std::vector<std::vector<std::byte>> packets;

  Team() {
    one.merge(Place{0, {0.0F, 0.0F}, 0.0, {1, 0, 100}}, 0.0);
    TemporaryTrail<Point> trail({.interval_s = 2.0});
    for (int step = 0; step < 160; ++step) trail.lay(step, point(0.25 * step, 0.0));
    Numbering numbers(1);
    for (const Crumb& crumb : trail.complete(1, 160.0, numbers)) one.merge(crumb, 160.0);
    one.merge(Place{1, {40.0F, 0.0F}, 160.0, {1, 0, 101}}, 160.0);
    std::vector<Crumb> news;
    Cursor cursor;
    one.news(cursor, {.own_only = true}, 160.0, news);
    MetricEncoder encoder;
    const auto encoded = encoder.encode({1, 0, 0, one.places(), news}, 1400);
    packets.assign(encoded.begin(), encoded.end());
  }
  /// What robot 2 knows of a place.
  void knows(EventId event, const Point& in_one) {
    two.merge(Place{event, into_two.apply(in_one), 10.0, {2, 0, event}}, 10.0);
  }
  int received(const AlignOptions& options) {
    int dropped = 0;
    for (const auto& bytes : packets) {
      const auto packet = MetricPacket::parse(bytes);
      std::vector<Place> places;
      for (std::size_t i = 0; i < packet->places(); ++i) places.push_back(packet->place(i));
      std::vector<PointPair> pairs;
      common_places(places, two.places(), pairs);
      const auto alignment = align(pairs, options);
      dropped += !alignment;
      if (!alignment) continue;
      for (const Place& place : places) two.merge(mapped(place, alignment->map), 161.0);
      for (std::size_t i = 0; i < packet->crumbs(); ++i) {
        two.merge(mapped(packet->crumb(i), alignment->map), 161.0, 1);
      }
    }
    return dropped;
  }
};

TEST(Recomposed, ARobotWithAnotherFrameFollowsTheTrailToTheEvent) {
  Team team;
  team.knows(0, {0.0F, 0.0F});
  team.knows(1, {40.0F, 0.0F});
  EXPECT_EQ(team.received({}), 0);
  ASSERT_EQ(team.two.size(), 80u);
  Point at = team.into_two.apply({0.2F, 0.3F});
  double last_s = 1e9;
  for (int step = 0; step < 1000; ++step) {
    const Crumb* best = team.two.best(1, {at, 1.0}, 161.0);
    ASSERT_NE(best, nullptr);
    ASSERT_LE(best->distance_s, last_s);
    last_s = best->distance_s;
    if (last_s <= 2.0) break;
    at = best->position;
  }
  EXPECT_EQ(last_s, 2.0);
  const Point goal = team.two.place(1)->position;
  EXPECT_LT(math::hypot(at.x_m - goal.x_m, at.y_m - goal.y_m), 2.0);
}

TEST(Recomposed, ARobotThatKnowsTooFewPlacesDropsTheTrailOrTranslatesIt) {
  Team careful;
  careful.knows(0, {0.0F, 0.0F});
  EXPECT_EQ(careful.received({}), static_cast<int>(careful.packets.size()));
  EXPECT_EQ(careful.two.size(), 0u);
  Team bold;
  bold.knows(0, {0.0F, 0.0F});
  EXPECT_EQ(bold.received({.optimistic = true}), 0);
  EXPECT_EQ(bold.two.size(), 80u);
  const Point start = bold.into_two.apply({0.0F, 0.0F});
  const Crumb* first = bold.two.best(1, {start, 0.1}, 161.0);
  ASSERT_NE(first, nullptr);  // right where both know the place, and turned away from there on
  EXPECT_EQ(first->distance_s, 160.0F);
}

}  // namespace
}  // namespace hearsay::trails
