// Rules that hold what they hear, know parts, or say less: single steps by hand, and gossiping
// networks whose ledgers know the truth.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "agents/estimators/gaussian.hpp"
#include "sim/kernel/random.hpp"

namespace hearsay {
namespace {

using gaussian::Belief;
using gaussian::Matrix;
using gaussian::Rule;
using gaussian::Vector;
using Options = GaussianEstimator::Options;

Belief scalar(double omega, double xi) {
  Belief b = Belief::unknown(1);
  b.omega(0, 0) = omega;
  b.xi(0) = xi;
  return b;
}

double omega(const GaussianEstimator& e) { return e.tracked(0).belief.omega(0, 0); }

/// Estimators that all know one another, and their measurements.
class Fleet {
 public:
  Fleet(int agents, const Options& options) : book(options.dimension), agents_(agents) {
    std::vector<AgentId> ids;
    for (AgentId id = 0; id < agents; ++id) ids.push_back(id);
    Options with_ledger = options;
    with_ledger.ledgers = &pool;
    for (int i = 0; i < agents; ++i) {
      estimators.push_back(std::make_unique<GaussianEstimator>(with_ledger, ids));
    }
  }
  GaussianEstimator& operator[](int i) { return *estimators[static_cast<std::size_t>(i)]; }
  void measure(int i, const Belief& z) { (*this)[i].measured(0, z, book.add(z)); }
  /// i talks, and all j with hears(j) hear it at once.
  template <class Hears>
  void talk(int i, int degree, const Hears& hears) {
    (*this)[i].about_to_talk(degree);
    const auto speech = (*this)[i].speech(no_agent);
    if (speech.bytes.empty()) return;
    const std::vector<std::byte> bytes(speech.bytes.begin(), speech.bytes.end());
    (*this)[i].sent(no_agent);
    for (int j = 0; j < agents_; ++j) {
      if (j != i && hears(j)) (*this)[j].heard(i, bytes, speech.rider.get());
    }
  }
  void talk(int i, int degree) {
    talk(i, degree, [](int) { return true; });
  }

  LedgerPool pool;
  MeasurementBook book;
  std::vector<std::unique_ptr<GaussianEstimator>> estimators;

 private:
  int agents_;
};

TEST(BatchRule, HoldsWhatItHearsUntilItTalks) {
  Fleet fleet(3, {.rule = Rule::ci_batch, .dimension = 1});
  for (int i = 0; i < 3; ++i) fleet.measure(i, scalar(i + 1, 0));
  fleet.talk(1, 2);
  fleet.talk(2, 2);
  EXPECT_EQ(omega(fleet[0]), 1.0);
  fleet[0].about_to_talk(2);
  EXPECT_DOUBLE_EQ(omega(fleet[0]), 3.0);  // the best of 1, 2 and 3
  EXPECT_EQ(fleet[0].counts().fusions, 2u);
  fleet[0].about_to_talk(2);  // nothing is held any more
  EXPECT_EQ(fleet[0].counts().fusions, 2u);
}

TEST(BatchRule, OfANeighboursBeliefsTheNewestCounts) {
  Fleet fleet(2, {.rule = Rule::ci_batch, .dimension = 1});
  fleet.measure(0, scalar(1, 0));
  fleet.measure(1, scalar(2, 0));
  std::vector<std::vector<std::byte>> letters;
  for (int k = 0; k < 2; ++k) {
    const auto speech = fleet[1].speech(no_agent);
    letters.emplace_back(speech.bytes.begin(), speech.bytes.end());
    fleet[1].sent(no_agent);
    fleet.measure(1, scalar(2, 0));
  }
  fleet[0].heard(1, letters[1], nullptr);
  fleet[0].heard(1, letters[0], nullptr);  // overtaken
  EXPECT_EQ(fleet[0].counts().refused, 1u);
  fleet[0].about_to_talk(1);
  EXPECT_DOUBLE_EQ(omega(fleet[0]), 4.0);
}

TEST(ConsensusRule, OneStepHasTheWeightsOfMetropolis) {
  // A star of three: the hub has two neighbours, each leaf one. π = 1/3 on both links.
  Fleet fleet(3, {.rule = Rule::consensus_information, .dimension = 1});
  fleet.measure(0, scalar(3, 0));
  fleet.measure(1, scalar(6, 0));
  fleet.measure(2, scalar(12, 0));
  const auto hub_alone = [](int j) { return j == 0; };
  fleet.talk(1, 1, hub_alone);
  fleet.talk(2, 1, hub_alone);
  fleet[0].about_to_talk(2);
  EXPECT_DOUBLE_EQ(omega(fleet[0]), (3.0 + 6.0 + 12.0) / 3.0);
  const auto weights = fleet[0].tracked(0).ledger.weights();
  for (std::size_t k = 0; k < 3; ++k) EXPECT_DOUBLE_EQ(weights[k], 1.0 / 3.0);
  fleet.measure(1, scalar(6, 0));  // one that was not heard leaves its weight to the own belief
  fleet.talk(1, 1, hub_alone);
  fleet[0].about_to_talk(2);
  EXPECT_DOUBLE_EQ(omega(fleet[0]), 7.0 * 2.0 / 3.0 + 12.0 / 3.0);
}

TEST(ConsensusRule, SynchronousRoundsReachTheMeanOfAll) {
  // A ring of five, everybody talks, then everybody fuses: x ← Wx, so Ω tends to the mean.
  constexpr int agents = 5;
  Fleet fleet(agents, {.rule = Rule::consensus_information, .dimension = 1});
  double mean = 0.0;
  for (int i = 0; i < agents; ++i) {
    fleet.measure(i, scalar(1 + i * i, 0));
    mean += (1.0 + i * i) / agents;
  }
  for (int round = 0; round < 60; ++round) {
    for (int i = 0; i < agents; ++i) {
      const auto speech = fleet[i].speech(no_agent);
      for (const int j : {(i + 1) % agents, (i + agents - 1) % agents}) {
        fleet[j].heard(i, speech.bytes, speech.rider.get());
      }
    }
    for (int i = 0; i < agents; ++i) fleet[i].about_to_talk(2);
  }
  for (int i = 0; i < agents; ++i) EXPECT_NEAR(omega(fleet[i]), mean, 1e-9 * mean);
}

TEST(HybridRule, FreshInformationCountsByTheCorrection) {
  // Two agents, π = ½: what both measured and said once is then in each with γ/2 of either.
  for (const double gamma : {1.0, 2.0, 5.0}) {
    Fleet fleet(2, {.rule = Rule::hybrid_consensus, .correction = gamma, .dimension = 1});
    fleet.measure(0, scalar(3, 0));
    fleet.measure(1, scalar(5, 0));
    for (int i = 0; i < 2; ++i) fleet.talk(i, 1);
    // Agent 1 fused before it spoke, when it had not said anything fresh yet: B₁ = ½·0 + γ½·3, and
    // its own 5 untouched.
    EXPECT_DOUBLE_EQ(omega(fleet[1]), 0.5 * gamma * 3.0 + 5.0);
    fleet.measure(0, scalar(100, 0));  // not said yet: it takes no part
    fleet[0].about_to_talk(1);
    EXPECT_DOUBLE_EQ(omega(fleet[0]),
                     0.5 * gamma * 3.0 + 0.5 * (0.5 * gamma * 3.0) + 0.5 * gamma * 5.0 + 100.0);
    const Belief sum = fleet.book.weighted_sum(fleet[0].tracked(0).ledger.weights());
    EXPECT_NEAR(sum.omega(0, 0), omega(fleet[0]), 1e-12 * omega(fleet[0]));
  }
}

TEST(SplitRule, WhatIsFreshAddsUpAndWhatWasSaidDoesNot) {
  Fleet fleet(2, {.rule = Rule::split_ci, .dimension = 1});
  fleet.measure(0, scalar(1, 0));
  fleet.measure(1, scalar(2, 0));
  fleet.talk(0, 1);
  EXPECT_NEAR(omega(fleet[1]), 3.0, 1e-12);  // neither had been said
  fleet.talk(1, 1);
  EXPECT_NEAR(omega(fleet[0]), 3.0, 1e-9);  // 1 was said, of the 3 only 2 are fresh, 1 is not
  fleet.talk(0, 1);
  EXPECT_NEAR(omega(fleet[1]), 3.0, 1e-9);  // nothing fresh on either side
}

Belief random_measurement(Stream& random) {
  Matrix M(2, 2), S = Matrix::Zero(2, 2);
  for (int j = 0; j < 2; ++j) {
    for (int i = 0; i < 2; ++i) M(i, j) = random.normal();
  }
  S(0, 0) = 1.0;
  S(1, 1) = 0.1;
  Vector z(2);
  z << random.normal(), random.normal();
  return gaussian::measurement_information(M, S, z);
}

struct Outcome {
  double most_overconfident = 0.0;  ///< largest eigenvalue of Ω P_true: at most one if conservative
  double ledger_gap = 0.0;          ///< of the belief from what its ledger says
};

/// Four agents measure, and speak to whoever happens to hear.
Outcome gossip(const Options& options, std::uint64_t seed) {
  Stream random(seed, Purpose("gossip"), Entity::agent(0));
  constexpr int agents = 4;
  Fleet fleet(agents, options);
  Outcome out;
  for (int step = 0; step < 160; ++step) {
    const auto i = static_cast<int>(random.below(agents));
    if (random.bernoulli(0.5)) {
      fleet.measure(i, random_measurement(random));
      continue;
    }
    std::vector<bool> hears;
    for (int j = 0; j < agents; ++j) hears.push_back(random.bernoulli(0.6));
    fleet.talk(i, 2, [&](int j) { return hears[static_cast<std::size_t>(j)]; });
    for (int j = 0; j < agents; ++j) {
      const TrackedBelief& tracked = fleet[j].tracked(0);
      const Ledger& ledger = tracked.ledger;
      const Belief sum = ledger.matrices().empty() ? fleet.book.weighted_sum(ledger.weights())
                                                   : fleet.book.weighted_sum_of(ledger.matrices());
      const double size = 1.0 + tracked.belief.omega.norm();
      out.ledger_gap = std::max(out.ledger_gap, (sum.omega - tracked.belief.omega).norm() / size);
      out.ledger_gap = std::max(out.ledger_gap, (sum.xi - tracked.belief.xi).norm() / size);
      const auto P = true_covariance(tracked.belief.omega, ledger, fleet.book);
      if (!P) continue;
      const Eigen::MatrixXd L = Eigen::MatrixXd(tracked.belief.omega).llt().matrixL();
      const Eigen::MatrixXd ratio = L.transpose() * Eigen::MatrixXd(*P) * L;
      const double most =
          Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(ratio).eigenvalues().maxCoeff();
      out.most_overconfident = std::max(out.most_overconfident, most);
    }
  }
  return out;
}

TEST(RulesInANetwork, AreConservativeAsTheTableSays) {
  for (const Rule rule : {Rule::ci_det, Rule::ci_batch, Rule::split_ci, Rule::consensus_information,
                          Rule::hybrid_consensus}) {
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      const Outcome out = gossip({.rule = rule, .dimension = 2}, seed);
      EXPECT_LT(out.most_overconfident, 1.0 + 1e-9) << gaussian::info(rule).name << " " << seed;
      EXPECT_GT(out.most_overconfident, 0.3) << gaussian::info(rule).name << " " << seed;
      EXPECT_LT(out.ledger_gap, 1e-9) << gaussian::info(rule).name << " " << seed;
    }
  }
  double nodes = 0.0, naive = 0.0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Options hybrid{.rule = Rule::hybrid_consensus, .correction = 4.0, .dimension = 2};
    const Outcome out = gossip(hybrid, seed);
    EXPECT_LT(out.ledger_gap, 1e-9);
    nodes = std::max(nodes, out.most_overconfident);
    naive = std::max(naive, gossip({.rule = Rule::naive, .dimension = 2}, seed).most_overconfident);
  }
  EXPECT_GT(nodes, 1.1);  // what the table warns of
  EXPECT_GT(naive, 2.0);
}

TEST(ContentsInANetwork, DiagonalBeliefsStayConservativeAndTheLedgerExact) {
  for (const Rule rule : {Rule::ci_det, Rule::ci_batch}) {
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      const Outcome out =
          gossip({.rule = rule, .content = Content::diagonal, .dimension = 2}, seed);
      EXPECT_LT(out.most_overconfident, 1.0 + 1e-9);
      EXPECT_GT(out.most_overconfident, 0.3);
      EXPECT_LT(out.ledger_gap, 1e-9);
    }
  }
}

TEST(ContentsInANetwork, AfterAQuantisedBeliefTheLedgerIsInexact) {
  Fleet fleet(2, {.rule = Rule::ci_det, .content = Content::quantised, .bits = 6, .dimension = 2});
  Stream random(1, Purpose("quantised"), Entity::agent(0));
  for (int k = 0; k < 3; ++k) {
    for (int i = 0; i < 2; ++i) fleet.measure(i, random_measurement(random));
  }
  const auto exact = [&](int i) {
    const TrackedBelief& tracked = fleet[i].tracked(0);
    return true_covariance(tracked.belief.omega, tracked.ledger, fleet.book).has_value();
  };
  EXPECT_TRUE(exact(1));
  fleet.talk(0, 1);
  EXPECT_EQ(fleet[1].counts().fusions, 1u);
  EXPECT_FALSE(exact(1));
  EXPECT_TRUE(exact(0));
  EXPECT_GT(multiplicity(fleet[1].tracked(0).ledger).measurements, 0u);
}

TEST(Contents, NothingIsSaidOfASingularBelief) {
  for (const Content content : {Content::diagonal, Content::quantised}) {
    Fleet fleet(2, {.rule = Rule::ci_det, .content = content, .dimension = 2});
    Belief along = Belief::unknown(2);
    along.omega(0, 0) = 1.0;
    fleet.measure(0, along);
    EXPECT_TRUE(fleet[0].speech(no_agent).bytes.empty());
  }
}

TEST(News, IsTheDivergenceFromWhatWasLastSaid) {
  Fleet fleet(2, {.rule = Rule::ci_det, .exact = false, .dimension = 1});
  EXPECT_EQ(fleet[0].news_nats(), 0.0);  // there is nothing to say
  fleet.measure(0, scalar(1, 0));
  EXPECT_EQ(fleet[0].news_nats(), std::numeric_limits<double>::infinity());
  fleet.talk(0, 1);
  EXPECT_EQ(fleet[0].news_nats(), 0.0);
  fleet.measure(0, scalar(3, 0));
  // N(0, ¼) from N(0, 1): ½(¼ − 1 + log 4).
  EXPECT_NEAR(fleet[0].news_nats(), 0.5 * (0.25 - 1.0 + std::log(4.0)), 1e-12);
  EXPECT_FALSE(fleet[0].tracked(0).ledger.exact());
  EXPECT_FALSE(fleet[1].tracked(0).ledger.exact());
}

}  // namespace
}  // namespace hearsay
