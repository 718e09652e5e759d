#include "agents/sensors/truth_image.hpp"

#include <algorithm>
#include <cmath>

#include "filters/grid/footprint.hpp"
#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"

namespace hearsay {
namespace {

using gaussian::CameraPose;
using gaussian::Vector3;

/// p in (0, 1) as ⌊p·2³²⌋.
std::uint32_t threshold_of(double p) { return static_cast<std::uint32_t>(p * 0x1p32); }

/// K⁻¹(u, v, 1).
Vector3 sight(const gaussian::Intrinsics& lens, int u, int v) {
  const double y = (v - lens.center_v) / lens.focal_v;
  return {(u - lens.center_u - lens.skew * y) / lens.focal_u, y, 1.0};
}

/// First and last of `count` pixels in [from, to], and in what rounding may have taken off it.
struct Range {
  int first, last;
};
Range pixels_between(double from, double to, int count) {
  constexpr double rounding = 1e-6;
  return {static_cast<int>(std::clamp(std::ceil(from - rounding), 0.0, count + 0.0)),
          static_cast<int>(std::clamp(std::floor(to + rounding), -1.0, count - 1.0))};
}

struct Box {
  Range u, v;
};
/// Pixels among which all are that show the cell: around its corners, or all there are if one of
/// these is behind the camera.
Box box_around(const grid::GridCamera& camera, const CameraPose& pose, const grid::Area& area,
               int cell) {
  const grid::Point centre = area.centre(cell);
  const double half_m = 0.5 * area.cell_m();
  double u_from = camera.width, u_to = -1.0, v_from = camera.height, v_to = -1.0;
  for (int corner = 0; corner < 4; ++corner) {
    const double x_m = centre.x_m + (corner % 2 == 0 ? half_m : -half_m);
    const double y_m = centre.y_m + (corner < 2 ? half_m : -half_m);
    const auto pixel = gaussian::project(camera.lens, pose, {x_m, y_m, camera.ground_m});
    if (!pixel) return {{0, camera.width - 1}, {0, camera.height - 1}};
    u_from = std::min(u_from, (*pixel)(0));
    u_to = std::max(u_to, (*pixel)(0));
    v_from = std::min(v_from, (*pixel)(1));
    v_to = std::max(v_to, (*pixel)(1));
  }
  return {pixels_between(u_from, u_to, camera.width), pixels_between(v_from, v_to, camera.height)};
}

std::size_t pixels_of(const grid::GridCamera& camera) {
  return static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
}

}  // namespace

TruthImage::TruthImage(const grid::GridCamera& camera, double depression_rad,
                       const grid::Area& area, const grid::Relief* relief)
    : camera_(camera),
      depression_rad_(depression_rad),
      area_(area),
      relief_(grid::uneven(relief, area)),
      image_(camera.width, camera.height) {
  grid::CameraLook(camera, area);  // which looks at the ranges
  require(pixels_of(camera) <= pixels_max, "TruthImage: an image has at most 262144 pixels");
  require(depression_rad >= 0.0 && depression_rad <= 0.5 * math::pi,
          "TruthImage: a camera looks 0 to π/2 below the horizon");
  detected_.resize(pixels_of(camera));
  false_alarm_.resize(pixels_of(camera));
  threshold_ = false_alarm_;
  showing_.reserve(pixels_of(camera));
}

CameraPose TruthImage::pose(const Point& place_m, double heading_rad) const {
  require(std::isfinite(place_m[0]) && std::isfinite(place_m[1]) && std::isfinite(place_m[2]) &&
              std::isfinite(heading_rad),
          "TruthImage: a place and a heading are finite");
  return gaussian::looking({place_m[0], place_m[1], place_m[2]}, heading_rad, depression_rad_);
}

void TruthImage::set_thresholds(double z_m) {
  if (z_m == z_m_) return;
  // Distances do not depend on the heading.
  const CameraPose at = pose({0.0, 0.0, z_m}, 0.0);
  const double height_m = z_m - camera_.ground_m;
  const double range_squared = camera_.range_max_m * camera_.range_max_m;
  std::size_t pixel = 0;
  for (int v = 0; v < camera_.height; ++v) {
    for (int u = 0; u < camera_.width; ++u, ++pixel) {
      const Vector3 ray = sight(camera_.lens, u, v);
      const double sinks = -at.axes.row(2).dot(ray);
      const bool meets = height_m > 0.0 && sinks > 0.0;
      const double times = meets ? height_m / sinks : 0.0;
      const double rho = meets ? std::min(1.0, times * times * ray.dot(ray) / range_squared) : 1.0;
      const grid::Detector detector = grid::faded(camera_.detector, rho);
      detected_[pixel] = threshold_of(detector.p_detect);
      false_alarm_[pixel] = threshold_of(detector.p_false);
    }
  }
  threshold_ = false_alarm_;
  z_m_ = z_m;
}

void TruthImage::set_thresholds_over_relief(const CameraPose& pose,
                                            std::span<const unsigned char> truth) {
  const Vector3 over_plane = pose.position_m - Vector3(0.0, 0.0, camera_.ground_m);
  const double range_squared = camera_.range_max_m * camera_.range_max_m;
  std::size_t pixel = 0;
  for (int v = 0; v < camera_.height; ++v) {
    for (int u = 0; u < camera_.width; ++u, ++pixel) {
      const Vector3 ray = pose.axes * sight(camera_.lens, u, v);
      const auto met = relief_->first_met(over_plane, ray);
      const bool around = !met && over_plane(2) > 0.0 && ray(2) < 0.0;
      const double times = met ? met->times : around ? over_plane(2) / -ray(2) : 0.0;
      const double rho =
          met || around ? std::min(1.0, times * times * ray.dot(ray) / range_squared) : 1.0;
      const grid::Detector detector = grid::faded(camera_.detector, rho);
      const bool shows = met && truth[static_cast<std::size_t>(met->cell)] != 0;
      threshold_[pixel] = threshold_of(shows ? detector.p_detect : detector.p_false);
    }
  }
}

void TruthImage::expect_cell(const CameraPose& pose, int cell) {
  const double height_m = pose.position_m(2) - camera_.ground_m;
  const Box box = box_around(camera_, pose, area_, cell);
  for (int v = box.v.first; v <= box.v.last; ++v) {
    for (int u = box.u.first; u <= box.u.last; ++u) {
      const Vector3 ray = pose.axes * sight(camera_.lens, u, v);
      if (!(ray(2) < 0.0)) continue;
      const double times = height_m / -ray(2);
      if (area_.at({pose.position_m(0) + times * ray(0), pose.position_m(1) + times * ray(1)}) !=
          cell) {
        continue;
      }
      const auto pixel = static_cast<std::size_t>(v) * static_cast<std::size_t>(camera_.width) +
                         static_cast<std::size_t>(u);
      threshold_[pixel] = detected_[pixel];
      showing_.push_back(pixel);
    }
  }
}

void TruthImage::expect_true_cells(const CameraPose& pose, std::span<const unsigned char> truth) {
  // Also cells that are in the image with a corner only.
  const double half_diagonal_m = std::sqrt(0.5) * area_.cell_m();
  grid::for_each_cell(grid::ground_in_image(camera_, pose, half_diagonal_m), area_, [&](int cell) {
    if (truth[static_cast<std::size_t>(cell)] != 0) expect_cell(pose, cell);
  });
}

void TruthImage::mark(Stream& draws) {
  const std::size_t pixels = threshold_.size();
  const auto width = static_cast<std::size_t>(camera_.width);
  const auto mark_pixel = [&](std::size_t pixel) {
    image_.mark(static_cast<int>(pixel % width), static_cast<int>(pixel / width));
  };
  for (std::size_t pixel = 0; pixel < pixels; pixel += 2) {
    const std::uint64_t word = draws.bits();
    if (static_cast<std::uint32_t>(word) < threshold_[pixel]) mark_pixel(pixel);
    if (pixel + 1 < pixels && static_cast<std::uint32_t>(word >> 32) < threshold_[pixel + 1]) {
      mark_pixel(pixel + 1);
    }
  }
}

const grid::SegmentedImage& TruthImage::draw(const Point& place_m, double heading_rad,
                                             std::span<const unsigned char> truth, Stream draws) {
  require(truth.size() == static_cast<std::size_t>(area_.cells()),
          "TruthImage: a truth is about all cells");
  const CameraPose at = pose(place_m, heading_rad);
  image_.clear();
  if (relief_ != nullptr) {
    set_thresholds_over_relief(at, truth);
    mark(draws);
    return image_;
  }
  set_thresholds(place_m[2]);
  expect_true_cells(at, truth);
  mark(draws);
  for (const std::size_t pixel : showing_) threshold_[pixel] = false_alarm_[pixel];
  showing_.clear();
  return image_;
}

}  // namespace hearsay
