// Ports in a test: fleets that no other test has, and waiting for what Cyclone's threads do.
#pragma once

#include <poll.h>
#include <unistd.h>

#include <string>

#include "net/live/port.hpp"

namespace hearsay::live {

/// For what is sure to come: only a failing test waits so long.
inline constexpr int wait_max_ms = 20000;

inline std::string own_fleet(const std::string& name) {
  return name + "-" + std::to_string(getpid());
}

/// Until `done`, looked at whenever the port wakes.
template <class F>
bool wait(Port& port, F&& done) {
  constexpr int step_ms = 20;  // what one port waits for may wake another
  for (int waited_ms = 0; waited_ms < wait_max_ms; waited_ms += step_ms) {
    port.drain();
    if (done()) return true;
    pollfd ear{.fd = port.wake_fd(), .events = POLLIN, .revents = 0};
    if (poll(&ear, 1, step_ms) == 1) waited_ms -= step_ms;
  }
  return done();
}

}  // namespace hearsay::live
