#include "filters/gaussian/fusion.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <set>

#include "sim/kernel/error.hpp"
#include "tests/filters/gaussian/samples.hpp"

namespace hearsay::gaussian {
namespace {

const Belief first = Belief::from_moments(vector({1, -2}), diagonal({3, 0.4}));
const Belief second = Belief::from_moments(vector({-2, -1}), matrix({{2, -0.8}, {-0.8, 1}}));

void expect_moments(const Belief& belief, double xx, double xy, double yy, double x, double y) {
  const Matrix P = *covariance(belief);
  EXPECT_NEAR(P(0, 0), xx, 5e-7);
  EXPECT_NEAR(P(0, 1), xy, 5e-7);
  EXPECT_NEAR(P(1, 1), yy, 5e-7);
  EXPECT_NEAR((*state(belief))(0), x, 5e-7);
  EXPECT_NEAR((*state(belief))(1), y, 5e-7);
}

Belief fused_by(Rule rule) {
  return fused(coefficients(rule, first, second), first, second, Belief::unknown(2));
}

TEST(FusionRules, NaiveFusionOfThePublishedPair) {
  expect_moments(fused_by(Rule::naive), 1.018868, -0.150943, 0.274214, -0.603774, -1.836478);
}

TEST(FusionRules, IntersectionByDeterminantOfThePublishedPair) {
  EXPECT_NEAR(intersect_det(first.omega, second.omega).omega, 0.564516, 5e-7);
  expect_moments(fused_by(Rule::ci_det), 2.099090, -0.262083, 0.520121, -0.445155, -1.881992);
}

TEST(FusionRules, IntersectionByTraceOfThePublishedPair) {
  EXPECT_NEAR(intersect_trace(first.omega, second.omega).omega, 0.403703, 5e-7);
  expect_moments(fused_by(Rule::ci_trace), 1.969313, -0.366226, 0.598282, -0.835367, -1.751667);
}

TEST(FusionRules, CoefficientsAreThoseOfTheTable) {
  const auto expect = [](Rule rule, double own, double received, double common) {
    const Coefficients c = coefficients(rule, first, second);
    EXPECT_EQ(c.own, own);
    EXPECT_EQ(c.received, received);
    EXPECT_EQ(c.common, common);
    EXPECT_EQ(c.skipped, nullptr);
  };
  expect(Rule::none, 1, 0, 0);
  expect(Rule::naive, 1, 1, 0);
  expect(Rule::local_update, 1, 1, 0);
  expect(Rule::channel, 1, 1, 1);
  expect(Rule::channel_robust, 1, 1, 1);
  const double omega = intersect_det(first.omega, second.omega).omega;
  expect(Rule::ci_det, omega, 1 - omega, 0);
  expect(Rule::ci_half, 0.5, 0.5, 0);
  EXPECT_EQ(coefficients(Rule::ci_fixed, first, second, 0.75).own, 0.75);
  EXPECT_EQ(coefficients(Rule::ci_fixed, first, second, 0.75).received, 0.25);
  EXPECT_EQ(coefficients(Rule::ci_fixed, first, second, 1.0).received, 0.0);
}

TEST(FusionRules, AChannelRemovesWhatTwoBeliefsHaveInCommon) {
  Stream random = stream("channel");
  const Belief a = random_belief(random, 3);
  const Belief b = random_belief(random, 3);
  const Belief common = random_belief(random, 3);
  Belief own = a;
  own += common;
  Belief received = b;
  received += common;
  Belief central = a;
  central += b;
  central += common;
  const Belief sum = fused(coefficients(Rule::channel, own, received), own, received, common);
  EXPECT_LT(relative(sum.omega, central.omega), 1e-12);
  EXPECT_LT(relative(sum.xi, central.xi), 1e-12);
}

TEST(FusionRules, TheTableIsComplete) {
  std::set<std::string_view> names;
  for (const RuleInfo& row : rules()) {
    names.insert(row.name);
    EXPECT_EQ(rule_by_name(row.name), row.rule);
    EXPECT_EQ(&info(row.rule), &row);
    for (const std::string_view text :
         {row.assumes, row.conservative, row.ledger, row.cost, row.source}) {
      EXPECT_FALSE(text.empty()) << row.name;
      EXPECT_EQ(text.find('\n'), std::string_view::npos) << row.name;
    }
    EXPECT_EQ(row.sends == Sends::nothing, row.rule == Rule::none);
  }
  EXPECT_EQ(names, (std::set<std::string_view>{
                       "none", "naive", "local-update", "channel", "channel-robust", "ci-det",
                       "ci-trace", "ci-half", "ci-fixed", "ci-niehsen", "ci-franken-huepper",
                       "most-certain", "inverse-ci", "ellipsoidal", "ci-batch", "split-ci",
                       "consensus-information", "hybrid-consensus"}));
  EXPECT_EQ(info(Rule::channel).memory, Memory::last_exchanged);
  EXPECT_EQ(info(Rule::channel_robust).memory, Memory::last_heard);
  EXPECT_EQ(info(Rule::channel_robust).sends, Sends::belief_less_heard);
}

TEST(FusionRules, AFixedWeightCanBeOneButNotNothing) {
  for (const double omega : {0.0, -0.5, 1.5, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW(coefficients(Rule::ci_fixed, first, second, omega), BrokenInvariant) << omega;
  }
  // Whatever the weight, who knows nothing takes what it hears.
  const Coefficients c = coefficients(Rule::ci_fixed, Belief::unknown(2), second, 1.0);
  EXPECT_EQ(c.own, 0.0);
  EXPECT_EQ(c.received, 1.0);
}

TEST(FusionRules, AnUnknownNameIsNoRule) {
  EXPECT_FALSE(rule_by_name("ci"));
  EXPECT_FALSE(rule_by_name(""));
  EXPECT_FALSE(rule_by_name("Naive"));
}

TEST(FusionRules, AnOverflownBeliefIsNeverFused) {
  Belief overflown = first;
  overflown.xi(0) = std::numeric_limits<double>::infinity();
  Belief undefined = first;
  undefined.omega(1, 1) = std::numeric_limits<double>::quiet_NaN();
  for (const RuleInfo& row : rules()) {
    if (row.rule == Rule::none || row.fuses == Fuses::at_once) continue;
    if (row.fuses == Fuses::by_parts) {
      const Matrix nothing = Matrix::Zero(2, 2);
      for (const Belief& bad : {overflown, undefined}) {
        EXPECT_STREQ(fuse_split(first, nothing, bad, nothing).skipped, "overflow");
        EXPECT_STREQ(fuse_split(bad, nothing, first, nothing).skipped, "overflow");
      }
      continue;
    }
    if (row.fuses == Fuses::by_direction) {
      for (const Belief& bad : {overflown, undefined}) {
        EXPECT_STREQ(fuse_by_direction(row.rule, first, bad).skipped, "overflow") << row.name;
        EXPECT_EQ(fuse_by_direction(row.rule, first, bad).belief.omega, first.omega);
        EXPECT_STREQ(fuse_by_direction(row.rule, bad, first).skipped, "overflow") << row.name;
      }
      continue;
    }
    for (const Belief& bad : {overflown, undefined}) {
      for (const Coefficients& c :
           {coefficients(row.rule, first, bad), coefficients(row.rule, bad, first)}) {
        EXPECT_STREQ(c.skipped, "overflow") << row.name;
        EXPECT_EQ(c.own, 1.0);
        EXPECT_EQ(c.received, 0.0);
        EXPECT_EQ(c.common, 0.0);
      }
    }
  }
}

TEST(FusionRules, BeliefsOfDifferentDimensionsAreRefused) {
  for (const RuleInfo& row : rules()) {
    EXPECT_THROW(coefficients(row.rule, first, Belief::unknown(3)), BrokenInvariant) << row.name;
    EXPECT_THROW(fuse_by_direction(row.rule, first, Belief::unknown(3)), BrokenInvariant);
    if (row.fuses != Fuses::by_weight) {
      EXPECT_THROW(coefficients(row.rule, first, second), BrokenInvariant) << row.name;
    }
    if (row.fuses != Fuses::by_direction) {
      EXPECT_THROW(fuse_by_direction(row.rule, first, second), BrokenInvariant) << row.name;
    }
  }
}

}  // namespace
}  // namespace hearsay::gaussian
