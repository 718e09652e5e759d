// Where a process of a fleet waits: for news from others, for a moment, for a signal.
#pragma once

#include <chrono>
#include <memory>

#include "net/live/port.hpp"

namespace hearsay::fleet {

using WallClock = std::chrono::steady_clock;
using WallTime = WallClock::time_point;

inline std::chrono::nanoseconds wall(double seconds) {
  return std::chrono::nanoseconds(static_cast<std::int64_t>(seconds * 1e9));
}

class Reactor {
 public:
  /// From here on SIGINT and SIGTERM do not end the process, but ask it to stop. `port` outlives
  /// this.
  explicit Reactor(live::Port& port);
  ~Reactor();

  /// Waits until readers of the port may have news, `until` has come or the process is asked to
  /// stop. @return whether there may be news.
  bool wait(WallTime until);
  /// It has been asked to stop.
  bool stopped() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hearsay::fleet
