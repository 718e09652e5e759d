#include "net/places.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "sim/kernel/error.hpp"
#include "sim/kernel/random.hpp"

namespace hearsay {
namespace {

constexpr Time never = Time::never();

std::vector<Nearby> copy(std::span<const Nearby> found) { return {found.begin(), found.end()}; }
std::vector<AgentId> who(std::span<const Nearby> found) {
  std::vector<AgentId> all;
  for (const Nearby& n : found) all.push_back(n.agent);
  return all;
}
using Agents = std::vector<AgentId>;

Leg still(const Point& place_m) { return {.from_m = place_m}; }

TEST(Places, ReachIsInclusiveAndInThreeDimensions) {
  Places places(6, 13.0, 0.0);
  places.set(0, still({0, 0, 0}), Time());
  places.set(1, still({3, 4, 12}), Time());
  places.set(2, still({-12, 5, 0}), Time());
  places.set(3, still({-12, 5, 1e-6}), Time());
  places.set(4, still({0, std::nextafter(13.0, 14.0), 0}), Time());
  places.set(5, still({5, 5, -20}), Time());
  const auto found = copy(places.near(0, Time()));
  EXPECT_EQ(who(found), (Agents{1, 2}));
  EXPECT_EQ(found[0].squared_distance_m2, 169.0);
  EXPECT_EQ(who(places.around({0, 0, 0}, 13.0, Time())), (Agents{0, 1, 2}));
  EXPECT_EQ(who(places.around({5, 5, -19}, 1.0, Time())), (Agents{5}));
  EXPECT_EQ(who(places.around({0, 0, 0}, 1e9, Time())), (Agents{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(who(places.around({1e300, 0, 0}, 1e9, Time())), Agents{});
  EXPECT_EQ(who(places.around({3, 4, 12}, 0.0, Time())), Agents{1});
}

TEST(Places, OneAgentIsAlone) {
  Places places(1, 100.0, 1.0);
  places.set(0, still({7, 7, 0}), Time());
  EXPECT_TRUE(places.near(0, Time()).empty());
  EXPECT_EQ(places.at(0, Time::at(1_s)), (Point{7, 7, 0}));
}

TEST(Places, WhoHasNoLegYetIsNowhere) {
  Places places(3, 100.0, 1.0);
  places.set(1, still({0, 0, 0}), Time());
  EXPECT_TRUE(places.near(1, Time()).empty());
  EXPECT_EQ(who(places.around({0, 0, 0}, 1e9, Time())), Agents{1});
  EXPECT_THROW(places.near(0, Time()), BrokenInvariant);
}

TEST(Places, ManyInOnePlaceFindEachOtherByNumber) {
  constexpr int crowd = 100;
  Places places(crowd, 1.0, 0.5);
  Agents all;
  for (AgentId a = crowd - 1; a >= 0; --a) places.set(a, still({-3, 5, 1}), Time());
  for (AgentId a = 0; a < crowd; ++a) all.push_back(a);
  for (AgentId a = 0; a < crowd; a += 7) {
    Agents others = all;
    others.erase(others.begin() + a);
    EXPECT_EQ(who(places.near(a, Time())), others);
  }
  // They leave one by one.
  for (AgentId a = 0; a < crowd - 1; ++a) {
    places.set(a, still({10.0 * a, -20, 0}), Time());
    all.erase(all.begin());
    ASSERT_EQ(who(places.around({-3, 5, 1}, 0.5, Time())), all);
  }
}

TEST(Places, AnEntryHoldsUntilItsSlackIsUsedUp) {
  Places places(3, 10.0, 2.0);
  places.set(0, still({0, 0, 0}), Time());
  // 2 m at 5 m/s take 0.4 s.
  const Leg leg{.end = Time::at(1_s), .from_m = {-12, 0, 0}, .velocity_m_per_s = {3, 4, 7}};
  EXPECT_EQ(places.set(1, leg, Time()), Time::at(400_ms));
  EXPECT_EQ(places.refresh(1, Time::at(400_ms)), Time::at(800_ms));
  EXPECT_EQ(places.refresh(1, Time::at(800_ms)), Time::at(1_s)) << "the leg ends before";
  EXPECT_EQ(places.refresh(0, Time::at(5_s)), never);
  // Straight down.
  EXPECT_EQ(places.set(2, {.velocity_m_per_s = {0, 0, -9}}, Time()), never);
  // So fast that a nanosecond is farther than the slack.
  EXPECT_EQ(places.set(1, {.velocity_m_per_s = {1e11, 0, 0}}, Time()), Time::nanoseconds(1));
}

TEST(Places, AtTheLastMomentEverybodyIsStillFound) {
  // Towards and away from cells' borders, at a grazing distance, for many slacks and places.
  Stream stream(3, Purpose("places"), Entity::agent(0));
  for (int round = 0; round < 20'000; ++round) {
    const double reach_m = stream.uniform(1.0, 50.0);
    Places places(2, reach_m, stream.uniform(0.01, 30.0));
    const double angle = stream.uniform(0.0, 6.3);
    const Leg leg{
        .from_m = {stream.uniform(-99, 99), stream.uniform(-99, 99), 0},
        .velocity_m_per_s = {std::cos(angle) * 10, std::sin(angle) * 10, 0},
    };
    const Time until = places.set(1, leg, Time());
    const Point there = leg.at(until);
    const double direction = stream.uniform(0.0, 6.3);
    const double near_m = reach_m * (1.0 - 1e-9), far_m = reach_m * (1.0 + 1e-9);
    const Point inside{there[0] + near_m * std::cos(direction),
                       there[1] + near_m * std::sin(direction), 0};
    const Point outside{there[0] + far_m * std::cos(direction),
                        there[1] + far_m * std::sin(direction), 0};
    ASSERT_EQ(who(places.around(inside, reach_m, until)), Agents{1}) << round;
    ASSERT_EQ(who(places.around(outside, reach_m, until)), Agents{}) << round;
  }
}

TEST(Places, FarFromTheOriginAsExactAsCoordinatesAre) {
  for (const double far_m : {1e6, 1e9, 1e12, -1e12}) {
    for (const double reach_m : {1e-3, 1.0, 100.0}) {
      constexpr int agents = 300;
      Places places(agents, reach_m, reach_m / 4);
      Stream stream(4, Purpose("places"), Entity::agent(0));
      std::vector<Point> at(agents);
      for (AgentId a = 0; a < agents; ++a) {
        Point& p = at[static_cast<std::size_t>(a)];
        p = {far_m + 10 * reach_m * stream.uniform(), 10 * reach_m * stream.uniform() - far_m, 0};
        places.set(a, still(p), Time());
      }
      for (AgentId a = 0; a < agents; ++a) {
        Agents expected;
        for (AgentId b = 0; b < agents; ++b) {
          const double d2 =
              squared_distance_m2(at[static_cast<std::size_t>(a)], at[static_cast<std::size_t>(b)]);
          if (b != a && d2 <= reach_m * reach_m) expected.push_back(b);
        }
        ASSERT_EQ(who(places.near(a, Time())), expected) << far_m << " " << reach_m;
      }
    }
  }
}

TEST(Places, WhoWasFiledWhenAndHowMuchSlackThereIsChangesNothing) {
  constexpr int agents = 60;
  Stream stream(5, Purpose("places"), Entity::agent(0));
  std::vector<Leg> legs;
  for (int a = 0; a < agents; ++a) {
    legs.push_back({.from_m = {stream.uniform(0, 50), stream.uniform(0, 50), stream.uniform(0, 9)},
                    .velocity_m_per_s = {stream.normal(), stream.normal(), 0}});
  }
  Places one(agents, 12.0, 1.0), other(agents, 12.0, 100.0);
  for (AgentId a = 0; a < agents; ++a) {
    one.set(a, legs[static_cast<std::size_t>(a)], Time());
    other.set(agents - 1 - a, legs[static_cast<std::size_t>(agents - 1 - a)], Time());
  }
  for (AgentId a = agents - 1; a >= 0; --a) one.refresh(a, Time::at(9_s));
  const auto bits = [](const Nearby& n) { return std::pair(n.agent, n.squared_distance_m2); };
  for (AgentId a = 0; a < agents; ++a) {
    const auto found = copy(one.near(a, Time::at(9_s)));
    const auto also = copy(other.near(a, Time::at(9_s)));
    ASSERT_TRUE(std::equal(found.begin(), found.end(), also.begin(), also.end(),
                           [&](const Nearby& n, const Nearby& m) { return bits(n) == bits(m); }));
    for (const Nearby& n : found) {
      const auto back = copy(one.near(n.agent, Time::at(9_s)));
      const auto me = std::find_if(back.begin(), back.end(), [&](auto& m) { return m.agent == a; });
      ASSERT_NE(me, back.end());
      ASSERT_EQ(me->squared_distance_m2, n.squared_distance_m2);
    }
  }
}

TEST(Places, RefusesWhatCannotBe) {
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_THROW(Places(0, 1.0, 1.0), InputError);
  EXPECT_THROW(Places(10'000'001, 1.0, 1.0), InputError);
  EXPECT_THROW(Places(1, 0.0, 1.0), InputError);
  EXPECT_THROW(Places(1, infinity, 1.0), InputError);
  EXPECT_THROW(Places(1, 1.0, -1.0), InputError);
  EXPECT_THROW(Places(1, 1.0, std::nan("")), InputError);
  Places places(1, 1.0, 0.0);
  EXPECT_THROW(places.set(1, still({}), Time()), BrokenInvariant);
  EXPECT_THROW(places.set(-1, still({}), Time()), BrokenInvariant);
  EXPECT_THROW(places.set(0, still({2e13, 0, 0}), Time()), BrokenInvariant);
  EXPECT_THROW(places.set(0, still({0, std::nan(""), 0}), Time()), BrokenInvariant);
  EXPECT_THROW(places.set(0, {.velocity_m_per_s = {1, 0, 0}}, Time()), BrokenInvariant);
  const Leg later{.begin = Time::at(1_s), .end = Time::at(2_s)};
  EXPECT_THROW(places.set(0, later, Time()), BrokenInvariant);
  EXPECT_THROW(places.set(0, later, Time::at(2_s)), BrokenInvariant);
  places.set(0, later, Time::at(1_s));
  EXPECT_THROW(places.near(0, Time::at(3_s)), BrokenInvariant);
  EXPECT_THROW(places.around({}, -1.0, Time::at(1_s)), InputError);
  EXPECT_THROW(places.around({infinity, 0, 0}, 1.0, Time::at(1_s)), BrokenInvariant);
}

}  // namespace
}  // namespace hearsay
