// How things move: paths as sequences of legs, exact at any time and without a time step.
//
// A Motion hands out one leg after another. Each begins when and where the one before ends (the
// place to within rounding, some parts in 10^16 of a coordinate). No leg lasts 0 ns; an endless one
// is the last. Everything happens at one altitude, whatever the motion.
//
// Times are whole nanoseconds. A leg to a given point takes distance / speed to the nearest
// nanosecond, but at least one, and its velocity is such that it ends at the point: its speed is
// wrong by at most half a nanosecond over its length. One that would end beyond the last instant
// (292 years) is endless.
//
// The random ones draw from Stream::at(seed, purpose, agent, k) for their k-th trip or step alone,
// so paths of different agents are independent, and nothing that anybody asks or draws changes one.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "sim/kernel/ids.hpp"
#include "sim/kernel/leg.hpp"
#include "sim/kernel/time.hpp"

namespace hearsay {

/// One thing's path.
class Motion {
 public:
  virtual ~Motion() = default;
  /// The next leg; the first call gives the one that begins at the start of the run.
  /// @throws BrokenInvariant after an endless leg.
  virtual Leg next() = 0;
};

namespace motion {

using PlanePoint = std::array<double, 2>;  ///< x, y in m, each within ±1e12

/// An upright rectangle with sides above 0.
struct Rectangle {
  PlanePoint min_m{};
  PlanePoint max_m{};
};

/// Stays where it is.
struct Hover {
  PlanePoint position_m{};
  double altitude_m = 0.0;
};

/// What comes after the last point of a list.
enum class Repeat : std::uint8_t {
  once,            ///< nothing: it stays there
  loop,            ///< the first point, straight from the last
  back_and_forth,  ///< the points in reverse, then from the first on again, …
};

/// From point to point, in straight lines.
struct Waypoints {
  std::vector<PlanePoint> points_m;  ///< at least 1; to repeat, at least 2 different ones
  double speed_m_per_s = 1.0;        ///< > 0, finite
  Duration pause = {};               ///< 0 … 9e9 s, at each point, also the first
  Repeat repeat = Repeat::once;
  /// Where it begins, once: from there it goes to the first point. None: it begins at that.
  std::optional<PlanePoint> start_m = {};
  double altitude_m = 0.0;
};

/// Parallel lanes over a rectangle, mown in turn to and fro. Lanes run along x from side to side,
/// the first at the lowest y to the right. There are as few as leave no place of the rectangle
/// farther than half of `lane_spacing_m` from its lane; they are equally far apart, and the outer
/// ones half as far from the edge.
struct LawnMower {
  Rectangle area;
  double lane_spacing_m = 1.0;  ///< > 0; at most 1e6 lanes
  double speed_m_per_s = 1.0;   ///< > 0, finite
  Repeat repeat = Repeat::loop;
  std::optional<PlanePoint> start_m = {};  ///< as for Waypoints
  double altitude_m = 0.0;
};

/// Random waypoint: straight to a place drawn evenly from the rectangle, at a speed drawn evenly
/// from its interval, there a pause drawn evenly from its interval, and so on. It begins in its
/// stationary law, so that places, speeds and pauses have the same law at any time: W. Navidi,
/// T. Camp, Stationary distributions for the random waypoint mobility model, IEEE Trans. Mobile
/// Computing 3(1), 2004.
struct RandomWaypoint {
  Rectangle area;
  double speed_min_m_per_s = 1.0;  ///< > 0: at 0 there is no stationary law, all would slow down
  double speed_max_m_per_s = 1.0;  ///< ≥ speed_min_m_per_s, finite
  Duration pause_min = {};         ///< 0 … 9e9 s
  Duration pause_max = {};         ///< pause_min … 9e9 s
  double altitude_m = 0.0;
};

/// Gauss–Markov: speed s and direction d keep the values of their last update and are drawn anew
/// every `update_period` (T. Camp, J. Boleng, V. Davies, A survey of mobility models for ad hoc
/// network research, Wireless Comm. Mobile Computing 2(5), 2002, section 2.5):
///     s ← α s + (1 − α) mean_s + √(1 − α²) sigma_s w,    w ~ N(0, 1),
/// and likewise for d, or, without a mean direction,
///     d ← d + √(1 − α²) sigma_d w.
/// Both begin in their stationary law, d without a mean anywhere in the circle, and the place
/// anywhere in the area. A negative speed is a motion backwards. At a wall the motion is reflected,
/// and with it all that follows: the path is one in the open plane, seen as between mirrors. (The
/// turn is at the last whole nanosecond before the wall.) So walls leave no trace in the speed,
/// and without a mean direction places are even over the area at any time: P. Nain, D. Towsley,
/// B. Liu, Z. Liu, Properties of random direction models, INFOCOM 2005.
struct GaussMarkov {
  Rectangle area;  ///< no side crossed in less than 1 µs at 10 sigmas above the mean speed
  double speed_mean_m_per_s = 1.0;                ///< ≥ 0, finite
  double speed_sigma_m_per_s = 0.0;               ///< ≥ 0, finite
  std::optional<double> direction_mean_rad = {};  ///< from x towards y, within ±1e6
  double direction_sigma_rad = 0.0;               ///< ≥ 0, at most 1e6
  double alpha = 0.0;                             ///< memory, [0, 1)
  Duration update_period = Duration::nanoseconds(1'000'000'000);  ///< > 0
  double altitude_m = 0.0;
};

/// Where something was at some times: straight lines between, it stands still before and after.
struct TrackSample {
  Time time;  ///< ≥ 0, after the sample before
  PlanePoint position_m{};
};
struct Track {
  std::vector<TrackSample> samples;  ///< at least 1
  double altitude_m = 0.0;
};

// Each throws InputError for an option outside its range; the message says which.
std::unique_ptr<Motion> make(const Hover& options);
std::unique_ptr<Motion> make(const Waypoints& options);
std::unique_ptr<Motion> make(const LawnMower& options);
std::unique_ptr<Motion> make(const Track& options);
std::unique_ptr<Motion> make(const RandomWaypoint& options, std::uint64_t seed, AgentId agent);
std::unique_ptr<Motion> make(const GaussMarkov& options, std::uint64_t seed, AgentId agent);

/// A straight leg from a place to another, as above. @throws BrokenInvariant for a speed that is
/// not above 0 and finite, a place beyond ±1e12 m, or one and the same place.
Leg leg_to(Time begin, const Point& from_m, const Point& to_m, double speed_m_per_s);

/// Mean distance of two places drawn evenly from a rectangle with sides a, b > 0: 0.5214 for the
/// unit square (L. Santaló, Integral Geometry and Geometric Probability, 1976, section 4.2).
double mean_distance_m(double a_m, double b_m);

}  // namespace motion
}  // namespace hearsay
