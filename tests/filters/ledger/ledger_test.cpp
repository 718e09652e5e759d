#include "filters/ledger/ledger.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "sim/kernel/error.hpp"
#include "tests/filters/gaussian/samples.hpp"

namespace hearsay {
namespace {

using gaussian::Belief;
using gaussian::matrix;
using gaussian::vector;
using testing::DoubleEq;
using testing::ElementsAre;

Belief information(double omega, double xi) { return {matrix({{omega}}), vector({xi})}; }

Ledger of(std::initializer_list<std::size_t> measurements) {
  Ledger ledger;
  for (const std::size_t k : measurements) ledger.measured(k);
  return ledger;
}

TEST(RumourLedger, AMeasurementCountsOnceEachTimeItIsUsed) {
  Ledger ledger = of({0, 2});
  EXPECT_THAT(ledger.weights(), ElementsAre(1, 0, 1));
  EXPECT_THAT(ledger.reach(), ElementsAre(1, 0, 1));
  ledger.measured(2);
  EXPECT_THAT(ledger.weights(), ElementsAre(1, 0, 2));
  EXPECT_THAT(ledger.reach(), ElementsAre(1, 0, 1));
}

TEST(RumourLedger, NaiveFusionCountsARumourTwice) {
  // a hears b, b hears a, a hears b again.
  Ledger a = of({0});
  Ledger b = of({1});
  a.combine(1, 1, b, 0, nullptr);
  EXPECT_THAT(a.weights(), ElementsAre(1, 1));
  b.combine(1, 1, a, 0, nullptr);
  EXPECT_THAT(b.weights(), ElementsAre(1, 2));
  a.combine(1, 1, b, 0, nullptr);
  EXPECT_THAT(a.weights(), ElementsAre(2, 3));
  EXPECT_THAT(a.reach(), ElementsAre(1, 1));
}

TEST(RumourLedger, AChannelTakesOutWhatIsCommon) {
  Ledger a = of({0, 1});
  Ledger b = of({1, 2});
  const Ledger common = of({1});
  a.combine(1, 1, b, 1, &common);
  EXPECT_THAT(a.weights(), ElementsAre(1, 1, 1));
}

TEST(RumourLedger, CrossingBeliefsLoseInformationInAChannel) {
  // Both have booked their own belief as common before the other's arrives: A + B − A = B.
  Ledger a = of({0});
  const Ledger b = of({1});
  const Ledger booked = a;
  a.combine(1, 1, b, 1, &booked);
  EXPECT_THAT(a.weights(), ElementsAre(0, 1));
  EXPECT_THAT(a.reach(), ElementsAre(1, 1));
}

TEST(RumourLedger, WhatWasNeverThereIsTakenAwayBelowZero) {
  Ledger a = of({1});
  const Ledger received = of({1});
  const Ledger common = of({0, 3});
  a.combine(1, 1, received, 1, &common);
  EXPECT_THAT(a.weights(), ElementsAre(-1, 2, 0, -1));
  // It may have been taken away, but it never travelled here.
  EXPECT_THAT(a.reach(), ElementsAre(0, 1, 0, 0));
}

TEST(RumourLedger, IntersectionLeavesFractions) {
  Ledger a = of({0, 1});
  const Ledger b = of({1, 2});
  a.combine(0.25, 0.75, b, 0, nullptr);
  EXPECT_THAT(a.weights(), ElementsAre(DoubleEq(0.25), DoubleEq(1), DoubleEq(0.75)));
}

TEST(RumourLedger, LedgersOfAnyLengthsCombine) {
  for (std::size_t own = 0; own < 20; ++own) {
    for (std::size_t heard = 0; heard < 20; ++heard) {
      for (std::size_t known = 0; known < 20; ++known) {
        Ledger a;
        Ledger b;
        Ledger c;
        for (std::size_t k = 0; k < own; ++k) a.measured(k);
        for (std::size_t k = 0; k < heard; ++k) b.measured(k);
        for (std::size_t k = 0; k < known; ++k) c.measured(k);
        a.combine(2, 3, b, 5, &c);
        ASSERT_EQ(a.weights().size(), std::max({own, heard, known}));
        ASSERT_EQ(a.reach().size(), a.weights().size());
        for (std::size_t k = 0; k < a.weights().size(); ++k) {
          ASSERT_EQ(a.weights()[k], (k < own ? 2 : 0) + (k < heard ? 3 : 0) - (k < known ? 5 : 0));
          ASSERT_EQ(a.reach()[k], k < own || k < heard ? 1 : 0);
        }
      }
    }
  }
}

TEST(RumourLedger, ABeliefMayBeFusedWithItself) {
  Ledger a = of({0, 1});
  a.combine(1, 1, a, 0, nullptr);
  EXPECT_THAT(a.weights(), ElementsAre(2, 2));
  EXPECT_THROW(a.combine(1, 1, of({0}), 1, &a), BrokenInvariant);
}

TEST(RumourLedger, AClearedLedgerHasMetNothing) {
  Ledger a = of({0, 5});
  a.clear();
  EXPECT_TRUE(a.weights().empty());
  EXPECT_TRUE(a.reach().empty());
  a.measured(1);
  EXPECT_THAT(a.weights(), ElementsAre(0, 1));
}

TEST(Multiplicity, IsOverTheMeasurementsThatCount) {
  Ledger a = of({0, 1, 2});
  Ledger b = of({1, 2, 2});
  a.combine(1, 1, b, 0, nullptr);        // 1, 2, 3
  a.combine(1, 0, Ledger(), 1e-13, &b);  // nothing to speak of
  const Ledger gone = of({0});
  a.combine(1, 0, Ledger(), 1, &gone);  // 0, 2, 3
  a.measured(4);                        // 0, 2, 3, 0, 1
  const Multiplicity m = multiplicity(a);
  EXPECT_EQ(m.measurements, 3u);
  EXPECT_NEAR(m.mean, 2.0, 1e-12);
  EXPECT_NEAR(m.max, 3.0, 1e-12);
  EXPECT_NEAR(m.share_above_one, 2.0 / 3.0, 1e-15);
}

TEST(Multiplicity, OfNothingHasNoMean) {
  for (const Multiplicity& m : {multiplicity(Ledger()), multiplicity([] {
                                  Ledger a = of({0});
                                  const Ledger same = of({0});
                                  a.combine(1, 0, Ledger(), 1, &same);
                                  return a;
                                }())}) {
    EXPECT_EQ(m.measurements, 0u);
    EXPECT_TRUE(std::isnan(m.mean));
    EXPECT_EQ(m.max, 0.0);
    EXPECT_EQ(m.share_above_one, 0.0);
  }
}

TEST(Multiplicity, RoundingIsNotDoubleCounting) {
  Ledger a = of({0, 1});
  a.combine(1 + 1e-10, 0, Ledger(), 0, nullptr);
  EXPECT_EQ(multiplicity(a).share_above_one, 0.0);
  a.combine(1 + 1e-8, 0, Ledger(), 0, nullptr);
  EXPECT_EQ(multiplicity(a).share_above_one, 1.0);
}

TEST(MeasurementBook, SumsWithWeights) {
  MeasurementBook book(1);
  EXPECT_EQ(book.add(information(1, 10)), 0u);
  EXPECT_EQ(book.add(information(2, 20)), 1u);
  EXPECT_EQ(book.add(information(4, 40)), 2u);
  EXPECT_EQ(book.size(), 3u);
  const double weights[] = {1, -2, 0.5};
  EXPECT_EQ(book.weighted_sum(weights).omega(0, 0), -1.0);
  EXPECT_EQ(book.weighted_sum(weights).xi(0), -10.0);
  EXPECT_EQ(book.weighted_square(weights)(0, 0), 1 + 8 + 1);
  EXPECT_EQ(book.weighted_square(weights, 3.0)(0, 0), 90.0);
  // Weights beyond the end, and weights that end early.
  const double more[] = {1, 1, 1, 7, 7};
  EXPECT_EQ(book.weighted_sum(more).omega(0, 0), 7.0);
  EXPECT_EQ(book.weighted_sum(std::span(more).first(2)).omega(0, 0), 3.0);
  const std::uint8_t chosen[] = {1, 0, 1};
  EXPECT_EQ(book.sum_over(chosen).omega(0, 0), 5.0);
  EXPECT_THROW(book.add(Belief::unknown(2)), BrokenInvariant);
}

TEST(MeasurementBook, SumsInEveryDimensionAndLength) {
  Stream random = gaussian::stream("book");
  for (int n = 1; n <= gaussian::dimension_max; ++n) {
    MeasurementBook book(n);
    Belief sum = Belief::unknown(n);
    gaussian::Matrix square = gaussian::Matrix::Zero(n, n);
    std::vector<double> weights;
    for (int k = 0; k < 11; ++k) {
      const Belief z = gaussian::random_belief(random, n);
      const double w = random.normal();
      book.add(z);
      weights.push_back(w);
      sum.omega += w * z.omega;
      sum.xi += w * z.xi;
      square += w * w * z.omega;
      EXPECT_LT(gaussian::relative(book.weighted_sum(weights).omega, sum.omega), 1e-12);
      EXPECT_LT(gaussian::relative(book.weighted_sum(weights).xi, sum.xi), 1e-12);
      EXPECT_LT(gaussian::relative(book.weighted_square(weights), square), 1e-12);
    }
  }
}

TEST(ReachGap, IsZeroForTheCentralFilterOfWhatTravelled) {
  MeasurementBook book(1);
  book.add(information(1, 10));
  book.add(information(2, 20));
  EXPECT_EQ(reach_gap(information(3, 30), of({0, 1}), book), 0.0);
  EXPECT_EQ(reach_gap(information(2, 20), of({1}), book), 0.0);
  EXPECT_EQ(reach_gap(Belief::unknown(1), Ledger(), book), 0.0);
}

TEST(ReachGap, IsTheLargerRelativeDistance) {
  MeasurementBook book(1);
  book.add(information(1, 10));
  book.add(information(2, 20));
  EXPECT_DOUBLE_EQ(reach_gap(information(6, 30), of({0, 1}), book), 1.0);
  EXPECT_DOUBLE_EQ(reach_gap(information(3, 45), of({0, 1}), book), 0.5);
  EXPECT_DOUBLE_EQ(reach_gap(information(3e85, 30), of({0, 1}), book), 1e85);
  EXPECT_DOUBLE_EQ(reach_gap(information(3e200, 30), of({0, 1}), book), 1e200);
  EXPECT_EQ(reach_gap(information(1, 1), Ledger(), book), std::numeric_limits<double>::infinity());
  EXPECT_EQ(reach_gap(information(3, std::nan("")), of({0, 1}), book),
            std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace hearsay
