#include "filters/grid/area.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "sim/kernel/error.hpp"

namespace hearsay::grid {
namespace {

const Area area({.columns = 4, .rows = 3, .cell_m = 2.5, .x_m = -5.0, .y_m = 10.0});

TEST(GridArea, CellsAreNumberedRowByRow) {
  EXPECT_EQ(area.cells(), 12);
  EXPECT_EQ(area.number({0, 0}), 0);
  EXPECT_EQ(area.number({3, 0}), 3);
  EXPECT_EQ(area.number({0, 1}), 4);
  EXPECT_EQ(area.number({3, 2}), 11);
  for (int i = 0; i < area.cells(); ++i) EXPECT_EQ(area.number(area.cell(i)), i);
}

TEST(GridArea, CentresLieInTheirCells) {
  EXPECT_EQ(area.centre(0).x_m, -3.75);
  EXPECT_EQ(area.centre(0).y_m, 11.25);
  EXPECT_EQ(area.centre(11).x_m, 3.75);
  EXPECT_EQ(area.centre(11).y_m, 16.25);
  for (int i = 0; i < area.cells(); ++i) EXPECT_EQ(area.at(area.centre(i)), i);
}

TEST(GridArea, ACellHasItsLowerEdgesAndNotItsUpperOnes) {
  EXPECT_EQ(area.at({-5.0, 10.0}), 0);
  EXPECT_EQ(area.at({-2.5, 10.0}), 1);
  EXPECT_EQ(area.at({-5.0, 12.5}), 4);
  EXPECT_EQ(area.at({5.0 - 1e-12, 10.0}), 3);
  EXPECT_FALSE(area.at({5.0, 10.0}));
  EXPECT_FALSE(area.at({-5.0, 17.5}));
  EXPECT_FALSE(area.at({-5.0 - 1e-12, 10.0}));
  EXPECT_FALSE(area.at({NAN, 10.0}));
  EXPECT_FALSE(area.at({0.0, HUGE_VAL}));
  EXPECT_FALSE(area.at({1e300, 1e300}));
}

TEST(GridArea, NeighboursShareASideOrACorner) {
  const auto around = [](const Area& a, int number) {
    const Neighbours n = a.neighbours(number);
    return std::vector<int>(n.begin(), n.end());
  };
  using Cells = std::vector<int>;
  EXPECT_EQ(around(area, 0), (Cells{1, 4, 5}));
  EXPECT_EQ(around(area, 3), (Cells{2, 6, 7}));
  EXPECT_EQ(around(area, 5), (Cells{0, 1, 2, 4, 6, 8, 9, 10}));
  EXPECT_EQ(around(area, 7), (Cells{2, 3, 6, 10, 11}));
  const Area one{Area::Options{}};
  EXPECT_EQ(around(one, 0), (Cells{}));
}

TEST(GridArea, RefusesWhatIsNoArea) {
  EXPECT_THROW(Area({.columns = 0, .rows = 1}), BrokenInvariant);
  EXPECT_THROW(Area({.columns = 1, .rows = -1}), BrokenInvariant);
  EXPECT_THROW(Area({.columns = Area::side_max + 1, .rows = 1}), BrokenInvariant);
  EXPECT_THROW(Area({.cell_m = 0.0}), BrokenInvariant);
  EXPECT_THROW(Area({.cell_m = NAN}), BrokenInvariant);
  EXPECT_THROW(Area({.cell_m = 1.0, .x_m = HUGE_VAL}), BrokenInvariant);
  EXPECT_THROW(area.number({4, 0}), BrokenInvariant);
  EXPECT_THROW(area.number({0, -1}), BrokenInvariant);
  EXPECT_THROW(area.cell(12), BrokenInvariant);
  EXPECT_THROW(area.centre(-1), BrokenInvariant);
  EXPECT_THROW(area.neighbours(12), BrokenInvariant);
}

}  // namespace
}  // namespace hearsay::grid
