// An estimator that another process saved goes on where that one stood.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "agents/estimators/gaussian.hpp"
#include "sim/kernel/random.hpp"

namespace hearsay {
namespace {

using gaussian::Belief;
using gaussian::Rule;

/// Two agents that measure two states of two numbers each, and talk.
class Talk {
 public:
  explicit Talk(Rule rule)
      : options_{.rule = rule, .subjects = 2, .dimension = 2, .ledgers = &pool_},
        a_(options_, std::array<AgentId, 1>{1}),
        b_(options_, std::array<AgentId, 1>{0}) {}

  void measure(GaussianEstimator& estimator, int subject) {
    Belief information = Belief::unknown(2);
    const double x = draws_.uniform(), y = draws_.uniform();
    information.omega << 1.0 + x, 0.1, 0.1, 2.0 + y;
    information.xi << 10.0 * x, 5.0 * y;
    estimator.measured(subject, information, measurements_++);
  }
  void say(GaussianEstimator& from, AgentId me, AgentId to,
           std::vector<GaussianEstimator*> hearers) {
    for (GaussianEstimator* hearer : hearers) hearer->about_to_talk(1);
    from.about_to_talk(1);
    const bool each = gaussian::info(from.rule()).sends == gaussian::Sends::belief_less_heard;
    const auto speech = from.speech(each ? to : no_agent);
    from.sent(each ? to : no_agent);
    const std::vector<std::byte> bytes(speech.bytes.begin(), speech.bytes.end());
    for (GaussianEstimator* hearer : hearers) hearer->heard(me, bytes, speech.rider.get());
  }
  GaussianEstimator& a() { return a_; }
  GaussianEstimator& b() { return b_; }
  GaussianEstimator another() { return GaussianEstimator(options_, std::array<AgentId, 1>{1}); }

 private:
  LedgerPool pool_;
  GaussianEstimator::Options options_;
  GaussianEstimator a_, b_;
  Stream draws_ = Stream(1, Purpose("memory test"), Entity::agent(0));
  std::size_t measurements_ = 0;
};

void expect_same(const GaussianEstimator& x, const GaussianEstimator& y) {
  for (int s = 0; s < 2; ++s) {
    EXPECT_EQ(x.tracked(s).belief.omega, y.tracked(s).belief.omega);
    EXPECT_EQ(x.tracked(s).belief.xi, y.tracked(s).belief.xi);
    const auto weights = x.tracked(s).ledger.weights(), others = y.tracked(s).ledger.weights();
    EXPECT_TRUE(std::equal(weights.begin(), weights.end(), others.begin(), others.end()));
  }
}

/// Each of A's and B's first words to the other, some lost on the way.
void talk_for_a_while(Talk& talk) {
  for (int round = 0; round < 6; ++round) {
    talk.measure(talk.a(), round % 2);
    talk.measure(talk.b(), 1 - round % 2);
    if (round != 2) talk.say(talk.a(), 0, 1, {&talk.b()});
    if (round != 4) talk.say(talk.b(), 1, 0, {&talk.a()});
  }
}

TEST(GaussianMemory, WhoRecallsItGoesOnLikeWhoKeptIt) {
  for (const gaussian::RuleInfo& rule : gaussian::rules()) {
    if (rule.sends == gaussian::Sends::nothing) continue;
    SCOPED_TRACE(rule.name);
    Talk talk(rule.rule);
    talk_for_a_while(talk);
    std::vector<std::byte> memory;
    ASSERT_TRUE(talk.a().save(memory));
    GaussianEstimator heir = talk.another();
    ASSERT_TRUE(heir.recall(memory));
    expect_same(talk.a(), heir);
    ASSERT_GT(talk.a().counts().fusions, 0u);
    for (int round = 0; round < 4; ++round) {
      talk.measure(talk.b(), round % 2);
      talk.say(talk.b(), 1, 0, {&talk.a(), &heir});
      expect_same(talk.a(), heir);
    }
    // What the heir says is news to whom the other has spoken to last.
    const std::uint64_t fusions = talk.b().counts().fusions;
    talk.measure(heir, 0);
    talk.say(heir, 0, 1, {&talk.b()});
    talk.say(talk.b(), 1, 0, {&heir});
    EXPECT_EQ(talk.b().counts().refused, 0u);
    EXPECT_GE(talk.b().counts().fusions, fusions);
  }
}

TEST(GaussianMemory, OfAnotherRuleOrDamagedIsRefusedAndChangesNothing) {
  Talk talk(Rule::channel);
  talk_for_a_while(talk);
  std::vector<std::byte> memory;
  ASSERT_TRUE(talk.a().save(memory));
  Talk others(Rule::naive);
  EXPECT_FALSE(others.a().recall(memory));
  GaussianEstimator heir = talk.another();
  for (std::size_t size = 0; size < memory.size(); ++size) {
    EXPECT_FALSE(heir.recall(std::span(memory).first(size)));
  }
  std::vector<std::byte> longer = memory;
  longer.push_back(std::byte{0});
  EXPECT_FALSE(heir.recall(longer));
  expect_same(heir, talk.another());
  EXPECT_TRUE(heir.recall(memory));
}

}  // namespace
}  // namespace hearsay
