// One suite over every fusion rule.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "filters/gaussian/fusion.hpp"
#include "filters/ledger/ledger.hpp"
#include "tests/filters/gaussian/samples.hpp"

namespace hearsay::gaussian {
namespace {

/// What a rule claims to be. A new rule gets its row here.
struct Character {
  Rule rule;
  bool idempotent;    ///< fusing a belief with itself changes nothing
  bool commutative;   ///< sender and receiver end with the same belief
  bool conservative;  ///< under any correlation, if both beliefs are
  bool any_order;     ///< of two beliefs that are heard either may come first
  bool any_units;     ///< other units on the axes change nothing
};
constexpr Character characters[] = {
    {Rule::none, true, false, true, true, true},
    {Rule::naive, false, true, false, true, true},
    {Rule::local_update, false, true, false, true, true},
    {Rule::channel, false, true, false, true, true},
    {Rule::channel_robust, false, true, false, true, true},
    {Rule::ci_det, true, true, true, false, true},
    {Rule::ci_trace, true, true, true, false, false},
    {Rule::ci_half, true, true, true, false, true},
    {Rule::ci_fixed, true, false, true, false, true},  // but for ω = ½
    {Rule::ci_niehsen, true, true, true, false, false},
    {Rule::ci_franken_huepper, true, true, true, false, true},
    {Rule::most_certain, true, true, true, true, true},
    {Rule::inverse_ci, true, true, false, false, true},
    {Rule::ellipsoidal, true, true, false, false, true},
    {Rule::ci_batch, true, true, true, true, true},
    {Rule::split_ci, true, true, true, false, true},  // nothing fresh: split_test.cpp has the rest
    {Rule::consensus_information, true, false, true, true, true},
    {Rule::hybrid_consensus, true, false, true, true, true},  // nothing fresh
};

class EveryRule : public testing::TestWithParam<RuleInfo> {
 protected:
  Rule rule() const { return GetParam().rule; }
  const Character& character() const {
    for (const Character& c : characters) {
      if (c.rule == rule()) return c;
    }
    throw std::logic_error("a rule without a row in this test");
  }
};

std::string test_name(const testing::TestParamInfo<RuleInfo>& parameter) {
  std::string name(parameter.param.name);
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

TEST_P(EveryRule, LeavesASymmetricMatrix) {
  Stream random = stream("symmetry");
  for (int trial = 0; trial < 300; ++trial) {
    const int n = 1 + trial % dimension_max;
    const Belief a = random_belief(random, n);
    const Belief b = random_belief(random, n);
    const Belief common = random_belief(random, n);
    const Belief sum = fused(rule(), a, b, common);
    EXPECT_EQ(sum.omega, Matrix(sum.omega.transpose()));
    EXPECT_TRUE(sum.omega.allFinite());
  }
}

TEST_P(EveryRule, LeavesAPositiveDefiniteMatrixOfTwo) {
  Stream random = stream("definiteness");
  for (int trial = 0; trial < 300; ++trial) {
    const int n = 1 + trial % dimension_max;
    const Belief a = random_belief(random, n), b = random_belief(random, n);
    // With nothing in common: a channel takes away what it is told, whatever comes of it.
    const Belief sum = fused(rule(), a, b, Belief::unknown(n));
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(sum.omega).eigenvalues()(0), 0.0);
    EXPECT_EQ(definiteness(sum), Definiteness::positive);
  }
}

/// What somebody believes who has heard b and then c.
Belief fused_of_three(Rule rule, const Belief& a, const Belief& b, const Belief& c) {
  const Belief nothing = Belief::unknown(a.dimension());
  if (info(rule).fuses != Fuses::at_once) {
    return fused(rule, fused(rule, a, b, nothing), c, nothing);
  }
  std::vector<double> weights(3, metropolis_weight(2, 2));
  if (rule == Rule::ci_batch) {
    const Matrix* const all[] = {&a.omega, &b.omega, &c.omega};
    BatchIntersection batch;
    const std::span<const double> found = batch.weights(all);
    weights.assign(found.begin(), found.end());
  }
  return fused({1.0, weights[2], 0.0, nullptr},
               fused({weights[0], weights[1], 0.0, nullptr}, a, b, {}), c, {});
}

TEST_P(EveryRule, WhoeverIsHeardFirst) {
  Stream random = stream("order");
  double greatest = 0.0;
  for (int trial = 0; trial < 200; ++trial) {
    const int n = 1 + trial % 4;
    const Belief a = random_belief(random, n), b = random_belief(random, n);
    const Belief c = random_belief(random, n);
    const Belief one = fused_of_three(rule(), a, b, c), other = fused_of_three(rule(), a, c, b);
    greatest = std::max({greatest, relative(one.omega, other.omega), relative(one.xi, other.xi)});
  }
  EXPECT_EQ(greatest < 1e-5, character().any_order) << greatest;
}

TEST_P(EveryRule, InOtherUnits) {
  Stream random = stream("units");
  double greatest = 0.0;
  for (int trial = 0; trial < 200; ++trial) {
    const int n = 2 + trial % 3;
    const Belief a = random_belief(random, n), b = random_belief(random, n);
    Eigen::VectorXd units(n);
    for (double& unit : units) unit = std::pow(10.0, random.uniform(-4.0, 4.0));
    const auto scaled = [&](const Belief& belief) {
      return Belief{Matrix(units.asDiagonal() * belief.omega * units.asDiagonal()),
                    Vector(units.asDiagonal() * belief.xi)};
    };
    const Belief sum = fused(rule(), a, b, Belief::unknown(n));
    Belief other = fused(rule(), scaled(a), scaled(b), Belief::unknown(n));
    const Eigen::VectorXd back = units.cwiseInverse();
    const Matrix omega = back.asDiagonal() * other.omega * back.asDiagonal();
    const Vector xi = back.asDiagonal() * other.xi;
    greatest = std::max({greatest, relative(omega, sum.omega), relative(xi, sum.xi)});
  }
  EXPECT_EQ(greatest < 1e-5, character().any_units) << greatest;
}

TEST_P(EveryRule, FusingABeliefWithItself) {
  Stream random = stream("idempotence");
  for (int trial = 0; trial < 100; ++trial) {
    const int n = 1 + trial % dimension_max;
    const Belief a = random_belief(random, n);
    const Belief sum = fused(rule(), a, a, Belief::unknown(n));
    EXPECT_EQ(relative(sum.omega, a.omega) < 1e-14, character().idempotent);
    EXPECT_EQ(relative(sum.xi, a.xi) < 1e-14, character().idempotent);
  }
}

TEST_P(EveryRule, WhoeverReceives) {
  Stream random = stream("commutativity");
  for (int trial = 0; trial < 400; ++trial) {
    const int n = 1 + trial % dimension_max;
    const Belief a = random_belief(random, n);
    const Belief b = random_belief(random, n);
    const Belief common = random_belief(random, n);
    const Belief one = fused(rule(), a, b, common);
    const Belief other = fused(rule(), b, a, common);
    EXPECT_EQ(relative(one.omega, other.omega) < 1e-10, character().commutative);
    if (character().commutative) {
      const Gains there = gains(rule(), a, b), back = gains(rule(), b, a);
      EXPECT_LT((there.own - back.received).norm(), 1e-10 * (1.0 + there.own.norm()));
    }
  }
}

/// P − P_true of ξ = G_aξ_a + G_bξ_b where the joint errors of both have covariance [P_a X; Xᵀ
/// P_b]; the least eigenvalue, relative to P.
double margin(const Gains& g, const Eigen::MatrixXd& A, const Eigen::MatrixXd& B,
              const Eigen::MatrixXd& X) {
  const Eigen::MatrixXd P = (g.own * A + g.received * B).inverse();
  const Eigen::MatrixXd cross = g.own * A * X * B * g.received.transpose();
  const Eigen::MatrixXd truth =
      P *
      (g.own * A * g.own.transpose() + g.received * B * g.received.transpose() + cross +
       cross.transpose()) *
      P;
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(P - truth).eigenvalues()(0) / P.norm();
}

/// X = L_a C L_bᵀ is admissible for every contraction C; half of them on the boundary.
Eigen::MatrixXd random_cross_covariance(Stream& random, const Eigen::MatrixXd& A,
                                        const Eigen::MatrixXd& B) {
  const auto n = static_cast<int>(A.rows());
  const Eigen::MatrixXd g = random_matrix(random, n, n);
  Eigen::MatrixXd contraction;
  if (random.bernoulli(0.5)) {
    contraction = Eigen::HouseholderQR<Eigen::MatrixXd>(g).householderQ();
    for (int i = 0; i < n; ++i) {  // Householder's signs are not random
      if (random.bernoulli(0.5)) contraction.col(i) *= -1.0;
    }
  } else {
    contraction = g / Eigen::JacobiSVD<Eigen::MatrixXd>(g).singularValues()(0);
    contraction *= random.uniform();
  }
  const Eigen::MatrixXd Pa = A.inverse();
  const Eigen::MatrixXd Pb = B.inverse();
  const Eigen::MatrixXd La = Pa.llt().matrixL();
  const Eigen::MatrixXd Lb = Pb.llt().matrixL();
  return La * contraction * Lb.transpose();
}

TEST_P(EveryRule, UnderCorrelationsNobodyKnowsOf) {
  Stream random = stream("conservativeness");
  double least = 1.0;
  for (int pair = 0; pair < 200; ++pair) {
    const int n = 1 + pair % 4;
    const Belief a = random_belief(random, n);
    const Belief b = random_belief(random, n);
    const Gains g = gains(rule(), a, b);
    for (int draw = 0; draw < 30; ++draw) {
      const Eigen::MatrixXd X = random_cross_covariance(random, a.omega, b.omega);
      least = std::min(least, margin(g, a.omega, b.omega, X));
    }
  }
  if (character().conservative) {
    EXPECT_GT(least, -1e-12);
  } else {
    EXPECT_LT(least, -0.5);
  }
}

TEST_P(EveryRule, TheLedgerSaysWhatTheBeliefSays) {
  // Three beliefs built from measurements, fused at random; each stays its ledger's weighted sum.
  Stream random = stream("ledger");
  MeasurementBook book(2);
  Belief beliefs[3] = {Belief::unknown(2), Belief::unknown(2), Belief::unknown(2)};
  Ledger ledgers[3];
  for (int step = 0; step < 60; ++step) {
    const auto i = static_cast<std::size_t>(random.below(3));
    const auto j = (i + 1 + static_cast<std::size_t>(random.below(2))) % 3;
    const std::size_t k = 3 - i - j;
    const Belief z = measurement_information(random_matrix(random, 1, 2), matrix({{0.5}}),
                                             random_vector(random, 1));
    ledgers[i].measured(book.add(z));
    beliefs[i] += z;
    if (info(rule()).fuses != Fuses::by_weight) {
      const Gains g = gains(rule(), beliefs[i], beliefs[j]);
      beliefs[i] = fused(rule(), beliefs[i], beliefs[j], beliefs[k]);
      ledgers[i].combine(Matrix(g.own), Matrix(g.received), ledgers[j]);
    } else {
      const Coefficients c = coefficients(rule(), beliefs[i], beliefs[j], weight_of_own);
      beliefs[i] = fused(c, beliefs[i], beliefs[j], beliefs[k]);
      ledgers[i].combine(c.own, c.received, ledgers[j], c.common, &ledgers[k]);
    }
    const Belief sum = ledgers[i].matrices().empty() ? book.weighted_sum(ledgers[i].weights())
                                                     : book.weighted_sum_of(ledgers[i].matrices());
    const double size = 1.0 + beliefs[i].omega.norm() + beliefs[j].omega.norm();
    EXPECT_LT((sum.omega - beliefs[i].omega).norm(), 1e-9 * size) << step;
    EXPECT_LT((sum.xi - beliefs[i].xi).norm(), 1e-9 * size) << step;
  }
}

/// Weights of both covariances' inverses for the published pair x₁ = (1, −2), P₁ = diag(3, 0.4);
/// x₂ = (−2, −1), P₂ = (2 −0.8; −0.8 1): published, or what the rule says by itself. Those by
/// direction have no such weights: directional_test.cpp has their formulas.
std::optional<std::array<double, 2>> weights_of_published_pair(Rule rule) {
  constexpr double det = 0.564516, trace = 0.403703, franken_huepper = 0.512579, niehsen = 0.468750;
  switch (rule) {
    case Rule::none:
    case Rule::most_certain:  // |P₁| = 1.2 < |P₂| = 1.36
      return {{1.0, 0.0}};
    case Rule::naive:
    case Rule::local_update:
    case Rule::channel:  // nothing was exchanged before
    case Rule::channel_robust:
      return {{1.0, 1.0}};
    case Rule::ci_det:
    case Rule::ci_batch:  // of two
    case Rule::split_ci:  // of which nothing is fresh
      return {{det, 1.0 - det}};
    case Rule::ci_trace:
      return {{trace, 1.0 - trace}};
    case Rule::ci_half:
      return {{0.5, 0.5}};
    case Rule::ci_fixed:
      return {{weight_of_own, 1.0 - weight_of_own}};
    case Rule::ci_franken_huepper:
      return {{franken_huepper, 1.0 - franken_huepper}};
    case Rule::ci_niehsen:
      return {{niehsen, 1.0 - niehsen}};
    case Rule::consensus_information:  // both of two neighbours: 1 − 1/3 and 1/3
    case Rule::hybrid_consensus:
      return {{2.0 / 3.0, 1.0 / 3.0}};
    case Rule::inverse_ci:
    case Rule::ellipsoidal:
      break;
  }
  return std::nullopt;
}

TEST_P(EveryRule, OfThePublishedPair) {
  const auto weights = weights_of_published_pair(rule());
  if (!weights) {
    EXPECT_EQ(info(rule()).fuses, Fuses::by_direction);
    return;
  }
  const Eigen::MatrixXd A = Eigen::Vector2d(1.0 / 3.0, 2.5).asDiagonal();
  const Eigen::MatrixXd B = Eigen::MatrixXd(matrix({{2, -0.8}, {-0.8, 1}})).inverse();
  const Belief a{Matrix(A), Vector(A * Eigen::Vector2d(1, -2))};
  const Belief b{Matrix(B), Vector(B * Eigen::Vector2d(-2, -1))};
  const Belief sum = fused(rule(), a, b, Belief::unknown(2));
  const auto& [own, received] = *weights;
  const Eigen::MatrixXd P = (own * A + received * B).inverse();
  const Eigen::Vector2d x = P * (own * a.xi + received * b.xi);
  EXPECT_LT((Eigen::MatrixXd(sum.omega).inverse() - P).norm(), 5e-6);
  EXPECT_LT((Eigen::MatrixXd(sum.omega).inverse() * sum.xi - x).norm(), 5e-6);
}

INSTANTIATE_TEST_SUITE_P(FusionRules, EveryRule, testing::ValuesIn(rules().begin(), rules().end()),
                         test_name);

TEST(FusionProperties, TheLeastMarginsOfThePublishedPair) {
  const Matrix A = diagonal({1.0 / 3.0, 2.5});
  const Eigen::MatrixXd Pb = matrix({{2, -0.8}, {-0.8, 1}});
  const Belief a{A, vector({0, 0})};
  const Belief b{Matrix(Pb.inverse()), vector({0, 0})};
  Stream random = stream("published margin");
  const auto least = [&](Rule rule) {
    const Gains g = gains(rule, a, b);
    const double size = (g.own * a.omega + g.received * b.omega).inverse().norm();
    double worst = 1.0;
    for (int draw = 0; draw < 5000; ++draw) {
      const Eigen::MatrixXd X = random_cross_covariance(random, a.omega, b.omega);
      worst = std::min(worst, size * margin(g, a.omega, b.omega, X));
    }
    return worst;
  };
  EXPECT_NEAR(least(Rule::naive), -1.04, 0.005);
  EXPECT_NEAR(least(Rule::ci_det), 0.0, 1e-6);
  // Our ω maximises the determinant; with the least trace instead it would be −0.55.
  EXPECT_NEAR(least(Rule::inverse_ci), -0.537, 0.005);
  EXPECT_NEAR(least(Rule::ellipsoidal), -1.39, 0.005);
}

}  // namespace
}  // namespace hearsay::gaussian
