// Where robots are and which way they face: the extended Kalman filter of planar poses that move by
// odometry and see places whose position is known, or each other. Thrun, Burgard & Fox,
// Probabilistic Robotics, 2005, chapters 5–7.
//
// With one robot it is what a robot alone knows of itself; with several, and every sighting between
// them, the central filter of cooperative localization (Roumeliotis & Bekey, Distributed multirobot
// localization, IEEE Trans. Robotics and Automation 18(5), 2002). What robots tell one another is
// fused in filters/localization/relative.hpp.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "filters/gaussian/belief.hpp"

namespace hearsay::localization {

using gaussian::Pose;

/// Standard deviations of white noise on what odometry says, for a second of driving: variances
/// grow with time, however finely it is cut.
struct OdometryNoise {
  double forward_m_per_sqrt_s = 0.02;  ///< along the heading, ≥ 0
  double sideways_m_per_sqrt_s = 0.0;  ///< across it, ≥ 0
  double turn_rad_per_sqrt_s = 0.05;   ///< of the heading, > 0
};

/// Range > 0 and bearing from the heading, counterclockwise; and their noise.
struct RelativeSighting {
  double range_m, bearing_rad;
  double sigma_range_m, sigma_bearing_rad;  ///< > 0
};

/// What became of a sighting.
enum class Use {
  used,
  outside_gate,  ///< less likely than the gate permits: left out
  no_direction,  ///< what is seen stands where the robot is thought to be
};

class PoseFilter {
 public:
  struct Options {
    std::vector<Pose> start;        ///< of each robot, at least one
    double start_sigma_m = 0.05;    ///< an axis, > 0
    double start_sigma_rad = 0.02;  ///< > 0
    OdometryNoise odometry;
    /// Squared Mahalanobis distance (2 degrees of freedom) beyond which a sighting is an outlier, >
    /// 0
    double gate = 13.8;
  };
  /// @throws BrokenInvariant outside these ranges.
  explicit PoseFilter(const Options& options);

  /// `robot` drove for `dt_s` > 0 at these velocities: forward, and of the heading.
  void drive(int robot, double forward_m_per_s, double turn_rad_per_s, double dt_s);

  /// `robot` saw something at a known place.
  Use saw_place(int robot, const Eigen::Vector2d& place_m, const RelativeSighting& seen);
  /// `robot` saw another of this filter.
  Use saw_robot(int robot, int other, const RelativeSighting& seen);

  int robots() const { return static_cast<int>(poses_.size()); }
  const Pose& pose(int robot) const { return poses_[static_cast<std::size_t>(robot)]; }
  /// Of (x, y, heading), m² and rad².
  Eigen::Matrix3d covariance(int robot) const { return P_.block<3, 3>(3 * robot, 3 * robot); }

  /// Of the only robot: another mean and covariance, as fusion gives them.
  /// @throws BrokenInvariant with several.
  void replace(const Pose& pose, const Eigen::Matrix3d& covariance);

 private:
  using Rows = Eigen::Matrix<double, 2, Eigen::Dynamic>;
  Use update(const Eigen::Vector2d& innovation, const RelativeSighting& seen);

  Options options_;
  std::vector<Pose> poses_;
  Eigen::MatrixXd P_;  // 3N×3N, over the errors of all poses
  Rows H_, W_;         // of the update being made
  Eigen::VectorXd step_;
};

/// (range, bearing) of a place from a pose, and how they change with the pose (2×3) and with the
/// place (2×2). Nothing within 1 mm of the pose.
struct View {
  Eigen::Vector2d value;
  Eigen::Matrix<double, 2, 3> by_pose;
  Eigen::Matrix2d by_place;
};
std::optional<View> view(const Pose& pose, const Eigen::Vector2d& place_m);

/// What was seen less what a view says: the angle wrapped.
Eigen::Vector2d innovation(const RelativeSighting& seen, const View& expected);

/// Noise of a sighting (2×2).
Eigen::Matrix2d noise(const RelativeSighting& seen);

/// One step of odometry: the pose after `dt_s`, by the heading half-way.
Pose driven(const Pose& from, double forward_m_per_s, double turn_rad_per_s, double dt_s);

}  // namespace hearsay::localization
