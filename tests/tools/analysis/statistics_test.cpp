#include "tools/analysis/statistics.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "sim/kernel/error.hpp"
#include "sim/kernel/random.hpp"

namespace hearsay::analysis {
namespace {

using Values = std::vector<double>;
constexpr double infinity = std::numeric_limits<double>::infinity();

void expect_interval(const Interval& interval, double estimate, double low, double high) {
  EXPECT_NEAR(interval.estimate, estimate, 1e-6 * std::abs(estimate) + 1e-12);
  EXPECT_NEAR(interval.low, low, 1e-6 * std::abs(low) + 1e-12);
  EXPECT_NEAR(interval.high, high, 1e-6 * std::abs(high) + 1e-12);
}

TEST(Statistics, TheTIntervalIsTheOneOfTheTextbook) {
  // Mean 3, deviation √2.5, t(4, 97.5 %) = 2.776445.
  expect_interval(mean_t(Values{1, 2, 3, 4, 5}, 0.05), 3.0, 1.036757, 4.963243);
}

TEST(Statistics, ASmallerAlphaWidensTheInterval) {
  // t(4, 99.5 %) = 4.604095.
  expect_interval(mean_t(Values{1, 2, 3, 4, 5}, 0.01), 3.0, -0.2555867, 6.2555867);
}

TEST(Statistics, OneValueHasNoWidthAndEqualValuesHaveWidthZero) {
  expect_interval(mean_t(Values{2.5, 2.5, 2.5}, 0.05), 2.5, 2.5, 2.5);
  const Interval one = mean_t(Values{2.5}, 0.05);
  EXPECT_EQ(one.estimate, 2.5);
  EXPECT_EQ(one.low, -infinity);
  EXPECT_EQ(one.high, infinity);
  const Interval rms = rms_interval(Values{-2.5}, 0.05);
  EXPECT_EQ(rms.estimate, 2.5);
  EXPECT_EQ(rms.low, 0.0);
  EXPECT_EQ(rms.high, infinity);
}

TEST(Statistics, ValuesThatDifferOnlyByRoundingHaveWidthZero) {
  const double x = 1e6 / 3.0;
  const Interval interval = mean_t(Values{x, std::nextafter(x, 1e9), x}, 0.05);
  EXPECT_EQ(interval.low, interval.high);
}

TEST(Statistics, MeansOfNonnegativeValuesAreIntervalsOfTheInverseCubeRoot) {
  // Mean 2, standard error 1/√3, t(2, 97.5 %) = 4.302653: 2/(1 ± 0.414023)³.
  expect_interval(mean_of_nonnegative(Values{1, 2, 3}, 0.05), 2.0, 0.70739277, 9.94004107);
  // Too wide a spread for a finite upper end.
  EXPECT_EQ(mean_of_nonnegative(Values{0, 0, 0, 1}, 0.001).high, infinity);
}

TEST(Statistics, TheRootMeanSquareIsThatOfTheSquares) {
  const Interval squares = mean_of_nonnegative(Values{1, 4, 9}, 0.05);
  expect_interval(rms_interval(Values{1, -2, 3}, 0.05), std::sqrt(14.0 / 3.0), 0.96007834,
                  std::sqrt(squares.high));
}

TEST(Statistics, TinyAndHugeValuesNeitherUnderflowNorOverflow) {
  const Interval tiny = rms_interval(Values{1e-200, 2e-200}, 0.05);
  EXPECT_NEAR(tiny.estimate / 1e-200, std::sqrt(2.5), 1e-9);
  const Interval huge = rms_interval(Values{1e200, 2e200}, 0.05);
  EXPECT_NEAR(huge.estimate / 1e200, std::sqrt(2.5), 1e-9);
  EXPECT_TRUE(std::isfinite(mean_t(Values{1e308, 1.2e308, 1.1e308}, 0.05).low));
}

TEST(Statistics, RatiosAndDifferencesOfPairsAgreeWithAHandCalculation) {
  const Values a = {2, 4, 6, 9};
  const Values b = {1, 2, 4, 4};
  expect_interval(ratio_of_means(a, b, 0.05), 1.9090909091, 1.3128427467, 2.7761345433);
  expect_interval(ratio_of_rms(a, b, 0.05), 1.9242408120, 1.2551167110, 2.9500863707);
  expect_interval(difference_of_rms(a, b, 0.05), 2.8109686902, -0.2683354568, 5.8902728373);
}

TEST(Statistics, PairingTakesOutWhatBothSidesShare) {
  Values a, b;
  Stream stream(3, Purpose("shared"), Entity{0});
  for (int i = 0; i < 50; ++i) {
    const double shared = 5.0 + stream.normal();
    b.push_back(shared);
    a.push_back(1.1 * shared);
  }
  expect_interval(ratio_of_rms(a, b, 0.05), 1.1, 1.1, 1.1);
  std::rotate(b.begin(), b.begin() + 1, b.end());
  const Interval unpaired = ratio_of_rms(a, b, 0.05);
  EXPECT_GT(unpaired.high - unpaired.low, 0.05);
}

TEST(Statistics, ARatioToZeroIsUndefined) {
  EXPECT_TRUE(std::isnan(ratio_of_rms(Values{1, 2}, Values{0, 0}, 0.05).estimate));
  EXPECT_TRUE(std::isnan(ratio_of_means(Values{1, 2}, Values{1, -1}, 0.05).estimate));
}

TEST(Statistics, TheMediansIntervalIsBetweenOrderStatistics) {
  // Of 10 values the 2nd and the 9th: P(fewer than 2 of 10 halves) = 11/1024 ≤ 0.025; 56/1024 is
  // too much for the 3rd. Of 5 values none are far enough out: 1/32 > 0.025.
  const std::vector<double> ten = {10, 9, 8, 7, 6, 5, 4, 3, 2, 1};
  expect_interval(median(ten, 0.05), 5.5, 2.0, 9.0);
  expect_interval(median(ten, 0.11), 5.5, 3.0, 8.0);  // 2 · 56/1024 = 0.109
  const std::vector<double> five = {3, 1, 2, 5, 4};
  EXPECT_EQ(median(five, 0.05).estimate, 3.0);
  EXPECT_EQ(median(five, 0.05).low, -infinity);
  EXPECT_EQ(median(five, 0.05).high, infinity);
  expect_interval(median(five, 0.07), 3.0, 1.0, 5.0);  // 2/32 = 0.0625
}

TEST(Statistics, TheMedianBearsValuesThatNeverCome) {
  const std::vector<double> few = {1, 2, 3, 4, 5, 6, 7, infinity, infinity, infinity};
  EXPECT_EQ(median(few, 0.05).estimate, 5.5);
  EXPECT_EQ(median(few, 0.05).low, 2.0);
  EXPECT_EQ(median(few, 0.05).high, infinity);
  const std::vector<double> most = {1, 2, infinity, infinity, infinity};
  EXPECT_EQ(median(most, 0.07).estimate, infinity);
  EXPECT_EQ(median(most, 0.07).low, 1.0);
}

TEST(Statistics, WilsonsIntervalHasItsPublishedValues) {
  expect_interval(share(8, 10, 0.05), 0.8, 0.490162, 0.943318);
  EXPECT_EQ(share(10, 10, 0.05).high, 1.0);
  EXPECT_NEAR(share(10, 10, 0.05).low, 0.722467, 1e-6);
  EXPECT_EQ(share(0, 10, 0.05).low, 0.0);
}

TEST(Statistics, BandsOfTheAneesAreTheOnesInPrint) {
  const Interval n2 = anees_band(2, 50, 0.05, 1);
  EXPECT_NEAR(n2.low, 0.7422, 5e-5);
  EXPECT_NEAR(n2.high, 1.2956, 5e-5);
  const Interval n4 = anees_band(4, 100, 0.05, 1);
  EXPECT_NEAR(n4.low, 0.8662, 5e-5);
  EXPECT_NEAR(n4.high, 1.1433, 5e-5);
  EXPECT_NEAR(anees_band(2, 100, 0.05, 1).high, 1.205, 5e-4);
  // Bonferroni: k comparisons at 5 % are one at 5 %/k.
  EXPECT_EQ(anees_band(2, 100, 0.05, 120).high, anees_band(2, 100, 0.05 / 120, 1).high);
}

TEST(Statistics, TheSlopeOfALineIsTheLines) {
  EXPECT_NEAR(slope(Values{0, 1, 4}, Values{3, 5, 11}), 2.0, 1e-12);
  EXPECT_THROW(slope(Values{1, 1}, Values{0, 1}), BrokenInvariant);
}

TEST(Statistics, WhatIsNotFiniteOrNotPairedIsRefused) {
  EXPECT_THROW(mean_t(Values{}, 0.05), BrokenInvariant);
  EXPECT_THROW(mean_t(Values{1.0, infinity}, 0.05), BrokenInvariant);
  EXPECT_THROW(mean_t(Values{1.0, 2.0}, 0.0), BrokenInvariant);
  EXPECT_THROW(mean_of_nonnegative(Values{1.0, -1.0}, 0.05), BrokenInvariant);
  EXPECT_THROW(ratio_of_rms(Values{1.0, 2.0}, Values{1.0}, 0.05), BrokenInvariant);
}

/// √(eᵀe/2) of normal errors with σ = 3 a coordinate, n repetitions.
Values errors(Stream& stream, int n) {
  Values values;
  for (int i = 0; i < n; ++i) {
    values.push_back(std::hypot(stream.normal(0.0, 3.0), stream.normal(0.0, 3.0)) / std::sqrt(2.0));
  }
  return values;
}

TEST(Statistics, TheRmsIntervalHoldsTheTruthAsOftenAsItSays) {
  Stream stream(1, Purpose("coverage"), Entity{0});
  int held = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    const Interval interval = rms_interval(errors(stream, 100), 0.05);
    held += interval.low <= 3.0 && 3.0 <= interval.high;
  }
  EXPECT_NEAR(held / 4000.0, 0.95, 0.02);
}

TEST(Statistics, AlsoFarInTheTailTheRmsIntervalMissesLittleMoreThanItSays) {
  Stream stream(2, Purpose("coverage"), Entity{0});
  int missed = 0;
  for (int trial = 0; trial < 40000; ++trial) {
    const Interval interval = rms_interval(errors(stream, 100), 0.001);
    missed += interval.low > 3.0 || 3.0 > interval.high;
  }
  // 40 would be exact; the plain t interval of the mean square misses about 160 times.
  EXPECT_GT(missed, 15);
  EXPECT_LT(missed, 90);
}

TEST(Statistics, TheRatioIntervalHoldsTheTruthAsOftenAsItSays) {
  Stream stream(3, Purpose("coverage"), Entity{0});
  int held = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    const Values a = errors(stream, 100);
    Values b = errors(stream, 100);
    for (std::size_t i = 0; i < b.size(); ++i) b[i] = std::hypot(a[i], b[i]);
    const double truth = 1.0 / std::sqrt(2.0);
    const Interval interval = ratio_of_rms(a, b, 0.05);
    held += interval.low <= truth && truth <= interval.high;
  }
  EXPECT_NEAR(held / 4000.0, 0.95, 0.02);
}

TEST(Statistics, TheBootstrapFindsTheSameInterval) {
  Stream stream(4, Purpose("bootstrap"), Entity{0});
  const Values values = errors(stream, 400);
  Values resampled;
  for (int b = 0; b < 4000; ++b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double value = values[stream.below(values.size())];
      sum += value * value;
    }
    resampled.push_back(std::sqrt(sum / static_cast<double>(values.size())));
  }
  std::sort(resampled.begin(), resampled.end());
  const Interval interval = rms_interval(values, 0.05);
  const double width = interval.high - interval.low;
  EXPECT_NEAR(interval.low, resampled[100], 0.1 * width);
  EXPECT_NEAR(interval.high, resampled[3900], 0.1 * width);
}

}  // namespace
}  // namespace hearsay::analysis
