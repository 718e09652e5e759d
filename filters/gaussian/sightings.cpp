#include "filters/gaussian/sightings.hpp"

#include <cmath>

#include "filters/gaussian/symmetric.hpp"
#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"

namespace hearsay::gaussian {
namespace {

/// The line from the observer to the position in x.
struct Line {
  int d;
  double along[3] = {};  ///< m; the third is 0 in the plane
  double level_m;        ///< length in the plane
  double range_m;
};

/// Nothing where the bearing is not defined: straight above, below or at the observer.
std::optional<Line> line_to(const Observer& observer, const Vector& x) {
  const auto d = static_cast<int>(observer.place_m.size());
  require(d == 2 || d == 3, "sighting: an observer's place has 2 or 3 coordinates");
  require(x.size() >= d, "sighting: the state must begin with a position");
  Line line{};
  line.d = d;
  for (int k = 0; k < d; ++k) line.along[k] = x(k) - observer.place_m(k);
  line.level_m = math::hypot(line.along[0], line.along[1]);
  line.range_m = math::hypot(line.level_m, line.along[2]);
  if (!(line.level_m > 0.0) || !std::isfinite(line.range_m)) return std::nullopt;
  return line;
}

Vector without_first(const Vector& v) { return v.tail(v.size() - 1); }

/// a − b, entries from `first_angle` on wrapped.
Vector wrapped_difference(const Vector& a, const Vector& b, Eigen::Index first_angle) {
  require(a.size() == b.size(), "sighting: measurements differ in dimension");
  Vector out = a - b;
  for (Eigen::Index i = first_angle; i < out.size(); ++i) out(i) = math::wrap_angle(out(i));
  return out;
}

Vector3 position_of(const CameraPixel& model, const Vector& x) {
  require(x.size() >= (model.plane_m ? 2 : 3),
          "camera pixel: the state must begin with a position");
  return {x(0), x(1), model.plane_m ? *model.plane_m : x(2)};
}

}  // namespace

std::optional<Vector> RangeBearing::value(const Vector& x) const {
  const auto line = line_to(observer, x);
  if (!line) return std::nullopt;
  Vector z(line->d);
  z(0) = line->range_m;
  z(1) = math::wrap_angle(math::atan2(line->along[1], line->along[0]) - observer.heading_rad);
  if (line->d == 3) z(2) = math::atan2(line->along[2], line->level_m);
  return z;
}

std::optional<Matrix> RangeBearing::jacobian(const Vector& x) const {
  const auto line = line_to(observer, x);
  if (!line) return std::nullopt;
  const double cos_bearing = line->along[0] / line->level_m;
  const double sin_bearing = line->along[1] / line->level_m;
  Matrix J = Matrix::Zero(line->d, x.size());
  for (int k = 0; k < line->d; ++k) J(0, k) = line->along[k] / line->range_m;
  J(1, 0) = -sin_bearing / line->level_m;
  J(1, 1) = cos_bearing / line->level_m;
  if (line->d == 3) {
    const double sin_elevation = line->along[2] / line->range_m;
    J(2, 0) = -cos_bearing * sin_elevation / line->range_m;
    J(2, 1) = -sin_bearing * sin_elevation / line->range_m;
    J(2, 2) = line->level_m / line->range_m / line->range_m;
  }
  if (!all_finite(J)) return std::nullopt;
  return J;
}

Vector RangeBearing::difference(const Vector& a, const Vector& b) const {
  return wrapped_difference(a, b, 1);
}

std::optional<Vector> BearingOnly::value(const Vector& x) const {
  const auto z = RangeBearing{observer}.value(x);
  if (!z) return std::nullopt;
  return without_first(*z);
}

std::optional<Matrix> BearingOnly::jacobian(const Vector& x) const {
  const auto J = RangeBearing{observer}.jacobian(x);
  if (!J) return std::nullopt;
  return Matrix(J->bottomRows(J->rows() - 1));
}

Vector BearingOnly::difference(const Vector& a, const Vector& b) const {
  return wrapped_difference(a, b, 0);
}

std::optional<Vector> CameraPixel::value(const Vector& x) const {
  return project(camera, pose, position_of(*this, x));
}

std::optional<Matrix> CameraPixel::jacobian(const Vector& x) const {
  const Vector3 point = position_of(*this, x);
  if (!project(camera, pose, point)) return std::nullopt;
  const Eigen::Matrix<double, 2, 3> by_point =
      projection_jacobian(camera, in_camera(pose, point)) * pose.axes.transpose();
  const int d = plane_m ? 2 : 3;
  Matrix J = Matrix::Zero(2, x.size());
  J.leftCols(d) = by_point.leftCols(d);
  if (!all_finite(J)) return std::nullopt;
  return J;
}

}  // namespace hearsay::gaussian
