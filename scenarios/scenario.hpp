// A scenario as typed data: one run's world, radio, agents and record. Units stand in the names.
// scenarios/schema.hpp says how each field is called in TOML and which values are allowed.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/explorer_spec.hpp"
#include "scenarios/forager_spec.hpp"
#include "scenarios/localizer_spec.hpp"
#include "scenarios/motion_spec.hpp"
#include "scenarios/radio_spec.hpp"
#include "scenarios/tracker_spec.hpp"

namespace hearsay {

struct TargetSpec {
  std::string name;  ///< default "target<i>"
  /// 2 coordinates; where it begins if it moves; none in a world with an area: anywhere in it
  std::optional<std::vector<double>> position_m;
  std::optional<MotionSpec> motion;  ///< none: it stands still
};

/// A recorded data set that takes the place of synthetic sensors.
struct LogSpec {
  std::string kind = "mrclam";   ///< UTIAS multi-robot data sets
  std::string directory;         ///< relative to the scenario file, or absolute
  double truth_gap_max_s = 0.5;  ///< measurements in wider gaps of the truth are skipped, > 0
  /// "landmarks", which stand still | "robots", which move: what estimators believe in
  std::string subjects = "landmarks";
};

struct WorldSpec {
  std::vector<TargetSpec> targets;  ///< empty with a log: see LogSpec::subjects
  /// > 0: agents look at targets and believe in them at multiples of this; none: targets stand
  /// still
  std::optional<double> step_s;
  std::optional<LogSpec> log;
  std::optional<AreaSpec> area;     ///< what explorers explore
  std::optional<PlanSpec> plan;     ///< the floor that foragers drive on
  std::vector<SourceSpec> sources;  ///< what there is at places of the plan
};

struct CircleSpec {
  std::vector<double> center_m = {0.0, 0.0};
  double radius_m = 1.0;  ///< > 0; agent k of n stands at angle 2πk/n
};

struct SensorSpec {
  /// "none" | "position" | "range-bearing" | "camera" | "scan" | "log"; of explorers
  /// "segmented-camera" | "presence"
  std::string kind = "none";
  double period_s = 1.0;                 ///< > 0
  double start_s = 0.0;                  ///< first look, ≥ 0
  std::optional<double> end_s;           ///< no look after; default: the end of the run
  std::optional<double> sigma_m;         ///< position, scan: same in every direction, > 0
  std::optional<double> sigma_along_m;   ///< position, scan: along the line of sight, …
  std::optional<double> sigma_across_m;  ///< … with across it; both instead of sigma_m
  std::optional<double> range_max_m;     ///< not log: what is farther away is not seen, > 0
  /// scan: of a target within range, 0 … 1; default 1
  std::optional<double> detection_probability;
  /// scan: mean number in each square kilometre within range, ≥ 0; default 0
  std::optional<double> false_alarms_per_km2;
  std::optional<std::string> detector;  ///< explorers: a name of grid::detectors(), or …
  std::optional<double> p_detect;       ///< … its probabilities, both in (0, 1)
  std::optional<double> p_false;
  std::optional<double> depression_rad;         ///< explorers: 0.01 … π/2; none: straight down
  std::optional<double> angle_max_rad;          ///< presence, which needs it: > 0, at most π
  std::optional<std::vector<double>> image_px;  ///< segmented-camera: none: 240, 320
  double sigma_range_m = 0.15;                  ///< log, range-bearing; > 0
  double sigma_bearing_rad = 0.08;              ///< log, range-bearing; > 0
  double sigma_heading_rad = 0.03;              ///< log, range-bearing: pose, ≥ 0
  double sigma_position_m = 0.05;               ///< the same and cameras: pose, per axis, ≥ 0
  double sigma_attitude_rad = 0.02;             ///< both cameras: pose, about each axis, ≥ 0
  double sigma_pixel = 1.0;                     ///< both cameras: per axis, > 0
  std::vector<double> focal_px = {347.881, 345.876};   ///< cameras: focal lengths, > 0
  std::vector<double> center_px = {119.512, 161.781};  ///< cameras: where the view's axis is
  std::string propagation = "unscented";               ///< camera: | "linearised" | "monte-carlo"
  std::optional<double> kappa;         ///< camera, "unscented": −7.5 … 100; default −5
  int draws = 1000;                    ///< camera, "monte-carlo": 2 … 16000
  std::optional<int> reference_draws;  ///< camera: 2 … 16000; none: looks are not compared
};

struct EstimatorSpec {
  /// "static-gaussian" | "moving-gaussian" | "trajectory-gaussian"
  std::string kind = "static-gaussian";
  std::string fusion = "none";  ///< a name of gaussian::rules()
  /// All but static-gaussian: needed, of the white-noise acceleration it expects, > 0
  std::optional<double> acceleration_psd_m2_per_s3;
  std::optional<double> window_s;  ///< trajectory-gaussian: T, a multiple of world.step_s
  std::optional<double> omega;     ///< "ci-fixed", which needs it: weight of its own belief, (0, 1]
  /// "hybrid-consensus" only: "nodes" | "one"; none: "nodes"
  std::optional<std::string> correction;
  bool operator==(const EstimatorSpec&) const = default;
};

struct TalkSpec {
  /// "periodic" | "on-update" | "event-triggered" | "adaptive" | "never"; of foragers, who know
  /// "periodic" and "never", too: "at-once" (each crumb as it is laid) | "at-event" (all news)
  std::string policy = "periodic";
  double period_s = 5.0;          ///< > 0
  std::string phase = "random";   ///< "random" | "staggered" | "together"
  std::optional<double> phase_s;  ///< this agent's own phase instead, in [0, period)
  /// "broadcast" | "acknowledged" | "store-and-forward" | "blackboard"
  std::string service = "broadcast";
  std::optional<double> divergence_nats;  ///< "event-triggered", which needs it: > 0
  std::string content = "belief";         ///< "belief" | "diagonal" | "quantised"
  std::optional<int> bits;                ///< "quantised": of an entry, 4 … 16; none: 8
  bool operator==(const TalkSpec&) const = default;
};

/// What a source sends.
struct TrafficSpec {
  std::string arrivals = "poisson";   ///< "periodic" | "poisson" | "saturated"
  std::optional<double> period_s;     ///< > 0, mean time between packets; not for "saturated"
  std::optional<double> phase_s;      ///< "periodic": the first, in [0, period); none: at random
  std::optional<int> packets_max;     ///< 1 … 1e9; none: no limit but the end of the run
  int bytes = 100;                    ///< of a packet, or their mean; 1 … 1e6
  std::string sizes = "fixed";        ///< "fixed" | "exponential"
  std::string service = "broadcast";  ///< "broadcast" | "unicast" | "acknowledged"
  std::optional<AgentRef> receiver;   ///< of the latter two, which need it
};

struct AgentSpec {
  std::string name;  ///< default "<kind><i>"; with count > 1 a number is appended
  /// "estimator" | "tracker" | "localizer" | "explorer" | "forager" | "source", or a program's own
  std::string kind = "estimator";
  int count = 1;                                  ///< 1 … 1e6
  std::optional<std::vector<double>> position_m;  ///< 2 coordinates
  std::optional<CircleSpec> circle;               ///< instead of position_m
  std::optional<MotionSpec> motion;               ///< none: it stands still
  SensorSpec sensor;
  EstimatorSpec estimator;
  TrackerSpec tracker;
  LocalizerSpec localizer;
  GridSpec grid;
  std::optional<ExplorationSpec> exploration;  ///< none: it goes as its motion says
  std::optional<RobotSpec> robot;              ///< of a forager, as the next two: needed
  std::optional<TaskSpec> task;
  std::optional<TrailsSpec> trails;
  TalkSpec talk;
  std::optional<TrafficSpec> traffic;        ///< of a source; none: it listens
  std::map<std::string, double> parameters;  ///< free, for agents of a user's program
};

/// When agents are to be asked whether they agree, as after a heal.
struct AgreementSpec {
  double from_s = 0.0;             ///< first sample, ≥ 0; agree_again_s is counted from here
  std::optional<double> within_m;  ///< > 0, must be given: estimates that near an axis agree
  double period_s = 1.0;           ///< > 0, between samples
};

struct RecordSpec {
  std::vector<std::string> series;  ///< names of metrics kept over time; empty: none
  double series_period_s = 1.0;     ///< > 0; samples at 0, period, 2·period, … and at the end
  TrackScoreSpec tracks;
  AlarmSpec alarms;
  std::optional<AgreementSpec> agreement;  ///< none: agree_again_s is not recorded
  std::string messages = "counts";         ///< "all" | "counts"
  std::string links = "on";                ///< "on" | "off"
  std::string ledger = "on";               ///< "on" | "off"
  std::string grids = "off";               ///< "on": all cells of all grids at the end
  std::string crumbs = "off";              ///< "on": an event for each crumb that foragers lay
};

struct Scenario {
  std::string file;                  ///< where it came from; not part of the scenario's content
  std::optional<double> duration_s;  ///< > 0; with a log the default is the log's span
  std::uint64_t seed = 1;
  std::uint64_t events_max = 100'000'000'000;
  WorldSpec world;
  RadioSpec radio;
  std::vector<AgentSpec> agents;  ///< at least one
  std::vector<DropoutSpec> dropouts;
  RecordSpec record;

  /// Number of agents: the sum of counts.
  int agent_count() const;
};

/// The name of every agent, by number: as given (with count > 1 and 0, 1, … behind it), else its
/// kind and number.
std::vector<std::string> agent_names(const Scenario& scenario);

/// Where every agent stands, by number, if the file says so.
std::vector<std::optional<std::array<double, 2>>> agent_positions(const Scenario& scenario);

}  // namespace hearsay
