// What a localizer knows, and who hears of what it sees: the witness of its run, in this process
// (agents/pose_witness) or in another (agents/remote/remote_eyes).
#pragma once

#include <Eigen/Core>
#include <optional>

#include "filters/localization/pose_filter.hpp"
#include "sim/kernel/ids.hpp"

namespace hearsay {

struct PoseBelief {
  localization::Pose pose;
  Eigen::Matrix3d covariance;
};

class PoseMind {
 public:
  virtual ~PoseMind() = default;
  /// Its own, at present; nothing if nobody knows.
  virtual std::optional<PoseBelief> own_pose() = 0;
};

class SightingAccount {
 public:
  virtual ~SightingAccount() = default;
  /// An agent saw this now.
  virtual void saw_place(AgentId agent, const Eigen::Vector2d& place_m,
                         const localization::RelativeSighting& seen) = 0;
  virtual void saw_robot(AgentId agent, AgentId other,
                         const localization::RelativeSighting& seen) = 0;
};

}  // namespace hearsay
