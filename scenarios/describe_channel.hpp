// What a scenario file may say of the channel and of failures; see describe.hpp.
#pragma once

#include "scenarios/channel_spec.hpp"
#include "scenarios/reading.hpp"

namespace hearsay {

inline Allowed decibels() { return between(-200.0, 200.0); }

template <class V>
void describe(V& v, LinkLossSpec& s) {
  v.field("from", s.from, anything(), "sender, by number or name");
  v.field("to", s.to, anything(), "receiver, by number or name");
  v.field("probability", s.probability, between(0.0, 1.0), "of losing a frame from it to there");
}

template <class V>
void describe(V& v, LossSpec& s) {
  v.field("model", s.model, one_of({"none", "bernoulli", "gilbert-elliott"}),
          "how packets get lost");
  v.field("probability", s.probability, between(0.0, 1.0),
          "of losing a frame on a link; \"gilbert-elliott\": on average over time");
  v.table("links", s.links, "\"bernoulli\": links with a probability of their own");
  v.field("mean_burst", s.mean_burst, between(1.0, 1e6),
          "\"gilbert-elliott\": mean stay in the bad state in packets, with probability");
  v.field("good_to_bad", s.good_to_bad, between(0.0, 1.0),
          "\"gilbert-elliott\": p a packet, instead of probability and mean_burst");
  v.field("bad_to_good", s.bad_to_good, above_zero_to(1.0),
          "\"gilbert-elliott\": r a packet, with good_to_bad");
  v.field("loss_good", s.loss_good, between(0.0, 1.0),
          "\"gilbert-elliott\": of a frame in the good state");
  v.field("loss_bad", s.loss_bad, between(0.0, 1.0),
          "\"gilbert-elliott\": of a frame in the bad state");
}

template <class V>
void describe(V& v, PropagationSpec& s) {
  v.field("model", s.model, one_of({"disk", "grey-zone", "log-distance"}),
          "how well a frame gets over a distance");
  v.field(
      "range_m", s.range_m, greater_than_zero(),
      "\"disk\", \"log-distance\": nobody hears beyond; default of \"log-distance\": where even "
      "a shadowing of 3 sigma leaves 8 bytes less than 1 % success");
  v.field("inner_m", s.inner_m, at_least(0.0), "\"grey-zone\": who is nearer hears everything");
  v.field("outer_m", s.outer_m, at_least(0.0),
          "\"grey-zone\": from here on nobody hears; in between the share falls linearly");
  v.field("exponent", s.exponent, between(1.0, 10.0), "\"log-distance\": of the path loss");
  v.field("reference_loss_db", s.reference_loss_db, decibels(),
          "\"log-distance\": path loss at reference_m");
  v.field("reference_m", s.reference_m, greater_than_zero(),
          "\"log-distance\": who is nearer is taken to be there");
  v.field("shadowing_sigma_db", s.shadowing_sigma_db, between(0.0, 30.0),
          "\"log-distance\": of what is fixed for a pair of agents");
  v.field("transmit_dbm", s.transmit_dbm, decibels(), "\"log-distance\": power of a transmitter");
  v.field("noise_dbm", s.noise_dbm, decibels(), "\"log-distance\": noise floor of a receiver");
}

template <class V>
void describe(V& v, JammerSpec& s) {
  v.field("position_m", s.position_m, anything(), "where it is: 2 coordinates");
  v.field("radius_m", s.radius_m, greater_than_zero(), "who is that near hears nothing");
  v.field("power_dbm", s.power_dbm, decibels(),
          "instead of radius_m, with \"log-distance\": noise that it sends");
  v.field("from_s", s.from_s, time_span(true), "first instant");
  v.field("until_s", s.until_s, time_span(false), "silent from then on; default: never");
  v.field("period_s", s.period_s, time_span(false),
          "on at its begin, with duty; default: always on");
  v.field("duty", s.duty, above_zero_to(1.0), "share of period_s in which it is on");
}

template <class V>
void describe(V& v, DropoutSpec& s) {
  v.field("agents", s.agents, anything(), "whom it befalls, by number or name; default: all");
  v.field("kind", s.kind, one_of({"die", "sleep", "reboot"}),
          "for good, back with its memory, or back as memory says");
  v.field("memory", s.memory, anything(), "\"reboot\": true if it remembers; default: it forgets");
  v.field("from_s", s.from_s, time_span(true), "begin of the outage");
  v.field("until_s", s.until_s, time_span(false), "\"sleep\", \"reboot\": end of the outage");
  v.field("mean_up_s", s.mean_up_s, time_span(false),
          "instead of from_s: mean of the exponential time before an outage");
  v.field("mean_down_s", s.mean_down_s, time_span(false),
          "\"sleep\", \"reboot\": mean of the exponential length of an outage");
  v.field("outages_max", s.outages_max, at_least(1),
          "with mean_down_s: at most so many an agent; default: no limit");
}

}  // namespace hearsay
