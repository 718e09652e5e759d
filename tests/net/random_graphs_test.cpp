#include "net/random_graphs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "graphs.hpp"

namespace hearsay {
namespace {

TEST(ErdosRenyi, NoneAndAllAreTheEnds) {
  EXPECT_EQ(erdos_renyi(20, 0.0, 1).links(), 0u);
  EXPECT_EQ(edges_of(erdos_renyi(20, 1.0, 1)), edges_of(Topology::full(20)));
  EXPECT_EQ(erdos_renyi(1, 0.5, 1).agents(), 1);
}

TEST(ErdosRenyi, DegreesAreBinomial) {
  constexpr int n = 21, graphs = 4000;
  constexpr double p = 0.3;
  std::vector<int> seen(n, 0);
  for (int g = 0; g < graphs; ++g) {
    // One agent a graph, each in turn: degrees within a graph depend on one another.
    const Topology graph = erdos_renyi(n, p, static_cast<std::uint64_t>(g));
    ++seen[graph.neighbours(g % n).size()];
  }
  double share = std::pow(1.0 - p, n - 1);
  for (int degree = 0; degree < n; ++degree) {
    const double observed = static_cast<double>(seen[static_cast<std::size_t>(degree)]) / graphs;
    EXPECT_NEAR(observed, share, tolerance(share, graphs) + 1.0 / graphs) << degree;
    share *= p / (1.0 - p) * (n - 1 - degree) / (degree + 1);
  }
}

// Gilbert (1959): whoever is not connected has a smallest piece around agent 0 of k < n agents.
double connected_share(int n, double p) {
  std::vector<double> connected(static_cast<std::size_t>(n) + 1, 1.0);
  for (int m = 2; m <= n; ++m) {
    double apart = 0.0, ways = 1.0;  // of choosing the k − 1 others in agent 0's piece
    for (int k = 1; k < m; ++k) {
      apart += ways * connected[static_cast<std::size_t>(k)] * std::pow(1.0 - p, k * (m - k));
      ways *= static_cast<double>(m - k) / k;
    }
    connected[static_cast<std::size_t>(m)] = 1.0 - apart;
  }
  return connected.back();
}

TEST(ErdosRenyi, IsConnectedAsOftenAsGilbertCounted) {
  constexpr int graphs = 4000;
  for (const auto& [n, p] : {std::pair{2, 0.4}, {5, 0.35}, {12, 0.2}, {30, 0.12}}) {
    int connected = 0;
    for (int g = 0; g < graphs; ++g) {
      connected += erdos_renyi(n, p, static_cast<std::uint64_t>(g)).is_connected() ? 1 : 0;
    }
    const double share = connected_share(n, p);
    EXPECT_NEAR(static_cast<double>(connected) / graphs, share, tolerance(share, graphs)) << n;
  }
}

TEST(ErdosRenyi, IsConnectedAtTheThresholdAsErdosAndRenyiFound) {
  constexpr int n = 300, graphs = 400;
  for (const double c : {-0.5, 0.5, 2.0}) {
    const double p = (std::log(n) + c) / n;
    int connected = 0;
    for (int g = 0; g < graphs; ++g) {
      connected += erdos_renyi(n, p, static_cast<std::uint64_t>(g)).is_connected() ? 1 : 0;
    }
    const double share = connected_share(n, p);
    EXPECT_NEAR(static_cast<double>(connected) / graphs, share, tolerance(share, graphs)) << c;
    // The limit is for n → ∞.
    EXPECT_NEAR(share, std::exp(-std::exp(-c)), 0.015) << c;
  }
}

TEST(ErdosRenyi, PairsDoNotDependOnHowManyAgentsThereAre) {
  std::set<Pair> expected;
  for (const Pair& edge : edges_of(erdos_renyi(40, 0.3, 9))) {
    if (edge.second < 25) expected.insert(edge);
  }
  EXPECT_EQ(edges_of(erdos_renyi(25, 0.3, 9)), expected);
}

TEST(ErdosRenyi, AMoreLikelyLinkIsAddedToThoseThatAre) {
  const auto few = edges_of(erdos_renyi(40, 0.2, 9)), many = edges_of(erdos_renyi(40, 0.4, 9));
  EXPECT_TRUE(std::includes(many.begin(), many.end(), few.begin(), few.end()));
  EXPECT_NE(edges_of(erdos_renyi(40, 0.2, 10)), few);
}

TEST(ErdosRenyi, BadParametersAreNamed) {
  EXPECT_EQ(message_of([] { erdos_renyi(5, 1.5, 1); }),
            "link_probability must be between 0 and 1, not 1.5");
  EXPECT_THROW(erdos_renyi(5, std::numeric_limits<double>::quiet_NaN(), 1), InputError);
  EXPECT_EQ(message_of([] { erdos_renyi(30'001, 0.0, 1); }),
            "an Erdős–Rényi graph has at most 30000 agents, not 30001");
  EXPECT_THROW(erdos_renyi(0, 0.5, 1), InputError);
}

struct Shape {
  double triangles = 0.0;
  double triples = 0.0;  // pairs of neighbours of an agent, over all agents
  double clustering() const { return 3.0 * triangles / triples; }
};

Shape shape_of(const Topology& topology) {
  Shape shape;
  for (AgentId a = 0; a < topology.agents(); ++a) {
    const auto row = topology.neighbours(a);
    for (std::size_t i = 0; i < row.size(); ++i) {
      for (std::size_t k = i + 1; k < row.size(); ++k) {
        shape.triples += 1.0;
        shape.triangles += topology.link(row[i], row[k]) >= 0 ? 1.0 / 3.0 : 0.0;
      }
    }
  }
  return shape;
}

TEST(SmallWorldGraph, WithoutRewiringIsALattice) {
  for (const int k : {0, 2, 4, 6}) {
    std::set<Pair> expected;
    for (AgentId a = 0; a < 13; ++a) {
      for (AgentId b = a + 1; b < 13; ++b) {
        if (std::min(b - a, 13 - (b - a)) <= k / 2) expected.insert({a, b});
      }
    }
    EXPECT_EQ(edges_of(small_world(13, {.mean_degree = k, .rewire_probability = 0.0}, 3)),
              expected);
  }
  EXPECT_EQ(edges_of(small_world(7, {.mean_degree = 6, .rewire_probability = 0.5}, 3)),
            edges_of(Topology::full(7)));
}

TEST(SmallWorldGraph, ALatticeClustersAsInClosedForm) {
  for (const int k : {4, 6, 8, 12}) {
    const Topology graph = small_world(200, {.mean_degree = k, .rewire_probability = 0.0}, 1);
    EXPECT_NEAR(shape_of(graph).clustering(), 3.0 * (k - 2) / (4.0 * (k - 1)), 1e-12) << k;
  }
}

// Barrat and Weigt (2000): a triangle stays if none of its three links is rewired, so triangles go
// with (1 − β)³; degrees get the variance (k/2)·β(2 − β), and with it grows the number of triples.
// Chance closes at most about k/n of the n·k²/2 triples of a random graph, which are 4k²/((k − 2)n)
// of the lattice's n·k(k − 2)/8 triangles. Other tolerances are 4 standard errors of a mean, taken
// from the graphs themselves.
TEST(SmallWorldGraph, RewiringBreaksTrianglesByTheCubeLaw) {
  constexpr int n = 4000, k = 8, graphs = 10;
  constexpr double lattice = n * k * (k - 2) / 8.0, chance = 4.0 * k * k / ((k - 2.0) * n);
  for (const double beta : {0.05, 0.2, 0.5}) {
    Average triangles, triples;
    for (int g = 0; g < graphs; ++g) {
      const Shape shape = shape_of(small_world(n, {.mean_degree = k, .rewire_probability = beta},
                                               static_cast<std::uint64_t>(g)));
      triangles.add(shape.triangles / lattice);
      triples.add(shape.triples / n);
    }
    const double kept = std::pow(1.0 - beta, 3);
    EXPECT_GT(triangles.mean(), kept - 4.0 * triangles.error()) << beta;
    EXPECT_LT(triangles.mean(), kept + 4.0 * triangles.error() + chance) << beta;
    const double variance = k / 2.0 * beta * (2.0 - beta);
    EXPECT_NEAR(triples.mean(), (k * (k - 1) + variance) / 2.0, 4.0 * triples.error()) << beta;
  }
}

TEST(SmallWorldGraph, RewiringKeepsTheNumberOfLinksAndMovesTheWantedShare) {
  constexpr int n = 500, k = 6;
  const auto lattice = edges_of(small_world(n, {.mean_degree = k, .rewire_probability = 0.0}, 1));
  for (const double beta : {0.1, 0.5, 1.0}) {
    const auto graph = edges_of(small_world(n, {.mean_degree = k, .rewire_probability = beta}, 11));
    EXPECT_EQ(graph.size(), lattice.size());
    std::vector<Pair> kept;
    std::set_intersection(graph.begin(), graph.end(), lattice.begin(), lattice.end(),
                          std::back_inserter(kept));
    // Those that moved onto a place of the lattice that had become free: about k/n of them.
    const double share = static_cast<double>(kept.size()) / static_cast<double>(lattice.size());
    EXPECT_NEAR(share, 1.0 - beta, tolerance(beta, n * k / 2) + beta * k / n) << beta;
  }
}

// All that can become of a ring of n agents, with its probability: every choice is followed.
void follow(int n, double beta, AgentId from, const std::set<Pair>& edges, double probability,
            std::map<std::set<Pair>, double>& outcomes) {
  if (from == n) {
    outcomes[edges] += probability;
    return;
  }
  const auto pair = [](AgentId a, AgentId b) { return Pair{std::min(a, b), std::max(a, b)}; };
  std::vector<AgentId> strangers;
  for (AgentId a = 0; a < n; ++a) {
    if (a != from && !edges.contains(pair(a, from))) strangers.push_back(a);
  }
  // With nobody to move to the link stays, too.
  const double stays = strangers.empty() ? 1.0 : 1.0 - beta;
  follow(n, beta, from + 1, edges, probability * stays, outcomes);
  for (const AgentId stranger : strangers) {
    std::set<Pair> moved = edges;
    moved.erase(pair(from, (from + 1) % n));
    moved.insert(pair(from, stranger));
    follow(n, beta, from + 1, moved, probability * beta / static_cast<double>(strangers.size()),
           outcomes);
  }
}

// Pearson's χ² of all outcomes; those expected less than 5 times are taken together. The tolerance
// is 4 standard deviations of χ².
TEST(SmallWorldGraph, EveryGraphComesAsOftenAsFollowingAllChoicesSays) {
  constexpr int n = 5, graphs = 20'000;
  constexpr double beta = 0.6;
  std::map<std::set<Pair>, double> outcomes;
  follow(n, beta, 0, edges_of(Topology::ring(n)), 1.0, outcomes);
  std::map<std::set<Pair>, int> seen;
  for (int g = 0; g < graphs; ++g) {
    ++seen[edges_of(small_world(n, {.mean_degree = 2, .rewire_probability = beta},
                                static_cast<std::uint64_t>(g)))];
  }
  double chi2 = 0.0, rare_expected = 0.0;
  int cells = 0, rare = 0, total = 0;
  const auto add = [&](double expected, int observed) {
    chi2 += (observed - expected) * (observed - expected) / expected;
    ++cells;
  };
  for (const auto& [edges, probability] : outcomes) {
    const double expected = probability * graphs;
    const int observed = seen[edges];
    total += observed;
    if (expected >= 5.0) {
      add(expected, observed);
    } else {
      rare_expected += expected;
      rare += observed;
    }
  }
  if (rare_expected > 0.0) add(rare_expected, rare);
  EXPECT_EQ(total, graphs);
  EXPECT_GT(cells, 50);
  EXPECT_NEAR(chi2, cells - 1, 4.0 * std::sqrt(2.0 * (cells - 1)));
}

TEST(SmallWorldGraph, BadParametersAreNamed) {
  EXPECT_EQ(message_of([] { small_world(10, {.mean_degree = 3}, 1); }),
            "mean_degree must be even and below the number of agents (10), not 3");
  EXPECT_THROW(small_world(10, {.mean_degree = 10}, 1), InputError);
  EXPECT_THROW(small_world(10, {.mean_degree = -2}, 1), InputError);
  EXPECT_THROW(small_world(0, {.mean_degree = 0}, 1), InputError);
  EXPECT_EQ(message_of([] { small_world(10, {.mean_degree = 2, .rewire_probability = -0.1}, 1); }),
            "rewire_probability must be between 0 and 1, not -0.1");
}

}  // namespace
}  // namespace hearsay
