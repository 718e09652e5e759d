// OSPA and GOSPA against values computed elsewhere, and against all assignments.
#include "filters/tracking/ospa.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "sim/kernel/error.hpp"
#include "tests/filters/gaussian/samples.hpp"

namespace hearsay::tracking {
namespace {

using gaussian::stream;
using gaussian::Vector;

constexpr double infinity = std::numeric_limits<double>::infinity();

std::vector<Vector> random_places(Stream& random, std::uint64_t most) {
  std::vector<Vector> places(random.below(most + 1));
  for (Vector& place : places) place = 5.0 * gaussian::random_vector(random, 2);
  return places;
}

// Four tracks, each half a metre off, of five truths.
Table four_of_five() {
  std::vector<Vector> tracks, truths;
  for (int i = 0; i < 5; ++i) {
    truths.push_back(gaussian::vector({50.0 * i, -20.0 * i}));
    if (i < 4) tracks.push_back(gaussian::vector({50.0 * i + 0.3, -20.0 * i - 0.4}));
  }
  return distances(tracks, truths);
}

TEST(Ospa, OfFourTracksOfFiveTruths) {
  const Table d = four_of_five();
  EXPECT_NEAR(ospa(d, 1, 10).distance, 2.4, 1e-12);
  EXPECT_NEAR(ospa(d, 2, 10).distance, 4.49444, 5e-6);
  EXPECT_EQ(ospa(d, infinity, 10).distance, 10.0);
  // (4·0.5³ + 10³)/5 under the cube root.
  EXPECT_NEAR(ospa(d, 3, 10).distance, std::cbrt(1000.5 / 5), 1e-12);
}

TEST(Ospa, SaysWhatIsPlaceAndWhatIsNumber) {
  const Ospa o = ospa(four_of_five(), 2, 10);
  EXPECT_NEAR(o.localisation, std::sqrt(4 * 0.25 / 5), 1e-12);
  EXPECT_NEAR(o.cardinality, std::sqrt(100.0 / 5), 1e-12);
}

TEST(Gospa, OfFourTracksOfFiveTruths) {
  const Gospa g = gospa(four_of_five(), 2, 10);
  EXPECT_NEAR(g.distance, std::sqrt(4 * 0.25 + 50), 1e-12);
  EXPECT_NEAR(g.localisation, 1.0, 1e-12);
  EXPECT_EQ(g.missed, 50.0);
  EXPECT_EQ(g.false_ones, 0.0);
  EXPECT_EQ(g.missed_count, 1);
  EXPECT_EQ(g.truth_of, (std::vector<int>{0, 1, 2, 3}));
}

TEST(Ospa, OfEmptySets) {
  EXPECT_EQ(ospa(Table(0, 0), 2, 10).distance, 0.0);
  EXPECT_EQ(ospa(Table(0, 3), 2, 10).distance, 10.0);
  EXPECT_EQ(ospa(Table(2, 0), infinity, 7).distance, 7.0);
  EXPECT_EQ(gospa(Table(0, 0), 1, 10).distance, 0.0);
  EXPECT_EQ(gospa(Table(0, 3), 1, 10).distance, 15.0);
  EXPECT_EQ(gospa(Table(2, 0), 1, 10).false_ones, 10.0);
}

/// The least OSPA over all permutations of the larger side, term by term as it is defined.
double ospa_by_force(const Table& d, double p, double c) {
  const bool wide = d.rows() <= d.columns();
  const int m = std::min(d.rows(), d.columns()), n = std::max(d.rows(), d.columns());
  if (n == 0) return 0;
  std::vector<int> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), 0);
  double best = infinity;
  do {
    double sum = std::isinf(p) ? (m < n ? c : 0.0) : (n - m) * std::pow(c, p);
    for (int i = 0; i < m; ++i) {
      const int j = order[static_cast<std::size_t>(i)];
      const double cut = std::min(c, wide ? d(i, j) : d(j, i));
      sum = std::isinf(p) ? std::max(sum, cut) : sum + std::pow(cut, p);
    }
    best = std::min(best, std::isinf(p) ? sum : std::pow(sum / n, 1 / p));
  } while (std::next_permutation(order.begin(), order.end()));
  return best;
}

TEST(Ospa, IsTheLeastOverAllAssignments) {
  Stream random = stream("ospa");
  for (int trial = 0; trial < 300; ++trial) {
    const Table d = distances(random_places(random, 5), random_places(random, 5));
    for (const double p : {1.0, 2.0, 2.5, infinity}) {
      EXPECT_NEAR(ospa(d, p, 6.0).distance, ospa_by_force(d, p, 6.0), 1e-12) << "p = " << p;
    }
  }
}

/// The least GOSPA over all choices of pairs, also of fewer than there could be.
double gospa_to_the_p_by_force(const Table& d, double p, double c, int row,
                               std::vector<char>& used) {
  const double half = 0.5 * std::pow(c, p);
  if (row == d.rows()) {
    return half * static_cast<double>(std::count(used.begin(), used.end(), char{0}));
  }
  double best = half + gospa_to_the_p_by_force(d, p, c, row + 1, used);
  for (int j = 0; j < d.columns(); ++j) {
    char& taken = used[static_cast<std::size_t>(j)];
    if (taken != 0) continue;
    taken = 1;
    best = std::min(best, std::pow(d(row, j), p) + gospa_to_the_p_by_force(d, p, c, row + 1, used));
    taken = 0;
  }
  return best;
}

TEST(Gospa, IsTheLeastOverAllChoicesOfPairs) {
  Stream random = stream("gospa");
  for (int trial = 0; trial < 300; ++trial) {
    const Table d = distances(random_places(random, 5), random_places(random, 5));
    for (const double p : {1.0, 2.0, 2.5}) {
      std::vector<char> used(static_cast<std::size_t>(d.columns()), 0);
      const double best = gospa_to_the_p_by_force(d, p, 6.0, 0, used);
      const Gospa g = gospa(d, p, 6.0);
      EXPECT_NEAR(std::pow(g.distance, p), best, 1e-11 * (1 + best));
      EXPECT_NEAR(g.localisation + g.missed + g.false_ones, best, 1e-11 * (1 + best));
      const auto pairs = g.truth_of.size() - static_cast<std::size_t>(g.false_count);
      EXPECT_EQ(pairs + static_cast<std::size_t>(g.missed_count),
                static_cast<std::size_t>(d.columns()));
    }
  }
}

TEST(OspaAndGospa, AreMetrics) {
  Stream random = stream("triangle");
  for (int trial = 0; trial < 300; ++trial) {
    const auto a = random_places(random, 5), b = random_places(random, 5),
               c = random_places(random, 5);
    const auto ab = distances(a, b), bc = distances(b, c), ac = distances(a, c);
    for (const double p : {1.0, 2.0}) {
      EXPECT_LE(ospa(ac, p, 6).distance, ospa(ab, p, 6).distance + ospa(bc, p, 6).distance + 1e-12);
      EXPECT_LE(gospa(ac, p, 6).distance,
                gospa(ab, p, 6).distance + gospa(bc, p, 6).distance + 1e-12);
      EXPECT_NEAR(gospa(ab, p, 6).distance, gospa(distances(b, a), p, 6).distance, 1e-12);
    }
    EXPECT_EQ(ospa(distances(a, a), 2, 6).distance, 0.0);
  }
}

TEST(OspaAndGospa, RefuseWhatIsNoOrderCutOffOrDistance) {
  EXPECT_THROW(ospa(Table(1, 1), 0.5, 10), BrokenInvariant);
  EXPECT_THROW(ospa(Table(1, 1), 2, 0), BrokenInvariant);
  EXPECT_THROW(gospa(Table(1, 1), infinity, 10), BrokenInvariant);
  EXPECT_THROW(gospa(Table(1, 1, -1), 2, 10), BrokenInvariant);
}

}  // namespace
}  // namespace hearsay::tracking
