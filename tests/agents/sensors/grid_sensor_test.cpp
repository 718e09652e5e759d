// What sensors of grids see, beside what looks claim that they would.
#include "agents/sensors/grid_sensor.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "sim/kernel/error.hpp"
#include "tools/memory/memory.hpp"

namespace hearsay {
namespace {

using grid::Area;
using grid::CellInView;
using grid::CellLook;

const double pi = std::acos(-1.0);
constexpr gaussian::Intrinsics lens{90.0, 90.0, 39.5, 29.5};

GridSensor::Options with_camera(double sigma_position_m = 0.0, double sigma_attitude_rad = 0.0) {
  return {.detector = {0.9, 0.05},
          .range_max_m = 1e5,
          .kind = GridSensor::Camera{.lens = lens,
                                     .width = 80,
                                     .height = 60,
                                     .sigma_position_m = sigma_position_m,
                                     .sigma_attitude_rad = sigma_attitude_rad}};
}
GridSensor::Options with_presence(double range_max_m, double angle_max_rad = 0.5) {
  return {.detector = {0.9, 0.05},
          .range_max_m = range_max_m,
          .kind = GridSensor::Presence{angle_max_rad}};
}

const Area plot({.columns = 60, .rows = 60, .cell_m = 1.0, .x_m = -30.0, .y_m = -30.0});

/// 1 for the cells whose centres f(x, y).
template <typename F>
std::vector<unsigned char> truth_where(const Area& area, const F& f) {
  std::vector<unsigned char> truth(static_cast<std::size_t>(area.cells()));
  for (int cell = 0; cell < area.cells(); ++cell) {
    const grid::Point at = area.centre(cell);
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

/// Mean of independent values, and how far it may be off: four of its standard deviations.
class Mean {
 public:
  void add(double x) {
    ++n_;
    sum_ += x;
    squares_ += x * x;
  }
  double value() const { return sum_ / n_; }
  double bound() const { return 4 * std::sqrt((squares_ / n_ - value() * value()) / n_) + 1e-12; }

 private:
  double n_ = 0, sum_ = 0, squares_ = 0;
};

// The western half is true. Cells four or more from its edge have ellipses on one side only.
TEST(GridSensor, SharesOfMarkedPixelsAreThoseOfTheDetector) {
  GridSensor sensor(with_camera(), plot);
  const auto truth = truth_where(plot, [](double x, double) { return x < 0; });
  Mean there, elsewhere;
  for (std::uint64_t k = 0; k < 150; ++k) {
    std::array<double, 2> sum{}, cells{};
    for (const CellLook& look : sensor.look({0, 0, 30}, 0, truth, 1, 0, k)) {
      const double x = plot.centre(look.cell).x_m;
      if (std::fabs(x) < 4) continue;
      sum[x < 0 ? 0 : 1] += look.m;
      cells[x < 0 ? 0 : 1] += 1;
      EXPECT_NEAR(look.m + look.n, 1.0, 1e-12);
    }
    ASSERT_GT(cells[0], 100);
    ASSERT_GT(cells[1], 100);
    there.add(sum[0] / cells[0]);
    elsewhere.add(sum[1] / cells[1]);
  }
  EXPECT_NEAR(there.value(), 0.9, there.bound());
  EXPECT_NEAR(elsewhere.value(), 0.05, elsewhere.bound());
  EXPECT_LT(there.bound(), 0.003);
}

TEST(GridSensor, LooksSpeakForTheTruthOnAverage) {
  GridSensor::Options options = with_camera(0.3, 0.01);
  options.depression_rad = 1.1;
  options.range_max_m = 80;
  GridSensor sensor(options, plot);
  const auto truth = truth_where(plot, [](double x, double y) { return std::hypot(x, y) < 4; });
  Mean inside, outside;
  for (std::uint64_t k = 0; k < 100; ++k) {
    for (const CellLook& look : sensor.look({-12, 0, 25}, 0, truth, 1, 0, k)) {
      const grid::Point at = plot.centre(look.cell);
      const double from_middle = std::hypot(at.x_m, at.y_m);
      if (from_middle < 3) inside.add(look.ratio);
      if (from_middle > 6) outside.add(look.ratio);
    }
  }
  EXPECT_GT(inside.value(), 0.5);
  EXPECT_LT(outside.value(), -0.2);
}

// Where the pose is believed to be off by e, so is what it shows: its middle by σ on each axis. (An
// image looks at it from above, where height and turns about the view move nothing.)
TEST(GridSensor, WhatItBelievesOfItsPoseIsOffByItsNoise) {
  struct Case {
    double sigma_position_m, sigma_attitude_rad, expected_m;
  };
  const Area coarse({.columns = 20, .rows = 20, .cell_m = 2.0, .x_m = -20.0, .y_m = -20.0});
  const auto truth = truth_where(coarse, [](double x, double y) { return std::hypot(x, y) < 5; });
  for (const Case& c : {Case{0.8, 0.0, 0.8}, Case{0.0, 0.02, 0.6}, Case{0.3, 0.01, 0.42426}}) {
    GridSensor::Options options = with_camera(c.sigma_position_m, c.sigma_attitude_rad);
    options.detector = {1 - 1e-9, 1e-9};
    GridSensor sensor(options, coarse);
    Mean x, y, xx, yy;
    for (std::uint64_t k = 0; k < 400; ++k) {
      double weight = 0, east = 0, north = 0;
      for (const CellLook& look : sensor.look({0, 0, 30}, 0.5, truth, 1, 0, k)) {
        weight += look.m;
        east += look.m * coarse.centre(look.cell).x_m;
        north += look.m * coarse.centre(look.cell).y_m;
      }
      x.add(east / weight);
      y.add(north / weight);
      xx.add(east / weight * east / weight);
      yy.add(north / weight * north / weight);
    }
    EXPECT_NEAR(x.value(), 0.0, x.bound());
    EXPECT_NEAR(y.value(), 0.0, y.bound());
    const double variance = c.expected_m * c.expected_m;
    EXPECT_NEAR(xx.value(), variance, xx.bound());
    EXPECT_NEAR(yy.value(), variance, yy.bound());
    EXPECT_LT(xx.bound(), 0.4 * variance);
  }
}

TEST(GridSensor, SeesTheSameLuckAtTheSameCount) {
  const auto truth = truth_where(plot, [](double x, double y) { return x * y > 50; });
  for (const auto& options : {with_camera(0.3, 0.01), with_presence(60.0)}) {
    GridSensor one(options, plot), other(options, plot);
    other.look({3, 3, 20}, 1.0, truth, 1, 0, 77);
    int different = 0;
    for (std::uint64_t k = 0; k < 20; ++k) {
      const auto first = copy_of(one.look({2, 1, 30}, 0.3, truth, 1, 4, k));
      ASSERT_FALSE(first.empty());
      EXPECT_TRUE(same(first, copy_of(other.look({2, 1, 30}, 0.3, truth, 1, 4, k))));
      different += same(first, copy_of(one.look({2, 1, 30}, 0.3, truth, 1, 4, k + 1))) ? 0 : 1;
      different += same(first, copy_of(one.look({2, 1, 30}, 0.3, truth, 1, 5, k))) ? 0 : 1;
      different += same(first, copy_of(one.look({2, 1, 30}, 0.3, truth, 2, 4, k))) ? 0 : 1;
    }
    EXPECT_GT(different, 5);
  }
}

TEST(GridSensor, ViewIsWhatALookFromAKnownPoseSees) {
  Stream random(1, Purpose("view"), Entity::agent(0));
  std::size_t cells = 0;
  for (int trial = 0; trial < 100; ++trial) {
    GridSensor::Options options = with_camera(0.5, 0.02);
    options.depression_rad = random.uniform(0.2, pi / 2);
    options.range_max_m = random.uniform(20, 90);
    GridSensor sensor(options, plot);
    const grid::GridCamera camera{.lens = lens,
                                  .width = 80,
                                  .height = 60,
                                  .detector = options.detector,
                                  .range_max_m = options.range_max_m};
    grid::CameraLook look(camera, plot);
    const Point place{random.uniform(-40, 40), random.uniform(-40, 40), random.uniform(-5, 50)};
    const double heading = random.uniform(-pi, pi);
    ASSERT_TRUE(look.look(
        gaussian::looking({place[0], place[1], place[2]}, heading, options.depression_rad),
        gaussian::Matrix::Zero(6, 6)));
    const auto view = sensor.view(place, heading);
    ASSERT_EQ(view.size(), look.in_view().size());
    for (std::size_t i = 0; i < view.size(); ++i) {
      EXPECT_EQ(view[i].cell, look.in_view()[i].cell);
      EXPECT_EQ(view[i].detector, look.in_view()[i].detector);
    }
    cells += view.size();
  }
  EXPECT_GT(cells, 10000u);
}

TEST(GridSensor, ATiltedCameraSeesWhatIsAhead) {
  GridSensor::Options options = with_camera();
  options.depression_rad = 0.8;
  GridSensor sensor(options, plot);
  for (const double heading : {0.0, 1.0, 2.5, -2.0}) {
    const double ahead_m = 10 / std::tan(0.8);  // where the middle of the image is
    double x = 0, y = 0, nearest = 1e9;
    for (const CellInView& c : sensor.view({1, 2, 10}, heading)) {
      const double dx = plot.centre(c.cell).x_m - 1, dy = plot.centre(c.cell).y_m - 2;
      EXPECT_GT(dx * std::cos(heading) + dy * std::sin(heading), 0.0);
      const double to_middle =
          std::hypot(dx - ahead_m * std::cos(heading), dy - ahead_m * std::sin(heading));
      nearest = std::min(nearest, to_middle);
      x += dx;
      y += dy;
    }
    EXPECT_LT(nearest, 0.75);
    EXPECT_NEAR(std::atan2(y, x), heading, 0.05);
  }
}

/// How often of `looks` a presence sensor fires from there.
double share_fired(GridSensor& sensor, const Point& place, std::span<const unsigned char> truth,
                   int looks) {
  int fired = 0;
  for (int k = 0; k < looks; ++k) {
    const auto seen = sensor.look(place, 0, truth, 1, 0, static_cast<std::uint64_t>(k));
    fired += !seen.empty() && seen[0].m > 0 ? 1 : 0;
  }
  return static_cast<double>(fired) / looks;
}

// 10 m up with a range of 20 m, the fade by distance is ¼ straight below.
TEST(GridSensor, APresenceSensorIsDecidedByTheTrueCellItSeesBest) {
  const Area line({.columns = 7, .rows = 1, .cell_m = 2.0, .x_m = -7.0, .y_m = -1.0});
  GridSensor sensor(with_presence(20.0, 0.7), line);
  // Columns 0 … 6 are at x = −6 … 6 m; 3 is below.
  const auto fade = [](double x) {
    const double distance = std::hypot(x, 10) / 20, angle = std::atan2(x, 10) / 0.7;
    return 1 - (1 - distance * distance) * (1 - angle * angle);
  };
  const auto expected = [](double least, double of_true) {
    return 0.5 * least + 0.05 * (of_true - least) + 0.9 * (1 - of_true);
  };
  EXPECT_DOUBLE_EQ(fade(0), 0.25);
  ASSERT_EQ(sensor.view({0, 0, 10}, 0).size(), 7u);
  struct Case {
    std::vector<unsigned char> truth;
    double expected;
  };
  const int looks = 10000;
  for (const Case& c : {Case{{0, 0, 0, 0, 0, 0, 0}, expected(fade(0), 1)},
                        Case{{0, 0, 0, 1, 0, 0, 0}, expected(fade(0), fade(0))},
                        Case{{0, 0, 0, 0, 1, 0, 1}, expected(fade(0), fade(2))},
                        Case{{1, 0, 0, 0, 0, 0, 0}, expected(fade(0), fade(-6))},
                        Case{{1, 1, 1, 1, 1, 1, 1}, expected(fade(0), fade(0))}}) {
    EXPECT_NEAR(share_fired(sensor, {0, 0, 10}, c.truth, looks), c.expected,
                4 * std::sqrt(c.expected * (1 - c.expected) / looks));
  }
}

TEST(GridSensor, APresenceSensorFiresWithPDForACellStraightBelowAndPFForNone) {
  const Area area({.columns = 9, .rows = 9, .x_m = -4.5, .y_m = -4.5});
  GridSensor sensor(with_presence(1e6), area);
  const auto truth = truth_where(area, [](double x, double y) { return x == 0 && y == 0; });
  EXPECT_NEAR(share_fired(sensor, {0, 0, 5}, truth, 20000), 0.9, 4 * std::sqrt(0.09 / 20000));
  const std::vector<unsigned char> nothing(81, 0);
  EXPECT_NEAR(share_fired(sensor, {0, 0, 5}, nothing, 20000), 0.05, 4 * std::sqrt(0.0475 / 20000));
}

// One cell that is in view, from random places: posteriors by their value, ten bins, against how
// often there was something.
TEST(GridSensor, APresenceSensorsBeliefsAboutOneCellAreCalibrated) {
  const Area cell(Area::Options{.cell_m = 2.0, .x_m = -1.0, .y_m = -1.0});
  GridSensor sensor(with_presence(20.0, 0.8), cell);
  Stream random(1, Purpose("worlds"), Entity::agent(0));
  std::array<double, 10> worlds{}, claimed{}, variance{}, were{};
  std::uint64_t count = 0;
  for (int world = 0; world < 20000; ++world) {
    grid::BernoulliGrid belief(cell, {.prior = 0.3});
    const std::array<unsigned char, 1> truth{static_cast<unsigned char>(random.bernoulli(0.3))};
    for (int k = 0; k < 4; ++k) {
      const Point place{random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(5, 15)};
      const auto looks = sensor.look(place, 0, truth, 1, 0, count++);
      ASSERT_EQ(looks.size(), 1u);
      add(looks, belief);
    }
    const double p = belief.probability(0);
    const auto bin = static_cast<std::size_t>(10 * p);
    ++worlds[bin];
    claimed[bin] += p;
    variance[bin] += p * (1 - p);
    were[bin] += truth[0];
  }
  for (std::size_t bin = 0; bin < 10; ++bin) {
    EXPECT_NEAR(were[bin], claimed[bin], 4 * std::sqrt(variance[bin])) << bin;
    EXPECT_GT(worlds[bin], 100.0);
  }
}

TEST(GridSensor, SeesNothingWhereThereIsNothingToSee) {
  const auto truth = truth_where(plot, [](double, double) { return true; });
  for (auto options : {with_camera(), with_presence(20.0)}) {
    options.range_max_m = 20.0;
    GridSensor sensor(options, plot);
    EXPECT_FALSE(sensor.look({0, 0, 10}, 0, truth, 1, 0, 0).empty());
    for (const Point& place : {Point{500, 0, 10}, Point{0, 0, 21}, Point{0, 0, -1}}) {
      EXPECT_TRUE(sensor.look(place, 0, truth, 1, 0, 0).empty());
      EXPECT_TRUE(sensor.view(place, 0).empty());
    }
  }
}

TEST(GridSensor, AllocatesNothingOnceItIsWarm) {
  const auto truth = truth_where(plot, [](double x, double y) { return x * y > 50; });
  for (const auto& options : {with_camera(0.3, 0.01), with_presence(60.0)}) {
    GridSensor sensor(options, plot);
    const auto rounds = [&] {
      for (std::uint64_t k = 0; k < 20; ++k) {
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

TEST(GridSensor, RefusesWhatIsNoSensor) {
  const auto refused = [](auto change) {
    auto options = with_camera();
    change(options, std::get<GridSensor::Camera>(options.kind));
    EXPECT_THROW(GridSensor(options, plot), BrokenInvariant);
  };
  refused([](auto& o, auto&) { o.detector = {0.1, 0.1}; });
  refused([](auto& o, auto&) { o.detector = {1.0, 0.1}; });
  refused([](auto& o, auto&) { o.range_max_m = 0.0; });
  refused([](auto& o, auto&) { o.depression_rad = -0.1; });
  refused([](auto&, auto& c) { c.sigma_position_m = -1.0; });
  refused([](auto&, auto& c) { c.sigma_attitude_rad = NAN; });
  refused([](auto&, auto& c) { c.sigma_pixel = 0.4; });
  refused([](auto&, auto& c) { c.width = c.height = 600; });
  EXPECT_THROW(GridSensor(with_presence(0.0), plot), BrokenInvariant);
  EXPECT_THROW(GridSensor(with_presence(10.0, 4.0), plot), BrokenInvariant);
  GridSensor sensor(with_presence(10.0), plot);
  EXPECT_THROW(sensor.look({0, 0, 5}, 0, std::vector<unsigned char>(5), 1, 0, 0), BrokenInvariant);
}

}  // namespace
}  // namespace hearsay
