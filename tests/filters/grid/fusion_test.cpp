#include "filters/grid/fusion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "sim/kernel/error.hpp"
#include "tests/filters/grid/samples.hpp"

namespace hearsay::grid {
namespace {

// One suite over every rule and both kinds of grid.
struct Case {
  Rule rule;
  bool beta;
};
std::vector<Case> cases() {
  std::vector<Case> all;
  for (const RuleInfo& row : rules()) {
    if (row.bernoulli) all.push_back({row.rule, false});
    if (row.beta) all.push_back({row.rule, true});
  }
  return all;
}

class EveryGridRule : public testing::TestWithParam<Case> {
 protected:
  Rule rule() const { return GetParam().rule; }
  const RuleInfo& row() const { return info(rule()); }
  std::vector<float> sample(Stream& random) const {
    return GetParam().beta ? random_counts(random, 200) : random_evidence(random, 100);
  }
  /// What `own` becomes. Nothing was common yet.
  std::vector<float> fused(const std::vector<float>& own, const std::vector<float>& received,
                           double omega = usual_omega) const {
    const std::vector<float> nothing(own.size(), 0.0F);
    return fused_with(own, {.received = received, .common = nothing}, omega);
  }
  std::vector<float> fused_with(const std::vector<float>& own, const Heard& heard,
                                double omega) const {
    if (GetParam().beta) return fused_in(BetaGrid(square(10), {{2.0, 3.0}}), own, heard, omega);
    return fused_in(BernoulliGrid(square(10), {.prior = 0.3}), own, heard, omega);
  }
  std::vector<Shares> shares_of(const std::vector<float>& own, const Heard& heard,
                                double omega) const {
    if (GetParam().beta) return shares_in(BetaGrid(square(10), {{2.0, 3.0}}), own, heard, omega);
    return shares_in(BernoulliGrid(square(10), {.prior = 0.3}), own, heard, omega);
  }

 private:
  template <typename Grid>
  std::vector<Shares> shares_in(Grid grid, const std::vector<float>& own, const Heard& heard,
                                double omega) const {
    set(grid, own);
    std::vector<Shares> out(own.size());
    shares(rule(), grid, heard, omega, out);
    return out;
  }
  template <typename Grid>
  std::vector<float> fused_in(Grid grid, const std::vector<float>& own, const Heard& heard,
                              double omega) const {
    set(grid, own);
    fuse(rule(), grid, heard, omega);
    return copy_of(grid);
  }
};

TEST_P(EveryGridRule, IsIdempotentWhereItSaysSo) {
  Stream random = stream("idempotent");
  for (int i = 0; i < 20; ++i) {
    const std::vector<float> own = sample(random);
    EXPECT_EQ(fused(own, own) == own, row().idempotent);
    if (row().idempotent) {
      EXPECT_EQ(fused(own, own, 0.3), own);
    }
  }
}

TEST_P(EveryGridRule, IsCommutativeWhereItSaysSo) {
  Stream random = stream("commutative");
  for (int i = 0; i < 20; ++i) {
    const std::vector<float> a = sample(random), b = sample(random);
    EXPECT_EQ(fused(a, b) == fused(b, a), row().commutative);
  }
}

TEST_P(EveryGridRule, IsCommutativeAmongOpposites) {
  // Equally strong and opposite, around zero and around the prior: no order may decide.
  if (!row().commutative) return;
  const std::size_t n = GetParam().beta ? 200 : 100;
  std::vector<float> a(n), b(n);
  const double l0 = log_odds_of(0.3);
  for (std::size_t i = 0; i < n; ++i) {
    const double x = 0.25 * static_cast<double>(i / 2);
    a[i] = static_cast<float>(i % 2 == 0 ? x : x - l0);
    b[i] = static_cast<float>(i % 2 == 0 ? -x : -x - l0);
    if (GetParam().beta) {  // (m, n) against (n, m), about the prior (2, 3)
      a[i] = static_cast<float>(i % 2 == 0 ? x + 1.0 : 0.0);
      b[i] = static_cast<float>(i % 2 == 0 ? 1.0 : x);
    }
  }
  EXPECT_EQ(fused(a, b), fused(b, a));
}

TEST_P(EveryGridRule, KeepsWithinLimits) {
  const std::size_t n = GetParam().beta ? 200 : 100;
  std::vector<float> own(n, GetParam().beta ? 9e5F : 19.0F);
  const std::vector<float> received = own;
  for (int i = 0; i < 100; ++i) own = fused(own, received);
  for (const float e : own) {
    EXPECT_LE(static_cast<double>(e), GetParam().beta ? 1e6 : 20.0 - log_odds_of(0.3));
  }
}

TEST_P(EveryGridRule, TouchesOnlyTheCellsThatWereHeard) {
  Stream random = stream("ranges");
  const std::vector<float> a = sample(random), b = sample(random);
  const std::vector<float> whole = fused(a, b);
  const std::vector<float> nothing(a.size(), 0.0F);
  const std::size_t layers = a.size() / 100;
  const auto part = std::span(b).subspan(30 * layers, 45 * layers);
  const Heard heard{30, part, std::span(nothing).first(part.size())};
  std::vector<float> result;
  if (GetParam().beta) {
    BetaGrid grid(square(10), {{2.0, 3.0}});
    set(grid, a);
    fuse(rule(), grid, heard);
    result = copy_of(grid);
  } else {
    BernoulliGrid grid(square(10), {.prior = 0.3});
    set(grid, a);
    fuse(rule(), grid, heard);
    result = copy_of(grid);
  }
  for (std::size_t i = 0; i < a.size(); ++i) {
    const bool inside = i >= 30 * layers && i < 75 * layers;
    EXPECT_EQ(result[i], inside ? whole[i] : a[i]);
  }
}

TEST_P(EveryGridRule, SharesMakeWhatFusionMakes) {
  Stream random = stream("shares");
  for (int i = 0; i < 20; ++i) {
    std::vector<float> a = sample(random), b = sample(random), c = sample(random);
    a[0] = b[0];
    const std::vector<Shares> made = shares_of(a, {0, b, c}, 0.3);
    const std::vector<float> result = fused_with(a, {0, b, c}, 0.3);
    for (std::size_t k = 0; k < a.size(); ++k) {
      const Shares& s = made[k];
      const double sum = s.own * static_cast<double>(a[k]) + s.heard * static_cast<double>(b[k]) -
                         s.common * static_cast<double>(c[k]);
      EXPECT_NEAR(static_cast<double>(result[k]), sum, 1e-5) << k;
      if (row().idempotent) {
        EXPECT_NEAR(s.own + s.heard, 1.0, 1e-12);
        EXPECT_GE(s.own, 0.0);
        EXPECT_LE(s.own, 1.0);
      }
    }
  }
}

TEST_P(EveryGridRule, HasAWholeRow) {
  EXPECT_EQ(rule_by_name(row().name), rule());
  for (const std::string_view text :
       {row().assumes, row().conservative, row().cost, row().source, row().ledger}) {
    EXPECT_FALSE(text.empty());
  }
}

INSTANTIATE_TEST_SUITE_P(GridRules, EveryGridRule, testing::ValuesIn(cases()),
                         [](const testing::TestParamInfo<Case>& at) {
                           std::string name(grid::info(at.param.rule).name);
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name + (at.param.beta ? "_beta" : "_bernoulli");
                         });

// What each rule makes of one cell, by the formulas of probability.
BernoulliGrid cell(double probability, double prior = 0.5) {
  BernoulliGrid grid(square(1), {.prior = prior});
  grid.add(0, log_odds_of(probability) - log_odds_of(prior));
  return grid;
}
double fused_probability(Rule rule, double own, double received, double prior = 0.5,
                         double omega = usual_omega) {
  BernoulliGrid a = cell(own, prior);
  const BernoulliGrid b = cell(received, prior);
  const std::vector<float> nothing(1, 0.0F);
  fuse(rule, a, {.received = b.evidence(), .common = nothing}, omega);
  return a.probability(0);
}

TEST(GridFusion, NaiveIsBayesRuleWithThePriorCountedOnce) {
  for (const double prior : {0.5, 0.2}) {
    const double yes = 0.7 * 0.6 / prior, no = 0.3 * 0.4 / (1 - prior);
    EXPECT_NEAR(fused_probability(Rule::naive, 0.7, 0.6, prior), yes / (yes + no), 1e-7);
  }
}

TEST(GridFusion, ChoicesByProbability) {
  EXPECT_NEAR(fused_probability(Rule::maximum, 0.1, 0.6), 0.6, 1e-7);
  EXPECT_NEAR(fused_probability(Rule::strongest, 0.1, 0.6), 0.1, 1e-7);
  EXPECT_NEAR(fused_probability(Rule::dictatorship, 0.1, 0.6), 0.1, 1e-7);
  // Prior 0.2: 0.6 moved farther from it than 0.1 did, but 0.1 has less entropy.
  EXPECT_NEAR(fused_probability(Rule::strongest, 0.1, 0.6, 0.2), 0.6, 1e-7);
  EXPECT_NEAR(fused_probability(Rule::dictatorship, 0.1, 0.6, 0.2), 0.1, 1e-7);
  // 0.1 against 0.9 is not settled by entropy (section 4.1.3): alarm.
  EXPECT_NEAR(fused_probability(Rule::dictatorship, 0.125, 0.875), 0.875, 1e-7);
  EXPECT_NEAR(fused_probability(Rule::dictatorship, 0.875, 0.125), 0.875, 1e-7);
}

TEST(GridFusion, DictatorshipTakesTheLesserEntropy) {
  Stream random = stream("dictator");
  for (int i = 0; i < 300; ++i) {
    const double prior = random.uniform(0.1, 0.9);
    const double p = random.uniform(0.01, 0.99), q = random.uniform(0.01, 0.99);
    const auto h = [](double x) { return -x * std::log(x) - (1 - x) * std::log(1 - x); };
    EXPECT_NEAR(h(fused_probability(Rule::dictatorship, p, q, prior)), std::min(h(p), h(q)), 1e-6);
  }
}

TEST(GridFusion, PoolsByProbability) {
  for (const double omega : {0.0, 0.25, 0.5, 1.0}) {
    for (const double prior : {0.5, 0.2}) {
      EXPECT_NEAR(fused_probability(Rule::linear_pool, 0.9, 0.3, prior, omega),
                  omega * 0.9 + (1 - omega) * 0.3, 1e-7);
      const double yes = std::pow(0.9, omega) * std::pow(0.3, 1 - omega);
      const double no = std::pow(0.1, omega) * std::pow(0.7, 1 - omega);
      EXPECT_NEAR(fused_probability(Rule::geometric_mean, 0.9, 0.3, prior, omega), yes / (yes + no),
                  1e-7);
    }
  }
}

TEST(GridFusion, TheTextsExampleRaisesAnAlarmByHearsayAlone) {
  // Section 4.1.3: j holds 0.7. i hears it from j, and from a third agent that has it from j.
  const BernoulliGrid j = cell(0.7);
  EXPECT_NEAR(j.evidence()[0], 0.847F, 5e-4F);
  const auto heard_twice = [&](Rule rule) {
    BernoulliGrid i(square(1)), third(square(1));
    std::vector<unsigned char> alarms;
    fuse(rule, third, {.received = j.evidence()});
    fuse(rule, i, {.received = j.evidence()});
    fuse(rule, i, {.received = third.evidence()});
    return std::pair(i.probability(0), i.mark_above(0.8, alarms));
  };
  EXPECT_NEAR(heard_twice(Rule::naive).first, 0.845, 5e-4);
  EXPECT_EQ(heard_twice(Rule::naive).second, 1);
  for (const Rule rule : {Rule::maximum, Rule::strongest, Rule::dictatorship, Rule::geometric_mean,
                          Rule::linear_pool}) {
    EXPECT_LE(heard_twice(rule).first, 0.7 + 1e-7);
    EXPECT_EQ(heard_twice(rule).second, 0);
  }
}

TEST(GridFusion, BetaRulesOfTheText) {
  const auto fused = [](Rule rule, Beta a, Beta b, Beta common = {1, 1}) {
    BetaGrid own(square(1)), received(square(1)), known(square(1));
    own.add(0, a.alpha - 1, a.beta - 1);
    received.add(0, b.alpha - 1, b.beta - 1);
    known.add(0, common.alpha - 1, common.beta - 1);
    fuse(rule, own, {.received = received.evidence(), .common = known.evidence()});
    return std::pair(own.at(0).alpha, own.at(0).beta);
  };
  EXPECT_EQ(fused(Rule::naive, {3, 5}, {4, 2}), std::pair(6.0, 6.0));                // eq. 4.35
  EXPECT_EQ(fused(Rule::channel, {3, 5}, {4, 2}, {2, 1.5}), std::pair(5.0, 5.5));    // eq. 4.36
  EXPECT_EQ(fused(Rule::elementwise_maximum, {3, 5}, {4, 2}), std::pair(4.0, 5.0));  // eq. 4.39
  EXPECT_EQ(fused(Rule::averaged_parameters, {3, 5}, {4, 2}), std::pair(3.5, 3.5));
  // Entropies −.868649 and −.794920 (facts of the literature): the first is more certain.
  EXPECT_EQ(fused(Rule::dictatorship, {4, 12}, {8, 2}), std::pair(4.0, 12.0));
  EXPECT_EQ(fused(Rule::dictatorship, {8, 2}, {4, 12}), std::pair(4.0, 12.0));
  // What is no Beta is not believed.
  EXPECT_EQ(fused(Rule::channel, {1, 1}, {1, 1}, {3, 1}).first, -1.0);
}

TEST(GridFusion, WhatIsNoBetaDoesNotDictate) {
  BetaGrid own(square(1)), broken(square(1));
  own.add(0, 1.0, 0.0);
  broken.evidence_mutable()[0] = -5.0F;
  BetaGrid mended = broken;
  fuse(Rule::dictatorship, own, {.received = broken.evidence()});
  EXPECT_EQ(own.at(0).alpha, 2.0);
  fuse(Rule::dictatorship, mended, {.received = own.evidence()});
  EXPECT_EQ(mended.at(0).alpha, 2.0);
}

TEST(GridFusion, RefusesWhatDoesNotFit) {
  BernoulliGrid grid(square(2));
  BetaGrid beta(square(2));
  const std::vector<float> four(4, 1.0F), three(3, 1.0F), eight(8, 1.0F);
  EXPECT_THROW(fuse(Rule::naive, grid, {1, four}), BrokenInvariant);
  EXPECT_THROW(fuse(Rule::naive, grid, {-1, four}), BrokenInvariant);
  EXPECT_THROW(fuse(Rule::naive, grid, {0, eight}), BrokenInvariant);
  EXPECT_THROW(fuse(Rule::naive, beta, {0, three}), BrokenInvariant);
  EXPECT_THROW(fuse(Rule::channel, grid, {0, four}), BrokenInvariant);
  EXPECT_THROW(fuse(Rule::channel_robust, grid, {0, four, three}), BrokenInvariant);
  EXPECT_THROW(fuse(Rule::geometric_mean, grid, {0, four}, 1.1), BrokenInvariant);
  EXPECT_THROW(fuse(Rule::geometric_mean, grid, {0, four}, NAN), BrokenInvariant);
  EXPECT_THROW(fuse(Rule::maximum, beta, {0, eight}), BrokenInvariant);
  EXPECT_THROW(fuse(Rule::averaged_parameters, grid, {0, four}), BrokenInvariant);
  EXPECT_FALSE(rule_by_name("no such rule"));
  std::vector<Shares> out(4);
  EXPECT_THROW(shares(Rule::naive, grid, {0, three}, 0.5, out), BrokenInvariant);
  EXPECT_THROW(shares(Rule::naive, grid, {1, four}, 0.5, out), BrokenInvariant);
  EXPECT_THROW(shares(Rule::channel, grid, {0, four}, 0.5, out), BrokenInvariant);
  EXPECT_THROW(shares(Rule::maximum, beta, {0, four}, 0.5, out), BrokenInvariant);
}

}  // namespace
}  // namespace hearsay::grid
