// How far a robot has come since some instant, by its odometry alone.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "filters/localization/pose_filter.hpp"
#include "sim/kernel/time.hpp"

namespace hearsay {

/// Where a robot drove by its odometry alone, in a frame of its own that drifts: remembered for a
/// while, so that it can say how far it has come since.
class DeadReckoning {
 public:
  /// Keeps what is not older than `memory` > 0, in steps of `step` > 0.
  DeadReckoning(Duration memory, Duration step);

  /// It drove until `until`, not before the last.
  void drive(Time until, double forward_m_per_s, double turn_rad_per_s, double dt_s);

  /// How far behind the present position the one at `then` lies, in the present frame (x ahead, y
  /// to the left), m. Nothing if that is forgotten, or still to come.
  std::optional<Eigen::Vector2d> behind(Time then) const;

 private:
  struct Sample {
    Time time;
    localization::Pose pose;
  };
  const Sample& kept(std::size_t i) const { return ring_[(begin_ + i) % ring_.size()]; }

  Duration memory_, step_;
  std::vector<Sample> ring_;
  std::size_t begin_ = 0, count_ = 0;
  Sample now_{};
};

}  // namespace hearsay
