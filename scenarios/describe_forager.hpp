// The part of describe.hpp about floors, and robots that go to and fro on them by trails.
#pragma once

#include <string>
#include <vector>

#include "filters/trails/parameters.hpp"
#include "scenarios/forager_spec.hpp"
#include "scenarios/reading.hpp"
#include "sim/world/collision.hpp"

namespace hearsay {

inline std::vector<std::string> trail_parameter_names() {
  std::vector<std::string> names;
  for (const auto& set : trails::parameter_sets()) names.emplace_back(set.name);
  return names;
}

template <class V>
void describe(V& v, PlanPlaceSpec& s) {
  v.field("name", s.name, anything(), "how tasks and robots call it");
  v.field("position_m", s.position_m, anything(),
          "2 coordinates, from the lower left corner of the plan; not in a wall");
}

template <class V>
void describe(V& v, BarrierSpec& s) {
  v.field("corner_m", s.corner_m, anything(), "a corner of the rectangle: 2 coordinates");
  v.field("opposite_m", s.opposite_m, anything(), "the corner opposite to it");
  v.field("from_s", s.from_s, time_span(true), "when it comes up");
  v.field("until_s", s.until_s, time_span(false), "when it goes down again; default: it stays");
}

template <class V>
void describe(V& v, PlanSpec& s) {
  v.field("file", s.file, anything(),
          "a drawing in text: # is wall, space and . are free, a letter is a place of that name; "
          "or, if it ends in .png, a bitmap; relative to the scenario file, or with --set as "
          "given");
  v.field("cell_m", s.cell_m, between(plan::cell_min_m, plan::cell_max_m),
          "side of a character or pixel");
  v.field("wall_below", s.wall_below, between(1, 255),
          "bitmaps: pixels of less luminance are wall; default 128");
  v.table("places", s.places, "places besides the letters of a drawing");
  v.table("barriers", s.barriers, "rectangles that are closed for a while");
}

template <class V>
void describe(V& v, SourceMoveSpec& s) {
  v.field("at_s", s.at_s, time_span(false), "when, later than the move before");
  v.field("place", s.place, anything(), "the place of the plan where the event is from then on");
}

template <class V>
void describe(V& v, SourceSpec& s) {
  v.field("name", s.name, anything(),
          "of the event; the place of the plan of that name is where it is at first");
  v.field("units", s.units, between(1, 1e9),
          "how many visits it bears, then nothing happens there any more; default: no limit");
  v.table("moves", s.moves, "when it goes to another place");
  v.field("event_radius_m", s.event_radius_m, greater_than_zero(),
          "who is so near has reached it; default 1");
}

template <class V>
void describe(V& v, RobotSpec& s) {
  v.field("start", s.start, anything(), "a place of the plan, or \"anywhere\"");
  v.field("scatter_m", s.scatter_m, between(0.0, 1e5),
          "it begins at most so far from its start, where there is room");
  v.field("heading_rad", s.heading_rad, between(-6.283185307179586, 6.283185307179586),
          "at first, counter-clockwise from x; default: at random");
  v.field("radius_m", s.radius_m, between(plan::radius_min_m, 1e3),
          "it is round; all robots of a run have the same radius");
  v.field("speed_m_per_s", s.speed_m_per_s, above_zero_to(1e3), "at most");
  v.field("turn_rad_per_s", s.turn_rad_per_s, above_zero_to(1e3), "at most");
  v.field("control_period_s", s.control_period_s, time_span(false),
          "how often it looks and steers; the same for all robots of a run");
  v.field("rays", s.rays, between(8, 4096), "of its scanner");
  v.field("view_rad", s.view_rad, above_zero_to(6.283185307179586),
          "of its scanner, half of it to either side");
  v.field("range_m", s.range_m, above_zero_to(1e5), "of its scanner");
  v.field("frame", s.frame, one_of({"own", "shared"}),
          "its odometry begins at the origin of a frame of its own, or with the true pose");
  v.field("forward_bias", s.forward_bias, between(0.0, 1.99),
          "E of Stage: odometry believes speeds to be 1 + b times themselves, b drawn once for a "
          "robot from ±E/2");
  v.field("turn_bias", s.turn_bias, between(0.0, 1.99), "the same of turns");
  v.field("forward_m_per_sqrt_m", s.forward_m_per_sqrt_m, between(0.0, 1e3),
          "random walk of odometry: standard deviation of the way after a metre");
  v.field("turn_rad_per_sqrt_m", s.turn_rad_per_sqrt_m, between(0.0, 1e3),
          "… of the heading after a metre");
  v.field("turn_rad_per_sqrt_rad", s.turn_rad_per_sqrt_rad, between(0.0, 1e3),
          "… of the heading after a turn of 1 rad");
  v.field("clock_offset_s", s.clock_offset_s, time_span(true),
          "each robot's clock is off by a draw from ± this");
}

template <class V>
void describe(V& v, TaskSpec& s) {
  v.field("events", s.events, anything(),
          "1 to 16 names of sources or places: it goes to them in turn, over and over");
  v.field("respawn", s.respawn, anything(), "after each event it is carried back to its start");
  v.field("wait_for_all", s.wait_for_all, anything(),
          "its first trip is without trails; then it waits until all robots that are up had one");
}

template <class V>
void describe_memory(V& v, TrailsSpec& s) {
  v.field("transform", s.transform, one_of({"pessimistic", "optimistic", "as-is"}),
          "what it does with crumbs from another's frame when fewer than two places are known to "
          "both: drop them, or move or copy them; \"as-is\": always copy them");
  v.field("scale", s.scale, anything(), "frames may differ in scale, too");
  v.field("relay", s.relay, anything(), "it passes on what others laid");
  v.field("crumbs_max", s.crumbs_max, between(1, 1e6), "in its memory; the oldest go first");
  v.field("packet_bytes_max", s.packet_bytes_max, between(128, 65000),
          "messages are cut into packets of at most so many bytes, without the radio's header");
}

template <class V>
void describe(V& v, TrailsSpec& s) {
  v.field("parameters", s.parameters, one_of(trail_parameter_names()),
          "a published set of the values below that are not given; of one that is about views its "
          "numbers count alone, not how it finds crumbs; thesis-2019-code has true positions: "
          "robot.frame = \"shared\", transform = \"as-is\"");
  v.field("navigation", s.navigation, one_of({"trails", "explore", "map"}),
          "by trails; as if it heard nothing; or by the shortest way, as if it knew the plan");
  v.field("exploration", s.exploration, one_of({"roam", "wall", "corridor"}),
          "without a trail: straight on and away from what is in the way, along walls, or in the "
          "middle of corridors");
  v.field("laying", s.laying, one_of({"at-once", "completed"}),
          "each crumb leads back to the last event, or, told at an event, to that");
  v.field("distance", s.distance, one_of({"time", "steps-without-turns"}),
          "what a crumb's distance to its event counts");
  v.field("sense_radius_m", s.sense_radius_m, above_zero_to(1e5),
          "crumbs so near are followed; default, if the set says nothing: 1");
  v.field("interval_s", s.interval_s, time_span(false),
          "time between crumbs; default, if the set says nothing: 1");
  v.field("trail_crumbs_max", s.trail_crumbs_max, between(1, 1e6),
          "\"completed\": a longer trail is abandoned; default, if the set says nothing: 500");
  v.field("age_max_s", s.age_max_s, time_span(false),
          "older crumbs vanish; default, if the set says nothing: never");
  v.field("life_arrivals", s.life_arrivals, between(1, 64),
          "crumbs vanish after so many arrivals at their event; default, if the set says nothing: "
          "never");
  v.field("trail_end_s", s.trail_end_s, between(0.0, 1e9),
          "with no more distance to the event, in the unit of distances, it leaves the trail; "
          "default, if the set says nothing: it follows on");
  v.field("trail_end", s.trail_end, one_of({"explore", "search", "none"}),
          "what it does then: explore, search around the trail's end, or follow on");
  v.field("random_chance", s.random_chance, between(0.0, 1.0),
          "of a random move in place of a crumb's, at first; default, whatever the set says: 0");
  v.field("random_falls_by", s.random_falls_by, between(0.0, 1.0),
          "how much less after each arrival; default, if the set says nothing: 0");
  v.field("lanes", s.lanes, one_of({"none", "so-lost", "highway"}),
          "how it keeps clear of those who come towards it");
  v.field("field_rad", s.field_rad, between(0.1, 6.283185307179586),
          "crumbs outside of so wide a field of view are not seen (Blinkered LOST); default: all "
          "are");
  describe_memory(v, s);
}

}  // namespace hearsay
