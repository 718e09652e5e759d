#include "filters/grid/ledger.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "sim/kernel/error.hpp"
#include "tests/filters/grid/ledger_fleet.hpp"

namespace hearsay::grid {
namespace {

const Area field({.columns = 8, .rows = 10});

template <typename Grid>
Grid wide_grid();
template <>
BernoulliGrid wide_grid<BernoulliGrid>() {
  return BernoulliGrid(field, {.prior = 0.3, .limit = BernoulliGrid::limit_max});
}
template <>
BetaGrid wide_grid<BetaGrid>() {
  return BetaGrid(field, {{2.0, 3.0}, BetaGrid::limit_max});
}
template <typename Grid>
bool is_for(const RuleInfo& rule);
template <>
bool is_for<BernoulliGrid>(const RuleInfo& rule) {
  return rule.bernoulli;
}
template <>
bool is_for<BetaGrid>(const RuleInfo& rule) {
  return rule.beta;
}
bool adds(const RuleInfo& rule) { return !rule.idempotent; }
bool chooses(Rule rule) {
  return rule == Rule::maximum || rule == Rule::strongest || rule == Rule::dictatorship ||
         rule == Rule::elementwise_maximum;
}

template <typename Grid>
class GridLedger : public testing::Test {};
using Grids = testing::Types<BernoulliGrid, BetaGrid>;
TYPED_TEST_SUITE(GridLedger, Grids);

/// Compares an agent's ledger with plain arrays, and its evidence with the sum over looks. `scales`
/// are, by number, the largest sums of absolute values so far: roundings are in proportion to them.
template <typename Grid>
void expect_identity(const Fleet<Grid>& fleet, std::size_t agent, std::vector<double>& of_weights,
                     std::vector<double>& of_evidence) {
  for (std::size_t i = 0; i < fleet.numbers(); ++i) {
    const std::span<const float> weights = fleet.ledger(agent).weights(i);
    const std::span<const CellLook> looks = fleet.book().looks(static_cast<int>(i / Grid::layers));
    const std::vector<double>& plain = fleet.plain(agent)[i];
    double size = 0.0, sum = 0.0;
    for (std::size_t k = 0; k < looks.size(); ++k) {
      const double e = fleet.book().added(looks[k], i % Grid::layers);
      size += std::fabs(plain[k] * e);
      sum += plain[k] * e;
      of_weights[i] = std::max(of_weights[i], std::fabs(plain[k]));
    }
    of_evidence[i] = std::max(of_evidence[i], size);
    for (std::size_t k = 0; k < looks.size(); ++k) {
      const double w = k < weights.size() ? static_cast<double>(weights[k]) : 0.0;
      ASSERT_NEAR(w, plain[k], 3e-6 * of_weights[i]) << i << " look " << k;
    }
    const auto evidence = static_cast<double>(fleet.grid(agent).evidence()[i]);
    ASSERT_NEAR(evidence, sum, 3e-6 * of_evidence[i]) << i;
    ASSERT_NEAR(evidence, fleet.book().weighted_sum(i, weights), 3e-6 * of_evidence[i]) << i;
    ASSERT_LT(std::fabs(evidence), 50.0);
  }
}

TYPED_TEST(GridLedger, EvidenceIsTheWeightedSumOfLooksAfterEveryStepUnderEveryRule) {
  for (const RuleInfo& rule : rules()) {
    if (!is_for<TypeParam>(rule)) continue;
    for (const auto& links : {ring(), full_graph()}) {
      SCOPED_TRACE(std::string(rule.name) + (links.size() == 4 ? " ring" : " full"));
      Fleet<TypeParam> fleet({rule.rule, 4, links, 0.4}, wide_grid<TypeParam>());
      Stream random = stream("ledger");
      std::vector<double> of_weights(fleet.numbers()), of_evidence(fleet.numbers());
      // Where loops multiply evidence there must be room for it.
      const double scale = adds(rule) ? 0x1p-60 : 1.0;
      for (int step = 0; step < 240; ++step) {
        const std::size_t agent = fleet.step(random, step < 160, scale);
        expect_identity(fleet, agent, of_weights, of_evidence);
        if (this->HasFatalFailure()) return;
      }
      EXPECT_GT(fleet.book().size(), 200u);
    }
  }
}

TYPED_TEST(GridLedger, ChoosingRulesCountALookOnceOrNotAtAllAndAveragesNeverMoreThanOnce) {
  for (const RuleInfo& rule : rules()) {
    if (!is_for<TypeParam>(rule) || adds(rule)) continue;
    SCOPED_TRACE(rule.name);
    Fleet<TypeParam> fleet({rule.rule, 4, full_graph()}, wide_grid<TypeParam>());
    Stream random = stream("gossip");
    std::size_t once = 0;
    for (int step = 0; step < 200; ++step) {
      const std::size_t agent = fleet.step(random, step < 120, 1.0);
      for (std::size_t i = 0; i < fleet.numbers(); ++i) {
        for (const float w : fleet.ledger(agent).weights(i)) {
          ASSERT_TRUE(!chooses(rule.rule) || w == 0.0F || w == 1.0F) << w;
          ASSERT_LE(w, 1.0F + 1e-5F);
          ASSERT_GE(w, 0.0F);
          once += w == 1.0F ? 1 : 0;
        }
      }
      const LookMultiplicity m = multiplicity(fleet.ledger(agent), fleet.book());
      ASSERT_EQ(m.share_above_one, 0.0);
    }
    EXPECT_GT(once, 0u);
  }
}

TYPED_TEST(GridLedger, ChannelRobustOnATreeCountsEveryLookOnceInTheEnd) {
  Fleet<TypeParam> fleet({Rule::channel_robust, 4, tree()}, wide_grid<TypeParam>());
  Stream random = stream("tree");
  std::size_t heard = 0, missing = 0;
  for (int step = 0; step < 300; ++step) {
    const std::size_t agent = fleet.step(random, step < 200, 1.0);
    for (std::size_t i = 0; i < fleet.numbers(); ++i) {
      for (const float w : fleet.ledger(agent).weights(i)) {
        ASSERT_TRUE(w == 0.0F || w == 1.0F) << w;
        (w == 0.0F ? missing : heard) += 1;
      }
    }
  }
  EXPECT_GT(heard, 0u);
  EXPECT_GT(missing, 0u);
  for (int round = 0; round < 2; ++round) {
    for (const auto& [a, b] : fleet.links()) fleet.exchange(a, b);
    for (const auto& [a, b] : fleet.links()) fleet.exchange(b, a);
  }
  for (std::size_t agent = 0; agent < 4; ++agent) {
    for (std::size_t i = 0; i < fleet.numbers(); ++i) {
      const std::size_t looks = fleet.book().looks(static_cast<int>(i / TypeParam::layers)).size();
      const std::span<const float> weights = fleet.ledger(agent).weights(i);
      ASSERT_EQ(std::vector<float>(weights.begin(), weights.end()),
                std::vector<float>(looks, 1.0F));
    }
    const LookMultiplicity m = multiplicity(fleet.ledger(agent), fleet.book());
    EXPECT_EQ(m.mean, 1.0);
    EXPECT_EQ(m.max, 1.0);
    EXPECT_EQ(m.share_missing, 0.0);
  }
}

// One cell, two agents that each looked at it once, for closed forms.
constexpr CellLook yes{0, 0.8, 1.0, 0.0}, no{0, -0.3, 0.0, 1.0};
Fleet<BernoulliGrid> two_agents(Rule rule, double scale = 1.0) {
  Fleet<BernoulliGrid> fleet({rule, 2, {{0, 1}}}, BernoulliGrid(square(1), {.limit = 64.0}));
  fleet.look(0, {0, scale * yes.ratio, 0.0, 0.0});
  fleet.look(1, {0, scale * no.ratio, 0.0, 0.0});
  return fleet;
}
std::vector<float> weights(const LookLedger& ledger, std::size_t number = 0) {
  return {ledger.weights(number).begin(), ledger.weights(number).end()};
}

TEST(GridLedgerOfTwo, NaiveInTurnsCountsByFibonacciAndAtOnceByDoubling) {
  Fleet<BernoulliGrid> in_turns = two_agents(Rule::naive, 1e-4);
  float before = 1.0F, last = 1.0F;  // F(1), F(2)
  for (int n = 0; n < 12; ++n) {
    in_turns.exchange(0, 1);
    EXPECT_EQ(weights(in_turns.ledger(1)), (std::vector{last, before}));
    in_turns.exchange(1, 0);
    EXPECT_EQ(weights(in_turns.ledger(0)), (std::vector{before + last, last}));
    before += last;
    last += before;
  }
  EXPECT_EQ(last, 121393.0F);  // F(26)
  Fleet<BernoulliGrid> at_once = two_agents(Rule::naive, 1e-4);
  for (int n = 0; n < 12; ++n) {
    at_once.send(0, 1);
    at_once.send(1, 0);
    at_once.deliver(0, 0, 1);
    at_once.deliver(0, 0, 1);
    const float doubled = std::ldexp(1.0F, n);
    EXPECT_EQ(weights(at_once.ledger(0)), (std::vector{doubled, doubled}));
    EXPECT_EQ(weights(at_once.ledger(1)), (std::vector{doubled, doubled}));
  }
}

TEST(GridLedgerOfTwo, ChannelCountsOnceInTurnsAndLosesLooksThatCross) {
  Fleet<BernoulliGrid> in_turns = two_agents(Rule::channel);
  for (int n = 0; n < 3; ++n) {
    in_turns.exchange(0, 1);
    in_turns.exchange(1, 0);
  }
  EXPECT_EQ(weights(in_turns.ledger(0)), (std::vector{1.0F, 1.0F}));
  EXPECT_EQ(weights(in_turns.ledger(1)), (std::vector{1.0F, 1.0F}));
  // Both have booked their own as common: A + B − A = B.
  Fleet<BernoulliGrid> crossing = two_agents(Rule::channel);
  crossing.send(0, 1);
  crossing.send(1, 0);
  crossing.deliver(0, 0, 1);
  crossing.deliver(0, 0, 1);
  EXPECT_EQ(weights(crossing.ledger(0)), (std::vector{0.0F, 1.0F}));
  EXPECT_EQ(weights(crossing.ledger(1)), (std::vector{1.0F, 0.0F}));
}

TEST(GridLedgerOfTwo, WeightsAreThoseOfTheFormulas) {
  const auto after_one = [](Rule rule, double omega) {
    Fleet<BernoulliGrid> fleet({rule, 2, {{0, 1}}, omega}, BernoulliGrid(square(1)));
    fleet.look(0, {0, log_odds_of(0.3), 0.0, 0.0});
    fleet.look(1, {0, log_odds_of(0.9), 0.0, 0.0});
    fleet.exchange(0, 1);
    return weights(fleet.ledger(1));
  };
  EXPECT_EQ(after_one(Rule::geometric_mean, 0.75), (std::vector{0.25F, 0.75F}));
  // p = (0.9 + 0.3)/2 = 0.6, so λ·log 9 + (1 − λ)·log(3/7) = log 1.5.
  const double lambda = std::log(1.5 * 7 / 3) / std::log(9.0 * 7 / 3);
  const std::vector<float> pooled = after_one(Rule::linear_pool, 0.5);
  EXPECT_NEAR(pooled[1], lambda, 1e-6);
  EXPECT_NEAR(pooled[0], 1.0 - lambda, 1e-6);
  EXPECT_EQ(after_one(Rule::maximum, 0.5), (std::vector{0.0F, 1.0F}));
}

TEST(GridLedgerOfTwo, LinearPoolOfNearlyEqualEvidenceStaysBetweenBoth) {
  BernoulliGrid own(square(1), {.limit = 64.0});
  for (float e = -40.0F; e < 41.0F; e += 2.5F) {
    own.evidence_mutable()[0] = e;
    for (const float heard : {e, std::nextafter(e, 100.0F), std::nextafter(e, -100.0F)}) {
      std::vector<Shares> s(1);
      shares(Rule::linear_pool, own, {.received = std::span(&heard, 1)}, 0.3, s);
      EXPECT_GE(s[0].own, 0.0);
      EXPECT_LE(s[0].own, 1.0);
      EXPECT_EQ(s[0].own + s[0].heard, 1.0);
      if (heard == e) {
        EXPECT_EQ(s[0].own, 0.3);
      }
    }
  }
}

TEST(GridLedgerOfTwo, ElementwiseMaximumTakesTheLayersApart) {
  Fleet<BetaGrid> fleet({Rule::elementwise_maximum, 2, {{0, 1}}}, BetaGrid(square(1)));
  fleet.look(0, {0, 0.0, 1.0, 4.0});
  fleet.look(1, {0, 0.0, 3.0, 1.0});
  fleet.exchange(0, 1);
  EXPECT_EQ(weights(fleet.ledger(1), 0), (std::vector{0.0F, 1.0F}));  // m of its own look
  EXPECT_EQ(weights(fleet.ledger(1), 1), (std::vector{1.0F}));        // n of the other's
}

TEST(GridLedgerOfTwo, TheTextsExampleCountsOneLookTwice) {
  // Section 4.1.3: the first holds 0.7. The third hears it from the first, and from the second.
  Fleet<BernoulliGrid> fleet({Rule::naive, 3, {{0, 1}, {0, 2}, {1, 2}}}, BernoulliGrid(square(1)));
  fleet.look(0, {0, log_odds_of(0.7), 0.0, 0.0});
  for (const auto& [from, to] : fleet.links()) fleet.exchange(from, to);
  EXPECT_NEAR(fleet.grid(2).probability(0), 0.845, 5e-4);
  EXPECT_EQ(weights(fleet.ledger(2)), std::vector{2.0F});
  const LookMultiplicity m = multiplicity(fleet.ledger(2), fleet.book());
  EXPECT_EQ(m.share_above_one, 1.0);
  EXPECT_EQ(m.max, 2.0);
}

TEST(GridLedgerOfTwo, BeyondTheLimitWeightsCountOnAndTheGapTells) {
  BernoulliGrid grid(square(1), {.limit = 1.0});
  LookBook book({1, 1});
  LookLedger ledger({1, 1});
  for (int i = 0; i < 2; ++i) {
    EXPECT_LT(largest_gap(ledger, book, grid.evidence()), 1e-6);
    grid.add(0, yes.ratio);
    ledger.looked(0, book.add(yes));
  }
  EXPECT_EQ(weights(ledger), (std::vector{1.0F, 1.0F}));
  EXPECT_NEAR(largest_gap(ledger, book, grid.evidence()), 0.6, 1e-6);
}

TEST(LookLedger, MultiplicityLeavesOutWhatLooksDidNotSay) {
  LookBook book({2, 2});
  LookLedger ledger({2, 2}), other({2, 2});
  EXPECT_TRUE(std::isnan(multiplicity(ledger, book).mean));
  EXPECT_EQ(multiplicity(ledger, book).share_missing, 0.0);
  ledger.looked(1, book.add({1, 0.0, 0.5, 2.0}));
  ledger.looked(1, book.add({1, 0.0, 0.0, 1.0}));  // no m: no weight for it is looked at
  other.looked(0, book.add({0, 0.0, 1.0, 0.0}));   // no n likewise, and not heard of
  // Weights of the first look: m 1, n 3. Of the second: n 3.
  const std::vector<Shares> triple = {{1, 0, 0}, {1, 0, 0}, {1, 0, 0}, {3, 0, 0}};
  ledger.combine(0, triple, other);
  const LookMultiplicity m = multiplicity(ledger, book);
  EXPECT_EQ(m.looks, 3u);
  EXPECT_EQ(m.mean, 7.0 / 3.0);
  EXPECT_EQ(m.max, 3.0);
  EXPECT_EQ(m.share_above_one, 2.0 / 3.0);
  EXPECT_EQ(m.share_missing, 0.25);
  EXPECT_EQ(book.size(), 3u);
  EXPECT_EQ(book.weighted_sum(3, ledger.weights(3)), 3.0 * 2.0 + 3.0 * 1.0);
}

TEST(LookLedger, CopiesStayWhatTheyWere) {
  const Shape shape{80, 1};
  LookLedger own(shape), heard(shape);
  for (int cell = 0; cell < 80; ++cell) own.looked(cell, 0);
  const LookLedger before = own;
  own.looked(40, 0);
  own.looked(41, 2);
  heard.copy_range(30, 11, own);
  EXPECT_EQ(weights(before, 40), std::vector{1.0F});
  EXPECT_EQ(weights(before, 41), std::vector{1.0F});
  EXPECT_EQ(weights(own, 40), std::vector{2.0F});
  EXPECT_EQ(weights(own, 41), (std::vector{1.0F, 0.0F, 1.0F}));
  for (int cell = 0; cell < 80; ++cell) {
    const bool taken = cell >= 30 && cell < 41;
    const std::vector<float> expected(taken ? 1 : 0, cell == 40 ? 2.0F : 1.0F);
    EXPECT_EQ(weights(heard, static_cast<std::size_t>(cell)), expected) << cell;
  }
  heard.looked(30, 1);
  EXPECT_EQ(weights(own, 30), std::vector{1.0F});
  own.clear();
  EXPECT_TRUE(weights(own, 40).empty());
  EXPECT_EQ(weights(heard, 40), std::vector{2.0F});
  EXPECT_EQ(weights(before, 0), std::vector{1.0F});
}

TEST(LookLedger, RowsOfAnyLengthAndSharesAreCombinedLookByLook) {
  Stream random = stream("rows");
  constexpr std::uint32_t looks = 200;
  const auto ledger_of = [&](std::uint32_t length) {
    LookLedger ledger({1, 1});
    for (std::uint32_t k = 0; k < length; ++k) {
      for (std::uint64_t times = random.below(4); times > 0; --times) ledger.looked(0, k);
    }
    return ledger;
  };
  const auto at = [](const std::vector<float>& row, std::size_t k) {
    return k < row.size() ? static_cast<double>(row[k]) : 0.0;
  };
  const auto length = [&] { return static_cast<std::uint32_t>(random.below(looks)); };
  for (int i = 0; i < 90; ++i) {
    LookLedger own = ledger_of(length());
    const LookLedger other = ledger_of(length()), common = ledger_of(length());
    // At times a row that both sides have, or that is also the common one.
    const LookLedger heard = i % 3 == 0 ? other : i % 3 == 1 ? own : common;
    const std::vector<float> a = weights(own), b = weights(heard), c = weights(common);
    const auto half = [&] { return 0.5 * static_cast<double>(random.below(4)); };
    const Shares s{half(), half(), half()};
    own.combine(0, std::span(&s, 1), heard, &common);
    const std::vector<float> result = weights(own);
    for (std::size_t k = 0; k < looks; ++k) {
      ASSERT_EQ(at(result, k), s.own * at(a, k) + s.heard * at(b, k) - s.common * at(c, k)) << i;
    }
    EXPECT_LE(result.size(), std::max({a.size(), b.size(), c.size()}));
    EXPECT_EQ(weights(heard), b);
  }
}

TEST(LookLedger, OneWeightAmongManyIsEnoughToChangeARow) {
  for (const std::uint32_t changed : {0U, 63U, 64U, 99U}) {
    LookLedger own({1, 1}), heard({1, 1});
    for (std::uint32_t k = 0; k < 100; ++k) own.looked(0, k);
    heard.looked(0, changed);
    own.combine(0, std::vector<Shares>{{1.0, 1.0, 0.0}}, heard);
    std::vector<float> expected(100, 1.0F);
    expected[changed] = 2.0F;
    EXPECT_EQ(weights(own), expected);
  }
}

TEST(LookLedger, WeightsBeyondAllBoundsStayFinite) {
  LookLedger own({1, 1});
  own.looked(0, 0);
  for (int i = 0; i < 300; ++i) {
    const LookLedger heard = own;
    own.combine(0, std::vector<Shares>{{1.0, 1.0, 0.0}}, heard);
  }
  EXPECT_EQ(weights(own), std::vector{1e30F});
  LookLedger none({1, 1}), less({1, 1});
  less.difference(none, own);
  EXPECT_EQ(weights(less), std::vector{-1e30F});
  for (int i = 0; i < 300; ++i) own.combine(0, std::vector<Shares>{{0.5, 0.5, 0.0}}, none);
  EXPECT_EQ(weights(own), std::vector{0.0F});
}

TEST(LookLedger, RefusesWhatDoesNotFit) {
  LookBook book({4, 2});
  LookLedger ledger({4, 2}), other({4, 1}), fits({4, 2});
  const std::vector<Shares> part(3), two(2);
  const std::vector<float> eight(8);
  EXPECT_THROW(LookBook({1, 3}), BrokenInvariant);
  EXPECT_THROW(LookLedger({-1, 1}), BrokenInvariant);
  EXPECT_THROW(book.add({4, 0.0, 1.0, 1.0}), BrokenInvariant);
  EXPECT_THROW(book.add({-1, 0.0, 1.0, 1.0}), BrokenInvariant);
  EXPECT_THROW(book.add({0, 0.0, HUGE_VAL, 1.0}), BrokenInvariant);
  EXPECT_THROW(book.looks(4), BrokenInvariant);
  EXPECT_THROW(ledger.looked(4, 0), BrokenInvariant);
  EXPECT_THROW(ledger.weights(8), BrokenInvariant);
  EXPECT_THROW(ledger.combine(0, part, fits), BrokenInvariant);
  EXPECT_THROW(ledger.combine(4, two, fits), BrokenInvariant);
  EXPECT_THROW(ledger.combine(-1, two, fits), BrokenInvariant);
  EXPECT_THROW(ledger.combine(0, two, other), BrokenInvariant);
  EXPECT_THROW(ledger.combine(0, two, ledger), BrokenInvariant);
  EXPECT_THROW(ledger.combine(0, two, fits, &ledger), BrokenInvariant);
  EXPECT_THROW(ledger.difference(fits, ledger), BrokenInvariant);
  EXPECT_THROW(ledger.copy_range(3, 2, fits), BrokenInvariant);
  EXPECT_THROW(ledger.copy_range(0, 4, other), BrokenInvariant);
  EXPECT_THROW(multiplicity(other, book), BrokenInvariant);
  EXPECT_THROW(largest_gap(ledger, book, std::span(eight).first(7)), BrokenInvariant);
  EXPECT_EQ(largest_gap(ledger, book, eight), 0.0);
}

}  // namespace
}  // namespace hearsay::grid
