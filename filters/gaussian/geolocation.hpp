// Geolocation: where on the ground is what a camera shows at a pixel, and how sure is that? Merino
// 2007, section 3.7.1: the pose of the camera is uncertain, and the way to the ground non-linear.
//
// What is uncertain, in this order (8): the camera's position (3, m, world), its attitude (3, rad:
// a small rotation about its own x, y, z) and the pixel (2). A rotation vector has no gimbal lock,
// so that straight down is a direction like any other.
#pragma once

#include <optional>

#include "filters/gaussian/camera.hpp"
#include "filters/gaussian/ground.hpp"
#include "filters/gaussian/propagation.hpp"

namespace hearsay::gaussian {

inline constexpr int look_dimension = 8;

/// Independent errors, each the same on all of its axes; ≥ 0.
struct LookNoise {
  double sigma_position_m = 0.0;
  double sigma_attitude_rad = 0.0;
  double sigma_pixel = 0.0;
};
Matrix look_covariance(const LookNoise& noise);

/// What a camera reports, and what its owner believes of the pose.
struct Look {
  Intrinsics camera;
  CameraPose pose;
  Vector pixel;       ///< 2
  Matrix covariance;  ///< 8×8, positive semi-definite
};

/// The ground's (x, y) where the pixel looks, m, if pose and pixel are off by `error` (8). Nothing
/// if the ray misses the ground.
std::optional<Vector> ground_position(const Look& look, const Ground& ground, const Vector& error);
/// The same without error, and its derivative by the error there (2×8).
struct GroundDerivative {
  Vector position_m;
  Matrix jacobian;
};
std::optional<GroundDerivative> ground_derivative(const Look& look, const Ground& ground);

/// Mean (2) and covariance (2×2) of the ground position, m and m². Nothing if the ray misses, or,
/// with the unscented transform, if that of a sigma point does.
std::optional<Moments> geolocate_linearised(const Look& look, const Ground& ground);
std::optional<Moments> geolocate_unscented(const Look& look, const Ground& ground,
                                           double kappa = usual_kappa(look_dimension));
/// From `draws` draws of 8 numbers each by `normal()`; tells how many of them missed.
template <typename Normal>
Sampled geolocate_sampled(const Look& look, const Ground& ground, int draws, Normal&& normal) {
  const Moments errors{Vector::Zero(look_dimension), look.covariance};
  return sampled(
      errors, draws, [&](const Vector& e) { return ground_position(look, ground, e); }, normal);
}

}  // namespace hearsay::gaussian
