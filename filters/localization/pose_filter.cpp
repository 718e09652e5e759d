#include "filters/localization/pose_filter.hpp"

#include <Eigen/Cholesky>
#include <cmath>

#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"

namespace hearsay::localization {
namespace {

constexpr double nearest_m = 1e-3;

bool positive(double value) { return value > 0.0 && std::isfinite(value); }

double square(double value) { return value * value; }

}  // namespace

PoseFilter::PoseFilter(const Options& options) : options_(options), poses_(options.start) {
  const OdometryNoise& drift = options.odometry;
  require(!poses_.empty(), "a pose filter needs a robot");
  require(positive(options.start_sigma_m) && positive(options.start_sigma_rad) &&
              positive(drift.turn_rad_per_sqrt_s) && drift.forward_m_per_sqrt_s >= 0.0 &&
              drift.sideways_m_per_sqrt_s >= 0.0 && positive(options.gate),
          "a pose filter's standard deviations and gate must be positive");
  const auto n = static_cast<Eigen::Index>(3 * poses_.size());
  P_ = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    P_(i, i) = square(i % 3 == 2 ? options.start_sigma_rad : options.start_sigma_m);
  }
  H_ = Rows::Zero(2, n);
  W_ = Rows::Zero(2, n);
}

Pose driven(const Pose& from, double forward_m_per_s, double turn_rad_per_s, double dt_s) {
  const double half = from.heading_rad + 0.5 * turn_rad_per_s * dt_s;
  const double way = forward_m_per_s * dt_s;
  return {from.x_m + way * math::cos(half), from.y_m + way * math::sin(half),
          math::wrap_angle(from.heading_rad + turn_rad_per_s * dt_s)};
}

// With F = I + f e_θᵀ of the robot's own block, f = (−Δy, Δx, 0): P ← FPFᵀ + Q row by row, column
// by column, so that a step of one robot costs O(N), not O(N³).
void PoseFilter::drive(int robot, double forward_m_per_s, double turn_rad_per_s, double dt_s) {
  Pose& pose = poses_[static_cast<std::size_t>(robot)];
  const Pose after = driven(pose, forward_m_per_s, turn_rad_per_s, dt_s);
  const double dx = after.x_m - pose.x_m, dy = after.y_m - pose.y_m;
  const double half = pose.heading_rad + 0.5 * turn_rad_per_s * dt_s;
  pose = after;
  const Eigen::Index r = 3 * robot;
  for (Eigen::Index j = 0; j < P_.cols(); ++j) {
    const double heading = P_(r + 2, j);
    P_(r, j) -= dy * heading;
    P_(r + 1, j) += dx * heading;
  }
  for (Eigen::Index i = 0; i < P_.rows(); ++i) {
    const double heading = P_(i, r + 2);
    P_(i, r) -= dy * heading;
    P_(i, r + 1) += dx * heading;
  }
  const OdometryNoise& drift = options_.odometry;
  const double along = square(drift.forward_m_per_sqrt_s) * dt_s;
  const double across = square(drift.sideways_m_per_sqrt_s) * dt_s;
  const double c = math::cos(half), s = math::sin(half);
  P_(r, r) += along * c * c + across * s * s;
  P_(r + 1, r + 1) += along * s * s + across * c * c;
  P_(r, r + 1) += (along - across) * c * s;
  P_(r + 1, r) = P_(r, r + 1);
  P_(r + 2, r + 2) += square(drift.turn_rad_per_sqrt_s) * dt_s;
}

Use PoseFilter::saw_place(int robot, const Eigen::Vector2d& place_m, const RelativeSighting& seen) {
  const std::optional<View> expected = view(pose(robot), place_m);
  if (!expected) return Use::no_direction;
  H_.setZero();
  H_.middleCols<3>(3 * robot) = expected->by_pose;
  return update(innovation(seen, *expected), seen);
}

Use PoseFilter::saw_robot(int robot, int other, const RelativeSighting& seen) {
  const Pose& there = pose(other);
  const std::optional<View> expected = view(pose(robot), {there.x_m, there.y_m});
  if (!expected) return Use::no_direction;
  H_.setZero();
  H_.middleCols<3>(3 * robot) = expected->by_pose;
  H_.middleCols<2>(3 * other) = expected->by_place;
  return update(innovation(seen, *expected), seen);
}

// P ← P − WᵀW with W = L⁻¹HP of S = LLᵀ: symmetric to the last bit. Written as K S Kᵀ the rounding
// of S, which is not quite symmetric, would feed on itself.
Use PoseFilter::update(const Eigen::Vector2d& innovation, const RelativeSighting& seen) {
  W_ = H_.lazyProduct(P_);
  Eigen::Matrix2d S = noise(seen);
  S += W_.lazyProduct(H_.transpose());
  const Eigen::LLT<Eigen::Matrix2d> cholesky(S);
  require(cholesky.info() == Eigen::Success, "pose filter: the innovation's covariance is none");
  const Eigen::Vector2d whitened = cholesky.matrixL().solve(innovation);
  if (whitened.squaredNorm() > options_.gate) return Use::outside_gate;
  cholesky.matrixL().solveInPlace(W_);
  step_ = W_.transpose().lazyProduct(whitened);
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(3 * i);
    poses_[i].x_m += step_(at);
    poses_[i].y_m += step_(at + 1);
    poses_[i].heading_rad = math::wrap_angle(poses_[i].heading_rad + step_(at + 2));
  }
  P_ -= W_.transpose().lazyProduct(W_);
  return Use::used;
}

void PoseFilter::replace(const Pose& pose, const Eigen::Matrix3d& covariance) {
  require(robots() == 1, "only the pose of a robot alone can be replaced");
  poses_.front() = {pose.x_m, pose.y_m, math::wrap_angle(pose.heading_rad)};
  P_ = covariance;
}

std::optional<View> view(const Pose& pose, const Eigen::Vector2d& place_m) {
  const double dx = place_m.x() - pose.x_m, dy = place_m.y() - pose.y_m;
  const double range = math::hypot(dx, dy);
  if (!(range > nearest_m)) return std::nullopt;
  const double c = dx / range, s = dy / range;
  View view;
  view.value << range, math::wrap_angle(math::atan2(dy, dx) - pose.heading_rad);
  view.by_place << c, s, -s / range, c / range;
  view.by_pose << -c, -s, 0.0, s / range, -c / range, -1.0;
  return view;
}

Eigen::Vector2d innovation(const RelativeSighting& seen, const View& expected) {
  return {seen.range_m - expected.value.x(),
          math::wrap_angle(seen.bearing_rad - expected.value.y())};
}

Eigen::Matrix2d noise(const RelativeSighting& seen) {
  Eigen::Matrix2d S = Eigen::Matrix2d::Zero();
  S(0, 0) = square(seen.sigma_range_m);
  S(1, 1) = square(seen.sigma_bearing_rad);
  return S;
}

}  // namespace hearsay::localization
