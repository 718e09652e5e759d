// Gated association against all ways to pair.
#include "filters/tracking/association.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/filters/gaussian/samples.hpp"

namespace hearsay::tracking {
namespace {

using gaussian::stream;

constexpr double infinity = std::numeric_limits<double>::infinity();

Table random_table(Stream& random) {
  Table d2(static_cast<int>(random.below(6)), static_cast<int>(random.below(6)));
  for (int i = 0; i < d2.rows(); ++i) {
    for (int j = 0; j < d2.columns(); ++j) {
      d2(i, j) = random.bernoulli(0.1) ? infinity : random.uniform(0, 20);
    }
  }
  return d2;
}

/// The largest Σ(gate − d²) of all sets of pairs inside the gate.
double best_gain(const Table& d2, double gate, int row, std::vector<char>& used) {
  if (row == d2.rows()) return 0.0;
  double best = best_gain(d2, gate, row + 1, used);
  for (int j = 0; j < d2.columns(); ++j) {
    char& taken = used[static_cast<std::size_t>(j)];
    if (taken != 0 || d2(row, j) > gate) continue;
    taken = 1;
    best = std::max(best, gate - d2(row, j) + best_gain(d2, gate, row + 1, used));
    taken = 0;
  }
  return best;
}

TEST(Association, OptimalGainsTheMostOfAllSetsOfPairs) {
  Stream random = stream("optimal");
  for (int trial = 0; trial < 400; ++trial) {
    const Table d2 = random_table(random);
    std::vector<char> used(static_cast<std::size_t>(d2.columns()), 0);
    const double best = best_gain(d2, 9.0, 0, used);
    const auto column_of = pair_within(d2, 9.0, Pairing::optimal);
    double gain = 0.0;
    for (int i = 0; i < d2.rows(); ++i) {
      const int j = column_of[static_cast<std::size_t>(i)];
      if (j == unassigned) continue;
      EXPECT_LE(d2(i, j), 9.0);
      gain += 9.0 - d2(i, j);
      EXPECT_EQ(std::count(column_of.begin(), column_of.end(), j), 1);
    }
    EXPECT_NEAR(gain, best, 1e-12);
  }
}

TEST(Association, NearestTakesTheNearestPairOfWhatIsLeft) {
  Stream random = stream("nearest");
  for (int trial = 0; trial < 400; ++trial) {
    const Table d2 = random_table(random);
    std::vector<int> expected(static_cast<std::size_t>(d2.rows()), unassigned);
    Table left = d2;
    while (true) {
      double least = infinity;
      int row = 0, column = 0;
      for (int i = 0; i < left.rows(); ++i) {
        for (int j = 0; j < left.columns(); ++j) {
          if (left(i, j) >= least) continue;
          least = left(i, j);
          row = i;
          column = j;
        }
      }
      if (least > 9.0) break;
      expected[static_cast<std::size_t>(row)] = column;
      for (int i = 0; i < left.rows(); ++i) left(i, column) = infinity;
      for (int j = 0; j < left.columns(); ++j) left(row, j) = infinity;
    }
    EXPECT_EQ(pair_within(d2, 9.0, Pairing::nearest), expected);
  }
}

// The nearest pair leaves the other row nothing within the gate; the optimum gives up 0.5.
TEST(Association, NearestAndOptimalDiffer) {
  Table d2(2, 2);
  d2(0, 0) = 1.0;
  d2(0, 1) = 1.5;
  d2(1, 0) = 2.0;
  d2(1, 1) = 50.0;
  EXPECT_EQ(pair_within(d2, 9.0, Pairing::nearest), (std::vector<int>{0, unassigned}));
  EXPECT_EQ(pair_within(d2, 9.0, Pairing::optimal), (std::vector<int>{1, 0}));
}

TEST(Association, TheGateItselfIsInside) {
  EXPECT_EQ(pair_within(Table(1, 1, 9.0), 9.0, Pairing::nearest), std::vector<int>{0});
  EXPECT_EQ(pair_within(Table(1, 1, 9.0), 9.0, Pairing::optimal), std::vector<int>{0});
}

TEST(Association, TiesGoToTheLowest) {
  EXPECT_EQ(pair_within(Table(2, 3, 1.0), 9.0, Pairing::nearest), (std::vector<int>{0, 1}));
}

TEST(Association, RefusesWhatIsNoDistance) {
  EXPECT_THROW(pair_within(Table(1, 1, -1.0), 9.0, Pairing::nearest), BrokenInvariant);
  EXPECT_THROW(pair_within(Table(1, 1, std::nan("")), 9.0, Pairing::optimal), BrokenInvariant);
  EXPECT_THROW(pair_within(Table(1, 1), 0.0, Pairing::nearest), BrokenInvariant);
}

}  // namespace
}  // namespace hearsay::tracking
