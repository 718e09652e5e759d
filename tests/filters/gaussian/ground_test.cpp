#include "filters/gaussian/ground.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "sim/kernel/error.hpp"
#include "tests/filters/gaussian/samples.hpp"

namespace hearsay::gaussian {
namespace {

Ray ray(const Vector3& from, const Vector3& direction) { return {from, direction.normalized()}; }

/// Heights of a function at the nodes.
template <typename Height>
Terrain terrain(int columns, int rows, double spacing_m, const Height& height) {
  Terrain::Options options{.x_m = -3.0,
                           .y_m = 2.0,
                           .spacing_m = spacing_m,
                           .columns = columns,
                           .rows = rows,
                           .heights_m = {}};
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      options.heights_m.push_back(height(-3.0 + i * spacing_m, 2.0 + j * spacing_m));
    }
  }
  return Terrain(std::move(options));
}

TEST(Ground, APlaneIsMetWhereTheSlantSays) {
  const Ground plane = Plane{10.0};
  const auto down = meet(plane, ray({3, 4, 50}, {0, 0, -1}));
  ASSERT_TRUE(down);
  EXPECT_EQ(down->point_m, Vector3(3, 4, 10));
  EXPECT_DOUBLE_EQ(down->distance_m, 40.0);
  EXPECT_EQ(down->normal, Vector3(0, 0, 1));
  const auto slant = meet(plane, ray({3, 4, 50}, {3, 0, -4}));  // 40 down, 30 along, 50 far
  ASSERT_TRUE(slant);
  EXPECT_LT((slant->point_m - Vector3(33, 4, 10)).norm(), 1e-12);
  EXPECT_NEAR(slant->distance_m, 50.0, 1e-12);
}

TEST(Ground, RaysThatDoNotComeDownMiss) {
  for (const Ground& ground :
       {Ground(Plane{1.0}), Ground(terrain(20, 20, 1.0, [](double, double) { return 1.0; }))}) {
    EXPECT_FALSE(meet(ground, ray({5, 8, 9}, {1, 0, 0}))) << "level";
    EXPECT_FALSE(meet(ground, ray({5, 8, 9}, {1, 0, 0.3}))) << "up";
    EXPECT_FALSE(meet(ground, ray({5, 8, 0}, {1, 0, 0.3}))) << "from under the ground";
    EXPECT_FALSE(meet(ground, ray({5, 8, 0}, {0, 0, -1}))) << "under the ground, down";
    EXPECT_FALSE(meet(ground, ray({5, 8, 1}, {0, 0, -1}))) << "on the ground";
    EXPECT_FALSE(meet(ground, ray({5, 8, 9}, {1, 0, -1e-6}))) << "beyond the longest range";
    EXPECT_FALSE(meet(ground, {{5, 8, std::nan("")}, {0, 0, -1}}));
    EXPECT_FALSE(meet(ground, {{5, 8, 9}, {std::nan(""), 0, -1}}));
  }
}

TEST(Terrain, IsBilinearBetweenItsNodesAndEndsAtItsEdge) {
  const Terrain t({.heights_m = {1.0, 2.0, 4.0, 9.0}});
  EXPECT_EQ(t.height_m(0, 0), 1.0);
  EXPECT_EQ(t.height_m(1, 0), 2.0);
  EXPECT_EQ(t.height_m(0, 1), 4.0);
  EXPECT_EQ(t.height_m(1, 1), 9.0);
  EXPECT_EQ(t.height_m(0.5, 0.5), 4.0);
  EXPECT_EQ(t.height_m(0.25, 0), 1.25);
  EXPECT_FALSE(t.height_m(1.001, 0.5));
  EXPECT_FALSE(t.height_m(0.5, -0.001));
  EXPECT_FALSE(t.height_m(std::nan(""), 0.5));
}

TEST(Terrain, ASlopeIsMetAsThePlaneItIs) {
  // z = 1 + 0.2x − 0.1y, by every way a ray can run over the grid.
  const auto height = [](double x, double y) { return 1 + 0.2 * x - 0.1 * y; };
  const Ground ground = terrain(25, 31, 0.5, height);
  const Vector3 normal(-0.2, 0.1, 1.0);
  Stream random = stream("slope");
  int hits = 0;
  for (int i = 0; i < 500; ++i) {
    const Vector3 from(random.uniform(-8, 14), random.uniform(-3, 22), random.uniform(8, 12));
    Vector3 to(random.uniform(-6, 12), random.uniform(-1, 20), 0.0);
    if (i % 5 == 0) to(0) = from(0);  // along the grid
    if (i % 5 == 1) to(1) = from(1);
    if (i % 10 == 0) to(1) = from(1);  // straight down
    to(2) = height(to(0), to(1));
    const bool inside = to(0) > -3 && to(0) < 9 && to(1) > 2 && to(1) < 17;
    const auto hit = meet(ground, ray(from, to - from));
    ASSERT_EQ(hit.has_value(), inside) << i;
    if (!hit) continue;
    ++hits;
    EXPECT_LT((hit->point_m - to).norm(), 1e-11);
    EXPECT_NEAR(hit->distance_m, (to - from).norm(), 1e-11);
    EXPECT_LT((hit->normal - normal).norm(), 1e-11);
  }
  EXPECT_GT(hits, 150);
}

TEST(Terrain, IsMetFirstWhereSmallStepsFindIt) {
  Stream random = stream("rough");
  const Terrain rough = terrain(12, 9, 1.0, [&](double, double) { return random.uniform(0, 3); });
  const Ground ground = rough;
  int hits = 0, misses = 0;
  for (int i = 0; i < 400; ++i) {
    const Vector3 from(random.uniform(-3, 8), random.uniform(2, 10), random.uniform(3.1, 5));
    const Ray r = ray(from, {random.normal(), random.normal(), random.uniform(-0.8, 0.05)});
    constexpr double step = 1e-3;
    double at = -1;
    for (int k = 0; k < 20000 && at < 0; ++k) {
      const Vector3 p = r.origin_m + k * step * r.direction;
      const auto h = rough.height_m(p(0), p(1));
      if (!h) break;
      if (p(2) <= *h) at = k * step;
    }
    const auto hit = meet(ground, r);
    if (at >= 0) {
      ++hits;
      ASSERT_TRUE(hit) << i;
      EXPECT_LE(hit->distance_m, at + 1e-9) << i;
      // The steps may have jumped over a crest that is thinner than a step: then this is one.
      EXPECT_NEAR(*rough.height_m(hit->point_m(0), hit->point_m(1)), hit->point_m(2), 1e-9);
      if (hit->distance_m < at - step) {
        const Vector3 p = r.origin_m + (hit->distance_m + 0.5 * step) * r.direction;
        EXPECT_LT(std::fabs(p(2) - *rough.height_m(p(0), p(1))), 1e-3) << i;
      }
    } else if (!hit) {
      ++misses;
    }
  }
  EXPECT_GT(hits, 60);
  EXPECT_GT(misses, 10);
}

TEST(Terrain, ARidgeInsideOneCellIsNotJumpedOver) {
  // Two high corners across: along the other diagonal the height is 4u(1 − u), at most 1 in the
  // middle of the cell. A ray at 0.99 meets it within a tenth of a metre of the middle.
  const Ground ground = Terrain({.heights_m = {0.0, 2.0, 2.0, 0.0}});
  const auto hit = meet(ground, ray({0, 0, 0.99}, {1, 1, 0}));
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->point_m(0), 0.5 * (1 - std::sqrt(0.01)), 1e-12);
  EXPECT_FALSE(meet(ground, ray({0, 0, 1.01}, {1, 1, 0})));
}

TEST(Terrain, IsEnteredFromOutsideOverItsEdgeButNotThroughItsSide) {
  const Ground ground = terrain(5, 5, 1.0, [](double, double) { return 10.0; });
  const auto over = meet(ground, ray({-8, 4, 15}, {1, 0, -0.8}));
  ASSERT_TRUE(over);
  EXPECT_LT((over->point_m - Vector3(-1.75, 4, 10)).norm(), 1e-12);
  EXPECT_FALSE(meet(ground, ray({-8, 4, 15}, {1, 0, -1.5}))) << "through the side";
  EXPECT_FALSE(meet(ground, ray({-8, 4, 15}, {1, 0, -0.1}))) << "over all of it";
  EXPECT_FALSE(meet(ground, ray({-8, 4, 15}, {-1, 0, -1}))) << "away from it";
  EXPECT_FALSE(meet(ground, ray({-8, 4, 15}, {0, 0, -1}))) << "down beside it";
}

TEST(Terrain, ShapesThatAreNoneAreRefused) {
  const auto bad = [](Terrain::Options options) {
    EXPECT_THROW(Terrain{options}, BrokenInvariant);
  };
  bad({.heights_m = {1, 2, 3}});
  bad({.columns = 1, .rows = 4, .heights_m = {1, 2, 3, 4}});
  bad({.spacing_m = 0.0, .heights_m = {1, 2, 3, 4}});
  bad({.heights_m = {1, 2, 3, std::nan("")}});
  bad({.x_m = HUGE_VAL, .heights_m = {1, 2, 3, 4}});
  bad({.columns = 5000, .rows = 2, .heights_m = std::vector<double>(10000, 0.0)});
}

}  // namespace
}  // namespace hearsay::gaussian
