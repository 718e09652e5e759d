#include "filters/grid/sensors.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/kernel/error.hpp"
#include "tests/filters/grid/samples.hpp"

namespace hearsay::grid {
namespace {

using gaussian::CameraPose;
using gaussian::looking;
using gaussian::Vector3;

const double pi = std::acos(-1.0);

TEST(GridDetector, HasTheQualitiesOfTableB1) {
  EXPECT_EQ(detector_by_name("infrared"), (Detector{0.962, 0.045}));
  EXPECT_EQ(detector_by_name("visual"), (Detector{0.819, 0.023}));
  EXPECT_EQ(detector_by_name("combined"), (Detector{0.981, 0.003}));
  EXPECT_FALSE(detector_by_name("sonar"));
  EXPECT_EQ(detectors().size(), 3u);
}

TEST(GridDetector, FadesToOneHalf) {
  const Detector d{0.9, 0.2};
  EXPECT_EQ(faded(d, 0.0), d);
  EXPECT_EQ(faded(d, 1.0), (Detector{0.5, 0.5}));
  EXPECT_NEAR(faded(d, 0.25).p_detect, 0.9 * 0.75 + 0.5 * 0.25, 1e-15);
  EXPECT_NEAR(faded(d, 0.25).p_false, 0.2 * 0.75 + 0.5 * 0.25, 1e-15);
  EXPECT_THROW(faded(d, 1.1), BrokenInvariant);
  EXPECT_THROW(faded({1.0, 0.2}, 0.0), BrokenInvariant);
  EXPECT_THROW(faded({0.9, 0.0}, 0.0), BrokenInvariant);
}

TEST(GridDetector, LooksWeighByLikelihood) {
  const Detector d{0.9, 0.2};
  EXPECT_NEAR(log_likelihood_ratio(d, 1.0), std::log(0.9 / 0.2), 1e-14);
  EXPECT_NEAR(log_likelihood_ratio(d, 0.0), std::log(0.1 / 0.8), 1e-14);
  EXPECT_NEAR(log_likelihood_ratio(d, 0.25), std::log(0.3 / 0.65), 1e-14);
  EXPECT_EQ(log_likelihood_ratio({0.5, 0.5}, 0.7), 0.0);
  EXPECT_THROW(log_likelihood_ratio(d, -0.1), BrokenInvariant);
}

TEST(GridDetector, LooksAreAddedToBothKindsOfGrid) {
  const std::vector<CellLook> looks{{1, 2.0, 0.75, 0.25}, {3, -1.0, 0.0, 1.0}};
  BernoulliGrid bernoulli(square(2));
  BetaGrid beta(square(2));
  add(looks, bernoulli);
  add(looks, beta);
  EXPECT_EQ(copy_of(bernoulli), (std::vector<float>{0.0F, 2.0F, 0.0F, -1.0F}));
  EXPECT_EQ(copy_of(beta), (std::vector<float>{0, 0, 0.75F, 0.25F, 0, 0, 0, 1}));
}

// Presence.
PresenceSensor fire_sensor() {
  return {.detector = {0.9, 0.1}, .range_max_m = 30.0, .angle_max_rad = 0.5};
}

TEST(PresenceSensor, FadesWithRangeAndAngle) {
  const Area area({.columns = 41, .rows = 41, .cell_m = 1.0, .x_m = -20.5, .y_m = -20.5});
  std::vector<CellInView> cells;
  cells_in_view(fire_sensor(), looking({0, 0, 20}, 0.0, pi / 2), area, cells);
  ASSERT_FALSE(cells.empty());
  for (const CellInView& c : cells) {
    const Point at = area.centre(c.cell);
    const double level = std::hypot(at.x_m, at.y_m), d2 = level * level + 400.0;
    const double angle = std::atan2(level, 20.0);
    const double left = (1 - d2 / 900.0) * (1 - angle * angle / 0.25);
    EXPECT_NEAR(c.detector.p_detect, 0.5 + 0.4 * left, 1e-12);
    EXPECT_NEAR(c.detector.p_false, 0.5 - 0.4 * left, 1e-12);
  }
  // Best below the sensor: 1 − (20/30)² = 5/9 of 0.4.
  const int middle = *area.at({0.0, 0.0});
  for (const CellInView& c : cells) {
    if (c.cell == middle) {
      EXPECT_NEAR(c.detector.p_detect, 0.5 + 0.4 * 5 / 9, 1e-12);
    }
  }
}

TEST(PresenceSensor, SeesTheCellsOfItsConeAndNoOthers) {
  Stream random = stream("cone");
  const Area area({.columns = 50, .rows = 40, .cell_m = 1.5, .x_m = -30.0, .y_m = -30.0});
  std::size_t found = 0;
  std::vector<CellInView> cells;
  for (int trial = 0; trial < 200; ++trial) {
    PresenceSensor sensor = fire_sensor();
    sensor.angle_max_rad = random.uniform(0.05, pi);
    sensor.range_max_m = random.uniform(5, 60);
    sensor.ground_m = random.uniform(-2, 2);
    const CameraPose pose =
        looking({random.uniform(-30, 30), random.uniform(-30, 30), random.uniform(-5, 40)},
                random.uniform(-pi, pi), random.uniform(-pi / 2, pi / 2));
    cells_in_view(sensor, pose, area, cells);
    std::vector<int> seen, expected;
    for (const CellInView& c : cells) seen.push_back(c.cell);
    for (int cell = 0; cell < area.cells(); ++cell) {
      const Point at = area.centre(cell);
      const Vector3 to = Vector3(at.x_m, at.y_m, sensor.ground_m) - pose.position_m;
      const double cosine = pose.axes.col(2).dot(to) / to.norm();
      const bool above = pose.position_m(2) > sensor.ground_m;
      if (above && to.norm() < sensor.range_max_m && std::acos(cosine) < sensor.angle_max_rad) {
        expected.push_back(cell);
      }
    }
    EXPECT_EQ(seen, expected);
    found += seen.size();
  }
  EXPECT_GT(found, 1000u);
}

TEST(PresenceSensor, AnswersForAllCellsInView) {
  const std::vector<CellInView> cells{
      {2, {0.9, 0.2}}, {5, {0.7, 0.4}}, {7, {0.6, 0.45}}, {8, {0.8, 0.1}}};
  std::vector<CellLook> looks;
  presence_look(cells, true, looks);
  ASSERT_EQ(looks.size(), 4u);
  EXPECT_EQ(looks[1].cell, 5);
  EXPECT_NEAR(looks[0].ratio, std::log(0.9 / 0.2), 1e-14);
  EXPECT_NEAR(looks[1].ratio, std::log(0.7 / 0.4), 1e-14);
  for (const CellLook& look : looks) {
    EXPECT_EQ(look.m, 0.25);
    EXPECT_EQ(look.n, 0.0);
  }
  presence_look(cells, false, looks);
  EXPECT_NEAR(looks[3].ratio, std::log(0.2 / 0.9), 1e-14);
  for (const CellLook& look : looks) {
    EXPECT_EQ(look.m, 0.0);
    EXPECT_EQ(look.n, 1.0);
  }
  presence_look({}, true, looks);
  EXPECT_TRUE(looks.empty());
}

TEST(PresenceSensor, RefusesWhatIsNone) {
  std::vector<CellInView> cells;
  const CameraPose pose = looking({0, 0, 20}, 0.0, pi / 2);
  PresenceSensor sensor = fire_sensor();
  sensor.range_max_m = 0.0;
  EXPECT_THROW(cells_in_view(sensor, pose, square(2), cells), BrokenInvariant);
  sensor = fire_sensor();
  sensor.angle_max_rad = 4.0;
  EXPECT_THROW(cells_in_view(sensor, pose, square(2), cells), BrokenInvariant);
  sensor = fire_sensor();
  sensor.detector.p_false = 0.0;
  EXPECT_THROW(cells_in_view(sensor, pose, square(2), cells), BrokenInvariant);
  EXPECT_THROW(cells_in_view(fire_sensor(), {{NAN, 0, 1}, pose.axes}, square(2), cells),
               BrokenInvariant);
}

}  // namespace
}  // namespace hearsay::grid
