#include "filters/grid/sensors.hpp"

#include <array>
#include <cmath>

#include "filters/grid/footprint.hpp"
#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"

namespace hearsay::grid {
namespace {

using gaussian::CameraPose;
using gaussian::Vector3;

constexpr std::array<NamedDetector, 3> table_b1 = {{
    {"infrared", {0.962, 0.045}},
    {"visual", {0.819, 0.023}},
    {"combined", {0.981, 0.003}},
}};

void require_detector(const Detector& d) {
  require(d.p_detect > 0.0 && d.p_detect < 1.0 && d.p_false > 0.0 && d.p_false < 1.0,
          "detector: P_D and P_F are in (0, 1)");
}

constexpr int sides = 8;
constexpr double widest_pyramid_rad = math::pi / 2.2;

/// Sides of a pyramid around the cone. A wall touches the cone where r points away from the axis:
/// inward normal a·sin φ − r·cos φ.
Footprint ground_of_cone(const PresenceSensor& sensor, const CameraPose& pose, double reach_m,
                         const Slab& heights) {
  Footprint ground = Footprint::around({pose.position_m(0), pose.position_m(1)}, reach_m);
  if (sensor.angle_max_rad > widest_pyramid_rad) return ground;
  const double s = math::sin(sensor.angle_max_rad), c = math::cos(sensor.angle_max_rad);
  for (int i = 0; i < sides; ++i) {
    const double turn = 2.0 * math::pi * i / sides;
    const Vector3 inward = pose.axes * Vector3(-c * math::cos(turn), -c * math::sin(turn), s);
    ground.cut(pose.position_m, inward, heights.before(inward));
  }
  return ground;
}

}  // namespace

std::span<const NamedDetector> detectors() { return table_b1; }

std::optional<Detector> detector_by_name(std::string_view name) {
  for (const NamedDetector& row : table_b1) {
    if (row.name == name) return row.detector;
  }
  return std::nullopt;
}

Detector faded(const Detector& detector, double rho) {
  require_detector(detector);
  require(rho >= 0.0 && rho <= 1.0, "detector: a share is in [0, 1]");
  return {detector.p_detect * (1.0 - rho) + 0.5 * rho, detector.p_false * (1.0 - rho) + 0.5 * rho};
}

double log_likelihood_ratio(const Detector& detector, double seen) {
  require_detector(detector);
  require(seen >= 0.0 && seen <= 1.0, "detector: a share is in [0, 1]");
  const double yes = seen * detector.p_detect + (1.0 - seen) * (1.0 - detector.p_detect);
  const double no = seen * detector.p_false + (1.0 - seen) * (1.0 - detector.p_false);
  return math::log(yes / no);
}

void add(std::span<const CellLook> looks, BernoulliGrid& grid) {
  for (const CellLook& look : looks) grid.add(look.cell, look.ratio);
}

void add(std::span<const CellLook> looks, BetaGrid& grid) {
  for (const CellLook& look : looks) grid.add(look.cell, look.m, look.n);
}

void cells_in_view(const PresenceSensor& sensor, const CameraPose& pose, const Area& area,
                   std::vector<CellInView>& out, const Relief* relief) {
  require_detector(sensor.detector);
  require(sensor.range_max_m > 0.0 && std::isfinite(sensor.range_max_m),
          "presence sensor: the range is positive");
  require(sensor.angle_max_rad > 0.0 && sensor.angle_max_rad <= math::pi,
          "presence sensor: half the opening angle is in (0, π]");
  require(pose.position_m.allFinite() && pose.axes.allFinite(),
          "presence sensor: a pose is finite");
  out.clear();
  relief = uneven(relief, area);
  const Slab heights = slab_of(relief, sensor.ground_m);
  const auto reach_m = heights.reach(pose.position_m(2), sensor.range_max_m);
  if (!reach_m) return;
  const Vector3 axis = pose.axes.col(2);
  const Vector3 over_plane = pose.position_m - Vector3(0.0, 0.0, sensor.ground_m);
  for_each_cell(ground_of_cone(sensor, pose, *reach_m, heights), area, [&](int cell) {
    const Point at = area.centre(cell);
    const double height_m = relief != nullptr ? relief->height_m(cell) : 0.0;
    const Vector3 to = Vector3(at.x_m, at.y_m, sensor.ground_m + height_m) - pose.position_m;
    const double d = std::sqrt(to.dot(to));
    const Vector3 across = gaussian::cross_matrix(axis) * to;
    const double angle = math::atan2(std::sqrt(across.dot(across)), axis.dot(to));
    if (!(d < sensor.range_max_m) || !(angle < sensor.angle_max_rad)) return;
    if (relief != nullptr && !relief->sees(over_plane, cell)) return;
    const double by_range = d / sensor.range_max_m, by_angle = angle / sensor.angle_max_rad;
    const double left = (1.0 - by_range * by_range) * (1.0 - by_angle * by_angle);
    out.push_back({cell, faded(sensor.detector, 1.0 - left)});
  });
}

void presence_look(std::span<const CellInView> cells, bool detected, std::vector<CellLook>& out) {
  out.clear();
  const double share = cells.empty() ? 0.0 : 1.0 / static_cast<double>(cells.size());
  for (const CellInView& in_view : cells) {
    const double ratio = log_likelihood_ratio(in_view.detector, detected ? 1.0 : 0.0);
    out.push_back({in_view.cell, ratio, detected ? share : 0.0, detected ? 0.0 : 1.0});
  }
}

}  // namespace hearsay::grid
