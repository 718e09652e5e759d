#include "sim/world/collision.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"
#include "tests/sim/world/floors.hpp"

namespace hearsay::plan {
namespace {

constexpr double touch_m = 1e-9;

/// Whether two segments have a point in common, by the sides their ends are on.
bool cross(Point a, Point b, const Segment& s) {
  const auto side = [](Point p, Point q, Point r) {
    return (Real{q.x_m} - p.x_m) * (Real{r.y_m} - p.y_m) -
           (Real{q.y_m} - p.y_m) * (Real{r.x_m} - p.x_m);
  };
  const Real from = side(a, b, s.from), to = side(a, b, s.to);
  if (from == 0 && to == 0) return false;  // in one line: what counts is how near they come
  return from * to <= 0 && side(s.from, s.to, a) * side(s.from, s.to, b) <= 0;
}

Point anywhere(Stream& stream, const Plan& plan) {
  return {stream.uniform(0.0, plan.width_m()), stream.uniform(0.0, plan.height_m())};
}

/// A goal that is hard on rounding: at walls, along them, past corners, far away, or none of these.
Point goal(Stream& stream, const Plan& plan, Point at, double radius) {
  const Segment& s = plan.walls()[stream.below(plan.walls().size())];
  const double length = static_cast<double>(distance(s.from, s.to));
  const Point unit{(s.to.x_m - s.from.x_m) / length, (s.to.y_m - s.from.y_m) / length};
  switch (stream.below(6)) {
    case 0:
      return s.from;
    case 1:  // along the direction of a wall
      return {at.x_m + unit.x_m * 2.0, at.y_m + unit.y_m * 2.0};
    case 2:  // to where the disc touches the wall's end from the side
      return {s.to.x_m - unit.y_m * radius, s.to.y_m + unit.x_m * radius};
    case 3: {  // at enormous speed
      const double angle = stream.uniform(0.0, 7.0);
      return {at.x_m + 1e6 * std::cos(angle), at.y_m + 1e6 * std::sin(angle)};
    }
    case 4:  // straight at the wall
      return {at.x_m + unit.y_m * 5.0, at.y_m - unit.x_m * 5.0};
    default:
      return {at.x_m + stream.uniform(-2.0, 2.0), at.y_m + stream.uniform(-2.0, 2.0)};
  }
}

TEST(Collision, AHundredThousandMovesEndInNoWallAndCrossNone) {
  Stream stream(9, Purpose("moves"), Entity{0});
  int moves = 0, blocked = 0, free = 0;
  while (moves < 100000) {
    const Drawing drawing = random_drawing(stream, 8, 1.0);
    const bool drawn = stream.bernoulli(0.6);
    const Plan plan = drawn ? Plan(drawing) : random_plan(stream);
    const WallIndex walls(plan);
    const double radius = stream.uniform(0.01, 0.45);
    Point at = anywhere(stream, plan);
    if (drawn && drawing.wall(static_cast<int>(at.x_m), static_cast<int>(at.y_m))) continue;
    if (distance(at, plan.walls()) < radius) continue;
    std::vector<Disc> others(stream.below(3));
    for (Disc& other : others) {
      other = {anywhere(stream, plan), 0.3};
      if (distance(at, other.at) < radius + 0.3) other.at = {-10.0, -10.0};
    }
    for (int i = 0; i < 200; ++i, ++moves) {
      const Point to = goal(stream, plan, at, radius);
      const Advance move = advance(walls, at, to, radius, others);
      Real room = 1e30L;
      for (const Segment& s : plan.walls()) {
        ASSERT_FALSE(move.distance_m > 0.0 && cross(at, move.at, s));
        room = std::min(room, distance(move.at, s) - radius);
      }
      for (const Disc& o : others)
        room = std::min(room, distance(move.at, o.at) - radius - o.radius_m);
      ASSERT_GE(room, -touch_m);
      ASSERT_NEAR(static_cast<double>(distance(at, move.at)), move.distance_m, touch_m);
      if (move.blocked) {
        ASSERT_LE(room, touch_m) << "stopped by nothing";
        ++blocked;
      } else {
        ASSERT_EQ(move.at, to);
        ++free;
      }
      // Nowhere on the way it came nearer than at the end.
      for (const double share : {0.25, 0.5, 0.75}) {
        const Point mid{at.x_m + share * (move.at.x_m - at.x_m),
                        at.y_m + share * (move.at.y_m - at.y_m)};
        ASSERT_GE(distance(mid, plan.walls()) - radius, -touch_m);
      }
      at = move.at;
    }
  }
  EXPECT_GT(blocked, 20000);
  EXPECT_GT(free, 10000);
}

TEST(Collision, ADiscStopsWhereItTouchesAWallHeadOn) {
  const WallIndex walls(Plan(10.0, 10.0, {}));
  const Advance move = advance(walls, {5.0, 5.0}, {50.0, 5.0}, 0.25);
  EXPECT_TRUE(move.blocked);
  EXPECT_NEAR(move.at.x_m, 9.75, 1e-12);
  EXPECT_EQ(move.at.y_m, 5.0);
  EXPECT_NEAR(move.distance_m, 4.75, 1e-12);
  const Advance slanting = advance(walls, {5.0, 5.0}, {9.0, 8.0}, 2.0);
  EXPECT_NEAR(slanting.distance_m, 3.75, 1e-12);  // x = 8 after 3/4 of 5 m
}

TEST(Collision, TheEndOfAWallIsRound) {
  const WallIndex walls(Plan(10.0, 10.0, {{{5.0, 0.0}, {5.0, 4.0}}}));
  // Passing 0.3 m above the end with a radius of 0.5 m: stops 0.4 m before it.
  const Advance move = advance(walls, {1.0, 4.3}, {9.0, 4.3}, 0.5);
  EXPECT_TRUE(move.blocked);
  EXPECT_NEAR(move.at.x_m, 4.6, 1e-12);
  EXPECT_FALSE(advance(walls, {1.0, 4.5 + 1e-12}, {9.0, 4.5 + 1e-12}, 0.5).blocked);
  EXPECT_TRUE(advance(walls, {1.0, 4.5 - 1e-6}, {9.0, 4.5 - 1e-6}, 0.5).blocked);
  EXPECT_NEAR(advance(walls, {1.0, 4.0}, {9.0, 4.0}, 0.5).at.x_m, 4.5, 1e-12);
}

TEST(Collision, WhoTouchesAWallMayGoAlongItAndAwayFromItButNotInto) {
  const WallIndex walls(Plan(10.0, 10.0, {}));
  const Point at = advance(walls, {5.0, 5.0}, {5.0, -5.0}, 0.5).at;
  EXPECT_NEAR(at.y_m, 0.5, 1e-12);
  EXPECT_FALSE(advance(walls, at, {8.0, at.y_m}, 0.5).blocked);
  EXPECT_FALSE(advance(walls, at, {8.0, at.y_m - 1e-15}, 0.5).blocked);  // a rounded heading
  EXPECT_FALSE(advance(walls, at, {6.0, 0.6}, 0.5).blocked);
  EXPECT_LE(advance(walls, at, {5.0, 0.0}, 0.5).distance_m, 1e-9);
  EXPECT_LE(advance(walls, at, {6.0, 0.4}, 0.5).distance_m, 1e-8);
}

TEST(Collision, CreepingAgainstAWallForeverDoesNotGetIn) {
  const WallIndex walls(Plan(10.0, 10.0, {{{0.0, 3.0}, {10.0, 4.0}}}));
  Point at{5.0, 2.0};
  for (int i = 0; i < 20000; ++i) {
    const double angle = 0.0996686524911620 + (i % 2 == 0 ? 0.0 : math::pi) + (i % 7) * 1e-9;
    at = advance(walls, at, {at.x_m + 0.1 * std::cos(angle), at.y_m + 0.1 * std::sin(angle)}, 0.4)
             .at;
    at = advance(walls, at, {at.x_m, at.y_m + 0.01}, 0.4).at;
  }
  EXPECT_GE(distance(at, Segment{{0.0, 3.0}, {10.0, 4.0}}), 0.4L - 1e-9L);
  EXPECT_LE(distance(at, Segment{{0.0, 3.0}, {10.0, 4.0}}), 0.4L + 1e-9L);
}

TEST(Collision, DiscsStopEachOther) {
  const WallIndex walls(Plan(10.0, 10.0, {}));
  const std::array<Disc, 1> other = {{{{6.0, 5.3}, 0.3}}};
  const Advance move = advance(walls, {2.0, 5.0}, {9.0, 5.0}, 0.2, other);
  EXPECT_TRUE(move.blocked);
  EXPECT_NEAR(move.at.x_m, 5.6, 1e-12);  // 0.3, 0.4, 0.5
  EXPECT_FALSE(advance(walls, move.at, {2.0, 5.0}, 0.2, other).blocked);
  // Two that overlap may part, but not come closer.
  EXPECT_FALSE(advance(walls, {5.8, 5.3}, {2.0, 5.3}, 0.2, other).blocked);
  EXPECT_EQ(advance(walls, {5.8, 5.3}, {6.0, 5.3}, 0.2, other).distance_m, 0.0);
}

TEST(Collision, WhoStandsInABarrierThatComesUpMayLeaveAwayFromItsEdge) {
  const std::array<Rectangle, 1> barrier = {{{{4.0, 4.0}, {6.0, 6.0}}}};
  WallIndex walls(Plan(10.0, 10.0, {}), barrier);
  EXPECT_FALSE(advance(walls, {3.9, 5.0}, {5.0, 5.0}, 0.3).blocked);
  walls.block(0);
  EXPECT_EQ(advance(walls, {3.9, 5.0}, {5.0, 5.0}, 0.3).distance_m, 0.0);
  EXPECT_FALSE(advance(walls, {3.9, 5.0}, {2.0, 5.0}, 0.3).blocked);
  walls.unblock(0);
  EXPECT_FALSE(advance(walls, {3.9, 5.0}, {5.0, 5.0}, 0.3).blocked);
}

TEST(Collision, WhoStandsInAThickWallStaysWithinThePlan) {
  const WallIndex walls(Plan(parse_text("######\n######\n##  ##\n######\n", "p", 1.0)));
  const Advance out = advance(walls, {0.7, 2.9}, {-20.3, 2.9}, 0.3);
  EXPECT_TRUE(out.blocked);
  EXPECT_EQ(out.at, (Point{0.0, 2.9}));
  EXPECT_NEAR(advance(walls, {0.7, 1.5}, {5.0, 1.5}, 0.3).at.x_m, 1.7, 1e-12);
  for (double angle = 0.0; angle < 6.3; angle += 0.37) {
    const ArcAdvance arc = advance_along_arc(walls, {{0.7, 2.9}, angle}, 50.0, 1.3, 0.3);
    EXPECT_TRUE(arc.blocked);
    EXPECT_TRUE(walls.contains(arc.end.at));
  }
}

TEST(Collision, AnArcEndsWhereItsCircleDoes) {
  const WallIndex walls(Plan(20.0, 20.0, {}));
  for (const double turn : {0.0, 1e-12, 0.3, -2.0, 6.0}) {
    for (const double length : {3.0, -3.0}) {
      const ArcAdvance arc = advance_along_arc(walls, {{10.0, 10.0}, 0.5}, length, turn, 0.3);
      const double half = 0.5 * turn;
      const double chord = half == 0.0 ? length : length * std::sin(half) / half;
      EXPECT_FALSE(arc.blocked);
      EXPECT_NEAR(arc.end.at.x_m, 10.0 + chord * std::cos(0.5 + half), 1e-12);
      EXPECT_NEAR(arc.end.at.y_m, 10.0 + chord * std::sin(0.5 + half), 1e-12);
      EXPECT_NEAR(arc.end.heading_rad, 0.5 + turn, 1e-12);
      EXPECT_NEAR(arc.distance_m, 3.0, 1e-12);
    }
  }
}

TEST(Collision, AnArcStopsWhereItsCircleMeetsTheWall) {
  // A circle of radius 2 around (5, 5), from its lowest point counter-clockwise; the wall x = 6.5
  // stops a disc of 0.5 m where x = 6: at an angle of 30 degrees.
  const WallIndex walls(Plan(10.0, 10.0, {{{6.5, 0.0}, {6.5, 10.0}}}));
  const ArcAdvance arc =
      advance_along_arc(walls, {{5.0, 3.0}, 0.0}, 4.0 * math::pi, 2.0 * math::pi, 0.5);
  EXPECT_TRUE(arc.blocked);
  EXPECT_NEAR(arc.end.at.x_m, 6.0, 1e-9);
  EXPECT_NEAR(arc.end.at.y_m, 5.0 - std::sqrt(3.0), 2e-3);  // 1 mm off the arc, at 30 degrees
  EXPECT_NEAR(arc.distance_m, 2.0 * math::pi / 6.0, 2e-3);
  EXPECT_NEAR(arc.end.heading_rad, math::pi / 6.0, 1e-3);
}

TEST(Collision, ClearanceIsThatOfBruteForce) {
  Stream stream(10, Purpose("moves"), Entity{1});
  for (int round = 0; round < 100; ++round) {
    const Plan plan = random_plan(stream);
    const WallIndex walls(plan);
    for (int i = 0; i < 20; ++i) {
      const Point p = anywhere(stream, plan);
      const double up_to = stream.uniform(0.0, 4.0);
      const double expected = static_cast<double>(std::min(distance(p, plan.walls()), Real{up_to}));
      ASSERT_NEAR(clearance(walls, p, up_to), expected, 1e-12);
    }
  }
}

TEST(Collision, MisuseIsABug) {
  const WallIndex walls(Plan(10.0, 10.0, {}));
  EXPECT_THROW(advance(walls, {11, 1}, {1, 1}, 0.1), BrokenInvariant);
  EXPECT_THROW(advance(walls, {1, 1}, {std::nan(""), 1}, 0.1), BrokenInvariant);
  EXPECT_THROW(advance(walls, {1, 1}, {2, 1}, 0.0), BrokenInvariant);
  EXPECT_THROW(advance(walls, {1, 1}, {2, 1}, std::nan("")), BrokenInvariant);
  EXPECT_THROW(advance_along_arc(walls, {{1, 1}, 0.0}, 1e5, 0.0, 0.1), BrokenInvariant);
  EXPECT_THROW(clearance(walls, {1, 1}, -1.0), BrokenInvariant);
}

}  // namespace
}  // namespace hearsay::plan
