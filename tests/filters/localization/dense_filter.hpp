// The extended Kalman filter of several planar poses once more, by the book: whole matrices,
// P ← FPFᵀ + Q, and Joseph's form of the update. With draws for its tests.
#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <vector>

#include "filters/localization/pose_filter.hpp"
#include "sim/kernel/random.hpp"

namespace hearsay::localization {

/// Sine and cosine know no turns: an angle brought to (−π, π].
inline double folded(double angle_rad) {
  return std::atan2(std::sin(angle_rad), std::cos(angle_rad));
}

struct DenseFilter {
  Eigen::VectorXd x;  // 3N
  Eigen::MatrixXd P;
  OdometryNoise odometry;

  explicit DenseFilter(const PoseFilter::Options& options) : odometry(options.odometry) {
    const auto n = static_cast<Eigen::Index>(3 * options.start.size());
    x.resize(n);
    Eigen::VectorXd sigmas(n);
    for (std::size_t i = 0; i < options.start.size(); ++i) {
      const Pose& pose = options.start[i];
      const auto at = static_cast<Eigen::Index>(3 * i);
      x.segment<3>(at) << pose.x_m, pose.y_m, pose.heading_rad;
      sigmas.segment<3>(at) << options.start_sigma_m, options.start_sigma_m,
          options.start_sigma_rad;
    }
    P = sigmas.cwiseAbs2().asDiagonal();
  }

  void drive(int robot, double forward, double turn, double dt_s) {
    const Eigen::Index r = 3 * robot;
    const double half = x(r + 2) + turn * dt_s / 2.0;
    const double c = std::cos(half), s = std::sin(half), way = forward * dt_s;
    x(r) += way * c;
    x(r + 1) += way * s;
    x(r + 2) += turn * dt_s;
    Eigen::MatrixXd F = Eigen::MatrixXd::Identity(x.size(), x.size());
    F(r, r + 2) = -way * s;
    F(r + 1, r + 2) = way * c;
    Eigen::MatrixXd G = Eigen::MatrixXd::Zero(x.size(), 3);
    G.block<3, 3>(r, 0) << c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0;
    const Eigen::Vector3d sigma(odometry.forward_m_per_sqrt_s, odometry.sideways_m_per_sqrt_s,
                                odometry.turn_rad_per_sqrt_s);
    P = (F * P * F.transpose() + G * (sigma.cwiseAbs2() * dt_s).asDiagonal() * G.transpose())
            .eval();
  }

  /// Any measurement: H (2×3N), noise R, innovation r.
  void update(const Eigen::MatrixXd& H, const Eigen::Matrix2d& R, const Eigen::Vector2d& r) {
    const Eigen::Matrix2d S = H * P * H.transpose() + R;
    const Eigen::MatrixXd K = P * H.transpose() * S.inverse();
    const Eigen::MatrixXd A = Eigen::MatrixXd::Identity(x.size(), x.size()) - K * H;
    x += K * r;
    P = (A * P * A.transpose() + K * R * K.transpose()).eval();
  }

  void saw(int robot, const Eigen::Vector2d& place, const RelativeSighting& seen, int other = -1) {
    const Eigen::Index r = 3 * robot;
    const double dx = place.x() - x(r), dy = place.y() - x(r + 1);
    const double q = dx * dx + dy * dy, range = std::sqrt(q);
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(2, x.size());
    H.block<2, 3>(0, r) << -dx / range, -dy / range, 0.0, dy / q, -dx / q, -1.0;
    if (other >= 0) H.block<2, 2>(0, 3 * other) << dx / range, dy / range, -dy / q, dx / q;
    Eigen::Matrix2d R = Eigen::Matrix2d::Zero();
    R(0, 0) = seen.sigma_range_m * seen.sigma_range_m;
    R(1, 1) = seen.sigma_bearing_rad * seen.sigma_bearing_rad;
    update(H, R,
           {seen.range_m - range, folded(seen.bearing_rad - (std::atan2(dy, dx) - x(r + 2)))});
  }
  void saw_robot(int robot, int other, const RelativeSighting& seen) {
    saw(robot, x.segment<2>(3 * other), seen, other);
  }
};

/// What a robot that truly is at `pose` sees of a place, with noise of these sigmas.
inline RelativeSighting sighting_of(const Pose& pose, const Eigen::Vector2d& place, double sigma_m,
                                    double sigma_rad, Stream& random) {
  const double dx = place.x() - pose.x_m, dy = place.y() - pose.y_m;
  return {std::hypot(dx, dy) + random.normal(0.0, sigma_m),
          folded(std::atan2(dy, dx) - pose.heading_rad + random.normal(0.0, sigma_rad)), sigma_m,
          sigma_rad};
}

/// A true step that odometry tells of with white noise, as the filter believes: the noise falls on
/// the direction half-way, and on the heading at the end.
inline Pose truly_driven(const Pose& from, double forward, double turn, double dt_s,
                         const OdometryNoise& noise, Stream& random) {
  const double half = from.heading_rad + turn * dt_s / 2.0, root = std::sqrt(dt_s);
  const double along = forward * dt_s + root * random.normal(0.0, noise.forward_m_per_sqrt_s);
  const double across = root * random.normal(0.0, noise.sideways_m_per_sqrt_s);
  const double c = std::cos(half), s = std::sin(half);
  return {from.x_m + along * c - across * s, from.y_m + along * s + across * c,
          folded(from.heading_rad + turn * dt_s +
                 root * random.normal(0.0, noise.turn_rad_per_sqrt_s))};
}

/// eᵀP⁻¹e of a pose.
inline double pose_nees(const Pose& estimate, const Eigen::Matrix3d& P, const Pose& truth) {
  const Eigen::Vector3d e(estimate.x_m - truth.x_m, estimate.y_m - truth.y_m,
                          folded(estimate.heading_rad - truth.heading_rad));
  return e.dot(P.inverse() * e);
}

}  // namespace hearsay::localization
