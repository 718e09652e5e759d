// What trails are made of: events, places and crumbs, wherever a position is something of a
// localization-space (space.hpp).
//
// Vaughan, Støy, Sukhatme & Matarić, "LOST: localization-space trails for robot teams", IEEE
// Transactions on Robotics and Automation 18(5), 2002; Shamshirdar 2019, section 4.2.2.
#pragma once

#include <compare>
#include <cstdint>
#include <limits>

namespace hearsay::trails {

/// An event is an occurrence that matters to the task, at a fixed place: the goal was reached,
/// something was picked up. Robots know events by number; names are the user's.
using EventId = std::uint32_t;
inline constexpr EventId no_event = std::numeric_limits<EventId>::max();

using RobotId = std::uint32_t;
inline constexpr RobotId no_robot = std::numeric_limits<RobotId>::max();

/// Which crumb, or which occurrence of an event: the robot that it comes from, how often that robot
/// had started anew, and a number that the robot gave once only. It stays the same however often
/// the thing is heard, by whatever way.
struct Identity {
  RobotId robot = 0;
  std::uint32_t incarnation = 0, number = 0;
  friend auto operator<=>(const Identity&, const Identity&) = default;
};

/// Gives a robot's numbers.
class Numbering {
 public:
  explicit Numbering(RobotId robot, std::uint32_t incarnation = 0) : next_{robot, incarnation, 0} {}
  Identity take() {
    const Identity taken = next_;
    ++next_.number;
    return taken;
  }

 private:
  Identity next_;
};

/// Where an event happened, and when it was last seen to happen there.
template <typename P>
struct PlaceOf {
  EventId event = no_event;
  P position{};
  double time_s = 0.0;
  Identity identity;  ///< of this occurrence
  friend bool operator==(const PlaceOf&, const PlaceOf&) = default;
};

/// A waypoint of a trail to the place of an event.
template <typename P>
struct CrumbOf {
  EventId event = no_event;  ///< whose place the crumb refers to
  EventId goal = no_event;   ///< what the robot that laid it was after, if it says so (SO-LOST)
  P position{};
  float distance_s = 0.0F;  ///< d ≥ 0: from here to the place, as time on the way; not a length
  double created_s = 0.0;   ///< t: when it was laid
  Identity identity;
  friend bool operator==(const CrumbOf&, const CrumbOf&) = default;
};

/// The order in which crumbs grow old: by t, then by identity. No two are equal in it.
struct Age {
  double created_s = -std::numeric_limits<double>::infinity();
  Identity identity;
  friend auto operator<=>(const Age&, const Age&) = default;
};
template <typename P>
Age age_of(const CrumbOf<P>& crumb) {
  return {crumb.created_s, crumb.identity};
}

/// The order in which crumbs are followed: the least d first; of equals the younger.
template <typename P>
bool follows_before(const CrumbOf<P>& a, const CrumbOf<P>& b) {
  if (a.distance_s != b.distance_s) return a.distance_s < b.distance_s;
  if (a.created_s != b.created_s) return a.created_s > b.created_s;
  return a.identity < b.identity;
}

}  // namespace hearsay::trails
