// A piece of a path: uniform straight motion between two instants.
//
// Paths are sequences of legs, so a position is exact at any time between events; nobody steps
// through time. Whoever moves things makes legs (sim/world/motion), whoever asks where they are
// (net/places, sensors) evaluates them.
#pragma once

#include <array>

#include "sim/kernel/time.hpp"

namespace hearsay {

using Point = std::array<double, 3>;  ///< x, y, z in m

struct Leg {
  Time begin;
  Time end = Time::never();  ///< the next leg begins here; ≥ begin
  Point from_m{};            ///< where it is at `begin`
  Point velocity_m_per_s{};  ///< (0, 0, 0): it stands still

  /// Where it is at `time`. Outside begin … end the motion is continued.
  Point at(Time time) const {
    const double t_s = (time - begin).seconds();
    return {from_m[0] + velocity_m_per_s[0] * t_s, from_m[1] + velocity_m_per_s[1] * t_s,
            from_m[2] + velocity_m_per_s[2] * t_s};
  }
};

inline double squared_distance_m2(const Point& p, const Point& q) {
  const double dx = q[0] - p[0], dy = q[1] - p[1], dz = q[2] - p[2];
  return dx * dx + dy * dy + dz * dz;
}

}  // namespace hearsay
