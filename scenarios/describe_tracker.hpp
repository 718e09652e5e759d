// The part of describe.hpp about agents that track.
#pragma once

#include <string>
#include <vector>

#include "filters/gaussian/fusion.hpp"
#include "scenarios/reading.hpp"
#include "scenarios/tracker_spec.hpp"

namespace hearsay {

/// The rules that a tracker can fuse by.
inline std::vector<std::string> tracker_fusion_names() {
  std::vector<std::string> names;
  for (const auto& rule : gaussian::rules()) {
    const bool fits =
        (rule.sends == gaussian::Sends::nothing || rule.sends == gaussian::Sends::belief) &&
        (rule.fuses == gaussian::Fuses::by_weight || rule.fuses == gaussian::Fuses::by_direction) &&
        rule.rule != gaussian::Rule::ci_fixed;  // trackers have no key for its weight
    if (fits && rule.memory == gaussian::Memory::nothing) names.emplace_back(rule.name);
  }
  return names;
}

template <class V>
void describe(V& v, TrackerSpec& s) {
  v.field("fusion", s.fusion, one_of(tracker_fusion_names()),
          "how a track that was heard is taken in");
  v.field("acceleration_psd_m2_per_s3", s.acceleration_psd_m2_per_s3, greater_than_zero(),
          "power spectral density of the white-noise acceleration it expects, an axis; default: "
          "targets stand still");
  v.field("birth_speed_sigma_m_per_s", s.birth_speed_sigma_m_per_s, greater_than_zero(),
          "standard deviation an axis of the velocity of what was seen only once");
  v.field("gate", s.gate, greater_than_zero(),
          "squared Mahalanobis distance within which plots, and tracks of others, may belong to a "
          "track");
  v.field("association", s.association, one_of({"nearest", "optimal"}),
          "the nearest pairs first, or all pairs together");
  v.field("confirm_hits", s.confirm_hits, between(1, 1000),
          "a track is confirmed by so many hits …");
  v.field("confirm_scans", s.confirm_scans, between(1, 1000),
          "… in its first so many scans, else it ends");
  v.field("misses_max", s.misses_max, between(1, 1e6),
          "a confirmed track ends when it was missed so often in a row");
  v.field("sigma_max_m", s.sigma_max_m, greater_than_zero(),
          "a track ends when the standard deviation an axis of its position is larger");
  v.field("tracks_max", s.tracks_max, between(1, 1e5), "no track begins beyond");
  v.field("apart_max", s.apart_max, between(1, 1e6),
          "a track of another agent is no longer this one after so many messages in a row outside "
          "the gate");
  v.field("trail_s", s.trail_s, time_span(false),
          "tracks are told of with the trajectory of their plots in so many seconds, and those of "
          "others compared by it, too; default: by their states alone");
}

template <class V>
void describe(V& v, TrackScoreSpec& s) {
  v.field("order", s.order, between(1, 100), "p of OSPA and GOSPA");
  v.field("cutoff_m", s.cutoff_m, greater_than_zero(),
          "c of both: what is farther from all targets is a false track");
}

}  // namespace hearsay
