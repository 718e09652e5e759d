// What robots that localize themselves tell one another, and how they take it in: covariance
// intersection keeps them consistent though nobody knows what their poses have in common.
// Carrillo-Arce, Nerurkar, Gordillo & Roumeliotis, Decentralized multi-robot cooperative
// localization using covariance intersection, IROS 2013; here with ranges and bearings, which do
// not show how a companion is turned, so that every message informs of two directions out of three.
#pragma once

#include "filters/gaussian/fusion.hpp"
#include "filters/localization/pose_filter.hpp"

namespace hearsay::localization {

/// A position in the plane: mean and covariance (2×2), m and m².
struct Place {
  Eigen::Vector2d mean;
  Eigen::Matrix2d covariance;
};

/// Where a companion is that a robot of this pose and covariance (3×3) saw, to first order.
Place place_of(const Pose& pose, const Eigen::Matrix3d& covariance, const RelativeSighting& seen);

/// What one robot makes of what another said.
enum class Taken {
  fused,
  skipped,       ///< the rule could not use it, or gave it no weight
  outside_gate,  ///< less likely than the gate permits
};

/// How a robot takes in information about itself.
struct Fusion {
  gaussian::Rule rule;  ///< one that fuses by weight and remembers nothing
  double gate;          ///< squared Mahalanobis distance (2 degrees of freedom), > 0
};

/// A companion says where this robot was `age_s` ago, `behind_m` from its present position in its
/// present frame. What odometry is off by since then is added to what the companion is unsure of,
/// to first order. `filter` has one robot.
Taken take_position(PoseFilter& filter, const Fusion& fusion, const Place& said,
                    const Eigen::Vector2d& behind_m, double age_s, const OdometryNoise& drift);

/// This robot sees a companion that is at `companion`, as far as it knows.
Taken take_sighting(PoseFilter& filter, const Fusion& fusion, const Place& companion,
                    const RelativeSighting& seen);

}  // namespace hearsay::localization
