// Sensors over uneven ground, beside rays through every pixel and what looks claim.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "agents/sensors/grid_sensor.hpp"
#include "sim/kernel/error.hpp"
#include "sim/kernel/random.hpp"
#include "tools/memory/memory.hpp"

namespace hearsay {
namespace {

using gaussian::Vector3;
using grid::Area;
using grid::CellLook;
using grid::Relief;

const double pi = std::acos(-1.0);
const Area plot({.columns = 60, .rows = 60, .cell_m = 1.0, .x_m = -30.0, .y_m = -30.0});

template <typename F>
std::shared_ptr<const Relief> relief_of(const Area& area, const F& height_m) {
  std::vector<double> heights_m;
  for (int cell = 0; cell < area.cells(); ++cell) {
    const grid::Point at = area.centre(cell);
    heights_m.push_back(height_m(at.x_m, at.y_m));
  }
  return std::make_shared<const Relief>(area, heights_m);
}
/// 9 m over the origin.
const auto hill =
    relief_of(plot, [](double x, double y) { return 9.0 * std::exp(-(x * x + y * y) / 200.0); });

GridSensor::Options with_camera(std::shared_ptr<const Relief> relief) {
  return {.detector = {0.9, 0.05},
          .range_max_m = 1e5,
          .kind = GridSensor::Camera{.lens = {90.0, 90.0, 39.5, 29.5}, .width = 80, .height = 60},
          .relief = std::move(relief)};
}
GridSensor::Options with_presence(std::shared_ptr<const Relief> relief) {
  return {.detector = {0.9, 0.05},
          .range_max_m = 60.0,
          .kind = GridSensor::Presence{0.5},
          .relief = std::move(relief)};
}
template <typename F>
std::vector<unsigned char> truth_where(const F& f) {
  std::vector<unsigned char> truth(static_cast<std::size_t>(plot.cells()));
  for (int cell = 0; cell < plot.cells(); ++cell) {
    const grid::Point at = plot.centre(cell);
    truth[static_cast<std::size_t>(cell)] = f(at.x_m, at.y_m) ? 1 : 0;
  }
  return truth;
}
std::vector<CellLook> copy_of(std::span<const CellLook> looks) {
  return {looks.begin(), looks.end()};
}
bool same(const std::vector<CellLook>& a, const std::vector<CellLook>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& p, const auto& q) {
    return p.cell == q.cell && p.ratio == q.ratio && p.m == q.m && p.n == q.n;
  });
}

/// The cell that a ray comes under first, by looking at each; −1 if it comes under none.
int first_under(const Relief& relief, const Vector3& from, const Vector3& by) {
  const Area& area = relief.area();
  int first = -1;
  double least = std::numeric_limits<double>::infinity();
  for (int cell = 0; cell < area.cells(); ++cell) {
    const grid::Point at = area.centre(cell);
    const double half = 0.5 * area.cell_m();
    const double xs[2] = {(at.x_m - half - from(0)) / by(0), (at.x_m + half - from(0)) / by(0)};
    const double ys[2] = {(at.y_m - half - from(1)) / by(1), (at.y_m + half - from(1)) / by(1)};
    const double begin = std::max({0.0, std::min(xs[0], xs[1]), std::min(ys[0], ys[1])});
    const double end = std::min(std::max(xs[0], xs[1]), std::max(ys[0], ys[1]));
    if (begin > end) continue;
    const double over = from(2) - relief.height_m(cell);
    double times = begin;
    if (over + begin * by(2) >= 0.0) {
      if (by(2) >= 0.0) continue;
      times = over / -by(2);
      if (times > end) continue;
    }
    if (times < least) {
      least = times;
      first = cell;
    }
  }
  return first;
}

TEST(ReliefImage, APixelShowsTheCellThatItsRayComesUnderFirst) {
  Stream random(1, Purpose("rays"), Entity::agent(0));
  int shown = 0, otherwise_on_a_plane = 0;
  for (std::uint64_t trial = 0; trial < 40; ++trial) {
    const Area area({.columns = 14, .rows = 11, .cell_m = random.uniform(1.0, 6.0)});
    const auto relief = relief_of(area, [&](double, double) { return random.uniform(-2, 6); });
    const grid::GridCamera c{.lens = {40.0, 42.0, 18.3, 12.1, 0.7},
                             .width = 37,
                             .height = 25,
                             .detector = {1.0 - 1e-12, 1e-12},
                             .range_max_m = 1e7,
                             .ground_m = random.uniform(-3.0, 3.0)};
    TruthImage image(c, random.uniform(0.1, pi / 2 - 0.01), area, relief.get());
    const Point place{random.uniform(-10, 60), random.uniform(-10, 50), random.uniform(7, 40)};
    const double heading = random.uniform(-pi, pi);
    std::vector<unsigned char> truth(static_cast<std::size_t>(area.cells()));
    for (unsigned char& cell : truth) cell = random.bernoulli(0.4) ? 1 : 0;
    const Stream draws = Stream::at(1, Purpose("pixels"), Entity::agent(0), trial);
    const grid::SegmentedImage& drawn = image.draw(place, heading, truth, draws);
    const gaussian::CameraPose pose = image.pose(place, heading);
    for (int v = 0; v < c.height; ++v) {
      for (int u = 0; u < c.width; ++u) {
        gaussian::Vector pixel(2);
        pixel << u, v;
        const Vector3 by = gaussian::ray_through(c.lens, pose, pixel).direction;
        const Vector3 from = pose.position_m - Vector3(0, 0, c.ground_m);
        const int cell = first_under(*relief, from, by);
        if (cell < 0 && !(by(2) < -0.05)) continue;  // so far off that it tells nothing
        const bool is_true = cell >= 0 && truth[static_cast<std::size_t>(cell)] != 0;
        ASSERT_EQ(drawn.at(u, v), is_true) << trial << ": " << u << ", " << v;
        shown += is_true ? 1 : 0;
        const Vector3 on_plane = from - from(2) / by(2) * by;
        const auto below = area.at({on_plane(0), on_plane(1)});
        otherwise_on_a_plane += cell >= 0 && (!below || *below != cell) ? 1 : 0;
      }
    }
  }
  EXPECT_GT(shown, 1500);
  EXPECT_GT(otherwise_on_a_plane, 1000);
}

TEST(ReliefImage, MarksFadeWithTheDistanceOfWhatIsSeen) {
  // Straight below the camera there is a tower of 20 m under 30 m: ρ is (10/40)², not (30/40)².
  const Area one({.columns = 1, .rows = 1, .cell_m = 4.0, .x_m = -2.0, .y_m = -2.0});
  const Relief tower(one, {20.0});
  const grid::GridCamera c{.lens = {20.0, 20.0, 0.0, 0.0},
                           .width = 1,
                           .height = 1,
                           .detector = {0.9, 0.05},
                           .range_max_m = 40.0};
  TruthImage image(c, pi / 2, one, &tower);
  const std::vector<unsigned char> nothing(1, 0), there(1, 1);
  int marked_nothing = 0, marked_there = 0;
  const int looks = 20000;
  for (int k = 0; k < looks; ++k) {
    const Stream draws =
        Stream::at(1, Purpose("pixels"), Entity::agent(0), static_cast<std::uint64_t>(k));
    marked_nothing += image.draw({0, 0, 30}, 0, nothing, draws).at(0, 0) ? 1 : 0;
    marked_there += image.draw({0, 0, 30}, 0, there, draws).at(0, 0) ? 1 : 0;
  }
  const double rho = 1.0 / 16.0;
  EXPECT_NEAR(1.0 * marked_nothing / looks, 0.05 * (1 - rho) + 0.5 * rho, 4 * 0.3 / 141.0);
  EXPECT_NEAR(1.0 * marked_there / looks, 0.9 * (1 - rho) + 0.5 * rho, 4 * 0.35 / 141.0);
}

// The western half is true; its edge runs over the top, which to a camera in the east is 2 m off
// where a plane would have it. Cells 2 m or more from it have ellipses on one side only.
TEST(ReliefSensor, SharesOfMarkedPixelsOverAHillAreThoseOfTheDetector) {
  GridSensor sensor(with_camera(hill), plot);
  const auto truth = truth_where([](double x, double) { return x < 0; });
  double marked[2] = {0, 0}, cells[2] = {0, 0};
  double near_edge = 0;
  const Point place{8, 0, 45};
  for (std::uint64_t k = 0; k < 100; ++k) {
    for (const CellLook& look : sensor.look(place, 0, truth, 1, 0, k)) {
      const double x = plot.centre(look.cell).x_m;
      if (std::fabs(x) < 2) continue;
      marked[x < 0 ? 0 : 1] += look.m;
      cells[x < 0 ? 0 : 1] += 1;
      near_edge += std::fabs(x) < 3 ? 1 : 0;
    }
  }
  ASSERT_GT(near_edge, 2000);
  // An ellipse has about 10 pixels of weight, shared with neighbours: 1σ is below 0.002.
  EXPECT_NEAR(marked[0] / cells[0], 0.9, 0.006);
  EXPECT_NEAR(marked[1] / cells[1], 0.05, 0.006);
}

TEST(ReliefSensor, ALevelReliefChangesNoBit) {
  const auto level = relief_of(plot, [](double, double) { return 0.0; });
  const auto truth = truth_where([](double x, double y) { return x * y > 20; });
  for (const auto& make : {with_camera, with_presence}) {
    GridSensor with(make(level), plot), without(make(nullptr), plot), over_hill(make(hill), plot);
    bool differs = false;
    for (std::uint64_t k = 0; k < 20; ++k) {
      const Point place{static_cast<double>(k) - 10, 3, 25};
      const auto a = copy_of(with.look(place, 0.2, truth, 1, 0, k));
      const auto b = copy_of(without.look(place, 0.2, truth, 1, 0, k));
      ASSERT_FALSE(a.empty());
      EXPECT_TRUE(same(a, b));
      differs = differs || !same(a, copy_of(over_hill.look(place, 0.2, truth, 1, 0, k)));
    }
    EXPECT_TRUE(differs);
  }
}

TEST(ReliefSensor, WhatIsBehindAWallIsNeitherInViewNorLookedAt) {
  const auto wall = relief_of(plot, [](double x, double) { return x > 4 && x < 5 ? 15.0 : 0.0; });
  for (const auto& make : {with_camera, with_presence}) {
    GridSensor::Options options = make(wall);
    options.depression_rad = 0.9;
    GridSensor sensor(options, plot);
    options.relief = nullptr;
    GridSensor on_a_plane(options, plot);
    const auto truth = truth_where([](double x, double) { return x > 5; });
    const auto beyond = [](int cell) { return plot.centre(cell).x_m > 5; };
    // Rays from 13 m before its far edge and 5 m over it come down 39 m behind it: off the plot.
    const Point place{-8, 0, 20};
    int before = 0, behind = 0;
    for (const grid::CellInView& c : sensor.view(place, 0.0)) {
      EXPECT_FALSE(beyond(c.cell));
      ++before;
    }
    for (const grid::CellInView& c : on_a_plane.view(place, 0.0)) behind += beyond(c.cell) ? 1 : 0;
    EXPECT_GT(before, 10);
    EXPECT_GT(behind, 10);
    const auto looks = sensor.look(place, 0.0, truth, 1, 0, 0);
    EXPECT_FALSE(looks.empty());
    for (const CellLook& look : looks) EXPECT_FALSE(beyond(look.cell));
  }
}

TEST(ReliefSensor, AllocatesNothingOnceItIsWarm) {
  const auto truth = truth_where([](double x, double y) { return x * y > 50; });
  for (const auto& options : {with_camera(hill), with_presence(hill)}) {
    GridSensor sensor(options, plot);
    const auto rounds = [&] {
      for (std::uint64_t k = 0; k < 10; ++k) {
        sensor.look({0, 0, k % 2 == 0 ? 30.0 : 20.0}, 0.3, truth, 1, 0, k);
        sensor.view({1, 2, 30}, 0.3);
      }
    };
    rounds();
    const std::size_t before = memory::allocations();
    rounds();
    EXPECT_EQ(memory::allocations() - before, 0u);
  }
}

TEST(ReliefSensor, RefusesTheReliefOfAnotherArea) {
  const Area other({.columns = 3, .rows = 3});
  EXPECT_THROW(GridSensor(with_camera(hill), other), BrokenInvariant);
  EXPECT_THROW(GridSensor(with_presence(hill), other), BrokenInvariant);
}

}  // namespace
}  // namespace hearsay
