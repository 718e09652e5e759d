// The part of describe.hpp about robots that localize themselves.
#pragma once

#include <string>
#include <vector>

#include "filters/gaussian/fusion.hpp"
#include "scenarios/localizer_spec.hpp"
#include "scenarios/reading.hpp"

namespace hearsay {

/// The rules by which a localizer can take in what it is told.
inline std::vector<std::string> localizer_fusion_names() {
  std::vector<std::string> names;
  for (const auto& rule : gaussian::rules()) {
    const bool fits =
        (rule.sends == gaussian::Sends::nothing || rule.sends == gaussian::Sends::belief) &&
        rule.fuses == gaussian::Fuses::by_weight && rule.memory == gaussian::Memory::nothing &&
        rule.rule != gaussian::Rule::ci_fixed &&    // there is no key for its weight
        rule.rule != gaussian::Rule::most_certain;  // a message never tells the whole pose
    if (fits) names.emplace_back(rule.name);
  }
  return names;
}

template <class V>
void describe(V& v, LocalizerSpec& s) {
  v.field("fusion", s.fusion, one_of(localizer_fusion_names()),
          "how what companions say of its position is taken in");
  v.field("landmarks_known", s.landmarks_known, between(0, 1e6),
          "how many landmarks it knows, the first of the log; default: all");
  v.field("start_sigma_m", s.start_sigma_m, between(1e-6, 1e6),
          "standard deviation of its first position, an axis");
  v.field("start_sigma_rad", s.start_sigma_rad, between(1e-6, 1e3),
          "standard deviation of its first heading");
  v.field(
      "forward_m_per_sqrt_s", s.forward_m_per_sqrt_s, at_least(0.0),
      "odometry: standard deviation along the heading after a second; it grows with the root of "
      "time");
  v.field("sideways_m_per_sqrt_s", s.sideways_m_per_sqrt_s, at_least(0.0),
          "odometry: standard deviation across the heading after a second");
  v.field("turn_rad_per_sqrt_s", s.turn_rad_per_sqrt_s, between(1e-6, 1e3),
          "odometry: standard deviation of the heading after a second");
  v.field("gate", s.gate, greater_than_zero(),
          "squared Mahalanobis distance beyond which what was seen or heard is left out");
  v.field("companion_speed_m_per_s", s.companion_speed_m_per_s, at_least(0.0),
          "how fast a companion may have gone from where it said it was, a standard deviation an "
          "axis");
  v.field("memory_s", s.memory_s, time_span(false), "how old may be what it is told of itself");
}

}  // namespace hearsay
