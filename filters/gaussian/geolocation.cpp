#include "filters/gaussian/geolocation.hpp"

#include <cmath>

#include "sim/kernel/error.hpp"

namespace hearsay::gaussian {
namespace {

void require_shapes(const Look& look) {
  require(look.pixel.size() == 2 && look.covariance.rows() == look_dimension &&
              look.covariance.cols() == look_dimension,
          "geolocation: a look has a pixel (2) and a covariance (8×8)");
}

Vector level(const Vector3& point) {
  Vector xy(2);
  xy << point(0), point(1);
  return xy;
}

}  // namespace

Matrix look_covariance(const LookNoise& noise) {
  require(
      noise.sigma_position_m >= 0.0 && noise.sigma_attitude_rad >= 0.0 && noise.sigma_pixel >= 0.0,
      "geolocation: standard deviations must not be negative");
  Matrix covariance = Matrix::Zero(look_dimension, look_dimension);
  for (int k = 0; k < 3; ++k) {
    covariance(k, k) = noise.sigma_position_m * noise.sigma_position_m;
    covariance(3 + k, 3 + k) = noise.sigma_attitude_rad * noise.sigma_attitude_rad;
  }
  covariance(6, 6) = covariance(7, 7) = noise.sigma_pixel * noise.sigma_pixel;
  return covariance;
}

std::optional<Vector> ground_position(const Look& look, const Ground& ground, const Vector& error) {
  require_shapes(look);
  require(error.size() == look_dimension, "geolocation: an error has 8 numbers");
  CameraPose pose = look.pose.turned({error(3), error(4), error(5)});
  pose.position_m += Vector3(error(0), error(1), error(2));
  Vector pixel = look.pixel;
  pixel(0) += error(6);
  pixel(1) += error(7);
  const auto hit = meet(ground, ray_through(look.camera, pose, pixel));
  if (!hit) return std::nullopt;
  return level(hit->point_m);
}

// The point is o + t·d with nᵀ(point) constant to first order, n the normal of the ground, so that
// its change is (I − d·nᵀ/(nᵀd))·(change of o + t·change of d). What d changes along itself drops
// out; hence d = R·w with any length of w, at the depth |t·d| = depth·|w|.
std::optional<GroundDerivative> ground_derivative(const Look& look, const Ground& ground) {
  require_shapes(look);
  const auto hit = meet(ground, ray_through(look.camera, look.pose, look.pixel));
  if (!hit) return std::nullopt;
  const Vector3 w = sight_of(look.camera, look.pixel);
  const Matrix3& R = look.pose.axes;
  const Vector3 d = R * w;
  const double depth = hit->distance_m / std::sqrt(w.dot(w));
  const double fu = look.camera.focal_u, fv = look.camera.focal_v;

  Eigen::Matrix<double, 3, look_dimension> change;
  change.leftCols<3>() = Matrix3::Identity();
  change.middleCols<3>(3) = -depth * (R * cross_matrix(w));  // of the rotation e: R·(e × w)
  change.col(6) = depth / fu * R.col(0);
  change.col(7) = depth / fv * (R.col(1) - look.camera.skew / fu * R.col(0));

  const double descent = hit->normal.dot(d);
  Matrix jacobian(2, look_dimension);
  for (int k = 0; k < look_dimension; ++k) {
    const double rise = hit->normal.dot(change.col(k)) / descent;
    jacobian(0, k) = change(0, k) - d(0) * rise;
    jacobian(1, k) = change(1, k) - d(1) * rise;
  }
  return GroundDerivative{level(hit->point_m), jacobian};
}

std::optional<Moments> geolocate_linearised(const Look& look, const Ground& ground) {
  const auto at = ground_derivative(look, ground);
  if (!at) return std::nullopt;
  const Moments errors{Vector::Zero(look_dimension), look.covariance};
  return linearised(errors, at->position_m, at->jacobian);
}

std::optional<Moments> geolocate_unscented(const Look& look, const Ground& ground, double kappa) {
  const Moments errors{Vector::Zero(look_dimension), look.covariance};
  const auto out =
      unscented(errors, kappa, [&](const Vector& e) { return ground_position(look, ground, e); });
  if (!out) return std::nullopt;
  return out->y;
}

}  // namespace hearsay::gaussian
