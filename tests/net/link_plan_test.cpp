#include "net/link_plan.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>
#include <string>
#include <utility>

#include "graphs.hpp"
#include "link_causes.hpp"
#include "net/random_graphs.hpp"

namespace hearsay {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

Time at(std::int64_t s) { return Time::at(Duration::nanoseconds(s * 1'000'000'000)); }

// A change in short: "3 down 0-1".
std::string text(const LinkChange& change) {
  return std::to_string(change.time.nanoseconds() / 1'000'000'000) +
         (change.up ? " up " : " down ") + std::to_string(change.a) + "-" +
         std::to_string(change.b);
}

std::vector<std::string> texts(const LinkPlan& plan) {
  std::vector<std::string> all;
  for (const LinkChange& change : plan.changes) all.push_back(text(change));
  return all;
}

std::vector<std::string> changes(Topology topology, const LinkCauses& causes) {
  return texts(plan_links(std::move(topology), causes));
}

void expect_in_order(const LinkPlan& plan) {
  EXPECT_TRUE(std::is_sorted(plan.changes.begin(), plan.changes.end()));
  std::map<Pair, LinkChange> before;
  for (const LinkChange& change : plan.changes) {
    ASSERT_LT(change.a, change.b);
    EXPECT_GE(plan.topology.link(change.a, change.b), 0);
    const auto [last, first] = before.try_emplace({change.a, change.b}, change);
    if (first) {
      EXPECT_FALSE(change.up);
    } else {
      EXPECT_NE(change.up, last->second.up);
      EXPECT_GT(change.time, last->second.time);
      last->second = change;
    }
  }
}

bool up_by_plan(const LinkPlan& plan, AgentId a, AgentId b, Time time) {
  bool up = true;
  for (const LinkChange& change : plan.changes) {
    if (change.time <= time && Pair{change.a, change.b} == Pair{a, b}) up = change.up;
  }
  return up;
}

TEST(LinkPlan, WithoutCausesNothingChanges) {
  const LinkPlan plan = plan_links(Topology::ring(5), {});
  EXPECT_EQ(edges_of(plan.topology), edges_of(Topology::ring(5)));
  EXPECT_THAT(plan.changes, IsEmpty());
}

TEST(LinkPlan, AnOutageTakesItsLinkDownAndUp) {
  LinkCauses causes{.outages = {{2, 1, at(3), at(5)}, {0, 1, at(0)}}};
  EXPECT_THAT(changes(Topology::line(3), causes),
              ElementsAre("0 down 0-1", "3 down 1-2", "5 up 1-2"));
}

TEST(LinkPlan, OverlappingOutagesAreCounted) {
  LinkCauses causes{.outages = {{0, 1, at(1), at(4)}, {1, 0, at(2), at(6)}, {0, 1, at(6), at(7)}}};
  EXPECT_THAT(changes(Topology::line(2), causes), ElementsAre("1 down 0-1", "7 up 0-1"));
}

TEST(LinkPlan, AnOutageOfNoLinkChangesNothing) {
  LinkCauses causes{.outages = {{0, 2, at(1), at(4)}, {1, 1, at(1), at(2)}}};
  EXPECT_THAT(changes(Topology::line(3), causes), IsEmpty());
}

TEST(LinkPlan, APartitionCutsBetweenGroupsAndHeals) {
  LinkCauses causes{.partitions = {{{{0, 1}, {2, 3}}, at(10), at(20)}}};
  EXPECT_THAT(changes(Topology::ring(4), causes),
              ElementsAre("10 down 0-3", "10 down 1-2", "20 up 0-3", "20 up 1-2"));
}

TEST(LinkPlan, ARotationCutsOffOneGroupAfterTheOther) {
  LinkCauses causes{.rotations = {{{{0}, {1}, {2}}, 10_s, 10_s, at(5), at(38)}}};
  // 0 from 5, 1 from 15, 2 from 25, 0 again from 35 to the end at 38.
  EXPECT_THAT(changes(Topology::full(3), causes),
              ElementsAre("5 down 0-1", "5 down 0-2", "15 up 0-2", "15 down 1-2", "25 up 0-1",
                          "25 down 0-2", "35 down 0-1", "35 up 1-2", "38 up 0-1", "38 up 0-2"));
}

TEST(LinkPlan, ARotationMayLeaveTheNetworkWholeInBetween) {
  LinkCauses causes{.rotations = {{{{0}, {1}}, 10_s, 4_s, at(0), at(16)}}};
  EXPECT_THAT(changes(Topology::line(2), causes),
              ElementsAre("0 down 0-1", "4 up 0-1", "10 down 0-1", "14 up 0-1"));
}

TEST(LinkPlan, TheOtherGroupsOfARotationHearOneAnother) {
  LinkCauses causes{.rotations = {{{{0}, {1}, {2}}, 10_s, 10_s, at(0), at(10)}}};
  EXPECT_THAT(changes(Topology::full(3), causes),
              ElementsAre("0 down 0-1", "0 down 0-2", "10 up 0-1", "10 up 0-2"));
}

TEST(LinkPlan, AContactIsFromUpToDown) {
  const std::vector<LinkChange> trace{{at(0), 0, 1, true},
                                      {at(2), 1, 2, true},
                                      {at(3), 0, 1, false},
                                      {at(3), 1, 2, false},
                                      {at(4), 1, 2, true}};
  const LinkPlan plan = plan_contacts(4, trace, {});
  EXPECT_EQ(plan.topology.agents(), 4);
  EXPECT_EQ(edges_of(plan.topology), (std::set<Pair>{{0, 1}, {1, 2}}));
  EXPECT_THAT(texts(plan),
              ElementsAre("0 down 1-2", "2 up 1-2", "3 down 0-1", "3 down 1-2", "4 up 1-2"));
}

TEST(LinkPlan, AContactThatIsBrokenForNoTimeGoesOn) {
  const std::vector<LinkChange> trace{
      {at(1), 0, 1, true}, {at(3), 0, 1, false}, {at(3), 0, 1, true}, {at(5), 0, 1, false}};
  EXPECT_THAT(texts(plan_contacts(2, trace, {})),
              ElementsAre("0 down 0-1", "1 up 0-1", "5 down 0-1"));
}

TEST(LinkPlan, IsWhatEachCauseSaysAtEachInstant) {
  constexpr int agents = 7, last = 60;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    Dice dice(seed);
    const LinkCauses causes = random_causes(agents, last, dice);
    const bool traced = dice.below(2) == 0;
    const auto trace = random_trace(agents, last, dice);
    const Topology graph = erdos_renyi(agents, 0.6, seed);
    const LinkPlan plan = traced ? plan_contacts(agents, trace, causes) : plan_links(graph, causes);
    expect_in_order(plan);
    for (AgentId a = 0; a < agents; ++a) {
      for (AgentId b = a + 1; b < agents; ++b) {
        const bool joined = plan.topology.link(a, b) >= 0;
        if (!traced) {
          EXPECT_EQ(joined, graph.link(a, b) >= 0);
        }
        for (int ns = 0; ns <= 2 * last + 2; ++ns) {
          const Time time = Time::nanoseconds(ns);
          const bool possible = traced ? in_contact(trace, a, b, time) : joined;
          EXPECT_EQ(joined && up_by_plan(plan, a, b, time), possible && allowed(causes, a, b, time))
              << a << "-" << b << " at " << ns;
        }
      }
    }
  }
}

TEST(LinkPlan, KeepsTheLengthsOfLinks) {
  const PlacedGraph graph = random_geometric(10, {.side_m = 10.0, .range_m = 5.0}, 1);
  const LinkPlan plan = plan_links(graph.topology, {.outages = {{0, 1, at(1), at(2)}}});
  EXPECT_TRUE(plan.topology.has_lengths());
}

TEST(LinkPlan, BadCausesAreNamed) {
  const auto message = [](LinkCauses causes) {
    return message_of([&] { plan_links(Topology::full(3), causes); });
  };
  EXPECT_EQ(message({.outages = {{0, 3, at(1), at(2)}}}), "there is no agent 3 (agents are 0 … 2)");
  EXPECT_EQ(message({.outages = {{0, 1, at(2), at(2)}}}),
            "an outage from 2.000000 s until 2.000000 s must begin at 0 or later, and end after it "
            "began");
  EXPECT_EQ(message({.partitions = {{{{0, 1}}, at(1), at(2)}}}), "agent 2 stands in no group");
  EXPECT_EQ(message({.partitions = {{{{0, 1}, {2, 0}}, at(1), at(2)}}}),
            "agent 0 stands in groups twice");
  EXPECT_EQ(message({.partitions = {{{{0, 1, 2}, {-1}}, at(1), at(2)}}}),
            "there is no agent -1 (agents are 0 … 2)");
  const Groups each{{0}, {1}, {2}};
  EXPECT_EQ(
      message({.rotations = {{each, 1_s, 2_s, at(0), at(9)}}}),
      "a rotation cuts off for more than 0 and at most its period of 1.000000 s, not 2.000000 "
      "s");
  EXPECT_THAT(message({.rotations = {{each, 1_s, 1_s, at(9), at(9)}}}),
              testing::StartsWith("a rotation from 9.000000 s until 9.000000 s must"));
}

TEST(LinkPlan, TooManyChangesAreRefusedBeforeTheyAreMade) {
  const Groups each{{0}, {1}, {2}};
  const auto message = [&](Duration period, Time until) {
    const LinkCauses causes{.rotations = {{each, period, period, Time(), until}}};
    return message_of([&] { plan_links(Topology::full(3), causes); });
  };
  EXPECT_EQ(message(1_ns, Time::nanoseconds(INT64_MAX)),
            "links change too often: more than 10000000 changes in a run");
  EXPECT_EQ(message(1_ns, at(1)), "links change too often: more than 10000000 changes in a run");
  // Nobody has a link to lose: however often, it costs nothing.
  const LinkCauses causes{.rotations = {{each, 1_ns, 1_ns, Time(), at(1'000'000'000)}}};
  EXPECT_THAT(changes(Topology::edges(3, {}), causes), IsEmpty());
}

}  // namespace
}  // namespace hearsay
