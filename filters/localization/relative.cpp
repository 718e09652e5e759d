#include "filters/localization/relative.hpp"

#include <Eigen/Cholesky>
#include <optional>

#include "sim/math/functions.hpp"

namespace hearsay::localization {
namespace {

/// A measurement of the pose's error δ = x − mean, r = Hδ + v, v ~ N(0, R).
struct Linear {
  Eigen::Matrix<double, 2, 3> H;
  Eigen::Matrix2d R;
  Eigen::Vector2d r;
};

/// Both beliefs are about δ: the robot's own has mean 0, so that no heading is ever averaged.
Taken fuse(PoseFilter& filter, const Fusion& fusion, const Linear& told) {
  const Eigen::Matrix3d P = filter.covariance(0);
  const Eigen::LLT<Eigen::Matrix2d> innovation(told.H * P * told.H.transpose() + told.R);
  const Eigen::LLT<Eigen::Matrix2d> noise(told.R);
  if (innovation.info() != Eigen::Success || noise.info() != Eigen::Success) return Taken::skipped;
  if (told.r.dot(innovation.solve(told.r)) > fusion.gate) return Taken::outside_gate;
  const Eigen::LLT<Eigen::Matrix3d> own_root(P);
  if (own_root.info() != Eigen::Success) return Taken::skipped;
  gaussian::Belief own = gaussian::Belief::unknown(3), received = own;
  own.omega = own_root.solve(Eigen::Matrix3d::Identity());
  own.omega = (0.5 * (own.omega + own.omega.transpose())).eval();
  received.omega = told.H.transpose() * noise.solve(told.H);
  received.omega = (0.5 * (received.omega + received.omega.transpose())).eval();
  received.xi = told.H.transpose() * noise.solve(told.r);
  const gaussian::Coefficients k = gaussian::coefficients(fusion.rule, own, received);
  if (k.skipped != nullptr || k.received == 0.0) return Taken::skipped;
  own *= k.own;
  received *= k.received;
  own += received;
  const auto step = gaussian::state(own);
  const auto covariance = gaussian::covariance(own);
  if (!step || !covariance) return Taken::skipped;
  const Pose& at = filter.pose(0);
  filter.replace({at.x_m + (*step)(0), at.y_m + (*step)(1), at.heading_rad + (*step)(2)},
                 *covariance);
  return Taken::fused;
}

}  // namespace

Place place_of(const Pose& pose, const Eigen::Matrix3d& covariance, const RelativeSighting& seen) {
  const double direction = pose.heading_rad + seen.bearing_rad;
  const double c = math::cos(direction), s = math::sin(direction);
  Eigen::Matrix<double, 2, 3> by_pose;
  by_pose << 1.0, 0.0, -seen.range_m * s, 0.0, 1.0, seen.range_m * c;
  Eigen::Matrix2d by_seen;
  by_seen << c, -seen.range_m * s, s, seen.range_m * c;
  return {{pose.x_m + seen.range_m * c, pose.y_m + seen.range_m * s},
          by_pose * covariance * by_pose.transpose() + by_seen * noise(seen) * by_seen.transpose()};
}

// Position then: p + R(θ)b. Its noise since, for a drive straight ahead of length |b|: that of the
// speed, and that of the heading, whose random walk moves the far end by ∫ of it: σ²τ|b|²/3 across.
Taken take_position(PoseFilter& filter, const Fusion& fusion, const Place& said,
                    const Eigen::Vector2d& behind_m, double age_s, const OdometryNoise& drift) {
  const Pose& pose = filter.pose(0);
  const double c = math::cos(pose.heading_rad), s = math::sin(pose.heading_rad);
  Eigen::Matrix2d turn;
  turn << c, -s, s, c;
  const Eigen::Vector2d offset = turn * behind_m;
  Linear told;
  told.H << 1.0, 0.0, -offset.y(), 0.0, 1.0, offset.x();
  told.r = said.mean - (Eigen::Vector2d(pose.x_m, pose.y_m) + offset);
  const Eigen::Vector2d across(-offset.y(), offset.x());
  const double forward = drift.forward_m_per_sqrt_s * drift.forward_m_per_sqrt_s +
                         drift.sideways_m_per_sqrt_s * drift.sideways_m_per_sqrt_s;
  const double turning = drift.turn_rad_per_sqrt_s * drift.turn_rad_per_sqrt_s;
  told.R = said.covariance + forward * age_s * Eigen::Matrix2d::Identity() +
           (turning * age_s / 3.0) * across * across.transpose();
  return fuse(filter, fusion, told);
}

Taken take_sighting(PoseFilter& filter, const Fusion& fusion, const Place& companion,
                    const RelativeSighting& seen) {
  const std::optional<View> expected = view(filter.pose(0), companion.mean);
  if (!expected) return Taken::skipped;
  Linear told;
  told.H = expected->by_pose;
  told.R = noise(seen) + expected->by_place * companion.covariance * expected->by_place.transpose();
  told.r = innovation(seen, *expected);
  return fuse(filter, fusion, told);
}

}  // namespace hearsay::localization
