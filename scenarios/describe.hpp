// What a scenario file may say: one description of each struct, for every purpose.
//
// describe(visitor, struct) names each member once, with the values it may take and what it means.
// A visitor reads TOML into the members, lists the keys, or writes the members out:
//   visitor.field(key, member, allowed, meaning)   a value
//   visitor.table(key, member, meaning)            a struct, an optional one, or a vector of them
//   visitor.names()                                names that a program adds to what files may say
// Combinations of values are checked elsewhere (checks.cpp).
#pragma once

#include <span>
#include <string>
#include <vector>

#include "filters/gaussian/fusion.hpp"
#include "scenarios/describe_explorer.hpp"
#include "scenarios/describe_forager.hpp"
#include "scenarios/describe_localizer.hpp"
#include "scenarios/describe_motion.hpp"
#include "scenarios/describe_radio.hpp"
#include "scenarios/describe_tracker.hpp"
#include "scenarios/loader.hpp"
#include "scenarios/reading.hpp"
#include "scenarios/scenario.hpp"

namespace hearsay {

inline std::vector<std::string> fusion_names() {
  std::vector<std::string> names;
  for (const auto& rule : gaussian::rules()) names.emplace_back(rule.name);
  return names;
}

inline std::vector<std::string> service_names() {
  return {"broadcast", "acknowledged", "store-and-forward", "blackboard"};
}

template <class V>
void describe(V& v, TargetSpec& s) {
  v.field("name", s.name, anything(), "its name in records; default target<i>");
  v.field("position_m", s.position_m, anything(),
          "where it is, or begins: 2 coordinates; default in a world with an area: anywhere in it");
  v.table("motion", s.motion, "how it moves; default: it stands still");
}

template <class V>
void describe(V& v, LogSpec& s) {
  v.field("kind", s.kind, one_of({"mrclam"}), "format of the data set");
  v.field("directory", s.directory, anything(),
          "where the data set lies; relative to the scenario file, or with --set as given");
  v.field("truth_gap_max_s", s.truth_gap_max_s, time_span(false),
          "measurements in wider gaps of the truth are skipped and counted");
  v.field(
      "subjects", s.subjects, one_of({"landmarks", "robots"}),
      "what estimators believe in: what stands still, or each other, who move (then world.step_s "
      "is needed)");
}

template <class V>
void describe(V& v, WorldSpec& s) {
  v.table("targets", s.targets, "what there is to be found");
  v.field("step_s", s.step_s, time_span(false),
          "agents look at targets and believe in them at multiples of this; default: targets stand "
          "still");
  v.table("log", s.log, "a recorded data set instead of targets and synthetic sensors");
  v.table("area", s.area, "the cells that agents of kind explorer have grids of");
  v.table("plan", s.plan, "the floor that agents of kind forager drive on");
  v.table("sources", s.sources, "what foragers fetch or leave at places of the plan");
}

template <class V>
void describe(V& v, CircleSpec& s) {
  v.field("center_m", s.center_m, anything(), "2 coordinates");
  v.field("radius_m", s.radius_m, greater_than_zero(), "agent k of n stands at angle 2πk/n");
}

template <class V>
void describe(V& v, SensorSpec& s) {
  v.field("kind", s.kind,
          one_of({"none", "position", "range-bearing", "camera", "scan", "log", "segmented-camera",
                  "presence"}),
          "what is measured; of explorers \"segmented-camera\", an image whose pixels a detector "
          "judged, or \"presence\", whether something is in view at all");
  v.field("period_s", s.period_s, time_span(false), "time between looks");
  v.field("start_s", s.start_s, time_span(true), "first look");
  v.field("end_s", s.end_s, time_span(true), "no look after; default: the end of the run");
  v.field("sigma_m", s.sigma_m, greater_than_zero(), "position, scan: noise in every direction");
  v.field("sigma_along_m", s.sigma_along_m, greater_than_zero(),
          "position, scan: noise along the line of sight, instead of sigma_m");
  v.field("sigma_across_m", s.sigma_across_m, greater_than_zero(),
          "position, scan: noise across the line of sight, with sigma_along_m");
  v.field(
      "range_max_m", s.range_max_m, greater_than_zero(),
      "position, range-bearing, camera, scan: what is farther away in the plane is not seen; "
      "default: no limit. Of explorers: the range at which a look tells nothing any more; needed");
  v.field("detection_probability", s.detection_probability, between(0.0, 1.0),
          "scan: of a target within range; default 1");
  v.field("false_alarms_per_km2", s.false_alarms_per_km2, at_least(0.0),
          "scan: mean number of plots of nothing in each square kilometre within range; default 0");
  v.field("detector", s.detector, one_of(detector_names()),
          "segmented-camera, presence: a detector of known quality, instead of the next two");
  v.field("p_detect", s.p_detect, between(1e-6, 1.0 - 1e-6),
          "segmented-camera, presence: probability that it sees what is there, at distance 0");
  v.field("p_false", s.p_false, between(1e-6, 1.0 - 1e-6),
          "segmented-camera, presence: … and what is not");
  v.field("depression_rad", s.depression_rad, between(0.01, 1.5707963267948966),
          "segmented-camera, presence: how far below the horizon it looks; default straight down");
  v.field("angle_max_rad", s.angle_max_rad, above_zero_to(3.1415926535897931),
          "presence: half the opening angle of its view");
  v.field("image_px", s.image_px, greater_than_zero(),
          "segmented-camera: width and height; default 240, 320");
  v.field("sigma_range_m", s.sigma_range_m, greater_than_zero(),
          "log, range-bearing: noise of the range");
  v.field("sigma_bearing_rad", s.sigma_bearing_rad, greater_than_zero(),
          "log, range-bearing: noise of the bearing");
  v.field("sigma_heading_rad", s.sigma_heading_rad, at_least(0.0),
          "log, range-bearing: uncertainty of the own heading");
  v.field("sigma_position_m", s.sigma_position_m, at_least(0.0),
          "log, range-bearing, cameras: uncertainty of the own position, per axis");
  v.field("sigma_attitude_rad", s.sigma_attitude_rad, at_least(0.0),
          "cameras: uncertainty of the attitude, about each of its axes");
  v.field("sigma_pixel", s.sigma_pixel, greater_than_zero(),
          "cameras: noise of the pixel, per axis");
  v.field("focal_px", s.focal_px, greater_than_zero(),
          "cameras: focal lengths across and down the image");
  v.field("center_px", s.center_px, anything(), "cameras: pixel of the axis of view");
  v.field("propagation", s.propagation, one_of({"unscented", "linearised", "monte-carlo"}),
          "camera: how errors of pose and pixel become one on the ground");
  v.field("kappa", s.kappa, between(-7.5, 100.0),
          "camera, \"unscented\": spread of the sigma points; default -5, that is 3 - n");
  v.field("draws", s.draws, between(2, 16000), "camera, \"monte-carlo\": draws a look");
  v.field("reference_draws", s.reference_draws, between(2, 16000),
          "camera: draws of a reference that each look is compared with; default: none");
}

template <class V>
void describe(V& v, EstimatorSpec& s) {
  v.field(
      "kind", s.kind, one_of({"static-gaussian", "moving-gaussian", "trajectory-gaussian"}),
      "what a belief is about: states that stand still, states as they are now, or as they were "
      "during the last window_s");
  v.field("fusion", s.fusion, one_of(fusion_names()), "how a belief that was heard is taken in");
  v.field("acceleration_psd_m2_per_s3", s.acceleration_psd_m2_per_s3, greater_than_zero(),
          "all but static-gaussian: power spectral density of the white-noise acceleration it "
          "expects, an axis");
  v.field("window_s", s.window_s, time_span(false),
          "trajectory-gaussian: how far back it can be told news; default 20 steps");
  v.field("omega", s.omega, above_zero_to(1.0), "\"ci-fixed\": weight of the own belief");
  v.field("correction", s.correction, one_of({"nodes", "one"}),
          "\"hybrid-consensus\": how often what is fresh counts, as the mean over all agents is "
          "right (default) or once at the most");
}

template <class V>
void describe(V& v, TalkSpec& s) {
  v.field("policy", s.policy,
          one_of({"periodic", "on-update", "event-triggered", "adaptive", "never", "at-once",
                  "at-event"}),
          "at every period; at those before which it measured; at those at which it has news (not "
          "with trajectory-gaussian); less often while its radio is busy; never. Trackers, "
          "localizers and explorers: \"periodic\" and \"never\" alone. Foragers: these (what "
          "changed since, at every period), \"at-once\" (each crumb as it is laid), \"at-event\" "
          "(all news whenever an event is reached)");
  v.field("period_s", s.period_s, time_span(false), "time between sendings");
  v.field("phase", s.phase, one_of({"random", "staggered", "together"}),
          "first sending: at random, agent i of n at i·period/n, or all at once");
  v.field("phase_s", s.phase_s, time_span(true), "first sending of this agent, below the period");
  v.field("service", s.service, one_of(service_names()), "how what it says travels");
  v.field(
      "divergence_nats", s.divergence_nats, greater_than_zero(),
      "\"event-triggered\": how far its belief may be from what it last sent, predicted to now");
  v.field("content", s.content, one_of({"belief", "diagonal", "quantised"}),
          "what of a belief is said; the smaller ones claim less. Trajectories, trackers and "
          "localizers: \"belief\" alone");
  v.field("bits", s.bits, between(4, 16),
          "\"quantised\": of an entry of the covariance; default 8");
}

template <class V>
void describe(V& v, TrafficSpec& s) {
  v.field("arrivals", s.arrivals, one_of({"periodic", "poisson", "saturated"}),
          "when there is a packet; \"saturated\": always, the next waits while one is sent");
  v.field("period_s", s.period_s, time_span(false),
          "\"periodic\", \"poisson\": mean time between packets");
  v.field("phase_s", s.phase_s, time_span(true),
          "\"periodic\": the first packet, below the period; default: at random");
  v.field("packets_max", s.packets_max, between(1, 1e9),
          "then it is silent; default: no limit but the end of the run");
  v.field("bytes", s.bytes, between(1, 1e6), "of a packet without headers, or their mean");
  v.field("sizes", s.sizes, one_of({"fixed", "exponential"}),
          "whether all packets have one size, or how sizes differ");
  v.field("service", s.service, one_of({"broadcast", "unicast", "acknowledged"}),
          "to all who hear, to one receiver, or to it until it acknowledges");
  v.field("receiver", s.receiver, anything(),
          "\"unicast\", \"acknowledged\": to whom, by number or name");
}

template <class V>
void describe(V& v, AgentSpec& s) {
  v.field("name", s.name, anything(), "default <kind><i>; with count > 1 a number is appended");
  v.field("kind", s.kind, one_of(v.names().agent_kinds), "class of the agent");
  Allowed count = between(1, 1e6);
  count.note = "a scenario needs at least one agent";
  v.field("count", s.count, count, "how many such agents");
  v.field("position_m", s.position_m, anything(), "where it stands: 2 coordinates");
  v.table("circle", s.circle, "the entry's agents stand on a circle, instead of position_m");
  v.table("motion", s.motion, "how it moves; default: it stands still");
  v.table("sensor", s.sensor, "what it measures");
  v.table("estimator", s.estimator, "what it believes");
  v.table("tracker", s.tracker, "how an agent of kind tracker finds and keeps targets");
  v.table("localizer", s.localizer, "how a robot of kind localizer finds its own pose");
  v.table("grid", s.grid, "what an agent of kind explorer believes of the area");
  v.table("exploration", s.exploration,
          "where an explorer with motion.kind = \"steered\" goes; default: as its motion says");
  v.table("robot", s.robot, "the body of an agent of kind forager, and where it begins");
  v.table("task", s.task, "what a forager is after");
  v.table("trails", s.trails, "how a forager uses trails");
  v.table("talk", s.talk, "what it says when");
  v.table("traffic", s.traffic, "what a source sends; default: nothing, it listens");
  v.field("parameters", s.parameters, anything(), "numbers for agents of a user's program");
}

template <class V>
void describe(V& v, AgreementSpec& s) {
  v.field("from_s", s.from_s, time_span(true),
          "when the last cut heals: agree_again_s is counted from here");
  v.field("within_m", s.within_m, greater_than_zero(),
          "agents whose estimates are that near on every axis agree");
  v.field("period_s", s.period_s, time_span(false), "how often they are asked");
}

template <class V>
void describe(V& v, RecordSpec& s) {
  v.field("series", s.series, one_of_if_known(v.names().metrics), "metrics kept over time");
  v.field("series_period_s", s.series_period_s, time_span(false), "time between samples");
  v.table("tracks", s.tracks, "how tracks are compared with targets");
  v.table("alarms", s.alarms, "how alarms of explorers are judged");
  v.table("agreement", s.agreement, "how long it takes until all agree (agree_again_s)");
  v.field("messages", s.messages, one_of({"all", "counts"}), "each packet's fate, or sums only");
  v.field("links", s.links, one_of({"on", "off"}), "how many packets met which fate on each link");
  v.field("ledger", s.ledger, one_of({"on", "off"}), "how often measurements were counted");
  v.field("grids", s.grids, one_of({"on", "off"}), "every cell of every grid at the end");
  v.field("crumbs", s.crumbs, one_of({"on", "off"}),
          "an event for each crumb that a forager lays: where it truly was");
}

template <class V>
void describe(V& v, Scenario& s) {
  v.field("duration_s", s.duration_s, time_span(false),
          "how long the run lasts; default with a log: its span");
  v.field("seed", s.seed, at_least(0), "of every random draw");
  v.field("events_max", s.events_max, between(1, 1e11), "the run fails after so many events");
  v.table("world", s.world, "what is true");
  v.table("radio", s.radio, "how agents hear one another");
  v.table("agents", s.agents, "at least one [[agents]]");
  v.table("dropouts", s.dropouts, "agents that die, sleep or reboot");
  v.table("record", s.record, "what the run leaves behind");
}

}  // namespace hearsay
