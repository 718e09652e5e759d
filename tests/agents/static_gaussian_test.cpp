#include "agents/estimators/static_gaussian.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "sim/kernel/random.hpp"

namespace hearsay {
namespace {

using gaussian::Belief;
using gaussian::Rule;

/// Information about a scalar state.
Belief scalar(double omega, double xi) {
  Belief b = Belief::unknown(1);
  b.omega(0, 0) = omega;
  b.xi(0) = xi;
  return b;
}

/// A message on its way: bytes and rider outlive the sender's next speech.
struct Letter {
  std::vector<std::byte> bytes;
  RiderPtr rider;
};

class Pair {
 public:
  explicit Pair(Rule rule)
      : a(options(rule), std::array<AgentId, 1>{1}), b(options(rule), std::array<AgentId, 1>{0}) {}

  static Letter post(StaticGaussianEstimator& from, AgentId to) {
    const bool each = gaussian::info(from.rule()).sends == gaussian::Sends::belief_less_heard;
    StaticGaussianEstimator::Speech speech = from.speech(each ? to : no_agent);
    Letter letter{{speech.bytes.begin(), speech.bytes.end()}, std::move(speech.rider)};
    from.sent(each ? to : no_agent);
    return letter;
  }
  Letter a_to_b() { return post(a, 1); }
  Letter b_to_a() { return post(b, 0); }
  void at_a(const Letter& letter) { a.heard(1, letter.bytes, letter.rider.get()); }
  void at_b(const Letter& letter) { b.heard(0, letter.bytes, letter.rider.get()); }

  LedgerPool pool;
  StaticGaussianEstimator a, b;

 private:
  StaticGaussianEstimator::Options options(Rule rule) {
    return {.rule = rule, .subjects = 1, .dimension = 1, .ledgers = &pool};
  }
};

double omega(const StaticGaussianEstimator& e) { return e.tracked(0).belief.omega(0, 0); }
double weight(const StaticGaussianEstimator& e, std::size_t k) {
  const auto weights = e.tracked(0).ledger.weights();
  return k < weights.size() ? weights[k] : 0.0;
}

TEST(StaticGaussianEstimator, ChannelAddsEachMeasurementOnceWhenTalkIsInTurn) {
  Pair pair(Rule::channel);
  pair.a.measured(0, scalar(1, 0), 0);
  pair.b.measured(0, scalar(2, 0), 1);
  for (int round = 0; round < 3; ++round) {
    pair.at_b(pair.a_to_b());
    pair.at_a(pair.b_to_a());
  }
  EXPECT_DOUBLE_EQ(omega(pair.a), 3.0);
  EXPECT_DOUBLE_EQ(omega(pair.b), 3.0);
  EXPECT_DOUBLE_EQ(weight(pair.a, 1), 1.0);
}

TEST(StaticGaussianEstimator, ChannelLosesInformationWhenBeliefsCross) {
  // Both book their own belief as common before the other's arrives: A + B − A = B.
  Pair pair(Rule::channel);
  pair.a.measured(0, scalar(1, 0), 0);
  pair.b.measured(0, scalar(2, 0), 1);
  const Letter ab = pair.a_to_b(), ba = pair.b_to_a();
  pair.at_a(ba);
  pair.at_b(ab);
  EXPECT_DOUBLE_EQ(omega(pair.a), 2.0);
  EXPECT_DOUBLE_EQ(omega(pair.b), 1.0);
  EXPECT_DOUBLE_EQ(weight(pair.a, 0), 0.0);
  EXPECT_DOUBLE_EQ(weight(pair.a, 1), 1.0);
}

TEST(StaticGaussianEstimator, ChannelRobustIsExactWhenBeliefsCross) {
  Pair pair(Rule::channel_robust);
  pair.a.measured(0, scalar(1, 0), 0);
  pair.b.measured(0, scalar(2, 0), 1);
  for (int round = 0; round < 3; ++round) {
    const Letter ab = pair.a_to_b(), ba = pair.b_to_a();
    pair.at_a(ba);
    pair.at_b(ab);
    EXPECT_DOUBLE_EQ(omega(pair.a), 3.0);
    EXPECT_DOUBLE_EQ(omega(pair.b), 3.0);
  }
}

TEST(StaticGaussianEstimator, ChannelRobustIsExactUnderLossDuplicationAndReordering) {
  Pair pair(Rule::channel_robust);
  pair.a.measured(0, scalar(1, 0), 0);
  const Letter first = pair.a_to_b();
  pair.a.measured(0, scalar(4, 0), 1);
  static_cast<void>(pair.a_to_b());  // lost
  const Letter third = pair.a_to_b();
  pair.b.measured(0, scalar(2, 0), 2);
  pair.at_b(third);
  pair.at_b(third);  // duplicated
  pair.at_b(first);  // overtaken
  EXPECT_DOUBLE_EQ(omega(pair.b), 7.0);
  EXPECT_EQ(pair.b.counts().refused, 2u);
  pair.at_a(pair.b_to_a());
  EXPECT_DOUBLE_EQ(omega(pair.a), 7.0);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_DOUBLE_EQ(weight(pair.a, k), 1.0);
}

TEST(StaticGaussianEstimator, ChannelRobustHearsARebootedNeighbourAgain) {
  Pair pair(Rule::channel_robust);
  pair.a.measured(0, scalar(1, 0), 0);
  for (int i = 0; i < 5; ++i) pair.at_b(pair.a_to_b());
  pair.a.new_incarnation();
  pair.a.measured(0, scalar(4, 0), 1);
  pair.at_b(pair.a_to_b());
  EXPECT_DOUBLE_EQ(omega(pair.b), 5.0);
}

TEST(StaticGaussianEstimator, NaiveCountsWhatItHearsTwiceTwice) {
  Pair pair(Rule::naive);
  pair.a.measured(0, scalar(1, 0), 0);
  const Letter letter = pair.a_to_b();
  pair.at_b(letter);
  pair.at_b(letter);
  EXPECT_DOUBLE_EQ(omega(pair.b), 2.0);
  EXPECT_DOUBLE_EQ(weight(pair.b, 0), 2.0);
}

TEST(StaticGaussianEstimator, WeightsTimesMeasurementsGiveTheBeliefUnderEveryRule) {
  for (const gaussian::RuleInfo& rule : gaussian::rules()) {
    if (rule.sends == gaussian::Sends::nothing) continue;
    Pair pair(rule.rule);
    std::vector<double> information;
    Stream draws(11, Purpose("test"), Entity::agent(0));
    for (int step = 0; step < 40; ++step) {
      const double amount = draws.uniform(0.5, 2.0);
      StaticGaussianEstimator& who = draws.bernoulli(0.5) ? pair.a : pair.b;
      who.measured(0, scalar(amount, 0), information.size());
      information.push_back(amount);
      const Letter ab = pair.a_to_b();
      if (draws.bernoulli(0.7)) pair.at_b(ab);
      const Letter ba = pair.b_to_a();
      if (draws.bernoulli(0.7)) pair.at_a(ba);
    }
    double sum = 0.0, size = 0.0;
    for (std::size_t k = 0; k < information.size(); ++k) {
      sum += weight(pair.a, k) * information[k];
      size += std::abs(weight(pair.a, k) * information[k]);
    }
    EXPECT_NEAR(sum, omega(pair.a), 1e-9 * size) << rule.name;
  }
}

TEST(StaticGaussianEstimator, RefusesWhatIsMalformedOrFromAStranger) {
  Pair pair(Rule::naive);
  pair.a.measured(0, scalar(1, 0), 0);
  Letter letter = pair.a_to_b();
  pair.b.heard(7, letter.bytes, nullptr);
  letter.bytes.pop_back();
  pair.at_b(letter);
  EXPECT_EQ(pair.b.counts().refused, 2u);
  EXPECT_DOUBLE_EQ(omega(pair.b), 0.0);
}

TEST(StaticGaussianEstimator, SaysNothingWhileItKnowsNothing) {
  Pair pair(Rule::ci_det);
  EXPECT_TRUE(pair.a.speech(no_agent).bytes.empty());
}

}  // namespace
}  // namespace hearsay
