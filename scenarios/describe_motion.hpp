// What agents.motion and world.targets.motion of a scenario file may say; see describe.hpp.
#pragma once

#include "scenarios/motion_spec.hpp"
#include "scenarios/reading.hpp"

namespace hearsay {

template <class V>
void describe(V& v, MotionSpec& s) {
  const Allowed coordinate = between(-1e12, 1e12);
  v.field("kind", s.kind,
          one_of({"hover", "waypoints", "lawn-mower", "random-waypoint", "gauss-markov", "track",
                  "steered", "white-noise-acceleration"}),
          "how it moves; \"track\" and \"steered\", as the agent itself decides, are for agents, "
          "\"white-noise-acceleration\" for targets");
  v.field("altitude_m", s.altitude_m, coordinate, "z, always the same");
  v.field("points_m", s.points_m, coordinate, "waypoints: from one to the next");
  v.field("speed_m_per_s", s.speed_m_per_s, greater_than_zero(), "waypoints, lawn-mower");
  v.field("pause_s", s.pause_s, time_span(true), "waypoints: at each point; default 0");
  v.field("repeat", s.repeat, one_of({"once", "loop", "back-and-forth"}),
          "waypoints, lawn-mower: what comes after the last point; default once, loop");
  v.field("area_m", s.area_m, coordinate,
          "lawn-mower, random-waypoint, gauss-markov: two opposite corners of a rectangle");
  v.field("lane_spacing_m", s.lane_spacing_m, greater_than_zero(),
          "lawn-mower: lanes run along x, at most this far apart");
  v.field("speed_min_m_per_s", s.speed_min_m_per_s, greater_than_zero(),
          "random-waypoint: of a trip, drawn evenly");
  v.field("speed_max_m_per_s", s.speed_max_m_per_s, greater_than_zero(), "random-waypoint");
  v.field("pause_min_s", s.pause_min_s, time_span(true),
          "random-waypoint: after a trip, drawn evenly; default 0");
  v.field("pause_max_s", s.pause_max_s, time_span(true), "random-waypoint; default 0");
  v.field("speed_mean_m_per_s", s.speed_mean_m_per_s, at_least(0.0), "gauss-markov");
  v.field("speed_sigma_m_per_s", s.speed_sigma_m_per_s, at_least(0.0), "gauss-markov");
  v.field("direction_mean_rad", s.direction_mean_rad, between(-1e6, 1e6),
          "gauss-markov: from x towards y; default: none, it turns at random");
  v.field("direction_sigma_rad", s.direction_sigma_rad, between(0.0, 1e6), "gauss-markov");
  v.field("alpha", s.alpha, between(0.0, 1.0),
          "gauss-markov: correlation of one update with the next, below 1");
  v.field("update_period_s", s.update_period_s, time_span(false), "gauss-markov; default 1");
  v.field("velocity_m_per_s", s.velocity_m_per_s, coordinate,
          "white-noise-acceleration: along x and y, at first; default 0, 0");
  v.field("acceleration_psd_m2_per_s3", s.acceleration_psd_m2_per_s3, at_least(0.0),
          "white-noise-acceleration: power spectral density, an axis");
  v.field("file", s.file, anything(),
          "track: CSV with t_s,agent,x_m,y_m; relative to the scenario file, or with --set as "
          "given");
}

}  // namespace hearsay
