// The plans that come with the scenarios, 0.5 m a character.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "sim/world/collision.hpp"
#include "sim/world/plan.hpp"
#include "sim/world/shortest_path.hpp"
#include "tests/sim/world/floors.hpp"

namespace hearsay::plan {
namespace {

constexpr double cell_m = 0.5;
constexpr double robot_m = 0.3;

Drawing shipped(const std::string& name) {
  return read_text(HEARSAY_SOURCE_DIR "/scenarios/lost/plans/" + name + ".txt", cell_m);
}

struct Expected {
  const char* name;
  double width_m, height_m;
  std::size_t places;
};
class ShippedPlans : public testing::TestWithParam<Expected> {};

/// Numbers the connected parts of what is free(column, row), from 1; 0 where it is not.
template <typename F>
std::vector<int> parts(int columns, int rows, F&& free) {
  std::vector<int> part(static_cast<std::size_t>(columns * rows), 0);
  int count = 0;
  std::vector<int> todo;
  for (int start = 0; start < columns * rows; ++start) {
    const auto visit = [&](int c, int r) {
      if (c < 0 || r < 0 || c >= columns || r >= rows) return;
      const int at = r * columns + c;
      if (part[static_cast<std::size_t>(at)] != 0 || !free(c, r)) return;
      part[static_cast<std::size_t>(at)] = count;
      todo.push_back(at);
    };
    if (part[static_cast<std::size_t>(start)] != 0 || !free(start % columns, start / columns)) {
      continue;
    }
    ++count;
    visit(start % columns, start / columns);
    while (!todo.empty()) {
      const int c = todo.back() % columns, r = todo.back() / columns;
      todo.pop_back();
      visit(c - 1, r), visit(c + 1, r), visit(c, r - 1), visit(c, r + 1);
    }
  }
  return part;
}

/// Whether a disc of that radius, in m, has room there, by the cells themselves.
bool has_room(const Drawing& d, double x, double y, double radius) {
  for (int row = static_cast<int>(y / d.cell_m) - 1; row <= y / d.cell_m + 1; ++row) {
    for (int column = static_cast<int>(x / d.cell_m) - 1; column <= x / d.cell_m + 1; ++column) {
      if (!d.wall(column, row)) continue;
      const double dx = std::max({column * d.cell_m - x, x - (column + 1) * d.cell_m, 0.0});
      const double dy = std::max({row * d.cell_m - y, y - (row + 1) * d.cell_m, 0.0});
      if (dx * dx + dy * dy < radius * radius) return false;
    }
  }
  return true;
}

TEST_P(ShippedPlans, HasItsSizeAndItsPlaces) {
  const auto& [name, width_m, height_m, places] = GetParam();
  const Plan plan(shipped(name));
  EXPECT_EQ(plan.width_m(), width_m);
  EXPECT_EQ(plan.height_m(), height_m);
  EXPECT_EQ(plan.places().size(), places);
  EXPECT_NO_THROW(plan.place("A"));
  EXPECT_NO_THROW(plan.place("B"));
}

TEST_P(ShippedPlans, ARobotGetsFromEachPlaceToEachOther) {
  const Drawing d = shipped(GetParam().name);
  // Steps of 0.1 m: with 0.305 m at both ends of one, there are 0.3 m all the way.
  constexpr double step_m = 0.1;
  const int columns = d.columns * 5, rows = d.rows * 5;
  const std::vector<int> part = parts(columns, rows, [&](int c, int r) {
    return has_room(d, (c + 0.5) * step_m, (r + 0.5) * step_m, 0.305);
  });
  const auto part_of = [&](Point p) {
    return part[static_cast<std::size_t>(static_cast<int>(p.y_m / step_m) * columns +
                                         static_cast<int>(p.x_m / step_m))];
  };
  const int first = part_of(d.places[0].at);
  EXPECT_GT(first, 0);
  for (const Place& place : d.places) EXPECT_EQ(part_of(place.at), first) << place.name;
}

TEST_P(ShippedPlans, TheShortestPathCanBeDrivenAndIsTheSameBothWays) {
  const Plan plan(shipped(GetParam().name));
  const WallIndex walls(plan);
  const Point a = plan.place("A"), b = plan.place("B");
  const auto there = shortest_path(walls, a, b, robot_m, 0.25);
  const auto back = shortest_path(walls, b, a, robot_m, 0.25);
  ASSERT_TRUE(there && back);
  EXPECT_NEAR(there->length_m, back->length_m, 0.005 * there->length_m);
  EXPECT_GE(there->length_m, distance(a, b) - 1e-9L);
  Real sum = 0;
  for (std::size_t i = 1; i < there->points.size(); ++i) {
    const Point p = there->points[i - 1], q = there->points[i];
    EXPECT_FALSE(advance(walls, p, q, robot_m).blocked);
    sum += distance(p, q);
  }
  EXPECT_NEAR(there->length_m, static_cast<double>(sum), 1e-9);
  EXPECT_EQ(there->points.front(), a);
  EXPECT_EQ(there->points.back(), b);
}

INSTANTIATE_TEST_SUITE_P(
    All, ShippedPlans,
    testing::Values(Expected{"square", 20.0, 20.0, 2}, Expected{"corridor", 40.0, 18.0, 2},
                    Expected{"cave", 40.0, 40.0, 3}, Expected{"hospital", 60.0, 30.0, 42},
                    Expected{"office", 30.5, 20.5, 4}, Expected{"doors", 20.0, 20.0, 2}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(ShippedHospital, HasFortyRoomsAroundOneNetOfCorridors) {
  const Drawing d = shipped("hospital");
  // Doors are two cells wide: where three by three are free, it is a room or a corridor.
  const std::vector<int> part = parts(d.columns, d.rows, [&](int c, int r) {
    for (int row = r - 1; row <= r + 1; ++row) {
      for (int column = c - 1; column <= c + 1; ++column) {
        if (d.wall(column, row)) return false;
      }
    }
    return true;
  });
  EXPECT_EQ(*std::max_element(part.begin(), part.end()), 41);
}

TEST(ShippedCorridor, IsAsLongAsTheTripsOfTheExperiment) {
  // LOST 2002: 1605 m in 52 trips, with four corners cut less well than by a map.
  const Plan plan(shipped("corridor"));
  const auto path = shortest_path(WallIndex(plan), plan.place("A"), plan.place("B"), robot_m, 0.25);
  ASSERT_TRUE(path);
  EXPECT_GT(path->length_m, 26.0);
  EXPECT_LT(path->length_m, 1605.0 / 52.0);
}

}  // namespace
}  // namespace hearsay::plan
