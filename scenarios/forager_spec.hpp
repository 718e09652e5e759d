// What a scenario says about floors, and robots that go to and fro on them by trails.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/world/plan.hpp"

namespace hearsay {

/// A place of a plan besides the letters of a text drawing.
struct PlanPlaceSpec {
  std::string name;
  std::optional<std::vector<double>> position_m;  ///< 2 coordinates, must be given
};

/// A rectangle that is closed for a while.
struct BarrierSpec {
  std::optional<std::vector<double>> corner_m;    ///< must be given
  std::optional<std::vector<double>> opposite_m;  ///< must be given
  double from_s = 0.0;                            ///< ≥ 0
  std::optional<double> until_s;                  ///< > from_s; none: it stays
};

/// The floor that robots drive on.
struct PlanSpec {
  std::string file;               ///< a text drawing, or a bitmap if it ends in .png
  double cell_m = 0.5;            ///< side of a character or pixel
  std::optional<int> wall_below;  ///< bitmaps: luminance, 1 … 255; none: 128
  std::vector<PlanPlaceSpec> places;
  std::vector<BarrierSpec> barriers;
  std::shared_ptr<const plan::Plan> plan;  ///< what is in the file, with all places
};

/// What happens at a place of the plan: there is something to be fetched, or left.
struct SourceMoveSpec {
  std::optional<double> at_s;  ///< must be given, > 0, rising
  std::string place;           ///< of the plan: from then on it is there
};
struct SourceSpec {
  std::string name;          ///< of the event; a place of that name is where it is at first
  std::optional<int> units;  ///< 1 … 1e9; so many visits, then nothing happens there any more
  std::vector<SourceMoveSpec> moves;
  std::optional<double> event_radius_m;  ///< > 0; none: 1 m
};

/// The body of a robot: all robots of a scenario have the same radius.
struct RobotSpec {
  std::string start;                  ///< name of a place of the plan, or "anywhere"
  double scatter_m = 1.0;             ///< ≥ 0: at most so far from the start, where there is room
  std::optional<double> heading_rad;  ///< at first; none: at random
  double radius_m = 0.25;             ///< > 0
  double speed_m_per_s = 0.25;        ///< > 0
  double turn_rad_per_s = 1.0;        ///< > 0
  double control_period_s = 0.1;      ///< > 0
  int rays = 180;                     ///< of its scanner, 8 … 4096
  double view_rad = 6.283185307179586;  ///< of its scanner, > 0 … 2π
  double range_m = 5.0;                 ///< of its scanner, > 0
  std::string frame = "own";            ///< | "shared": its odometry begins with the true pose
  double forward_bias = 0.0;            ///< Stage's E, [0, 2)
  double turn_bias = 0.0;               ///< the same
  double forward_m_per_sqrt_m = 0.0;    ///< random walk, ≥ 0
  double turn_rad_per_sqrt_m = 0.0;
  double turn_rad_per_sqrt_rad = 0.0;
  double clock_offset_s = 0.0;  ///< ≥ 0: each robot's clock is off by a draw from ± this
};

/// What a robot is after: the events in turn, over and over.
struct TaskSpec {
  std::vector<std::string> events;  ///< names of sources or places, 1 … 16, none twice
  bool respawn = false;             ///< after each event it is carried back to its start
  bool wait_for_all = false;        ///< after its first arrival it waits until all had one
};

/// How a robot uses trails. What is not given is as its parameter set says, or as noted.
struct TrailsSpec {
  std::string parameters = "lost-2002";  ///< a name of trails::parameter_sets()
  std::string navigation = "trails";     ///< | "explore" | "map"
  std::string exploration = "roam";      ///< | "wall" | "corridor"
  std::optional<std::string> laying;     ///< "at-once" | "completed"
  std::optional<std::string> distance;   ///< "time" | "steps-without-turns"
  std::optional<double> sense_radius_m;  ///< r > 0; none: 1 m
  std::optional<double> interval_s;      ///< S > 0; none: 1 s
  std::optional<int> trail_crumbs_max;   ///< L ≥ 1, "completed" only; none: 500
  std::optional<double> age_max_s;       ///< a > 0; none: for ever
  std::optional<int> life_arrivals;      ///< 1 … 64; none: for ever
  std::optional<double> trail_end_s;     ///< ≥ 0, in the unit of d: with less it leaves the trail
  std::string trail_end = "explore";     ///< | "search" | "none"
  std::optional<double>
      random_chance;  ///< local search: at first, 0 … 1; none: 0, whatever the set says
  std::optional<double> random_falls_by;  ///< 0 … 1, with random_chance; none: 0
  std::string lanes = "none";             ///< | "so-lost" | "highway"
  std::optional<double> field_rad;        ///< Blinkered LOST: 0.1 … 2π
  std::string transform = "pessimistic";  ///< | "optimistic" | "as-is"
  bool scale = true;                      ///< frames may differ in scale
  bool relay = false;                     ///< it passes on what others laid
  int crumbs_max = 4096;                  ///< in its memory, ≥ 1
  int packet_bytes_max = 1400;            ///< 128 … 65000
};

}  // namespace hearsay
