#include "net/link_states.hpp"

#include <gtest/gtest.h>

#include "link_causes.hpp"
#include "net/random_graphs.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

Time ns(std::int64_t n) { return Time::nanoseconds(n); }

std::size_t link(const Topology& topology, AgentId from, AgentId to) {
  return static_cast<std::size_t>(topology.link(from, to));
}

TEST(LinkStates, WithoutChangesEveryLinkIsUpForEver) {
  const Topology line = Topology::line(3);
  LinkStates states(line, {});
  EXPECT_EQ(states.next_change(), Time::never());
  states.advance(ns(5));
  for (std::size_t i = 0; i < line.links(); ++i) {
    EXPECT_TRUE(states.up(i));
    EXPECT_TRUE(states.up_since(i, Time()));
  }
}

TEST(LinkStates, BothDirectionsChangeAtOnce) {
  const LinkPlan plan = plan_links(Topology::line(3), {.outages = {{1, 2, ns(3), ns(5)}}});
  LinkStates states(plan.topology, plan.changes);
  EXPECT_EQ(states.next_change(), ns(3));
  EXPECT_TRUE(states.up(link(plan.topology, 1, 2)));
  states.advance(ns(3));
  EXPECT_FALSE(states.up(link(plan.topology, 1, 2)));
  EXPECT_FALSE(states.up(link(plan.topology, 2, 1)));
  EXPECT_TRUE(states.up(link(plan.topology, 0, 1)));
  EXPECT_EQ(states.next_change(), ns(5));
  states.advance(ns(9));
  EXPECT_TRUE(states.up(link(plan.topology, 2, 1)));
  EXPECT_EQ(states.next_change(), Time::never());
}

TEST(LinkStates, WhatIsDownAtTheStartIsDownBeforeTheFirstStep) {
  const LinkPlan plan = plan_links(Topology::line(2), {.outages = {{0, 1, Time(), ns(5)}}});
  const LinkStates states(plan.topology, plan.changes);
  EXPECT_FALSE(states.up(0));
  EXPECT_EQ(states.next_change(), ns(5));
}

TEST(LinkStates, AnInterruptionIsRememberedThoughItIsOver) {
  const LinkPlan plan = plan_links(Topology::line(2), {.outages = {{0, 1, ns(3), ns(5)}}});
  LinkStates states(plan.topology, plan.changes);
  states.advance(ns(2));
  EXPECT_TRUE(states.up_since(0, Time()));
  states.advance(ns(4));
  EXPECT_FALSE(states.up_since(0, ns(4)));
  states.advance(ns(7));
  EXPECT_FALSE(states.up_since(0, ns(2)));
  EXPECT_FALSE(states.up_since(0, ns(4)));
  EXPECT_TRUE(states.up_since(0, ns(5)));
  EXPECT_TRUE(states.up_since(0, ns(6)));
}

TEST(LinkStates, AreWhatEachCauseSaysAtEachInstant) {
  constexpr int agents = 6, last = 50;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    Dice dice(seed);
    const LinkCauses causes = random_causes(agents, last, dice);
    const LinkPlan plan = plan_links(erdos_renyi(agents, 0.6, seed), causes);
    LinkStates states(plan.topology, plan.changes);
    for (int now = 0; now <= 2 * last; now += 1 + dice.below(4)) {
      states.advance(ns(now));
      EXPECT_GT(states.next_change(), ns(now));
      const int since = dice.below(now + 1);
      for (AgentId a = 0; a < agents; ++a) {
        for (const AgentId b : plan.topology.neighbours(a)) {
          const std::size_t i = link(plan.topology, a, b);
          EXPECT_EQ(states.up(i), allowed(causes, a, b, ns(now)));
          bool throughout = true;
          for (int t = since; t <= now; ++t) throughout &= allowed(causes, a, b, ns(t));
          EXPECT_EQ(states.up_since(i, ns(since)), throughout) << since << " … " << now;
        }
      }
    }
  }
}

TEST(LinkStates, WhatCannotBeIsABrokenInvariant) {
  const Topology line = Topology::line(3);
  const std::vector<LinkChange> foreign{{ns(4), 0, 2, false}};
  LinkStates states(line, foreign);
  EXPECT_THROW(states.advance(ns(4)), BrokenInvariant);
  const std::vector<LinkChange> changes{{ns(4), 0, 1, false}};
  LinkStates others(line, changes);
  others.advance(ns(6));
  EXPECT_THROW(others.advance(ns(5)), BrokenInvariant);
}

}  // namespace
}  // namespace hearsay
