#include "agents/talk/policy.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace hearsay {
namespace {

TEST(TalkPolicy, PeriodicTalksAtEveryTickWhateverHappens) {
  TalkPolicy policy({.kind = TalkPolicyKind::periodic});
  for (const std::size_t waiting : {0u, 1u, 100u}) {
    const auto decision = policy.decide({.waiting = waiting});
    EXPECT_TRUE(decision.talks);
    EXPECT_EQ(decision.ticks, 1u);
  }
}

TEST(TalkPolicy, OnUpdateTalksOnlyAboutWhatItMeasured) {
  TalkPolicy policy({.kind = TalkPolicyKind::on_update});
  EXPECT_FALSE(policy.decide({.measured = false, .divergence_nats = 9.0}).talks);
  EXPECT_TRUE(policy.decide({.measured = true}).talks);
}

TEST(TalkPolicy, EventTriggeredTalksBeyondItsThreshold) {
  TalkPolicy policy({.kind = TalkPolicyKind::event_triggered, .divergence_nats = 0.5});
  EXPECT_FALSE(policy.decide({.measured = true, .divergence_nats = 0.5}).talks);
  EXPECT_TRUE(policy.decide({.divergence_nats = 0.51}).talks);
  EXPECT_TRUE(policy.decide({.divergence_nats = std::numeric_limits<double>::infinity()}).talks);
}

TEST(TalkPolicy, AdaptiveDoublesItsPeriodWhileTheQueueIsFullAndComesBack) {
  TalkPolicy policy({.kind = TalkPolicyKind::adaptive});
  EXPECT_TRUE(policy.decide({}).talks);
  std::vector<std::uint64_t> ticks;
  for (int i = 0; i < 8; ++i) {
    const auto decision = policy.decide({.waiting = 1});
    EXPECT_FALSE(decision.talks);
    ticks.push_back(decision.ticks);
  }
  EXPECT_EQ(ticks, (std::vector<std::uint64_t>{2, 4, 8, 16, 32, 64, 64, 64}));
  ticks.clear();
  for (int i = 0; i < 8; ++i) {
    const auto decision = policy.decide({});
    EXPECT_TRUE(decision.talks);
    ticks.push_back(decision.ticks);
  }
  EXPECT_EQ(ticks, (std::vector<std::uint64_t>{32, 16, 8, 4, 2, 1, 1, 1}));
}

}  // namespace
}  // namespace hearsay
