// What [radio] of a scenario file may say; see describe.hpp.
#pragma once

#include "scenarios/describe_channel.hpp"
#include "scenarios/radio_spec.hpp"
#include "scenarios/reading.hpp"

namespace hearsay {

template <class V>
void describe(V& v, RadioSpec& s) {
  v.field("topology", s.topology,
          one_of({"line", "ring", "star", "full", "edges", "disk", "by-position"}),
          "who hears whom");
  v.field("edges", s.edges, anything(), "for \"edges\": pairs of agents, by number or name");
  v.field("range_m", s.range_m, at_least(0.0), "for \"disk\": who is nearer hears");
  Allowed rate = greater_than_zero();
  rate.finest = 1e-3;
  v.field("rate_bps", s.rate_bps, rate, "bits a second of a transmitter");
  v.field("header_bytes", s.header_bytes, between(0, 65535), "added to each packet on the air");
  v.field("queue_packets_max", s.queue_packets_max, between(1, 1e6),
          "packets waiting or being sent at a transmitter");
  v.field("latency_s", s.latency_s, time_span(true), "from the last bit sent to arrival");
  v.field("propagation_m_per_s", s.propagation_m_per_s, greater_than_zero(),
          "for \"disk\" and \"by-position\": arrival is later by distance / speed; default: by "
          "nothing");
  v.table("loss", s.loss, "how packets get lost");
  v.table("propagation", s.propagation,
          "for \"by-position\": how well a frame gets over a distance");
  v.table("jammers", s.jammers, "senders of noise");
}

}  // namespace hearsay
