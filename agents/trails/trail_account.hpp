// What is kept of the trips and trails of a team, and who keeps it: the witness of this process
// (agents/trails/trail_witness) or of another (agents/remote/remote_body). Robots by their number
// on the floor.
#pragma once

#include <cstddef>
#include <functional>
#include <span>

#include "filters/trails/store.hpp"
#include "sim/world/differential_drive.hpp"

namespace hearsay {

class TrailAccount {
 public:
  virtual ~TrailAccount() = default;
  /// How a robot spent a step.
  enum class Doing : std::uint8_t { following, exploring, searching, panicking, waiting };
  static constexpr int doings = 5;

  /// A trip begins: the robot sets off.
  virtual void sets_off(int robot) = 0;
  virtual void drove(int robot, double length_m, bool blocked, Doing doing, double dt_s) = 0;
  /// The trip ends, if one has begun: whether it had.
  virtual bool arrived(int robot, trails::EventId event) = 0;
  /// It dropped a crumb here; of what it told, or was silent about.
  virtual void dropped(int robot) = 0;
  virtual void told(int robot, std::span<const trails::Crumb> crumbs) = 0;
  virtual void gave_up(int robot) = 0;
  /// It learned crumbs from another robot.
  virtual void learned(int robot, trails::RobotId from,
                       std::span<const trails::Identity> crumbs) = 0;
  /// Whether all robots that are up have had a trip.
  virtual bool all_arrived() = 0;
};

/// What a robot knows of trails, for who looks into its mind.
class TrailMind {
 public:
  virtual ~TrailMind() = default;
  /// How many crumbs it knows, and what became of those it learned.
  virtual std::size_t crumbs_known() const = 0;
  virtual trails::TrailCounts crumbs_counted() const = 0;
  /// Calls `look` for all crumbs, in the order in which they were learned.
  virtual void each_crumb(const std::function<void(const trails::Crumb&)>& look) const = 0;
  /// Where it believes that it is.
  virtual drive::Pose believed_pose() const = 0;
};

}  // namespace hearsay
