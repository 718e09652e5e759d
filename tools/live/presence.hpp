// Whether somebody is gone for good.
#pragma once

#include <optional>

#include "tools/live/reactor.hpp"

namespace hearsay::fleet {

/// Where processors are busy, or this very process was stopped for a while, a sign of life may come
/// late: gone is who was seen without one for half a second on end.
class Presence {
 public:
  /// To be asked every now and then. `alive`: what DDS says.
  bool gone(bool alive) {
    const WallTime now = WallClock::now();
    if (alive) {
      absent_since_.reset();
    } else if (!absent_since_) {
      absent_since_ = now;
    }
    return absent_since_ && now - *absent_since_ >= wall(0.5);
  }

 private:
  std::optional<WallTime> absent_since_;
};

}  // namespace hearsay::fleet
