#include "filters/gaussian/camera.hpp"

#include <cmath>

#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"

namespace hearsay::gaussian {
namespace {

void require_lens(const Intrinsics& camera) {
  require(camera.focal_u > 0.0 && camera.focal_v > 0.0, "camera: focal lengths must be positive");
}

/// Axes of a camera that looks along (cos ψ cos θ, sin ψ cos θ, −sin θ), its x axis level.
Matrix3 level_axes(double cos_heading, double sin_heading, double cos_down, double sin_down) {
  const Vector3 ahead(cos_down * cos_heading, cos_down * sin_heading, -sin_down);
  const Vector3 right(sin_heading, -cos_heading, 0.0);
  Matrix3 axes;
  axes << right, cross_matrix(ahead) * right, ahead;
  return axes;
}

}  // namespace

Matrix3 cross_matrix(const Vector3& a) {
  Matrix3 m;
  m << 0.0, -a(2), a(1), a(2), 0.0, -a(0), -a(1), a(0), 0.0;
  return m;
}

Matrix3 rotation(const Vector3& r) {
  const double angle = std::sqrt(r.dot(r));
  const double half = math::sin(0.5 * angle);
  // sin φ/φ and (1 − cos φ)/φ², the latter by half angles, so that small ones lose nothing.
  const double first = angle > 0.0 ? math::sin(angle) / angle : 1.0;
  const double second = angle > 1e-150 ? 2.0 * (half / angle) * (half / angle) : 0.5;
  const Matrix3 cross = cross_matrix(r);
  return Matrix3::Identity() + first * cross + second * (cross * cross);
}

CameraPose looking(const Vector3& position_m, double heading_rad, double depression_rad,
                   double roll_rad) {
  const Matrix3 level = level_axes(math::cos(heading_rad), math::sin(heading_rad),
                                   math::cos(depression_rad), math::sin(depression_rad));
  return CameraPose{position_m, level}.turned({0.0, 0.0, roll_rad});
}

std::optional<CameraPose> looking_at(const Vector3& position_m, const Vector3& target_m) {
  const Vector3 sight = target_m - position_m;
  const double level = std::sqrt(sight(0) * sight(0) + sight(1) * sight(1));
  const double length = std::sqrt(sight.dot(sight));
  if (!(length > 0.0) || !std::isfinite(length)) return std::nullopt;
  const double cos_heading = level > 0.0 ? sight(0) / level : 1.0;
  const double sin_heading = level > 0.0 ? sight(1) / level : 0.0;
  return CameraPose{position_m,
                    level_axes(cos_heading, sin_heading, level / length, -sight(2) / length)};
}

Vector3 in_camera(const CameraPose& pose, const Vector3& point_m) {
  return pose.axes.transpose() * (point_m - pose.position_m);
}

std::optional<Vector> project(const Intrinsics& camera, const CameraPose& pose,
                              const Vector3& point_m) {
  require_lens(camera);
  const Vector3 p = in_camera(pose, point_m);
  if (!(p(2) > 0.0)) return std::nullopt;
  const double x = p(0) / p(2), y = p(1) / p(2);
  Vector pixel(2);
  pixel << camera.focal_u * x + camera.skew * y + camera.center_u,
      camera.focal_v * y + camera.center_v;
  if (!std::isfinite(pixel(0)) || !std::isfinite(pixel(1))) return std::nullopt;
  return pixel;
}

Eigen::Matrix<double, 2, 3> projection_jacobian(const Intrinsics& camera, const Vector3& point) {
  const double x = point(0) / point(2), y = point(1) / point(2);
  Eigen::Matrix<double, 2, 3> J;
  J << camera.focal_u, camera.skew, -(camera.focal_u * x + camera.skew * y),  //
      0.0, camera.focal_v, -camera.focal_v * y;
  return J / point(2);
}

Vector3 sight_of(const Intrinsics& camera, const Vector& pixel) {
  require_lens(camera);
  require(pixel.size() == 2, "camera: a pixel has 2 coordinates");
  const double y = (pixel(1) - camera.center_v) / camera.focal_v;
  return {(pixel(0) - camera.center_u - camera.skew * y) / camera.focal_u, y, 1.0};
}

Ray ray_through(const Intrinsics& camera, const CameraPose& pose, const Vector& pixel) {
  const Vector3 sight = pose.axes * sight_of(camera, pixel);
  return {pose.position_m, sight / std::sqrt(sight.dot(sight))};
}

}  // namespace hearsay::gaussian
