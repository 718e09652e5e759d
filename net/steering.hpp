// Who can be told to move elsewhere, as agents see it: the movement of this process
// (net/movement.hpp) or of another.
#pragma once

#include "sim/kernel/ids.hpp"
#include "sim/kernel/leg.hpp"

namespace hearsay {

class Steering {
 public:
  virtual ~Steering() = default;
  /// `agent` leaves its path for good: from now on it moves along `leg`, which begins now where it
  /// is, and stays where that ends, until it is steered again.
  /// @throws BrokenInvariant for a leg that begins at another time or place (by more than 1 mm), or
  /// that is over.
  virtual void steer(AgentId agent, const Leg& leg) = 0;
};

}  // namespace hearsay
