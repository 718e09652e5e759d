// Heights of cells: rays and looks beside all cells one by one.
#include "filters/grid/relief.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "filters/gaussian/geolocation.hpp"
#include "filters/grid/camera_look.hpp"
#include "sim/kernel/error.hpp"
#include "tests/filters/grid/samples.hpp"

namespace hearsay::grid {
namespace {

using gaussian::CameraPose;
using gaussian::look_covariance;
using gaussian::looking;
using gaussian::Matrix;
using gaussian::Vector3;

const double pi = std::acos(-1.0);
const Area area({.columns = 30, .rows = 25, .cell_m = 2.0, .x_m = -30.0, .y_m = -25.0});

template <typename F>
Relief relief_of(const Area& cells, const F& height_m) {
  std::vector<double> heights_m;
  for (int cell = 0; cell < cells.cells(); ++cell) {
    const Point at = cells.centre(cell);
    heights_m.push_back(height_m(at.x_m, at.y_m));
  }
  return Relief(cells, heights_m);
}
Relief random_relief(Stream& random, double low_m, double high_m) {
  return relief_of(area, [&](double, double) { return random.uniform(low_m, high_m); });
}

GridCamera infrared() {
  return {.lens = gaussian::infrared_camera,
          .width = 240,
          .height = 320,
          .detector = {0.962, 0.045},
          .range_max_m = 100.0};
}
CameraPose random_pose(Stream& random, double low_m = -5.0) {
  return looking({random.uniform(-40, 40), random.uniform(-35, 35), random.uniform(low_m, 40)},
                 random.uniform(-pi, pi), random.uniform(-0.5, pi / 2), random.uniform(-1, 1));
}
Matrix pose_covariance(double sigma_position_m, double sigma_attitude_rad) {
  return look_covariance({sigma_position_m, sigma_attitude_rad, 0.0}).topLeftCorner(6, 6);
}

/// Where a ray comes under a cell first, each cell by itself; infinite if nowhere.
double times_under(const Relief& relief, const Vector3& from, const Vector3& by, int cell) {
  const double never = std::numeric_limits<double>::infinity();
  const Point at = area.centre(cell);
  double begin = 0.0, end = never;
  const double half = 0.5 * area.cell_m();
  const double middle[2] = {at.x_m, at.y_m};
  for (int k = 0; k < 2; ++k) {
    const double a = (middle[k] - half - from(k)) / by(k), b = (middle[k] + half - from(k)) / by(k);
    begin = std::max(begin, std::min(a, b));
    end = std::min(end, std::max(a, b));
  }
  if (begin > end) return never;
  const double over = from(2) - relief.height_m(cell);
  if (over + begin * by(2) < 0.0) return begin;
  if (by(2) >= 0.0) return never;
  const double down = over / -by(2);
  return down <= end ? down : never;
}

struct Nearest {
  int cell = -1;
  double times = std::numeric_limits<double>::infinity();
};
Nearest nearest(const Relief& relief, const Vector3& from, const Vector3& by) {
  Nearest first;
  for (int cell = 0; cell < area.cells(); ++cell) {
    const double times = times_under(relief, from, by, cell);
    if (times < first.times) first = {cell, times};
  }
  return first;
}
bool in_sight(const Relief& relief, const Vector3& from, int cell) {
  const Point at = area.centre(cell);
  const Vector3 to = Vector3(at.x_m, at.y_m, relief.height_m(cell)) - from;
  return to(2) < 0.0 && nearest(relief, from, to).cell == cell;
}

TEST(Relief, RaysMeetTheCellTheyComeUnderFirst) {
  Stream random = stream("rays over a relief");
  int met_at_all = 0, by_walls = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const Relief relief = random_relief(random, -2.0, trial % 2 == 0 ? 0.5 : 8.0);
    const Vector3 from(random.uniform(-50, 50), random.uniform(-45, 45), random.uniform(-3, 20));
    const Vector3 by(random.normal(), random.normal(), random.uniform(-3.0, 0.2));
    const Nearest expected = nearest(relief, from, by);
    const auto met = relief.first_met(from, by);
    ASSERT_EQ(met.has_value(), expected.cell >= 0) << trial;
    if (!met) continue;
    ++met_at_all;
    ASSERT_EQ(met->cell, expected.cell) << trial;
    EXPECT_NEAR(met->times, expected.times, 1e-9 * (1.0 + expected.times));
    by_walls += from(2) + met->times * by(2) < relief.height_m(met->cell) - 1e-6 ? 1 : 0;
  }
  EXPECT_GT(met_at_all, 1000);
  EXPECT_GT(by_walls, 300);
  EXPECT_LT(by_walls, met_at_all - 300);
}

TEST(Relief, RaysAlongTheAxesAndStraightDown) {
  const Relief relief = relief_of(area, [](double x, double) { return x > 10.0 ? 3.0 : 0.0; });
  const auto down = relief.first_met({1.0, 1.0, 7.0}, {0.0, 0.0, -2.0});
  ASSERT_TRUE(down);
  EXPECT_EQ(down->cell, area.at({1.0, 1.0}));
  EXPECT_EQ(down->times, 3.5);
  const auto level = relief.first_met({-50.0, 1.0, 2.0}, {1.0, 0.0, 0.0});  // against the wall
  ASSERT_TRUE(level);
  EXPECT_EQ(level->cell, area.at({10.5, 1.0}));
  EXPECT_EQ(level->times, 60.0);
  EXPECT_FALSE(relief.first_met({-50.0, 1.0, 4.0}, {1.0, 0.0, 0.0}));
  EXPECT_FALSE(relief.first_met({-50.0, 40.0, 2.0}, {1.0, 0.0, -0.01}));
  EXPECT_FALSE(relief.first_met({1.0, 1.0, 7.0}, {0.0, 0.0, 1.0}));
  EXPECT_FALSE(relief.first_met({50.0, 1.0, 7.0}, {0.0, 0.0, -1.0}));
  // A camera that is under the ground meets it where it is.
  const auto under = relief.first_met({20.0, 1.0, 2.0}, {-1.0, 0.3, -0.1});
  ASSERT_TRUE(under);
  EXPECT_EQ(under->cell, area.at({20.0, 1.0}));
  EXPECT_EQ(under->times, 0.0);
}

TEST(Relief, ALevelOneChangesNoBit) {
  Stream random = stream("level relief");
  const Relief level(area, std::vector<double>(static_cast<std::size_t>(area.cells()), 0.0));
  EXPECT_TRUE(level.level());
  SegmentedImage image(240, 320);
  for (int v = 0; v < 320; ++v) {
    for (int u = v % 3; u < 240; u += 3) image.mark(u, v);
  }
  std::size_t judged = 0;
  for (int trial = 0; trial < 60; ++trial) {
    GridCamera camera = infrared();
    camera.ground_m = random.uniform(-3, 3);
    const CameraPose pose = random_pose(random);
    CameraLook without(camera, area), with(camera, area, &level);
    ASSERT_TRUE(without.look(pose, pose_covariance(0.5, 0.02)));
    ASSERT_TRUE(with.look(pose, pose_covariance(0.5, 0.02)));
    std::vector<CellLook> a, b;
    without.judge(image, a);
    with.judge(image, b);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      EXPECT_TRUE(a[i].cell == b[i].cell && a[i].ratio == b[i].ratio && a[i].m == b[i].m);
    }
    judged += a.size();
    const PresenceSensor sensor{{0.9, 0.1}, 50.0, random.uniform(0.2, 2.0), camera.ground_m};
    std::vector<CellInView> c, d;
    cells_in_view(sensor, pose, area, c);
    cells_in_view(sensor, pose, area, d, &level);
    EXPECT_TRUE(std::equal(c.begin(), c.end(), d.begin(), d.end(), [](auto& p, auto& q) {
      return p.cell == q.cell && p.detector == q.detector;
    }));
  }
  EXPECT_GT(judged, 1000u);
}

// Terraces of one height are a plane there, with other arithmetic.
TEST(Relief, OneHeightForAllIsAHigherPlane) {
  Stream random = stream("high plane");
  const Relief raised = relief_of(area, [](double, double) { return 2.5; });
  GridCamera low = infrared(), high = infrared();
  high.ground_m = 2.5;
  std::size_t found = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const CameraPose pose = random_pose(random);
    CameraLook with(low, area, &raised), plane(high, area);
    ASSERT_TRUE(with.look(pose, pose_covariance(0.5, 0.02)));
    ASSERT_TRUE(plane.look(pose, pose_covariance(0.5, 0.02)));
    ASSERT_EQ(with.in_view().size(), plane.in_view().size());
    for (std::size_t i = 0; i < plane.in_view().size(); ++i) {
      const int cell = plane.in_view()[i].cell;
      ASSERT_EQ(with.in_view()[i].cell, cell);
      const auto a = with.ellipse(cell), b = plane.ellipse(cell);
      ASSERT_EQ(a.has_value(), b.has_value());
      if (!a) continue;
      EXPECT_NEAR(a->u, b->u, 1e-7 * (1.0 + std::fabs(b->u)));
      EXPECT_NEAR(a->vv, b->vv, 1e-7 * b->vv);
    }
    found += plane.in_view().size();
  }
  EXPECT_GT(found, 1000u);
}

TEST(Relief, ACameraSeesTheCentresThatAreInItsImageAndNotHidden) {
  Stream random = stream("camera over a relief");
  std::size_t found = 0, hidden = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const Relief relief = random_relief(random, -4.0, random.uniform(-3.0, 12.0));
    GridCamera c = infrared();
    c.range_max_m = random.uniform(10, 80);
    c.ground_m = random.uniform(-3, 3);
    const CameraPose pose = random_pose(random);
    std::vector<CellInView> seen;
    cells_in_image(c, pose, area, seen, &relief);
    std::size_t next = 0;
    for (int cell = 0; cell < area.cells(); ++cell) {
      const Point at = area.centre(cell);
      const Vector3 point(at.x_m, at.y_m, c.ground_m + relief.height_m(cell));
      const auto pixel = gaussian::project(c.lens, pose, point);
      const double distance = (point - pose.position_m).norm();
      if (!pixel || distance >= c.range_max_m) continue;
      const double u = (*pixel)(0), v = (*pixel)(1);
      if (!(u >= -0.5 && u < 239.5 && v >= -0.5 && v < 319.5)) continue;
      if (!in_sight(relief, pose.position_m - Vector3(0, 0, c.ground_m), cell)) {
        ++hidden;
        continue;
      }
      ASSERT_LT(next, seen.size()) << trial;
      ASSERT_EQ(seen[next].cell, cell) << trial;
      const double rho = distance * distance / (c.range_max_m * c.range_max_m);
      EXPECT_NEAR(seen[next].detector.p_detect, 0.962 * (1 - rho) + 0.5 * rho, 1e-12);
      ++next;
    }
    EXPECT_EQ(next, seen.size()) << trial;
    found += next;
  }
  EXPECT_GT(found, 2000u);
  EXPECT_GT(hidden, 500u);
}

TEST(Relief, APresenceSensorSeesTheCentresThatAreInItsConeAndNotHidden) {
  Stream random = stream("presence over a relief");
  std::size_t found = 0, hidden = 0;
  for (int trial = 0; trial < 120; ++trial) {
    const Relief relief = random_relief(random, -4.0, random.uniform(-3.0, 12.0));
    const PresenceSensor sensor{{0.9, 0.1}, random.uniform(10, 60), random.uniform(0.1, 2.0)};
    const CameraPose pose = random_pose(random);
    std::vector<CellInView> seen;
    cells_in_view(sensor, pose, area, seen, &relief);
    std::size_t next = 0;
    for (int cell = 0; cell < area.cells(); ++cell) {
      const Point at = area.centre(cell);
      const Vector3 to = Vector3(at.x_m, at.y_m, relief.height_m(cell)) - pose.position_m;
      const double angle = std::acos(to.dot(pose.axes.col(2)) / to.norm());
      if (to.norm() >= sensor.range_max_m || angle >= sensor.angle_max_rad) continue;
      if (!in_sight(relief, pose.position_m, cell)) {
        ++hidden;
        continue;
      }
      ASSERT_LT(next, seen.size()) << trial;
      ASSERT_EQ(seen[next++].cell, cell) << trial;
    }
    EXPECT_EQ(next, seen.size()) << trial;
    found += next;
  }
  EXPECT_GT(found, 2000u);
  EXPECT_GT(hidden, 500u);
}

// Straight down, image up is x and image left is y: u = c − f·(y − y₀)/(z − h), v likewise with x.
TEST(Relief, PixelsOfATiltedPlaneAreThoseOfTheClosedForm) {
  const auto height_m = [](double x, double y) { return 6.0 + 0.15 * x - 0.08 * y; };
  const Relief slope = relief_of(area, height_m);
  GridCamera camera = infrared();
  camera.cells_have_extent = false;
  const Vector3 place(3.0, -2.0, 40.0);
  CameraLook look(camera, area, &slope);
  ASSERT_TRUE(look.look(looking(place, 0.0, pi / 2), Matrix::Zero(6, 6)));
  std::size_t in_image = 0;
  for (int cell = 0; cell < area.cells(); ++cell) {
    const Point at = area.centre(cell);
    const double below = place(2) - height_m(at.x_m, at.y_m);
    const double u = camera.lens.center_u - camera.lens.focal_u * (at.y_m - place(1)) / below;
    const double v = camera.lens.center_v - camera.lens.focal_v * (at.x_m - place(0)) / below;
    if (u >= -0.5 && u < 239.5 && v >= -0.5 && v < 319.5) ++in_image;
    const auto ellipse = look.ellipse(cell);
    ASSERT_TRUE(ellipse);
    EXPECT_NEAR(ellipse->u, u, 1e-9);
    EXPECT_NEAR(ellipse->v, v, 1e-9);
    EXPECT_NEAR(ellipse->uu, 0.25, 1e-9);
  }
  EXPECT_GT(in_image, 100u);
  EXPECT_EQ(look.in_view().size(), in_image);  // from above a gentle slope hides nothing
}

// From (15, 10) over an edge at (10, 5) rays fall 1 in 1 and come down at x = 5: what lies between
// is behind the step.
TEST(Relief, WhatLiesBehindAStepIsNotInView) {
  const Area line({.columns = 30, .rows = 3, .cell_m = 1.0});
  const Relief step = relief_of(line, [](double x, double) { return x > 10.0 ? 5.0 : 0.0; });
  const CameraPose pose = looking({15.0, 1.5, 10.0}, pi, 0.3);
  const PresenceSensor sensor{{0.9, 0.1}, 50.0, pi};
  GridCamera camera = infrared();
  camera.lens = {100.0, 100.0, 119.5, 159.5};
  std::vector<CellInView> seen, in_image;
  cells_in_view(sensor, pose, line, seen, &step);
  cells_in_image(camera, pose, line, in_image, &step);
  std::vector<int> columns, columns_in_image;
  for (const CellInView& c : seen) {
    if (line.cell(c.cell).row == 1) columns.push_back(line.cell(c.cell).column);
  }
  for (const CellInView& c : in_image) {
    if (line.cell(c.cell).row == 1) columns_in_image.push_back(line.cell(c.cell).column);
  }
  std::vector<int> expected;
  for (int column = 0; column < 30; ++column) {
    if (column < 5 || column >= 10) expected.push_back(column);
  }
  EXPECT_EQ(columns, expected);
  // The camera has the same step before it, and nothing behind it in its image.
  ASSERT_FALSE(columns_in_image.empty());
  EXPECT_EQ(std::count(columns_in_image.begin(), columns_in_image.end(), 4), 1);
  EXPECT_EQ(std::count(columns_in_image.begin(), columns_in_image.end(), 10), 1);
  for (int column = 5; column < 10; ++column) {
    EXPECT_EQ(std::count(columns_in_image.begin(), columns_in_image.end(), column), 0) << column;
  }
  cells_in_image(camera, pose, line, in_image);  // of a plane it sees these, too
  EXPECT_TRUE(std::any_of(in_image.begin(), in_image.end(),
                          [&](const CellInView& c) { return line.cell(c.cell).column == 7; }));
}

TEST(Relief, EllipsesHoldThePixelsOfACellAtItsHeight) {
  // Mean and covariance of the pixel over poses and places in the cell; 1σ of a variance is 1 %.
  Stream random = stream("pixels over a relief");
  const Relief hills = relief_of(area, [](double x, double y) { return 6.0 + 0.2 * x + 0.1 * y; });
  const double sigma_m = 0.6, sigma_rad = 0.015;
  const CameraPose pose = looking({-4.0, 2.0, 35.0}, 0.5, 1.1);
  CameraLook look(infrared(), area, &hills);
  ASSERT_TRUE(look.look(pose, pose_covariance(sigma_m, sigma_rad)));
  ASSERT_GT(look.in_view().size(), 40u);
  for (std::size_t i = 0; i < look.in_view().size(); i += 15) {
    const int cell = look.in_view()[i].cell;
    const Point at = area.centre(cell);
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();
    const int draws = 20000;
    for (int draw = 0; draw < draws; ++draw) {
      Vector3 shift, turn;
      for (int k = 0; k < 3; ++k) {
        shift(k) = random.normal(0.0, sigma_m);
        turn(k) = random.normal(0.0, sigma_rad);
      }
      CameraPose moved = pose.turned(turn);
      moved.position_m += shift;
      const auto pixel = gaussian::project(
          infrared().lens, moved,
          {at.x_m + random.uniform(-1, 1), at.y_m + random.uniform(-1, 1), hills.height_m(cell)});
      ASSERT_TRUE(pixel);
      sum += *pixel;
      squares += *pixel * pixel->transpose();
    }
    const Eigen::Vector2d mean = sum / draws;
    const Eigen::Matrix2d covariance = squares / draws - mean * mean.transpose();
    const auto ellipse = look.ellipse(cell);
    ASSERT_TRUE(ellipse);
    EXPECT_NEAR(ellipse->u, mean(0), 0.05 * std::sqrt(covariance(0, 0)));
    EXPECT_NEAR(ellipse->v, mean(1), 0.05 * std::sqrt(covariance(1, 1)));
    EXPECT_NEAR(ellipse->uu - 0.25, covariance(0, 0), 0.05 * covariance(0, 0));
    EXPECT_NEAR(ellipse->vv - 0.25, covariance(1, 1), 0.05 * covariance(1, 1));
  }
}

TEST(Relief, RefusesWhatIsNone) {
  EXPECT_THROW(Relief(area, {1.0}), BrokenInvariant);
  std::vector<double> heights(static_cast<std::size_t>(area.cells()), 1.0);
  heights[7] = NAN;
  EXPECT_THROW(Relief(area, heights), BrokenInvariant);
  heights[7] = 1.0;
  const Relief relief(area, heights);
  std::vector<CellInView> seen;
  const CameraPose pose = looking({0, 0, 20}, 0.0, 1.0);
  EXPECT_THROW(CameraLook(infrared(), square(3), &relief), BrokenInvariant);
  EXPECT_THROW(cells_in_image(infrared(), pose, square(3), seen, &relief), BrokenInvariant);
  const PresenceSensor sensor{{0.9, 0.1}, 50.0, 1.0};
  EXPECT_THROW(cells_in_view(sensor, pose, square(3), seen, &relief), BrokenInvariant);
}

}  // namespace
}  // namespace hearsay::grid
