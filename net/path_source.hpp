// Where legs of agents' paths come from.
#pragma once

#include "sim/kernel/ids.hpp"
#include "sim/kernel/leg.hpp"
#include "sim/kernel/time.hpp"

namespace hearsay {

/// Knows how agents move.
class PathSource {
 public:
  virtual ~PathSource() = default;
  /// The next leg of `agent`, which begins where and when the one before it ends; the first begins
  /// when the simulation stands at `now` or earlier. Not asked for after an endless leg.
  virtual Leg next(AgentId agent, Time now) = 0;
};

}  // namespace hearsay
