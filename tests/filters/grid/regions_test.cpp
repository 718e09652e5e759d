#include "filters/grid/regions.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <string_view>

#include "sim/kernel/error.hpp"
#include "tests/filters/grid/samples.hpp"

namespace hearsay::grid {
namespace {

TEST(GridRegions, HangTogetherBySidesAndCorners) {
  const Area area({.columns = 6, .rows = 4});
  constexpr std::string_view map =
      "##...#"
      "..#..#"
      "......"
      "#..###";
  BernoulliGrid grid(area);
  for (int i = 0; i < area.cells(); ++i)
    grid.add(i, map[static_cast<std::size_t>(i)] == '#' ? 2.0 : -2.0);
  RegionFinder finder;
  const auto regions = finder.find(grid, 0.5);
  ASSERT_EQ(regions.size(), 4u);
  const int firsts[] = {0, 5, 18, 21}, sizes[] = {3, 2, 1, 3};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(regions[i].first_cell, firsts[i]);
    EXPECT_EQ(regions[i].cells, sizes[i]);
    EXPECT_NEAR(regions[i].mean_probability, 1 / (1 + std::exp(-2.0)), 1e-12);
  }
  EXPECT_TRUE(finder.find(grid, 0.9).empty());
  EXPECT_EQ(finder.find(grid, 0.1).size(), 1u);
  EXPECT_THROW(finder.find(grid, 1.1), BrokenInvariant);
}

TEST(GridRegions, ArePlacesByEquation420) {
  // Two cells of p = 0.8 and one of 0.6, far from the origin.
  const Area area({.columns = 5, .rows = 5, .cell_m = 2.0, .x_m = 1000.0, .y_m = -500.0});
  BetaGrid grid(area);
  grid.add(area.number({1, 1}), 3, 0);  // α 4, β 1
  grid.add(area.number({2, 1}), 3, 0);
  grid.add(area.number({2, 2}), 2, 1);  // α 3, β 2
  RegionFinder finder;
  const auto regions = finder.find(grid, 0.55);
  ASSERT_EQ(regions.size(), 1u);
  const Region& r = regions[0];
  const double p = 2.2, x = (0.8 * 1003 + 0.8 * 1005 + 0.6 * 1005) / p;
  const double y = (0.8 * -497 + 0.8 * -497 + 0.6 * -495) / p;
  EXPECT_NEAR(r.position.x_m, x, 1e-9);
  EXPECT_NEAR(r.position.y_m, y, 1e-9);
  const auto moment = [&](auto f) {
    return (0.8 * f(1003.0, -497.0) + 0.8 * f(1005.0, -497.0) + 0.6 * f(1005.0, -495.0)) / p;
  };
  EXPECT_NEAR(r.xx_m2, moment([&](double u, double) { return (u - x) * (u - x); }), 1e-9);
  EXPECT_NEAR(r.xy_m2, moment([&](double u, double v) { return (u - x) * (v - y); }), 1e-9);
  EXPECT_NEAR(r.yy_m2, moment([&](double, double v) { return (v - y) * (v - y); }), 1e-9);
  EXPECT_NEAR(r.mean_probability, p / 3, 1e-12);
}

TEST(GridRegions, EqualTheComponentsOfTheGraph) {
  // Beside union of all pairs of marked neighbours.
  Stream random = stream("regions");
  RegionFinder finder;
  for (int trial = 0; trial < 30; ++trial) {
    const Area area({.columns = 25, .rows = 17});
    BernoulliGrid grid(area);
    for (int i = 0; i < area.cells(); ++i) grid.add(i, random.bernoulli(0.35) ? 1.0 : -1.0);
    std::vector<int> root(static_cast<std::size_t>(area.cells()));
    std::iota(root.begin(), root.end(), 0);
    const auto find_root = [&](int i) {
      while (root[static_cast<std::size_t>(i)] != i) i = root[static_cast<std::size_t>(i)];
      return i;
    };
    std::vector<int> sizes(root.size(), 0);
    for (int i = 0; i < area.cells(); ++i) {
      for (int j = 0; j < i; ++j) {
        const Cell a = area.cell(i), b = area.cell(j);
        const bool beside = std::abs(a.column - b.column) <= 1 && std::abs(a.row - b.row) <= 1;
        if (!beside || grid.evidence()[static_cast<std::size_t>(i)] < 0.0F ||
            grid.evidence()[static_cast<std::size_t>(j)] < 0.0F) {
          continue;
        }
        const int x = find_root(i), y = find_root(j);
        root[static_cast<std::size_t>(std::max(x, y))] = std::min(x, y);
      }
    }
    for (int i = 0; i < area.cells(); ++i) {
      if (grid.evidence()[static_cast<std::size_t>(i)] > 0.0F)
        ++sizes[static_cast<std::size_t>(find_root(i))];
    }
    std::size_t k = 0;
    const auto regions = finder.find(grid, 0.5);
    for (int i = 0; i < area.cells(); ++i) {
      if (sizes[static_cast<std::size_t>(i)] == 0) continue;
      ASSERT_LT(k, regions.size());
      EXPECT_EQ(regions[k].first_cell, i);
      EXPECT_EQ(regions[k++].cells, sizes[static_cast<std::size_t>(i)]);
    }
    EXPECT_EQ(k, regions.size());
  }
}

TEST(GridRegions, AreMatchedWithPlaces) {
  std::vector<Region> regions(3);
  regions[0].position = {10, 10};
  regions[1].position = {50, 50};
  regions[2].position = {13, 14};
  const std::vector<Point> places{{13, 11}, {90, 90}, {10, 13}};
  const Match m = match(regions, places, 8.0);
  EXPECT_EQ(m.detected, 2);
  EXPECT_EQ(m.missed, 1);
  EXPECT_EQ(m.false_alarms, 1);
  EXPECT_EQ(m.place_of, (std::vector<int>{2, -1, 0}));  // 3 + 3 is less than √10 + √10
  EXPECT_NEAR(m.position_error_m, 3.0, 1e-12);
  const Match none = match({}, places, 8.0);
  EXPECT_EQ(none.missed, 3);
  EXPECT_EQ(none.position_error_m, 0.0);
  EXPECT_EQ(match(regions, {}, 8.0).false_alarms, 3);
  EXPECT_THROW(match(regions, places, 0.0), BrokenInvariant);
}

TEST(GridRegions, ASecondRegionAtAPlaceIsAFalseAlarm) {
  std::vector<Region> regions(2);
  regions[0].position = {1, 0};
  regions[1].position = {-2, 0};
  const Match m = match(regions, std::vector<Point>{{0, 0}}, 5.0);
  EXPECT_EQ(m.place_of, (std::vector<int>{0, -1}));
  EXPECT_EQ(m.false_alarms, 1);
}

TEST(GridRegions, RatesCellByCell) {
  const std::vector<unsigned char> marks{1, 0, 1, 1, 0, 0}, truth{1, 1, 0, 1, 0, 0};
  const CellRates rates = cell_rates(marks, truth);
  EXPECT_EQ(rates.hits, 2);
  EXPECT_EQ(rates.true_cells, 3);
  EXPECT_EQ(rates.false_alarms, 1);
  EXPECT_EQ(rates.empty_cells, 3);
  EXPECT_THROW(cell_rates(marks, std::vector<unsigned char>(5)), BrokenInvariant);
}

}  // namespace
}  // namespace hearsay::grid
