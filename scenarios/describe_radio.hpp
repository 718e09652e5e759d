// What [radio] of a scenario file may say; see describe.hpp.
#pragma once

#include "scenarios/describe_links.hpp"
#include "scenarios/radio_spec.hpp"
#include "scenarios/reading.hpp"

namespace hearsay {

template <class V>
void describe(V& v, LossSpec& s) {
  v.field("model", s.model, one_of({"none", "bernoulli"}), "how packets get lost");
  v.field("probability", s.probability, between(0.0, 1.0), "of losing a packet on a link");
}

template <class V>
void describe(V& v, RadioSpec& s) {
  v.field("topology", s.topology,
          one_of({"line", "ring", "star", "full", "binary-tree", "grid", "erdos-renyi",
                  "small-world", "random-geometric", "edges", "disk", "contacts"}),
          "who hears whom");
  v.field("edges", s.edges, anything(), "for \"edges\": pairs of agents, by number or name");
  v.field("range_m", s.range_m, at_least(0.0),
          "for \"disk\" and \"random-geometric\": who is nearer hears");
  v.field("columns", s.columns, at_least(1), "for \"grid\": agents in a row");
  v.field("link_probability", s.link_probability, between(0.0, 1.0),
          "for \"erdos-renyi\": of two agents' hearing each other");
  v.field("mean_degree", s.mean_degree, at_least(2),
          "for \"small-world\": neighbours of an agent on the ring, an even number");
  v.field("rewire_probability", s.rewire_probability, between(0.0, 1.0),
          "for \"small-world\": of a link of the ring to lead elsewhere");
  Allowed side = between(0.0, 1e12);
  side.above_low = true;
  v.field("side_m", s.side_m, side,
          "for \"random-geometric\": of the square in which agents stand at random");
  v.field(
      "contacts", s.contacts, anything(),
      "for \"contacts\": CSV file t_s,a,b,state with state up or down; relative to the scenario "
      "file, or with --set as given");
  v.table("outages", s.outages, "links that are down for a while");
  v.table("partitions", s.partitions, "times in which groups of agents do not hear one another");
  v.table("rotation", s.rotation, "groups of agents are cut off in turn");
  Allowed rate = greater_than_zero();
  rate.finest = 1e-3;
  v.field("rate_bps", s.rate_bps, rate, "bits a second of a transmitter");
  v.field("header_bytes", s.header_bytes, between(0, 65535), "added to each packet on the air");
  v.field("queue_packets_max", s.queue_packets_max, between(1, 1e6),
          "packets waiting or being sent at a transmitter");
  v.field("latency_s", s.latency_s, time_span(true), "from the last bit sent to arrival");
  v.field(
      "propagation_m_per_s", s.propagation_m_per_s, greater_than_zero(),
      "for \"disk\" and \"random-geometric\": arrival is later by distance / speed; default: by "
      "nothing");
  v.table("loss", s.loss, "how packets get lost");
}

}  // namespace hearsay
