// Trajectory estimators that exchange what was measured, over links that lose, delay and reorder,
// against one that measured everything itself.
#include "agents/estimators/trajectory_gaussian.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <set>
#include <utility>

#include "filters/gaussian/trajectory_factor.hpp"
#include "sim/kernel/error.hpp"
#include "tests/filters/gaussian/samples.hpp"

namespace hearsay {
namespace {

using namespace gaussian;
using Message = TrajectoryEstimator::Message;

/// Agents on a graph; whoever measures or says something does so at a stamp.
class Fleet {
 public:
  struct Options {
    std::vector<std::pair<int, int>> edges;
    int agents = 1;
    int steps_max = 20;
    TrajectoryExchange exchange = TrajectoryExchange::all_but_yours;
    int latency_max = 0;  ///< stamps
  };
  explicit Fleet(Options options)
      : options_(std::move(options)), random_(stream("fleet")), central_(estimator(1000, 0)) {
    for (int a = 0; a < options_.agents; ++a) agents_.push_back(estimator(options_.steps_max, 0));
    reached_.resize(agents_.size());
  }

  /// Everybody goes on to `now`, measures perhaps, hears what is due and talks.
  void step(Stamp now, double measures, double loss) {
    central_.advance(now);
    for (std::size_t a = 0; a < agents_.size(); ++a) note_folding(a, now);
    for (TrajectoryEstimator& agent : agents_) agent.advance(now);
    for (std::size_t a = 0; a < agents_.size(); ++a) {
      if (random_.bernoulli(measures)) measure(a, now);
    }
    hear(now);
    for (const auto& [a, b] : options_.edges) {
      talk(a, b, now, loss);
      talk(b, a, now, loss);
    }
  }
  void measure(std::size_t a, Stamp now) {
    Matrix M = Matrix::Zero(2, 4);
    M.leftCols(2).setIdentity();
    const Belief seen = measurement_information(M, random_information(random_, 2, 1.0),
                                                10.0 * random_vector(random_, 2));
    central_.measured(now, seen);
    EXPECT_TRUE(agents_[a].measured(now, seen));
    reached_[a].insert({now, made_++});
  }

  TrajectoryEstimator& agent(std::size_t a) { return agents_[a]; }
  std::size_t agents() const { return agents_.size(); }
  /// What one who measured everything believes of the stamps from `first` on.
  Trajectory central(Stamp first) {
    Trajectory t = central_.belief();
    while (t.stamps().front() < first) t.marginalise(0);
    return t;
  }
  /// Whether an agent marginalised a stamp before all measured at it had reached it.
  bool folded_early() const { return folded_early_; }

 private:
  using Measured = std::set<std::pair<Stamp, int>>;
  struct Sent {
    std::size_t from, to;
    Stamp due;
    Message message;
    Measured carries;
  };
  TrajectoryEstimator estimator(int steps_max, Stamp first) const {
    return TrajectoryEstimator({.exchange = options_.exchange,
                                .step = white_noise_acceleration(2, 1.0, 0.3),
                                .steps_max = steps_max},
                               first);
  }
  // Which measurements can have reached whom is kept apart from the estimators' own arithmetic.
  void note_folding(std::size_t a, Stamp now) {
    const Stamp first = std::max<Stamp>(0, now - options_.steps_max + 1);
    for (std::size_t b = 0; b < agents_.size(); ++b) {
      for (const auto& measured : reached_[b]) {
        if (measured.first < first && !reached_[a].count(measured)) folded_early_ = true;
      }
    }
  }
  void talk(int from, int to, Stamp now, double loss) {
    const auto a = static_cast<std::size_t>(from), b = static_cast<std::size_t>(to);
    Sent sent{a, b, now + static_cast<Stamp>(random_.below(options_.latency_max + 1)), {}, {}};
    agents_[a].speak(static_cast<AgentId>(to), sent.message);
    for (const auto& measured : reached_[a]) {
      if (measured.first >= agents_[a].first()) sent.carries.insert(measured);
    }
    if (!random_.bernoulli(loss)) air_.push_back(std::move(sent));
  }
  void hear(Stamp now) {
    std::vector<Sent> later;
    for (Sent& sent : air_) {
      if (sent.due > now) {
        later.push_back(std::move(sent));
        continue;
      }
      agents_[sent.to].heard(static_cast<AgentId>(sent.from), sent.message);
      // A message that was overtaken is refused; its news came with the one that overtook it.
      reached_[sent.to].insert(sent.carries.begin(), sent.carries.end());
    }
    air_ = std::move(later);
  }

  Options options_;
  Stream random_;
  TrajectoryEstimator central_;
  std::vector<TrajectoryEstimator> agents_;
  std::vector<Measured> reached_;
  std::vector<Sent> air_;
  int made_ = 0;
  bool folded_early_ = false;
};

const std::vector<std::pair<int, int>> tree = {{0, 1}, {1, 2}, {1, 3}, {3, 4}, {3, 5}};
const std::vector<std::pair<int, int>> triangle = {{0, 1}, {1, 2}, {2, 0}};

void expect_central(Fleet& fleet, double within) {
  for (std::size_t a = 0; a < fleet.agents(); ++a) {
    const Trajectory& believed = fleet.agent(a).belief();
    const Trajectory central = fleet.central(fleet.agent(a).first());
    TrajectoryFactor one, other;
    ASSERT_EQ(one.factor(believed), Definiteness::positive);
    ASSERT_EQ(other.factor(central), Definiteness::positive);
    for (std::size_t k = 0; k < one.means().size(); ++k) {
      EXPECT_LE(relative(one.means()[k], other.means()[k]), within) << a << ' ' << k;
      EXPECT_LE(relative(one.covariances()[k], other.covariances()[k]), within) << a << ' ' << k;
    }
  }
}

TEST(TrajectoryEstimator, OnATreeIsTheCentralSmootherWhateverTheLinksDo) {
  Fleet fleet({.edges = tree, .agents = 6, .steps_max = 40, .latency_max = 3});
  for (Stamp now = 1; now <= 100; ++now) fleet.step(now, 0.3, 0.4);
  for (Stamp now = 101; now <= 120; ++now) fleet.step(now, 0.0, 0.0);  // the last news travels
  ASSERT_FALSE(fleet.folded_early());
  ASSERT_EQ(fleet.agent(0).first(), 81);
  expect_central(fleet, 1e-8);
  for (std::size_t a = 0; a < fleet.agents(); ++a) EXPECT_EQ(fleet.agent(a).counts().late, 0u);
}

TEST(TrajectoryEstimator, WithAShortWindowLosesInformationAndNeverCountsItTwice) {
  Fleet fleet({.edges = tree, .agents = 6, .steps_max = 6, .latency_max = 4});
  for (Stamp now = 1; now <= 80; ++now) fleet.step(now, 0.3, 0.4);
  ASSERT_TRUE(fleet.folded_early());
  std::uint64_t late = 0;
  for (std::size_t a = 0; a < fleet.agents(); ++a) {
    const Trajectory& believed = fleet.agent(a).belief();
    const Trajectory central = fleet.central(fleet.agent(a).first());
    TrajectoryFactor one, other;
    ASSERT_EQ(one.factor(believed), Definiteness::positive);
    ASSERT_EQ(other.factor(central), Definiteness::positive);
    for (std::size_t k = 0; k < one.covariances().size(); ++k) {
      const Eigen::MatrixXd wider = one.covariances()[k] - other.covariances()[k];
      EXPECT_GE(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(wider).eigenvalues()(0),
                -1e-9 * other.covariances()[k].norm());
    }
    late += fleet.agent(a).counts().late;
  }
  EXPECT_GT(late, 0u);
}

TEST(TrajectoryEstimator, ThatTellsOnlyItsOwnIsExactWhereAllHearAll) {
  Fleet fleet({.edges = triangle,
               .agents = 3,
               .steps_max = 30,
               .exchange = TrajectoryExchange::own,
               .latency_max = 2});
  for (Stamp now = 1; now <= 60; ++now) fleet.step(now, 0.4, 0.3);
  for (Stamp now = 61; now <= 70; ++now) fleet.step(now, 0.0, 0.0);
  ASSERT_FALSE(fleet.folded_early());
  expect_central(fleet, 1e-8);
}

TEST(TrajectoryEstimator, OnALoopCountsTwice) {
  for (const auto exchange : {TrajectoryExchange::all_but_yours, TrajectoryExchange::everything}) {
    Fleet fleet({.edges = triangle, .agents = 3, .steps_max = 30, .exchange = exchange});
    for (Stamp now = 1; now <= 12; ++now) fleet.step(now, 0.5, 0.0);
    TrajectoryFactor one, other;
    ASSERT_EQ(one.factor(fleet.agent(0).belief()), Definiteness::positive);
    ASSERT_EQ(other.factor(fleet.central(0)), Definiteness::positive);
    // Of what has gone round the loop a few times; it claims less than all measurements allow.
    EXPECT_LT(one.covariances()[5].trace(), 0.7 * other.covariances()[5].trace());
  }
}

class Pair : public testing::Test {
 protected:
  static TrajectoryEstimator make(int steps_max = 5) {
    return TrajectoryEstimator(
        {.step = white_noise_acceleration(1, 1.0, 1.0), .steps_max = steps_max}, 0);
  }
  static Belief seen(double x) {
    return measurement_information(matrix({{1, 0}}), diagonal({1.0}), vector({x}));
  }
  static double first_entry(TrajectoryEstimator& e) { return e.belief().omega(0)(0, 0); }
  TrajectoryEstimator a_ = make(), b_ = make();
  Message message_;
};

TEST_F(Pair, OlderAndRepeatedMessagesAreRefused) {
  a_.measured(0, seen(1.0));
  Message first;
  a_.speak(1, first);
  a_.measured(0, seen(3.0));
  a_.speak(1, message_);
  b_.heard(0, message_);
  b_.heard(0, message_);
  b_.heard(0, first);
  EXPECT_EQ(b_.counts().refused, 2u);
  EXPECT_DOUBLE_EQ(first_entry(b_), 2.0);
}

TEST_F(Pair, WhatCannotBeIsRefusedWhole) {
  const auto refused = [&](const Message& message) {
    const std::uint64_t before = b_.counts().refused;
    b_.heard(0, message);
    return b_.counts().refused == before + 1 && first_entry(b_) == 0.0;
  };
  EXPECT_TRUE(refused({.count = 1, .first = 0, .entries = {{1, seen(1.0)}}}));  // the future
  EXPECT_TRUE(refused({.count = 1, .first = 0, .entries = {{0, Belief::unknown(3)}}}));
  EXPECT_TRUE(refused({.count = 1, .first = 0, .entries = {{0, seen(1.0)}, {0, seen(1.0)}}}));
  EXPECT_TRUE(refused({.count = 1, .first = 1, .entries = {{0, seen(1.0)}}}));
}

TEST_F(Pair, ARebootedNeighbourIsHeardAgain) {
  a_.measured(0, seen(1.0));
  for (int i = 0; i < 3; ++i) a_.speak(1, message_);
  b_.heard(0, message_);
  a_.forget(0);
  a_.measured(0, seen(2.0));
  a_.speak(1, message_);
  b_.heard(0, message_);
  EXPECT_EQ(b_.counts().refused, 0u);
  EXPECT_DOUBLE_EQ(first_entry(b_), 1.0);  // what it knew before is given back
}

TEST_F(Pair, ANeighboursShorterWindowTakesNothingBack) {
  a_.measured(0, seen(1.0));
  a_.speak(1, message_);
  b_ = make(50);
  b_.heard(0, message_);
  for (Stamp now = 1; now <= 10; ++now) {
    a_.advance(now);
    b_.advance(now);
  }
  a_.speak(1, message_);
  EXPECT_EQ(message_.first, 6);
  b_.heard(0, message_);
  EXPECT_GE(first_entry(b_), 1.0);
}

TEST_F(Pair, AMeasurementOfAStampThatIsGoneIsLate) {
  a_.advance(10);
  EXPECT_FALSE(a_.measured(5, seen(1.0)));
  EXPECT_TRUE(a_.measured(6, seen(1.0)));
  EXPECT_EQ(a_.counts().late, 1u);
  EXPECT_THROW(a_.measured(11, seen(1.0)), BrokenInvariant);
  EXPECT_THROW(a_.advance(9), BrokenInvariant);
}

}  // namespace
}  // namespace hearsay
