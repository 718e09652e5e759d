#include "filters/grid/footprint.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/kernel/error.hpp"
#include "tests/filters/grid/samples.hpp"

namespace hearsay::grid {
namespace {

using gaussian::Vector3;

TEST(Footprint, IsASquareAtFirst) {
  const Footprint square = Footprint::around({3.0, -1.0}, 2.0);
  EXPECT_EQ(square.corners().size(), 4u);
  EXPECT_EQ(square.square_metres(), 16.0);
  const auto stretch = square.along(0.0);
  ASSERT_TRUE(stretch);
  EXPECT_EQ(stretch->from_m, 1.0);
  EXPECT_EQ(stretch->to_m, 5.0);
  EXPECT_FALSE(square.along(1.5));
  EXPECT_FALSE(square.along(-3.5));
}

TEST(Footprint, WallsCutOffWhatLiesBehind) {
  Footprint half = Footprint::around({0.0, 0.0}, 2.0);
  half.cut({0.0, 0.0, 5.0}, {1.0, 0.0, 0.0}, 0.0);
  EXPECT_EQ(half.square_metres(), 8.0);
  half.cut({0.0, 0.0, 5.0}, {1.0, -1.0, 0.0}, 0.0);  // what is left of x ≥ y
  EXPECT_EQ(half.square_metres(), 6.0);
  // A slanted wall through (0, 0, 5): x ≥ 1 on the ground.
  half.cut({0.0, 0.0, 5.0}, {5.0, 0.0, 1.0}, 0.0);
  EXPECT_NEAR(half.square_metres(), 6.0 - 2.5, 1e-12);
  half.cut({9.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, 0.0);
  EXPECT_TRUE(half.corners().empty());
  EXPECT_EQ(half.square_metres(), 0.0);
  EXPECT_FALSE(half.along(0.0));
}

TEST(Footprint, HasTheCellsThatAllWallsLeave) {
  Stream random = stream("footprint");
  const Area area({.columns = 60, .rows = 50, .cell_m = 0.7, .x_m = -20.0, .y_m = -15.0});
  std::size_t found = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const Point centre{random.uniform(-30, 30), random.uniform(-30, 30)};
    const double reach_m = random.uniform(0.1, 30.0), ground_m = random.uniform(-1, 1);
    Footprint polygon = Footprint::around(centre, reach_m);
    std::vector<std::pair<Vector3, Vector3>> walls;
    const std::uint64_t count = random.below(9);
    for (std::uint64_t i = 0; i < count; ++i) {
      walls.emplace_back(Vector3(random.normal(0, 9), random.normal(0, 9), random.normal()),
                         Vector3(random.normal(), random.normal(), 4 * random.normal()));
      polygon.cut(walls.back().first, walls.back().second, ground_m);
    }
    std::vector<int> visited, inside;
    const auto within = [&](int cell) {
      const Point at = area.centre(cell);
      bool ok =
          std::fabs(at.x_m - centre.x_m) <= reach_m && std::fabs(at.y_m - centre.y_m) <= reach_m;
      for (const auto& wall : walls) {
        const Vector3 to = Vector3(at.x_m, at.y_m, ground_m) - wall.first;
        ok = ok && wall.second.dot(to) >= 0.0;
      }
      return ok;
    };
    for_each_cell(polygon, area, [&](int cell) {
      visited.push_back(cell);
      if (within(cell)) inside.push_back(cell);
    });
    std::vector<int> all;
    for (int cell = 0; cell < area.cells(); ++cell) {
      if (within(cell)) all.push_back(cell);
    }
    EXPECT_EQ(inside, all);
    EXPECT_LE(visited.size(), inside.size() + 2u * 50u);  // one at either end of a row
    found += all.size();
  }
  EXPECT_GT(found, 1000u);
}

TEST(Footprint, OneBeyondAllNumbersVisitsNoCellThatIsNotThere) {
  const Area area({.columns = 7, .rows = 5});
  for (const double far_m : {1e300, 1e308, static_cast<double>(INFINITY)}) {
    Footprint ground = Footprint::around({3.0, 2.0}, far_m);
    ground.cut({3.0, 2.0, 10.0}, {1.0, 0.5, 0.2}, 0.0);
    for_each_cell(ground, area, [&](int cell) { EXPECT_TRUE(area.has(cell)) << far_m; });
  }
}

TEST(Footprint, ReachesAsFarAsARangeDoes) {
  EXPECT_NEAR(*reach(3.0, 5.0), 4.0, 1e-15);
  EXPECT_FALSE(reach(5.0, 5.0));
  EXPECT_FALSE(reach(6.0, 5.0));
  EXPECT_FALSE(reach(0.0, 5.0));
  EXPECT_FALSE(reach(-1.0, 5.0));
  EXPECT_FALSE(reach(NAN, 5.0));
}

}  // namespace
}  // namespace hearsay::grid
