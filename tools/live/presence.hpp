// Whether somebody is gone for good.
#pragma once

#include <optional>

#include "tools/live/reactor.hpp"

namespace hearsay::fleet {

/// Until agents give up their world, and a world in lockstep an agent. An agent that is given up by
/// mistake can join again; who gives up its world is lost.
inline constexpr double world_grace_s = 8.0, agent_grace_s = 3.0;
/// Until a world in real time gives up an agent, for which it does not wait.
inline constexpr double call_grace_s = 0.5;

/// Where processors are busy, or this very process was stopped for a while, a sign of life may come
/// late: gone is who was seen without one for so long on end.
class Presence {
 public:
  /// `grace_s`: after DDS's own lease of a second.
  explicit Presence(double grace_s) : grace_s_(grace_s) {}
  /// To be asked every now and then. `alive`: what DDS says.
  bool gone(bool alive) {
    const WallTime now = WallClock::now();
    if (alive) {
      absent_since_.reset();
    } else if (!absent_since_) {
      absent_since_ = now;
    }
    return absent_since_ && now - *absent_since_ >= wall(grace_s_);
  }

 private:
  double grace_s_;
  std::optional<WallTime> absent_since_;
};

}  // namespace hearsay::fleet
