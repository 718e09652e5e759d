// Estimators of several moving states that exchange trajectories, against a filter that measured
// everything itself.
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "agents/estimators/shared_trajectories.hpp"
#include "agents/estimators/whole_trajectories.hpp"
#include "tests/filters/gaussian/samples.hpp"

namespace hearsay {
namespace {

using namespace gaussian;

MotionModel model() {
  return {.step = white_noise_acceleration(2, 1.0, 0.1), .period = Duration::seconds(1)};
}

// Agents in a line; each measures and says things when told to.
class Line {
 public:
  Line(Rule rule, int agents, int steps_max = 10, int subjects = 1)
      : rule_(rule), central_(static_cast<std::size_t>(subjects), Belief::unknown(4)) {
    workspace_.measured_at.resize(static_cast<std::size_t>(subjects));
    for (int i = 0; i < agents; ++i) agents_.push_back(make(steps_max, subjects));
  }

  void advance(std::int64_t now) {
    for (; now_ < now; ++now_) {
      for (Belief& belief : central_) belief = predict(belief, model().step);
    }
    for (auto& agent : agents_) agent->advance(now);
  }
  void measured(int agent, int subject = 0) {
    Matrix M = Matrix::Zero(2, 4);
    M.leftCols(2).setIdentity();
    const Belief seen = measurement_information(M, random_information(random_, 2, 1.0),
                                                10.0 * random_vector(random_, 2));
    const auto s = static_cast<std::size_t>(subject);
    central_[s] += seen;
    agents_[static_cast<std::size_t>(agent)]->measured(subject, seen,
                                                       workspace_.measured_at[s].size());
    workspace_.measured_at[s].push_back(now_);
  }
  struct Letter {
    std::vector<std::byte> bytes;
    RiderPtr rider;
  };
  Letter letter(int from, int to) {
    Estimator& sender = *agents_[static_cast<std::size_t>(from)];
    const bool each = info(rule_).sends == Sends::belief_less_heard;
    Estimator::Speech speech = sender.speech(each ? to : no_agent);
    Letter letter{{speech.bytes.begin(), speech.bytes.end()}, std::move(speech.rider)};
    if (rule_ == Rule::channel) sender.sent(to);
    return letter;
  }
  void hears(int who, int from, const Letter& letter) {
    agents_[static_cast<std::size_t>(who)]->heard(from, letter.bytes, letter.rider.get());
  }
  void says(int from, int to) { hears(to, from, letter(from, to)); }

  Estimator& agent(int i) { return *agents_[static_cast<std::size_t>(i)]; }
  const TrackedBelief& tracked(int i, int subject = 0) { return agent(i).tracked(subject); }
  double distance_to_central(int i, int subject = 0) {
    const Belief& central = central_[static_cast<std::size_t>(subject)];
    return kl_divergence_nats(central, tracked(i, subject).belief).value_or(1e300);
  }
  Stream& random() { return random_; }

 private:
  std::unique_ptr<Estimator> make(int steps_max, int subjects) {
    if (const auto exchange = exchange_of(rule_)) {
      return std::make_unique<SharedTrajectories>(
          SharedTrajectories::Options{.exchange = *exchange,
                                      .subjects = subjects,
                                      .motion = model(),
                                      .steps_max = steps_max,
                                      .ledgers = &pool_,
                                      .workspace = &workspace_});
    }
    return std::make_unique<WholeTrajectories>(WholeTrajectories::Options{.rule = rule_,
                                                                          .subjects = subjects,
                                                                          .motion = model(),
                                                                          .steps_max = steps_max,
                                                                          .ledgers = &pool_,
                                                                          .workspace = &workspace_},
                                               std::vector<AgentId>{});
  }

  Rule rule_;
  LedgerPool pool_;
  EstimatorWorkspace workspace_;
  std::vector<std::unique_ptr<Estimator>> agents_;
  std::vector<Belief> central_;
  std::int64_t now_ = 0;
  Stream random_ = stream("trajectories");
};

// News go up the line and back down in turn: no belief crosses another, none is lost.
void talk_in_turn(Line& line, int agents) {
  for (int i = 0; i + 1 < agents; ++i) line.says(i, i + 1);
  for (int i = agents - 1; i > 0; --i) line.says(i, i - 1);
}

TEST(Trajectories, InTurnOnALineBothFormsAreTheCentralFilter) {
  for (const Rule rule : {Rule::channel, Rule::channel_robust}) {
    Line line(rule, 3, 10, 2);
    for (int now = 1; now <= 40; ++now) {
      line.advance(now);
      line.measured(now % 3, now % 2);
      line.measured((now + 1) % 3, 0);
      if (now % 4 == 0) talk_in_turn(line, 3);
    }
    for (int i = 0; i < 3; ++i) {
      EXPECT_LT(line.distance_to_central(i, 0), 1e-9) << info(rule).name << i;
      EXPECT_LT(line.distance_to_central(i, 1), 1e-9) << info(rule).name << i;
      for (const double w : line.tracked(i).ledger.weights()) EXPECT_NEAR(w, 1.0, 1e-12);
    }
  }
}

TEST(Trajectories, CrossingBeliefsSpoilOnlyTheFormThatBooksWhatItSent) {
  for (const Rule rule : {Rule::channel, Rule::channel_robust}) {
    Line line(rule, 2);
    for (int now = 1; now <= 6; ++now) {
      line.advance(now);
      line.measured(0);
      line.measured(1);
    }
    for (int round = 0; round < 2; ++round) {
      const Line::Letter a = line.letter(0, 1), b = line.letter(1, 0);
      line.hears(1, 0, a);
      line.hears(0, 1, b);
    }
    if (rule == Rule::channel_robust) {
      EXPECT_LT(line.distance_to_central(0), 1e-9);
    } else {
      EXPECT_GT(line.distance_to_central(0), 0.1);
    }
  }
}

TEST(Trajectories, NaiveCountsAgainWhatComesBack) {
  Line line(Rule::naive, 2);
  line.advance(1);
  line.measured(0);
  for (int round = 0; round < 3; ++round) {
    line.says(0, 1);
    line.says(1, 0);
  }
  // 1, 1 → 2, 3 → 5, 8 → 13: as Fibonacci has it.
  EXPECT_EQ(line.tracked(0).ledger.weights()[0], 13.0);
  EXPECT_EQ(line.tracked(1).ledger.weights()[0], 8.0);
}

TEST(Trajectories, IntersectionNeverCountsTwiceAndNeverClaimsMoreThanTheCentralFilter) {
  for (const Rule rule : {Rule::ci_det, Rule::ci_half}) {
    Line line(rule, 3);
    for (int now = 1; now <= 30; ++now) {
      line.advance(now);
      line.measured(now % 3);
      if (now > 6 && now % 3 == 0) talk_in_turn(line, 3);
    }
    for (int i = 0; i < 3; ++i) {
      for (const double w : line.tracked(i).ledger.weights()) EXPECT_LE(w, 1.0 + 1e-12);
      const auto own = log_determinant(line.tracked(i).belief.omega);
      ASSERT_TRUE(own);
    }
    EXPECT_GT(line.distance_to_central(1), 0.01);
  }
}

// What was told late still counts, as long as its stamp is in the window.
TEST(Trajectories, NewsMayBeAsOldAsTheWindow) {
  for (const int steps_max : {6, 12}) {
    Line line(Rule::channel_robust, 2, steps_max);
    for (int now = 1; now <= 8; ++now) {
      line.advance(now);
      line.measured(now % 2);
    }
    const Line::Letter old = line.letter(0, 1);
    line.advance(12);
    line.hears(1, 0, old);
    if (steps_max == 12) {
      EXPECT_LT(line.distance_to_central(1), 1e-9);
      EXPECT_EQ(line.agent(1).counts().late, 0u);
    } else {
      EXPECT_GT(line.distance_to_central(1), 1e-3);
      EXPECT_EQ(line.agent(1).counts().late, 2u);  // of stamps 4 and 6
      for (const double w : line.tracked(1).ledger.weights()) EXPECT_LE(w, 1.0);
    }
  }
}

TEST(Trajectories, AnAgentThatKnowsTooLittleHasNoEstimate) {
  for (const Rule rule : {Rule::channel_robust, Rule::ci_det}) {
    Line line(rule, 2);
    line.advance(5);
    EXPECT_EQ(definiteness(line.tracked(0).belief), Definiteness::singular);
    EXPECT_TRUE(line.letter(0, 1).bytes.empty());
    line.measured(0);
    line.advance(8);
    EXPECT_EQ(definiteness(line.tracked(0).belief), Definiteness::singular);
    line.measured(0);
    EXPECT_EQ(definiteness(line.tracked(0).belief), Definiteness::positive);
    EXPECT_LT(line.distance_to_central(0), 1e-9);
  }
}

TEST(Trajectories, AfterItForgotAnAgentIsHeardAgain) {
  for (const Rule rule : {Rule::channel_robust, Rule::ci_half}) {
    Line line(rule, 2);
    for (int now = 1; now <= 12; ++now) {
      line.advance(now);
      line.measured(0);
    }
    line.says(0, 1);
    line.agent(0).forget();
    EXPECT_TRUE(line.tracked(0).belief.omega.isZero(0.0));
    line.measured(0);
    line.says(0, 1);
    EXPECT_EQ(line.agent(1).counts().refused, 0u);
    EXPECT_EQ(line.agent(1).counts().fusions, 2u);
  }
}

TEST(Trajectories, RefuseWhatIsNotAMessage) {
  for (const Rule rule : {Rule::channel_robust, Rule::ci_half}) {
    Line line(rule, 2);
    line.advance(3);
    line.measured(0);
    line.advance(4);
    line.measured(0);
    const Line::Letter good = line.letter(0, 1);
    std::uint64_t refused = 0;
    for (std::size_t size = 0; size < good.bytes.size(); ++size) {
      const auto part = std::span(good.bytes).first(size);
      line.agent(1).heard(0, part, nullptr);
      EXPECT_EQ(line.agent(1).counts().refused, ++refused);
    }
    // A sender from the future, and one that counts in other stamps.
    for (const std::uint8_t byte : {std::uint8_t{0xff}, std::uint8_t{0x01}}) {
      Line::Letter bad{good.bytes, RiderPtr()};
      bad.bytes[20 + 4] = static_cast<std::byte>(byte);  // of first_ns
      line.agent(1).heard(0, bad.bytes, nullptr);
      EXPECT_EQ(line.agent(1).counts().refused, ++refused);
    }
    EXPECT_TRUE(line.tracked(1).belief.omega.isZero(0.0));
    for (int i = 0; i < 2000; ++i) {
      Line::Letter bad{good.bytes, RiderPtr()};
      const std::size_t at = line.random().below(bad.bytes.size());
      bad.bytes[at] = static_cast<std::byte>(line.random().below(256));
      line.agent(1).heard(0, bad.bytes, nullptr);
      (void)line.tracked(1);
    }
  }
}

}  // namespace
}  // namespace hearsay
