// Robots that drive on two wheels, and the odometry by which they think they know where they are.
//
// A drive without slip: within a step speeds are constant, so the way is an arc, and it is followed
// exactly. Odometry integrates the same speeds with errors: a bias in proportion to the motion,
// drawn once for a robot, as Stage has it, and a random walk that grows with the way. Behaviours
// see odometry alone; the true pose stays with the world.
#pragma once

#include <cstdint>

#include "sim/kernel/ids.hpp"

namespace hearsay::drive {

/// In the plane. Heading counter-clockwise from x, in (−π, π].
struct Pose {
  double x_m = 0.0, y_m = 0.0, heading_rad = 0.0;
};

/// What the wheels are told: along the heading, and counter-clockwise.
struct Command {
  double forward_m_per_s = 0.0, turn_rad_per_s = 0.0;
};

/// What they can do, ≥ 0.
struct Limits {
  double speed_max_m_per_s = 1.0;  ///< either way
  double turn_max_rad_per_s = 1.0;
  double acceleration_max_m_per_s2 = 0.0;  ///< 0: speeds change at once
  double turn_acceleration_max_rad_per_s2 = 0.0;
};

/// The command nearest to `wanted`, each number for itself, that can follow `before` within `dt_s`.
/// @throws BrokenInvariant for numbers that are not finite, negative limits or dt_s ≤ 0.
Command limited(const Command& wanted, const Command& before, const Limits& limits, double dt_s);

/// Where it is after `dt_s` ≥ 0 of constant speeds: the end of the arc.
Pose driven(const Pose& from, const Command& command, double dt_s);

/// Where `place` is, seen from `frame`: what a robot that believes itself there says of it.
Pose relative_to(const Pose& frame, const Pose& place);

/// Integrates commands with errors, in a frame of its own.
class Odometer {
 public:
  struct Options {
    Pose start;  ///< what it believes at first
    /// E of Stage: forward and turn speeds are believed to be 1 + b times themselves, b drawn once
    /// evenly from ±E/2, each in [0, 2). (A drive without slip has no other axis.)
    double forward_bias = 0.0, turn_bias = 0.0;
    /// Random walk, ≥ 0: standard deviations after 1 m of way or 1 rad of turning; variances add.
    double forward_m_per_sqrt_m = 0.0;
    double turn_rad_per_sqrt_m = 0.0, turn_rad_per_sqrt_rad = 0.0;
  };
  /// @throws BrokenInvariant outside these ranges.
  Odometer(const Options& options, std::uint64_t seed, AgentId agent);

  /// It drove so for `dt_s` ≥ 0.
  void drove(const Command& command, double dt_s);

  /// Somebody tells it where it is, in its own frame.
  void set(const Pose& pose) { pose_ = pose; }

  const Pose& pose() const { return pose_; }
  /// b of its forward and turn speeds.
  double forward_bias() const { return forward_bias_; }
  double turn_bias() const { return turn_bias_; }

 private:
  Options options_;
  std::uint64_t seed_;
  AgentId agent_;
  double forward_bias_, turn_bias_;
  Pose pose_;
  std::uint64_t steps_ = 0;
};

}  // namespace hearsay::drive
