#include "net/topology.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

using Pair = std::pair<AgentId, AgentId>;
using Position = std::array<double, 3>;

std::set<Pair> links_of(const Topology& topology) {
  std::set<Pair> links;
  for (AgentId a = 0; a < topology.agents(); ++a) {
    for (const AgentId b : topology.neighbours(a)) links.insert({a, b});
  }
  EXPECT_EQ(links.size(), topology.links());
  return links;
}

// Whether each two of n agents are neighbours is asked of `joined`, the plainest way to say it.
template <typename Joined>
std::set<Pair> expected_links(int n, Joined joined) {
  std::set<Pair> links;
  for (AgentId a = 0; a < n; ++a) {
    for (AgentId b = 0; b < n; ++b) {
      if (a != b && joined(a, b)) links.insert({a, b});
    }
  }
  return links;
}

template <typename Error, typename Call>
std::string message_of(Call call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "no such error";
}

// Numbers in a fixed disorder, so that the test needs no generator of the library.
class Scatter {
 public:
  explicit Scatter(std::uint64_t seed) : state_(seed * 2 + 1) {}
  double operator()(double low, double high) {
    state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
    return low + (high - low) * static_cast<double>(state_ >> 11) * 0x1p-53;
  }

 private:
  std::uint64_t state_;
};

void expect_disk_as_by_brute_force(const std::vector<Position>& positions, double range_m) {
  const Topology topology = Topology::disk(positions, range_m);
  const int n = static_cast<int>(positions.size());
  EXPECT_EQ(topology.agents(), n);
  EXPECT_EQ(links_of(topology), expected_links(n, [&](AgentId a, AgentId b) {
              const Position& p = positions[static_cast<std::size_t>(a)];
              const Position& q = positions[static_cast<std::size_t>(b)];
              double square = 0.0;
              for (std::size_t i = 0; i < 3; ++i) square += (p[i] - q[i]) * (p[i] - q[i]);
              return square <= range_m * range_m;
            }));
}

TEST(Topology, NamedGraphsJoinWhomTheyShould) {
  for (int n = 1; n <= 7; ++n) {
    SCOPED_TRACE(n);
    EXPECT_EQ(links_of(Topology::line(n)),
              expected_links(n, [](AgentId a, AgentId b) { return a - b == 1 || b - a == 1; }));
    EXPECT_EQ(links_of(Topology::ring(n)), expected_links(n, [n](AgentId a, AgentId b) {
                return (a + 1) % n == b || (b + 1) % n == a;
              }));
    EXPECT_EQ(links_of(Topology::star(n)),
              expected_links(n, [](AgentId a, AgentId b) { return a == 0 || b == 0; }));
    EXPECT_EQ(links_of(Topology::full(n)),
              expected_links(n, [](AgentId, AgentId) { return true; }));
  }
}

TEST(Topology, ABinaryTreeJoinsEachWithTheHalfOfItsNumber) {
  for (int n = 1; n <= 20; ++n) {
    const auto parent = [](AgentId a) { return a == 0 ? -1 : (a + 1) / 2 - 1; };
    EXPECT_EQ(links_of(Topology::binary_tree(n)), expected_links(n, [&](AgentId a, AgentId b) {
                return parent(a) == b || parent(b) == a;
              }));
  }
}

TEST(Topology, AGridJoinsPlacesThatAreOneStepApart) {
  for (int n = 1; n <= 13; ++n) {
    for (int columns = 1; columns <= n; ++columns) {
      SCOPED_TRACE(std::to_string(n) + " in " + std::to_string(columns));
      const Topology grid = Topology::grid(n, columns);
      EXPECT_EQ(links_of(grid), expected_links(n, [columns](AgentId a, AgentId b) {
                  const int across = std::abs(a % columns - b % columns);
                  const int down = std::abs(a / columns - b / columns);
                  return across + down == 1;
                }));
      EXPECT_TRUE(grid.is_connected());
    }
  }
}

TEST(Topology, AGridHasNoMoreColumnsThanAgents) {
  EXPECT_EQ(message_of<InputError>([] { Topology::grid(4, 5); }),
            "a grid of 4 agents has 1 … 4 columns, not 5");
  EXPECT_THROW(Topology::grid(4, 0), InputError);
}

TEST(Topology, SmallRingsHaveNoDoubleEdge) {
  EXPECT_EQ(Topology::ring(1).links(), 0u);
  EXPECT_EQ(Topology::ring(2).links(), 2u);
  EXPECT_EQ(Topology::ring(3).links(), 6u);
  EXPECT_EQ(Topology::line(1).agents(), 1);
  EXPECT_TRUE(Topology::line(1).neighbours(0).empty());
}

TEST(Topology, NeighboursComeInOrderOfNumber) {
  EXPECT_THAT(Topology::ring(5).neighbours(0), testing::ElementsAre(1, 4));
  const std::vector<Pair> edges{{3, 0}, {2, 3}, {3, 1}};
  EXPECT_THAT(Topology::edges(4, edges).neighbours(3), testing::ElementsAre(0, 1, 2));
}

TEST(Topology, AnEdgeCountsOnceHoweverOftenItIsListed) {
  const std::vector<Pair> edges{{0, 1}, {1, 0}, {0, 1}, {1, 2}};
  EXPECT_EQ(links_of(Topology::edges(3, edges)), links_of(Topology::line(3)));
}

TEST(Topology, LinksAreNumberedRowByRow) {
  const Topology star = Topology::star(4);
  std::int64_t expected = 0;
  for (AgentId a = 0; a < 4; ++a) {
    EXPECT_EQ(static_cast<std::int64_t>(star.first_link(a)), expected);
    for (const AgentId b : star.neighbours(a)) EXPECT_EQ(star.link(a, b), expected++);
  }
  EXPECT_EQ(expected, 6);
}

TEST(Topology, WhatIsNoLinkHasNoNumber) {
  const Topology line = Topology::line(3);
  EXPECT_EQ(line.link(0, 2), -1);
  EXPECT_EQ(line.link(1, 1), -1);
  EXPECT_EQ(line.link(1, 3), -1);
  EXPECT_EQ(line.link(1, -1), -1);
  EXPECT_EQ(line.link(-1, 0), -1);
  EXPECT_EQ(line.link(3, 2), -1);
}

TEST(Topology, KnowsATree) {
  EXPECT_TRUE(Topology::line(1).is_tree());
  EXPECT_TRUE(Topology::line(5).is_tree());
  EXPECT_TRUE(Topology::star(5).is_tree());
  for (int n = 1; n <= 33; ++n) EXPECT_TRUE(Topology::binary_tree(n).is_tree()) << n;
  EXPECT_TRUE(Topology::grid(7, 1).is_tree());
  EXPECT_TRUE(Topology::grid(7, 7).is_tree());
  EXPECT_FALSE(Topology::grid(7, 3).is_tree());
  EXPECT_TRUE(Topology::ring(2).is_tree());
  EXPECT_FALSE(Topology::ring(3).is_tree());
  EXPECT_FALSE(Topology::full(4).is_tree());
  const std::vector<Pair> apart{{0, 1}, {2, 3}};
  EXPECT_FALSE(Topology::edges(4, apart).is_tree());
  const std::vector<Pair> triangle_and_one{{0, 1}, {1, 2}, {2, 0}};  // n − 1 edges, not connected
  EXPECT_FALSE(Topology::edges(4, triangle_and_one).is_tree());
}

TEST(Topology, KnowsWhetherItIsInOnePiece) {
  EXPECT_TRUE(Topology::line(1).is_connected());
  EXPECT_TRUE(Topology::full(4).is_connected());
  const std::vector<Pair> apart{{0, 1}, {2, 3}};
  EXPECT_FALSE(Topology::edges(4, apart).is_connected());
  EXPECT_FALSE(Topology::edges(2, {}).is_connected());
}

TEST(Topology, BadEdgesAreNamed) {
  const auto message = [](std::vector<Pair> edges) {
    return message_of<InputError>([&] { Topology::edges(3, edges); });
  };
  EXPECT_EQ(message({{0, 1}, {1, 3}}),
            "edge 1 [1, 3] names agent 3, which is not there (agents are 0 … 2)");
  EXPECT_EQ(message({{-1, 2}}),
            "edge 0 [-1, 2] names agent -1, which is not there (agents are 0 … 2)");
  EXPECT_EQ(message({{2, 2}}), "edge 0 [2, 2] joins agent 2 to itself");
  EXPECT_EQ(message({{0, 2}}), "no such error");
}

TEST(Topology, NeedsAnAgent) {
  EXPECT_EQ(message_of<InputError>([] { Topology::ring(0); }),
            "a topology needs at least one agent, not 0");
  EXPECT_EQ(message_of<InputError>([] { Topology::full(-3); }),
            "a topology needs at least one agent, not -3");
  EXPECT_THROW(Topology::disk({}, 1.0), InputError);
}

TEST(Topology, BadRangesAndPositionsAreNamed) {
  const std::vector<Position> two{{0, 0, 0}, {1, 0, 0}};
  EXPECT_EQ(message_of<InputError>([&] { Topology::disk(two, -2.5); }),
            "range_m must be positive and finite, not -2.5");
  EXPECT_THROW(Topology::disk(two, 0.0), InputError);
  EXPECT_THROW(Topology::disk(two, std::numeric_limits<double>::infinity()), InputError);
  EXPECT_THROW(Topology::disk(two, std::numeric_limits<double>::quiet_NaN()), InputError);
  std::vector<Position> bad = two;
  bad[1][2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(message_of<InputError>([&] { Topology::disk(bad, 1.0); }),
            "position of agent 1 must be within ±1e12 m on each axis, not nan");
}

TEST(Topology, ADiskIncludesItsRim) {
  const std::vector<Position> positions{{0, 0, 0}, {60, 80, 0}, {0, 0, 100}, {0, 0, -100.001}};
  EXPECT_EQ(links_of(Topology::disk(positions, 100.0)),
            (std::set<Pair>{{0, 1}, {1, 0}, {0, 2}, {2, 0}}));
}

TEST(Topology, ADiskIsWhatBruteForceFinds) {
  Scatter scatter(7);
  for (const double range_m : {0.3, 3.0, 11.0, 40.0, 500.0}) {
    std::vector<Position> positions;
    for (int i = 0; i < 300; ++i) {
      positions.push_back({scatter(-50, 50), scatter(-30, 70), scatter(0, 5)});
    }
    SCOPED_TRACE(range_m);
    expect_disk_as_by_brute_force(positions, range_m);
  }
}

TEST(Topology, ADiskIsRightOnALatticeOfItsRange) {
  std::vector<Position> lattice;  // every neighbour is exactly at the range, on a cell's border
  for (int x = 0; x < 12; ++x) {
    for (int y = 0; y < 12; ++y) lattice.push_back({-0.7 + 0.1 * x, 0.1 * y, 0.0});
  }
  expect_disk_as_by_brute_force(lattice, 0.1);
}

TEST(Topology, ADiskIsRightWhereTheRangeIsTinyInAHugeWorld) {
  Scatter scatter(8);
  std::vector<Position> positions;
  for (int i = 0; i < 100; ++i) {
    const double x = scatter(-1e12, 1e12), y = scatter(-1e12, 1e12);
    positions.push_back({x, y, 0.0});
    positions.push_back({x + 0.25, y, 0.0});
  }
  expect_disk_as_by_brute_force(positions, 0.5);
  EXPECT_GE(Topology::disk(positions, 0.5).links(), 100u);
}

TEST(Topology, ADiskOfCoincidentAgentsIsFull) {
  const std::vector<Position> positions(5, Position{3.0, -4.0, 5.0});
  EXPECT_EQ(links_of(Topology::disk(positions, 1e-9)), links_of(Topology::full(5)));
}

TEST(Topology, ALinkOfADiskIsAsLongAsTheWay) {
  const std::vector<Position> positions{{1, 1, 0}, {4, 5, 0}, {1, 1, 2}, {1, 14, 0}};
  const Topology disk = Topology::disk(positions, 13.0);
  const auto length_m = [&](AgentId from, AgentId to) {
    return disk.length_m(static_cast<std::size_t>(disk.link(from, to)));
  };
  EXPECT_TRUE(disk.has_lengths());
  EXPECT_EQ(length_m(0, 1), 5.0);
  EXPECT_EQ(length_m(1, 0), 5.0);
  EXPECT_EQ(length_m(2, 0), 2.0);
  EXPECT_EQ(length_m(3, 0), 13.0);
  EXPECT_EQ(length_m(1, 2), std::sqrt(29.0));
  EXPECT_EQ(disk.link(2, 3), -1);
}

TEST(Topology, WithoutPositionsLinksHaveNoLength) {
  const Topology ring = Topology::ring(3);
  EXPECT_FALSE(ring.has_lengths());
  EXPECT_EQ(ring.length_m(5), 0.0);
}

}  // namespace
}  // namespace hearsay
