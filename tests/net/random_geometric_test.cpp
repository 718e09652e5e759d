#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <set>
#include <utility>
#include <vector>

#include "graphs.hpp"
#include "net/random_graphs.hpp"

namespace hearsay {
namespace {

using Position = std::array<double, 3>;

// The pieces into which n agents fall when `joined` says which two are joined: by union and find.
class Pieces {
 public:
  template <typename Joined>
  Pieces(int n, Joined joined) : leader_(static_cast<std::size_t>(n)) {
    std::iota(leader_.begin(), leader_.end(), 0);
    for (int a = 0; a < n; ++a) {
      for (int b = a + 1; b < n; ++b) {
        if (joined(a, b)) leader_[static_cast<std::size_t>(find(b))] = find(a);
      }
    }
  }
  int of_size(int size) const {
    std::map<int, int> sizes;
    for (std::size_t a = 0; a < leader_.size(); ++a) ++sizes[find(static_cast<int>(a))];
    return static_cast<int>(std::count_if(
        sizes.begin(), sizes.end(), [size](const auto& piece) { return piece.second == size; }));
  }

 private:
  int find(int a) const {
    while (leader_[static_cast<std::size_t>(a)] != a) a = leader_[static_cast<std::size_t>(a)];
    return a;
  }
  std::vector<int> leader_;
};

double distance_m(const Position& p, const Position& q) {
  return std::hypot(p[0] - q[0], p[1] - q[1]);
}

int isolated(const Topology& topology) {
  int count = 0;
  for (AgentId a = 0; a < topology.agents(); ++a) count += topology.neighbours(a).empty() ? 1 : 0;
  return count;
}

TEST(RandomGeometricGraph, JoinsWhoIsInRange) {
  const PlacedGraph graph = random_geometric(60, {.side_m = 100.0, .range_m = 18.0}, 4);
  std::set<Pair> expected;
  for (AgentId a = 0; a < 60; ++a) {
    const Position& p = graph.positions_m[static_cast<std::size_t>(a)];
    EXPECT_TRUE(p[0] >= 0.0 && p[0] < 100.0 && p[1] >= 0.0 && p[1] < 100.0 && p[2] == 0.0);
    for (AgentId b = a + 1; b < 60; ++b) {
      if (distance_m(p, graph.positions_m[static_cast<std::size_t>(b)]) <= 18.0) {
        expected.insert({a, b});
      }
    }
  }
  EXPECT_EQ(edges_of(graph.topology), expected);
  EXPECT_TRUE(graph.topology.has_lengths());
}

TEST(RandomGeometricGraph, PlacesDoNotDependOnHowManyAgentsOrHowFarTheyHear) {
  const PlacedGraph few = random_geometric(10, {.side_m = 50.0, .range_m = 5.0}, 4);
  const PlacedGraph many = random_geometric(30, {.side_m = 50.0, .range_m = 20.0}, 4);
  EXPECT_TRUE(std::equal(few.positions_m.begin(), few.positions_m.end(), many.positions_m.begin()));
  EXPECT_NE(random_geometric(10, {.side_m = 50.0, .range_m = 5.0}, 5).positions_m, few.positions_m);
}

// Places on the border joined to those opposite: no edges of the square, so the limit law holds.
double torus_distance(const Position& p, const Position& q) {
  const double dx = std::fabs(p[0] - q[0]), dy = std::fabs(p[1] - q[1]);
  return std::hypot(std::min(dx, 1.0 - dx), std::min(dy, 1.0 - dy));
}

// Expected numbers of agents alone and of pairs apart from the rest, among n on a unit torus,
// exact: the others must be outside the disk of the one, or outside those of the two.
std::pair<double, double> expected_apart(int n, double r) {
  const double disk = std::numbers::pi * r * r;
  constexpr int strips = 1000;
  double pairs = 0.0;
  for (int i = 0; i < strips; ++i) {
    const double d = r * (i + 0.5) / strips;
    const double both =
        2.0 * r * r * std::acos(d / (2.0 * r)) - d / 2.0 * std::sqrt(4.0 * r * r - d * d);
    pairs += 2.0 * std::numbers::pi * d * r / strips * std::pow(1.0 - (2.0 * disk - both), n - 2);
  }
  return {n * std::pow(1.0 - disk, n - 1), n * (n - 1) / 2.0 * pairs};
}

// Penrose (1997): with n·π·r² = ln n + c on a torus both P(nobody is alone) and P(connected) tend
// to exp(−e^−c). For the latter the way is long: pairs, triples … apart vanish only as powers of 1
// / ln n (at n = 10⁵ it is still .06 away). If their numbers fall like E₁, E₂, E₂²/E₁ …, then
// P(connected) = exp(−E₁ / (1 − E₂/E₁)), which is .586 at n = 200 where the limit is .692.
TEST(RandomGeometricGraph, PlacesOnATorusAreConnectedAsPenroseFound) {
  constexpr int n = 200, graphs = 600;
  constexpr double c = 1.0;
  const double range = std::sqrt((std::log(n) + c) / (n * std::numbers::pi));
  int connected = 0, nobody_alone = 0;
  Average alone, pairs;
  for (int g = 0; g < graphs; ++g) {
    const auto places =
        random_geometric(n, {.side_m = 1.0, .range_m = range}, static_cast<std::uint64_t>(g))
            .positions_m;
    const Pieces pieces(n, [&](int a, int b) {
      return torus_distance(places[static_cast<std::size_t>(a)],
                            places[static_cast<std::size_t>(b)]) <= range;
    });
    connected += pieces.of_size(n);
    nobody_alone += pieces.of_size(1) == 0 ? 1 : 0;
    alone.add(pieces.of_size(1));
    pairs.add(pieces.of_size(2));
  }
  const auto [one, two] = expected_apart(n, range);
  EXPECT_NEAR(alone.mean(), one, 4.0 * alone.error());
  EXPECT_NEAR(pairs.mean(), two, 4.0 * pairs.error());
  const double whole = std::exp(-one / (1.0 - two / one)), limit = std::exp(-std::exp(-c));
  EXPECT_NEAR(static_cast<double>(connected) / graphs, whole, tolerance(whole, graphs));
  // At this n Poisson's law gives .709, .017 from the limit.
  EXPECT_NEAR(static_cast<double>(nobody_alone) / graphs, limit, tolerance(limit, graphs) + 0.017);
}

// Area of the disk of radius r around (x, y) within the unit square, by strips.
double area_within(double x, double y, double r) {
  constexpr int strips = 200;
  double area = 0.0;
  for (int i = 0; i < strips; ++i) {
    const double u = x - r + 2.0 * r * (i + 0.5) / strips;
    if (u < 0.0 || u > 1.0) continue;
    const double half = std::sqrt(r * r - (u - x) * (u - x));
    area += (std::min(y + half, 1.0) - std::max(y - half, 0.0)) * 2.0 * r / strips;
  }
  return area;
}

// At this n the number of agents alone is nearly a Poisson number; .02 is allowed for the rest.
TEST(RandomGeometricGraph, AgentsAreAloneOnASquareAsOftenAsTheIntegralSays) {
  constexpr int n = 150, graphs = 2000, cells = 60;
  constexpr double range = 0.14;
  double expected = 0.0;
  for (int i = 0; i < cells; ++i) {
    for (int k = 0; k < cells; ++k) {
      const double area = area_within((i + 0.5) / cells, (k + 0.5) / cells, range);
      expected += n * std::pow(1.0 - area, n - 1) / (cells * cells);
    }
  }
  Average alone;
  int connected = 0, nobody_alone = 0;
  for (int g = 0; g < graphs; ++g) {
    const PlacedGraph graph =
        random_geometric(n, {.side_m = 1.0, .range_m = range}, static_cast<std::uint64_t>(g));
    const int lonely = isolated(graph.topology);
    alone.add(lonely);
    nobody_alone += lonely == 0 ? 1 : 0;
    const bool whole = graph.topology.is_connected();
    connected += whole ? 1 : 0;
    if (g % 20 != 0) continue;
    const Pieces pieces(n, [&](int a, int b) {
      return distance_m(graph.positions_m[static_cast<std::size_t>(a)],
                        graph.positions_m[static_cast<std::size_t>(b)]) <= range;
    });
    EXPECT_EQ(whole, pieces.of_size(n) == 1);
    EXPECT_EQ(lonely, pieces.of_size(1));
  }
  EXPECT_NEAR(alone.mean(), expected, 4.0 * alone.error());
  const double poisson = std::exp(-expected);
  EXPECT_NEAR(static_cast<double>(nobody_alone) / graphs, poisson,
              tolerance(poisson, graphs) + 0.02);
  EXPECT_LT(connected, nobody_alone);
  EXPECT_GT(connected, graphs / 4);  // so that union and find has met both
}

TEST(RandomGeometricGraph, BadParametersAreNamed) {
  EXPECT_EQ(message_of([] { random_geometric(3, {.side_m = 0.0}, 1); }),
            "side_m must be positive and at most 1e12, not 0");
  EXPECT_EQ(message_of([] { random_geometric(3, {.range_m = -1.0}, 1); }),
            "range_m must be positive and finite, not -1");
  EXPECT_THROW(random_geometric(0, {}, 1), InputError);
}

}  // namespace
}  // namespace hearsay
