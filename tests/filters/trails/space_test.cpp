#include "filters/trails/space.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"
#include "tests/filters/trails/samples.hpp"

namespace hearsay::trails {
namespace {

std::vector<std::uint32_t> found(const MetricIndex& index, const MetricReach& reach,
                                 EventId event = 7) {
  std::vector<std::uint32_t> slots;
  index.visit(event, reach, [&](std::uint32_t slot) { slots.push_back(slot); });
  std::sort(slots.begin(), slots.end());
  return slots;
}

/// By angles, where the index goes by products.
bool near(const MetricReach& reach, const Point& p) {
  const double x = double{p.x_m} - reach.at.x_m, y = double{p.y_m} - reach.at.y_m;
  if (!(x * x + y * y < reach.radius_m * reach.radius_m)) return false;
  if (!reach.field || (x == 0.0 && y == 0.0)) return true;
  const double off = math::wrap_angle(math::atan2(y, x) - reach.field->heading_rad);
  return std::fabs(off) <= 0.5 * reach.field->width_rad;
}

MetricReach random_reach(Stream& random, double half_side_m) {
  MetricReach reach{random_point(random, half_side_m), random.uniform(0.0, 5.0), std::nullopt};
  if (random.bernoulli(0.1)) reach.radius_m = random.uniform(0.0, 300.0);
  if (random.bernoulli(0.5)) {
    reach.field = Field{random.uniform(-10.0, 10.0), random.uniform(0.01, 2.0 * math::pi)};
  }
  return reach;
}

TEST(MetricIndex, FindsWhatAComparisonWithEveryPointFinds) {
  Stream random = stream("index");
  const auto event_of = [](std::uint32_t slot) { return slot % 3 == 0 ? 5U : 1000U; };
  for (const double half_side_m : {4.0, 60.0, 900.0}) {
    MetricIndex index({.cell_m = 1.3});
    std::vector<std::optional<Point>> points(700);
    std::size_t seen = 0;
    for (int step = 0; step < 4000; ++step) {
      const auto slot = static_cast<std::uint32_t>(random.below(points.size()));
      if (points[slot]) {
        index.remove(slot);
        points[slot].reset();
      } else {
        points[slot] = random_point(random, half_side_m);
        index.add(slot, event_of(slot), *points[slot]);
      }
      if (step % 2 != 0) continue;
      const MetricReach reach = random_reach(random, half_side_m);
      const EventId event = step % 4 == 0 ? 5 : 1000;
      std::vector<std::uint32_t> expected;
      for (std::uint32_t i = 0; i < points.size(); ++i) {
        if (points[i] && event_of(i) == event && near(reach, *points[i])) expected.push_back(i);
      }
      ASSERT_EQ(found(index, reach, event), expected) << half_side_m << ", step " << step;
      seen += expected.size();
    }
    EXPECT_GT(seen, 500u);
  }
}

TEST(MetricIndex, CellsOfABlockThatAreFiledInOneListAreToldApart) {
  // Blocks of nearly as many cells as there are lists, 512: some cells have a list in common.
  MetricIndex index({.cell_m = 1.0});
  Stream random = stream("shared lists");
  std::vector<Point> points;
  for (std::uint32_t slot = 0; slot < 500; ++slot) {
    points.push_back(random_point(random, 20.0));
    index.add(slot, 7, points.back());
  }
  for (int i = 0; i < 300; ++i) {
    const MetricReach reach{random_point(random, 10.0), random.uniform(8.0, 10.7), std::nullopt};
    std::vector<std::uint32_t> expected;
    for (std::uint32_t slot = 0; slot < points.size(); ++slot) {
      if (near(reach, points[slot])) expected.push_back(slot);
    }
    ASSERT_EQ(found(index, reach), expected);
  }
}

TEST(MetricIndex, APointAtTheRadiusIsNotNear) {
  MetricIndex index({});
  index.add(0, 7, {3.0F, 4.0F});
  EXPECT_TRUE(found(index, {{0.0F, 0.0F}, 5.0}).empty());
  EXPECT_EQ(found(index, {{0.0F, 0.0F}, 5.001}).size(), 1u);
  EXPECT_TRUE(found(index, {{3.0F, 4.0F}, 0.0}).empty());
}

TEST(MetricIndex, AFieldOfViewLooksWhereTheRobotHeads) {
  MetricIndex index({});
  index.add(0, 7, {1.0F, 0.0F});
  index.add(1, 7, {0.0F, 1.0F});
  index.add(2, 7, {-1.0F, 0.0F});
  index.add(3, 7, {0.0F, 0.0F});  // where the robot is
  const auto in_field = [&](double heading_rad, double width_rad) {
    return found(index, {{0.0F, 0.0F}, 2.0, Field{heading_rad, width_rad}});
  };
  using Slots = std::vector<std::uint32_t>;
  EXPECT_EQ(in_field(0.0, 1.0), (Slots{0, 3}));
  EXPECT_EQ(in_field(math::pi / 2, 1.0), (Slots{1, 3}));
  EXPECT_EQ(in_field(math::pi, 1.0), (Slots{2, 3}));
  EXPECT_EQ(in_field(-math::pi, 1.0), (Slots{2, 3}));
  EXPECT_EQ(in_field(math::pi / 4, 1.6), (Slots{0, 1, 3}));
  EXPECT_EQ(in_field(math::pi / 2, 3.2), (Slots{0, 1, 2, 3}));
  EXPECT_EQ(in_field(1.0, 2.0 * math::pi), (Slots{0, 1, 2, 3}));
}

TEST(MetricIndex, LooksAtPointsInReachAndNotAtAllThatAre) {
  // Trails along both axes and both diagonals, 4 km each, a point every half metre.
  MetricIndex index({.cell_m = 1.0});
  std::uint32_t slot = 0;
  for (int i = -4000; i < 4000; ++i) {
    const float s = 0.5F * static_cast<float>(i);
    index.add(slot++, 7, {s, 0.25F});
    index.add(slot++, 7, {0.25F, s});
    index.add(slot++, 7, {s, s});
    index.add(slot++, 7, {s, -s});
  }
  Stream random = stream("looks");
  std::size_t most = 0;
  for (int i = 0; i < 500; ++i) {
    const float s = static_cast<float>(random.uniform(-1900.0, 1900.0));
    for (const Point at : {Point{s, 0.3F}, Point{0.3F, s}, Point{s, s}, Point{s, -s}}) {
      most = std::max(most, index.looks(7, {at, 1.0}));
    }
  }
  EXPECT_GE(most, 6u);
  EXPECT_LE(most, 60u);  // of 32000
  EXPECT_EQ(index.looks(7, {{0.0F, 0.0F}, 1e6}), 32000u);
  EXPECT_EQ(index.looks(7, {{0.0F, 0.0F}, std::numeric_limits<double>::infinity()}), 32000u);
}

TEST(MetricIndex, ALookForOneEventLooksAtNoOthersThatAreThere) {
  MetricIndex index({.cell_m = 1.0});
  Stream random = stream("events");
  for (std::uint32_t slot = 0; slot < 3000; ++slot) {
    index.add(slot, slot % 100 == 0 ? 1 : 2, random_point(random, 2.0));
  }
  const MetricReach reach{{0.0F, 0.0F}, 1.0};
  EXPECT_LE(index.looks(1, reach), 30u);
  EXPECT_GE(index.looks(2, reach), 1000u);
  EXPECT_EQ(index.looks(3, reach), 0u);
}

TEST(MetricIndex, WhatItCannotHoldIsRefused) {
  const float inf = std::numeric_limits<float>::infinity();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const Point p :
       {Point{inf, 0.0F}, Point{0.0F, nan}, Point{2e6F, 0.0F}, Point{0.0F, -2e6F}}) {
    EXPECT_FALSE(MetricSpace::sound(p));
    EXPECT_THROW(MetricIndex({}).add(0, 7, p), BrokenInvariant);
    EXPECT_THROW(MetricIndex({}).looks(7, {p, 1.0}), BrokenInvariant);
  }
  EXPECT_THROW(MetricIndex({.cell_m = 0.001}), BrokenInvariant);
  EXPECT_THROW(MetricIndex({.cell_m = 1e7}), BrokenInvariant);
  MetricIndex index({.cell_m = 0.01});
  index.add(0, 7, {1e6F, -1e6F});
  EXPECT_EQ(found(index, {{1e6F, -1e6F}, 0.1}).size(), 1u);
  EXPECT_THROW(index.add(0, 7, {}), BrokenInvariant);
  EXPECT_THROW(index.remove(1), BrokenInvariant);
  const Point at{};
  EXPECT_THROW(index.looks(7, {at, -1.0}), BrokenInvariant);
  EXPECT_THROW(index.looks(7, {at, double{nan}}), BrokenInvariant);
  EXPECT_THROW(index.looks(7, {at, 1.0, Field{0.0, 0.0}}), BrokenInvariant);
  EXPECT_THROW(index.looks(7, {at, 1.0, Field{0.0, 6.3}}), BrokenInvariant);
  EXPECT_THROW(index.looks(7, {at, 1.0, Field{double{inf}, 1.0}}), BrokenInvariant);
}

}  // namespace
}  // namespace hearsay::trails
