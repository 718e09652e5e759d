#include "agents/estimators/gaussian.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

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

  static Letter post(GaussianEstimator& from, AgentId to) {
    const bool each = gaussian::info(from.rule()).sends == gaussian::Sends::belief_less_heard;
    GaussianEstimator::Speech speech = from.speech(each ? to : no_agent);
    Letter letter{{speech.bytes.begin(), speech.bytes.end()}, std::move(speech.rider)};
    from.sent(each ? to : no_agent);
    return letter;
  }
  Letter a_to_b() { return post(a, 1); }
  Letter b_to_a() { return post(b, 0); }
  void at_a(const Letter& letter) { a.heard(1, letter.bytes, letter.rider.get()); }
  void at_b(const Letter& letter) { b.heard(0, letter.bytes, letter.rider.get()); }

  LedgerPool pool;
  GaussianEstimator a, b;

 private:
  GaussianEstimator::Options options(Rule rule) {
    return {.rule = rule, .subjects = 1, .dimension = 1, .ledgers = &pool};
  }
};

double omega(const GaussianEstimator& e) { return e.tracked(0).belief.omega(0, 0); }
double weight(const GaussianEstimator& e, std::size_t k) {
  const auto weights = e.tracked(0).ledger.weights();
  return k < weights.size() ? weights[k] : 0.0;
}

TEST(GaussianEstimator, ChannelAddsEachMeasurementOnceWhenTalkIsInTurn) {
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

TEST(GaussianEstimator, ChannelLosesInformationWhenBeliefsCross) {
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

TEST(GaussianEstimator, ChannelRobustIsExactWhenBeliefsCross) {
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

TEST(GaussianEstimator, ChannelRobustIsExactUnderLossDuplicationAndReordering) {
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

TEST(GaussianEstimator, ChannelRobustHearsARebootedNeighbourAgain) {
  Pair pair(Rule::channel_robust);
  pair.a.measured(0, scalar(1, 0), 0);
  for (int i = 0; i < 5; ++i) pair.at_b(pair.a_to_b());
  pair.a.new_incarnation();
  pair.a.measured(0, scalar(4, 0), 1);
  pair.at_b(pair.a_to_b());
  EXPECT_DOUBLE_EQ(omega(pair.b), 5.0);
}

TEST(GaussianEstimator, NaiveCountsWhatItHearsTwiceTwice) {
  Pair pair(Rule::naive);
  pair.a.measured(0, scalar(1, 0), 0);
  const Letter letter = pair.a_to_b();
  pair.at_b(letter);
  pair.at_b(letter);
  EXPECT_DOUBLE_EQ(omega(pair.b), 2.0);
  EXPECT_DOUBLE_EQ(weight(pair.b, 0), 2.0);
}

TEST(GaussianEstimator, WeightsTimesMeasurementsGiveTheBeliefUnderEveryRule) {
  for (const gaussian::RuleInfo& rule : gaussian::rules()) {
    if (rule.sends == gaussian::Sends::nothing) continue;
    Pair pair(rule.rule);
    std::vector<double> information;
    Stream draws(11, Purpose("test"), Entity::agent(0));
    for (int step = 0; step < 40; ++step) {
      const double amount = draws.uniform(0.5, 2.0);
      GaussianEstimator& who = draws.bernoulli(0.5) ? pair.a : pair.b;
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

/// Three on a line, 0 – 1 – 2, with one measurement each, of information 1, 2 and 4. All has been
/// told in turn: everybody's information is 7.
class Line {
 public:
  explicit Line(Rule rule) : rule_(rule) {
    const auto with = [&](std::vector<AgentId> neighbours) {
      agents.emplace_back(
          GaussianEstimator::Options{
              .rule = rule, .subjects = 1, .dimension = 1, .ledgers = &pool_},
          neighbours);
    };
    with({1});
    with({0, 2});
    with({1});
    for (std::size_t i = 0; i < 3; ++i) agents[i].measured(0, scalar(1 << i, 0), i);
    for (const AgentId speaker : {0, 2, 1}) talk(speaker);
  }

  Letter post(AgentId from, AgentId to) {
    const bool each = gaussian::info(rule_).sends == gaussian::Sends::belief_less_heard;
    return Pair::post(agents[static_cast<std::size_t>(from)], each ? to : no_agent);
  }
  void hear(AgentId from, AgentId to, const Letter& letter) {
    agents[static_cast<std::size_t>(to)].heard(from, letter.bytes, letter.rider.get());
  }
  /// Says what there is to say to all neighbours, who hear it.
  void talk(AgentId from) {
    for (AgentId to = from == 0 ? 1 : from - 1; to <= std::min(from + 1, 2); to += 2) {
      hear(from, to, post(from, to));
    }
  }
  std::vector<double> weights(std::size_t agent) const {
    std::vector<double> found;
    for (std::size_t k = 0; k < 4; ++k) found.push_back(weight(agents[agent], k));
    return found;
  }

  std::vector<GaussianEstimator> agents;

 private:
  Rule rule_;
  LedgerPool pool_;
};

TEST(GaussianEstimator, ChannelRobustGivesBackWhatANeighbourSaidBeforeItForgot) {
  Line line(Rule::channel_robust);
  for (std::size_t i = 0; i < 3; ++i) ASSERT_DOUBLE_EQ(omega(line.agents[i]), 7.0);
  const Letter old = line.post(1, 0);  // under way when the middle one fails
  line.agents[1].forget();
  EXPECT_DOUBLE_EQ(omega(line.agents[1]), 0.0);
  line.agents[1].measured(0, scalar(8, 0), 3);
  line.talk(1);
  // The new message stands for all that the old ones said: also what had come through it.
  EXPECT_EQ(line.weights(0), (std::vector<double>{1, 0, 0, 1}));
  EXPECT_EQ(line.weights(2), (std::vector<double>{0, 0, 1, 1}));
  line.hear(1, 0, old);
  EXPECT_EQ(line.agents[0].counts().refused, 1u);
  // What came through it comes again; its own old measurement is gone for good. Nothing is twice.
  for (const AgentId speaker : {0, 2, 1}) line.talk(speaker);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_DOUBLE_EQ(omega(line.agents[i]), 1.0 + 4.0 + 8.0) << i;
    EXPECT_EQ(line.weights(i), (std::vector<double>{1, 0, 1, 1})) << i;
  }
}

TEST(GaussianEstimator, ChannelCountsTwiceWhatItsNeighboursTellItAfterItForgot) {
  Line line(Rule::channel);
  line.talk(0);
  line.talk(2);
  line.talk(1);
  for (std::size_t i = 0; i < 3; ++i) ASSERT_DOUBLE_EQ(omega(line.agents[i]), 7.0);
  line.agents[1].forget();
  line.talk(0);
  EXPECT_EQ(line.weights(1), (std::vector<double>{1, 1, 1, 0}));
  line.talk(2);
  EXPECT_EQ(line.weights(1), (std::vector<double>{2, 2, 2, 0}));
}

TEST(GaussianEstimator, CovarianceIntersectionHearsAfterItForgotWhatItHadSaid) {
  Line line(Rule::ci_det);
  const double known = omega(line.agents[0]);
  ASSERT_DOUBLE_EQ(known, 4.0);  // the best of the three
  line.agents[1].forget();
  line.talk(0);
  EXPECT_DOUBLE_EQ(omega(line.agents[1]), known);
}

TEST(GaussianEstimator, RefusesWhatIsMalformedOrFromAStranger) {
  Pair pair(Rule::naive);
  pair.a.measured(0, scalar(1, 0), 0);
  Letter letter = pair.a_to_b();
  pair.b.heard(7, letter.bytes, nullptr);
  letter.bytes.pop_back();
  pair.at_b(letter);
  EXPECT_EQ(pair.b.counts().refused, 2u);
  EXPECT_DOUBLE_EQ(omega(pair.b), 0.0);
}

TEST(GaussianEstimator, SaysNothingWhileItKnowsNothing) {
  Pair pair(Rule::ci_det);
  EXPECT_TRUE(pair.a.speech(no_agent).bytes.empty());
}

}  // namespace
}  // namespace hearsay
