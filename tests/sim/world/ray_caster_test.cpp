#include "sim/world/ray_caster.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"
#include "tests/sim/world/floors.hpp"

namespace hearsay::plan {
namespace {

constexpr double far_m = 1000.0;

Point direction(double angle_rad) { return {std::cos(angle_rad), std::sin(angle_rad)}; }
Point towards(Point from, Point to) {
  const double length = static_cast<double>(distance(from, to));
  return {(to.x_m - from.x_m) / length, (to.y_m - from.y_m) / length};
}
Point anywhere(Stream& stream, const Plan& plan) {
  return {stream.uniform(0.0, plan.width_m()), stream.uniform(0.0, plan.height_m())};
}

Plan some_plan(Stream& stream) {
  return stream.bernoulli(0.5) ? Plan(random_drawing(stream, 25, 0.5)) : random_plan(stream);
}

TEST(RayCaster, DistancesAreThoseOfBruteForce) {
  Stream stream(5, Purpose("rays"), Entity{0});
  int hits = 0;
  for (int round = 0; round < 300; ++round) {
    const Plan plan = some_plan(stream);
    const WallIndex walls(plan);
    for (int ray = 0; ray < 60; ++ray) {
      const Point o = anywhere(stream, plan);
      const Point d = direction(stream.uniform(0.0, 7.0));
      const double range = stream.uniform(0.1, 20.0);
      Real expected = range;
      for (const Segment& s : plan.walls()) {
        if (const auto t = crossing(o, d, s)) expected = std::min(expected, *t);
      }
      const Hit hit = cast(walls, o, d, range);
      ASSERT_NEAR(hit.distance_m, static_cast<double>(expected), 1e-9);
      if (hit.what == nothing) continue;
      ++hits;
      const Point at{o.x_m + hit.distance_m * d.x_m, o.y_m + hit.distance_m * d.y_m};
      ASSERT_LT(distance(at, plan.walls()[static_cast<std::size_t>(hit.what)]), 1e-9L);
    }
  }
  EXPECT_GT(hits, 5000);
}

TEST(RayCaster, TheSizeOfTheCellsOfTheIndexChangesNoBit) {
  Stream stream(6, Purpose("rays"), Entity{0});
  for (int round = 0; round < 60; ++round) {
    const Plan plan = some_plan(stream);
    const WallIndex whole(plan, {}, 1000.0), fine(plan, {}, 0.13), same(plan, {}, 0.5), usual(plan);
    ASSERT_EQ(whole.columns() * whole.rows(), 1);
    for (int ray = 0; ray < 60; ++ray) {
      Point o = anywhere(stream, plan);
      Point d = direction(stream.uniform(0.0, 7.0));
      if (ray % 3 == 0) {  // along lines of the lattice, from its points
        o = {std::floor(o.x_m * 2.0) / 2.0, std::floor(o.y_m * 2.0) / 2.0};
        d = std::array<Point, 4>{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}}[stream.below(4)];
      } else if (ray % 3 == 1) {  // at corners
        const Segment& s = plan.walls()[stream.below(plan.walls().size())];
        if (s.to == o) continue;
        d = towards(o, s.to);
      }
      const double expected = cast(whole, o, d, far_m).distance_m;
      for (const WallIndex* walls : {&fine, &same, &usual}) {
        ASSERT_EQ(cast(*walls, o, d, far_m).distance_m, expected);
      }
    }
  }
}

/// A room of 4 × 3 m with a thick pillar from (1, 1) to (2, 2).
const Plan& room() {
  static const Plan plan(parse_text("######\n#    #\n# #  #\n#    #\n######\n", "p", 1.0));
  return plan;
}

TEST(RayCaster, ParallelToWallsAndAlongThemIsDefined) {
  const WallIndex walls(room());  // free: 1 … 5 × 1 … 4; the pillar: 2 … 3 × 2 … 3
  const auto from = [&](double x, double y, double dx, double dy) {
    return cast(walls, {x, y}, {dx, dy}, far_m).distance_m;
  };
  EXPECT_EQ(from(1.5, 1.5, 1, 0), 3.5);   // parallel to both
  EXPECT_EQ(from(1.5, 2.5, 1, 0), 0.5);   // straight at the pillar
  EXPECT_EQ(from(1.5, 3.0, 1, 0), 0.5);   // along the pillar's upper side: its corner
  EXPECT_EQ(from(1.5, 2.0, 1, 0), 0.5);   // along its lower side
  EXPECT_EQ(from(4.5, 2.0, -1, 0), 1.5);  // the same from behind
  EXPECT_EQ(from(2.5, 2.0, 1, 0), 0.0);   // from within a side, along it
  EXPECT_EQ(from(2.5, 2.0, 0, -1), 0.0);  // from a wall, away from it
  EXPECT_EQ(from(2.0, 2.0, -1, 0), 0.0);  // from a corner
  EXPECT_EQ(from(1.0, 1.0, 1, 0), 0.0);   // from a corner of the room, along its wall
  EXPECT_EQ(from(2.5, 2.5, 1, 0), 0.5);   // from inside the pillar: its surface
  EXPECT_EQ(from(3.0 + 1e-12, 2.5, 1, 0), 2.0 - 1e-12);
  const double r = std::sqrt(0.5);
  EXPECT_NEAR(cast(walls, {1.5, 1.5}, {r, r}, far_m).distance_m, r, 1e-12);  // at a corner
  // Just past two corners of the pillar, on the diagonal from (1, 3) to (3, 1) … moved out.
  EXPECT_NEAR(cast(walls, {1.0 + 1e-9, 3.0 - 2e-9}, {r, -r}, far_m).distance_m, 2.0 / r, 1e-6);
}

TEST(RayCaster, NoRaySlipsOutBetweenTwoWalls) {
  Stream stream(7, Purpose("rays"), Entity{0});
  for (int round = 0; round < 200; ++round) {
    const Drawing drawing = random_drawing(stream, 12, stream.uniform(0.1, 1.0));
    const Plan plan(drawing);
    const WallIndex walls(plan);
    for (int ray = 0; ray < 100; ++ray) {
      const Point o = anywhere(stream, plan);
      if (drawing.wall(static_cast<int>(o.x_m / drawing.cell_m),
                       static_cast<int>(o.y_m / drawing.cell_m))) {
        continue;
      }
      const Point corner = plan.walls()[stream.below(plan.walls().size())].from;
      const Point d = towards(o, corner);
      const Hit hit = cast(walls, o, d, far_m);
      // It may graze the corner by a rounding and go on, but not leave the plan.
      Real expected = 1e30L;
      for (const Segment& s : plan.walls()) {
        for (const double nudge : {-1e-9, 1e-9}) {
          const Point turned{d.x_m - nudge * d.y_m, d.y_m + nudge * d.x_m};
          if (const auto t = crossing(o, turned, s)) expected = std::min(expected, *t);
        }
      }
      ASSERT_NE(hit.what, nothing);
      ASSERT_GE(hit.distance_m, static_cast<double>(expected) - 1e-6);
      const Point at{o.x_m + hit.distance_m * d.x_m, o.y_m + hit.distance_m * d.y_m};
      ASSERT_LT(distance(at, plan.walls()), 1e-9L);
    }
  }
}

TEST(RayCaster, DiscsAreHitAtTheirEdge) {
  Stream stream(8, Purpose("rays"), Entity{0});
  const Plan plan(20.0, 20.0, {});
  const WallIndex walls(plan);
  int hits = 0;
  for (int ray = 0; ray < 3000; ++ray) {
    const Point o = anywhere(stream, plan), d = direction(stream.uniform(0.0, 7.0));
    std::vector<Disc> discs(stream.below(4));
    for (Disc& disc : discs) disc = {anywhere(stream, plan), stream.uniform(0.1, 3.0)};
    Real expected = 1e30L;
    for (const Segment& s : plan.walls()) {
      if (const auto t = crossing(o, d, s)) expected = std::min(expected, *t);
    }
    for (const Disc& disc : discs) {
      if (distance(o, disc.at) <= disc.radius_m) expected = 0;
      const Real x = Real{o.x_m} - disc.at.x_m, y = Real{o.y_m} - disc.at.y_m;
      const Real b = x * d.x_m + y * d.y_m;
      const Real root = b * b - (x * x + y * y - Real{disc.radius_m} * disc.radius_m);
      if (root >= 0 && -b - std::sqrt(root) >= 0)
        expected = std::min(expected, -b - std::sqrt(root));
    }
    const Hit hit = cast(walls, o, d, far_m, discs);
    ASSERT_NEAR(hit.distance_m, static_cast<double>(expected), 1e-7);
    hits += hit.what >= static_cast<int>(walls.segments().size());
  }
  EXPECT_GT(hits, 300);
}

TEST(RayCaster, ABarrierIsSeenWhileItIsUp) {
  const Plan plan(10.0, 2.0, {});
  const std::array<Rectangle, 2> barriers = {{{{4.0, 0.0}, {5.0, 2.0}}, {{7.0, 0.0}, {8.0, 2.0}}}};
  WallIndex walls(plan, barriers);
  const auto ahead = [&] { return cast(walls, {1.0, 1.0}, {1.0, 0.0}, far_m).distance_m; };
  EXPECT_EQ(ahead(), 9.0);
  walls.block(1);
  EXPECT_EQ(ahead(), 6.0);
  walls.block(0);
  EXPECT_EQ(ahead(), 3.0);
  walls.unblock(0);
  EXPECT_EQ(ahead(), 6.0);
  EXPECT_THROW(walls.block(2), BrokenInvariant);
  for (const Rectangle& bad : {Rectangle{{4, 0}, {11, 1}}, Rectangle{{4, 0}, {4, 1}},
                               Rectangle{{4, 1}, {5, 0}}, Rectangle{{std::nan(""), 0}, {5, 1}}}) {
    EXPECT_THROW(WallIndex(plan, std::array{bad}), InputError);
  }
}

TEST(RayCaster, AScanIsItsRays) {
  const WallIndex walls(room());
  const double view = 1.5 * math::pi, heading = 0.7;
  const Fan fan(37, view);
  EXPECT_NEAR(fan.angle_rad(0), -view / 2 + view / 74, 1e-15);
  EXPECT_NEAR(fan.angle_rad(18), 0.0, 1e-15);
  EXPECT_NEAR(fan.angle_rad(36), view / 2 - view / 74, 1e-15);
  const std::array<Disc, 1> discs = {{{{4.5, 1.5}, 0.25}}};
  std::vector<double> distances(37);
  scan(walls, {1.25, 1.5}, heading, fan, 2.5, discs, distances);
  for (std::size_t i = 0; i < distances.size(); ++i) {
    const Point d = direction(heading + fan.angle_rad(i));
    EXPECT_NEAR(distances[i], cast(walls, {1.25, 1.5}, d, 2.5, discs).distance_m, 1e-9) << i;
  }
  EXPECT_EQ(Fan(1, 0.0).directions()[0], (Point{1.0, 0.0}));
  // As narrow as numbers are, it sees a disc straight on.
  scan(walls, {1.25, 1.5}, 0.0, Fan(37, 1e-307), 5.0, discs, distances);
  for (const double d : distances)
    EXPECT_NEAR(d, cast(walls, {1.25, 1.5}, {1.0, 0.0}, 5.0, discs).distance_m, 1e-12);
}

TEST(RayCaster, MisuseIsABug) {
  const WallIndex walls(room());
  EXPECT_THROW(cast(walls, {-1, 1}, {1, 0}, 1.0), BrokenInvariant);
  EXPECT_THROW(cast(walls, {std::nan(""), 1}, {1, 0}, 1.0), BrokenInvariant);
  EXPECT_THROW(cast(walls, {1, 1}, {1, 1}, 1.0), BrokenInvariant);
  EXPECT_THROW(cast(walls, {1, 1}, {1, 0}, 0.0), BrokenInvariant);
  EXPECT_THROW(Fan(0, 1.0), BrokenInvariant);
  EXPECT_THROW(Fan(1, 7.0), BrokenInvariant);
  std::vector<double> two(2);
  EXPECT_THROW(scan(walls, {1, 1}, 0.0, Fan(3, 1.0), 1.0, {}, two), BrokenInvariant);
}

}  // namespace
}  // namespace hearsay::plan
