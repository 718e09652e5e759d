// A pin-hole camera, its pose, and rays. Merino 2007, section 3.5.2, eq. 3.57.
//
// The world has x and y in the plane and z up, in metres. The camera's own axes: x to the right of
// the image, y down the image, z along the view. Pixels are (u, v), u to the right, v down.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "filters/gaussian/belief.hpp"

namespace hearsay::gaussian {

using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;

/// K = [focal_u skew center_u; 0 focal_v center_v; 0 0 1], in pixels; focal lengths > 0.
struct Intrinsics {
  double focal_u, focal_v;
  double center_u, center_v;
  double skew = 0.0;
};
/// The infrared camera of Merino's experiments (2007, p. 72).
inline constexpr Intrinsics infrared_camera{347.881, 345.876, 119.512, 161.781};

/// [a]×, so that [a]×·b = a × b.
Matrix3 cross_matrix(const Vector3& a);

/// Rotation by |r| about r (rad, right-handed): Rodrigues' formula, by sim/math.
Matrix3 rotation(const Vector3& r);

struct CameraPose {
  Vector3 position_m;
  Matrix3 axes;  ///< columns: the camera's x, y, z in the world; Rᵀ of eq. 3.57

  /// Turned by a small rotation vector (rad) about its own axes.
  CameraPose turned(const Vector3& r) const { return {position_m, axes * rotation(r)}; }
};

/// Looks along `heading_rad` (counter-clockwise from x), `depression_rad` below the horizon, rolled
/// by `roll_rad` about the view. Straight down, the heading says what is up in the image.
CameraPose looking(const Vector3& position_m, double heading_rad, double depression_rad,
                   double roll_rad = 0.0);
/// Looks at a target without roll; straight up or down with heading 0. Nothing if it stands on it.
std::optional<CameraPose> looking_at(const Vector3& position_m, const Vector3& target_m);

/// The point in the camera's axes, Rᵀ-turned: (right, down, ahead), m.
Vector3 in_camera(const CameraPose& pose, const Vector3& point_m);

/// The pixel (2) of a point: s·(u, v, 1) = K·in_camera(point). Nothing unless it lies ahead.
std::optional<Vector> project(const Intrinsics& camera, const CameraPose& pose,
                              const Vector3& point_m);
/// ∂(pixel)/∂(point in the camera's axes), 2×3, at a point ahead.
Eigen::Matrix<double, 2, 3> projection_jacobian(const Intrinsics& camera, const Vector3& point);

/// K⁻¹(u, v, 1): where a pixel looks, in the camera's axes; its z is 1.
Vector3 sight_of(const Intrinsics& camera, const Vector& pixel);

struct Ray {
  Vector3 origin_m;
  Vector3 direction;  ///< of length 1
};
Ray ray_through(const Intrinsics& camera, const CameraPose& pose, const Vector& pixel);

}  // namespace hearsay::gaussian
