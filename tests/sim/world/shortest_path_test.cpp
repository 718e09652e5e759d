#include "sim/world/shortest_path.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "sim/kernel/error.hpp"
#include "sim/world/collision.hpp"
#include "tests/sim/world/floors.hpp"

namespace hearsay::plan {
namespace {

double length(const std::optional<Path>& path) { return path ? path->length_m : -1.0; }

/// The way of a disc of radius r from a to b round a corner c: straight, along the circle,
/// straight.
double round_corner(Point a, Point c, Point b, double r) {
  const double ac = static_cast<double>(distance(a, c)), bc = static_cast<double>(distance(b, c));
  const double cosine =
      ((a.x_m - c.x_m) * (b.x_m - c.x_m) + (a.y_m - c.y_m) * (b.y_m - c.y_m)) / (ac * bc);
  const double between = 2.0 * std::acos(-1.0) - std::acos(cosine);  // on the free side
  return std::sqrt(ac * ac - r * r) + std::sqrt(bc * bc - r * r) +
         r * (between - std::acos(r / ac) - std::acos(r / bc));
}

TEST(ShortestPath, InAnEmptySquareItIsTheStraightLine) {
  const WallIndex walls(Plan(20.0, 20.0, {}));
  const auto path = shortest_path(walls, {1.03, 2.04}, {17.3, 19.1}, 0.3, 0.25);
  ASSERT_TRUE(path);
  EXPECT_EQ(path->points.size(), 2u);
  EXPECT_NEAR(path->length_m, std::sqrt(16.27 * 16.27 + 17.06 * 17.06), 1e-12);
}

TEST(ShortestPath, InACorridorWithACornerItIsStraightRoundAndStraight) {
  // Two arms 3 m wide; the inner corner is at (7, 3), the free side below and to the right.
  const Plan plan(10.0, 20.0, {{{0.0, 3.0}, {7.0, 3.0}}, {{7.0, 3.0}, {7.0, 20.0}}});
  const WallIndex walls(plan);
  for (const double r : {0.1, 0.3, 0.8}) {
    for (const double spacing : {0.1, 0.25, 0.4}) {
      const Point a{0.9, 1.2}, b{8.7, 18.1};
      const double expected = round_corner(a, {7.0, 3.0}, b, r);
      const double found = length(shortest_path(walls, a, b, r, spacing));
      EXPECT_GE(found, expected - 1e-6);
      EXPECT_LE(found, expected + 0.003) << r << " " << spacing;
    }
  }
}

TEST(ShortestPath, OfTwoWaysRoundAWallItTakesTheShorter) {
  const WallIndex walls(Plan(10.0, 10.0, {{{5.0, 2.0}, {5.0, 9.0}}}));
  const Point a{2.0, 5.0}, b{8.0, 5.0};
  const auto path = shortest_path(walls, a, b, 0.3, 0.25);
  ASSERT_TRUE(path);
  for (const Point& p : path->points) EXPECT_LT(p.y_m, 5.1);
  EXPECT_NEAR(path->length_m, round_corner(a, {5.0, 2.0}, b, 0.3), 0.01);
}

TEST(ShortestPath, ABarrierThatIsUpIsWalkedRound) {
  const std::array<Rectangle, 2> barriers = {{{{4.8, 0.0}, {5.2, 2.0}}, {{4.8, 9.0}, {5.2, 10.0}}}};
  WallIndex walls(Plan(10.0, 10.0, {{{5.0, 2.0}, {5.0, 9.0}}}), barriers);
  const Point a{2.0, 5.0}, b{8.0, 5.0};
  const double before = length(shortest_path(walls, a, b, 0.3, 0.25));
  walls.block(0);
  EXPECT_GT(length(shortest_path(walls, a, b, 0.3, 0.25)), before + 1.0);
  walls.block(1);
  EXPECT_FALSE(shortest_path(walls, a, b, 0.3, 0.25));
  walls.unblock(0);
  EXPECT_EQ(length(shortest_path(walls, a, b, 0.3, 0.25)), before);
}

TEST(ShortestPath, ADiscTooWideForADoorHasNoPath) {
  const WallIndex walls(Plan(10.0, 10.0, {{{5.0, 0.0}, {5.0, 4.5}}, {{5.0, 5.5}, {5.0, 10.0}}}));
  EXPECT_TRUE(shortest_path(walls, {2.0, 2.0}, {8.0, 7.0}, 0.3, 0.25));
  EXPECT_FALSE(shortest_path(walls, {2.0, 2.0}, {8.0, 7.0}, 0.51, 0.25));
  EXPECT_FALSE(shortest_path(walls, {0.2, 2.0}, {8.0, 7.0}, 0.3, 0.25)) << "begins in a wall";
}

TEST(ShortestPath, ItCanBeDrivenAndIsNotLongerThanTheGridsOwn) {
  Stream stream(11, Purpose("paths"), Entity{0});
  int found = 0;
  for (int round = 0; round < 40; ++round) {
    const Plan plan(random_drawing(stream, 12, 1.0));
    const WallIndex walls(plan);
    const Point a{stream.uniform(0.0, plan.width_m()), stream.uniform(0.0, plan.height_m())};
    const Point b{stream.uniform(0.0, plan.width_m()), stream.uniform(0.0, plan.height_m())};
    const auto path = shortest_path(walls, a, b, 0.3, 0.25);
    if (!path) continue;
    ++found;
    for (std::size_t i = 1; i < path->points.size(); ++i) {
      EXPECT_FALSE(advance(walls, path->points[i - 1], path->points[i], 0.3).blocked);
    }
    const auto fine = shortest_path(walls, a, b, 0.3, 0.1);
    ASSERT_TRUE(fine);
    EXPECT_NEAR(fine->length_m, path->length_m, 0.06 * path->length_m);
  }
  EXPECT_GT(found, 5);
}

TEST(ShortestPath, MisuseIsABug) {
  const WallIndex walls(Plan(10.0, 10.0, {}));
  EXPECT_THROW(shortest_path(walls, {-1, 1}, {2, 2}, 0.3, 0.25), BrokenInvariant);
  EXPECT_THROW(shortest_path(walls, {1, 1}, {2, 2}, 0.0, 0.25), BrokenInvariant);
  EXPECT_THROW(shortest_path(walls, {1, 1}, {2, 2}, 0.3, 0.0), BrokenInvariant);
  EXPECT_THROW(shortest_path(walls, {1, 1}, {2, 2}, 0.3, 1e-4), BrokenInvariant);
}

}  // namespace
}  // namespace hearsay::plan
