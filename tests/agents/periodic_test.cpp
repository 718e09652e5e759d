#include "agents/talk/periodic.hpp"

#include <gtest/gtest.h>

#include <set>

namespace hearsay {
namespace {

TEST(PeriodicTalk, StaggeredAgentsSpeakOneAfterAnother) {
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(talk_phase(TalkPhase::staggered, 5_s, i, 5, 1), 1_s * i);
  }
  // A period that the number of agents does not divide: rounded down to the nanosecond.
  EXPECT_EQ(talk_phase(TalkPhase::staggered, 10_ns, 1, 3, 1), 3_ns);
  EXPECT_EQ(talk_phase(TalkPhase::staggered, 10_ns, 2, 3, 1), 6_ns);
}

TEST(PeriodicTalk, TogetherAllSpeakAtOnce) {
  for (int i = 0; i < 5; ++i) EXPECT_EQ(talk_phase(TalkPhase::together, 5_s, i, 5, 1), 0_ns);
}

TEST(PeriodicTalk, RandomPhasesAreInsideThePeriodAndDifferByAgentAndSeed) {
  std::set<std::int64_t> phases;
  for (int i = 0; i < 50; ++i) {
    for (std::uint64_t seed = 1; seed <= 2; ++seed) {
      const Duration phase = talk_phase(TalkPhase::random, 5_s, i, 50, seed);
      EXPECT_GE(phase, 0_ns);
      EXPECT_LT(phase, 5_s);
      phases.insert(phase.nanoseconds());
    }
  }
  EXPECT_EQ(phases.size(), 100u);
}

TEST(PeriodicTalk, TickKComesKPeriodsAfterThePhase) {
  const PeriodicTalk talk{.period = 5_s, .phase = 2_s};
  EXPECT_EQ(talk.tick(0), Time::at(2_s));
  EXPECT_EQ(talk.tick(7), Time::at(37_s));
}

}  // namespace
}  // namespace hearsay
