// What the motions share: checks of options, places, straight legs.
#pragma once

#include <cstdint>

#include "sim/kernel/leg.hpp"
#include "sim/kernel/random.hpp"
#include "sim/kernel/time.hpp"
#include "sim/world/motion.hpp"

namespace hearsay::motion {

// Each throws InputError "<what> must be …, not <value>" unless it is.
void check_above_zero(double value, const char* what);
void check_between(double value, double low, double high, const char* what);
void check_pause(Duration pause, const char* what);
void check_point(const PlanePoint& point_m, const char* what);
void check_altitude(double altitude_m);
void check_area(const Rectangle& area);

inline Point at_altitude(const PlanePoint& p, double altitude_m) {
  return {p[0], p[1], altitude_m};
}

/// Drawn evenly: two words of the stream.
Point place_in(const Rectangle& area, double altitude_m, Stream& stream);

/// `span` ≥ 0 after `begin` ≥ 0, or never if that is beyond the last instant.
Time later(Time begin, Duration span);

/// From a point to another that is not the same.
Leg straight(Time begin, const Point& from_m, const Point& to_m, double speed_m_per_s);

/// Stands still.
inline Leg rest(Time begin, Time end, const Point& place_m) {
  return {.begin = begin, .end = end, .from_m = place_m};
}

}  // namespace hearsay::motion
