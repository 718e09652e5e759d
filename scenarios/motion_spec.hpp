// How an agent moves, as typed data. Units stand in the names.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/world/motion.hpp"

namespace hearsay {

/// The tracks of a file, by agent; empty for an agent of which it says nothing.
using Tracks = std::vector<std::vector<motion::TrackSample>>;

/// Only altitude_m belongs to every kind. What is marked with a kind is for that one alone.
struct MotionSpec {
  /// "hover" | "waypoints" | "lawn-mower" | "random-waypoint" | "gauss-markov" | "track" |
  /// "steered" | "white-noise-acceleration", of targets alone
  std::string kind = "hover";
  double altitude_m = 0.0;
  std::vector<std::array<double, 2>> points_m;  ///< waypoints: needed
  std::optional<double> speed_m_per_s;          ///< waypoints, lawn-mower: needed, > 0
  std::optional<double> pause_s;                ///< waypoints: at each point, ≥ 0; default 0
  /// "once" | "loop" | "back-and-forth"; waypoints: default once; lawn-mower: loop
  std::optional<std::string> repeat;
  /// Two opposite corners; lawn-mower, random-waypoint, gauss-markov: needed
  std::vector<std::array<double, 2>> area_m;
  std::optional<double> lane_spacing_m;       ///< lawn-mower: needed, > 0
  std::optional<double> speed_min_m_per_s;    ///< random-waypoint: needed, > 0
  std::optional<double> speed_max_m_per_s;    ///< random-waypoint: needed, ≥ speed_min_m_per_s
  std::optional<double> pause_min_s;          ///< random-waypoint, ≥ 0; default 0
  std::optional<double> pause_max_s;          ///< random-waypoint, ≥ pause_min_s; default 0
  std::optional<double> speed_mean_m_per_s;   ///< gauss-markov: needed, ≥ 0
  std::optional<double> speed_sigma_m_per_s;  ///< gauss-markov: needed, ≥ 0
  std::optional<double> direction_mean_rad;   ///< gauss-markov; default: none, turns at random
  std::optional<double> direction_sigma_rad;  ///< gauss-markov: needed, ≥ 0
  std::optional<double> alpha;                ///< gauss-markov: needed, [0, 1)
  std::optional<double> update_period_s;      ///< gauss-markov, > 0; default 1
  std::optional<std::vector<double>>
      velocity_m_per_s;  ///< white-noise-acceleration: at first; default (0, 0)
  /// white-noise-acceleration: needed, ≥ 0
  std::optional<double> acceleration_psd_m2_per_s3;
  std::optional<std::string> file;       ///< track: needed
  std::shared_ptr<const Tracks> tracks;  ///< what is in the file; the checks read it
};

}  // namespace hearsay
