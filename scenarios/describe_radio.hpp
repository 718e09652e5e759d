// What [radio] of a scenario file may say; see describe.hpp.
#pragma once

#include "scenarios/describe_channel.hpp"
#include "scenarios/describe_links.hpp"
#include "scenarios/radio_spec.hpp"
#include "scenarios/reading.hpp"

namespace hearsay {

template <class V>
void describe(V& v, JitterSpec& s) {
  v.field("law", s.law, one_of({"none", "uniform", "exponential"}),
          "of the latency beside latency_s");
  v.field("spread_s", s.spread_s, time_span(true), "uniform: the most; exponential: the mean");
  v.field("order", s.order, one_of({"reordering", "in-order"}),
          "whether a packet may overtake another on its link");
}

template <class V>
void describe(V& v, SharingSpec& s) {
  v.field("model", s.model, one_of({"none", "slotted-aloha", "carrier-sense", "tdma"}),
          "who may send when; \"none\": all at will, packets pass through one another");
  v.field("slot_s", s.slot_s, time_span(true), "length of a slot");
  v.field("send_probability", s.send_probability, between(0.001, 1.0),
          "slotted-aloha: of taking a slot");
  v.field("slots", s.slots, between(0, 1e6), "tdma: in a cycle; 0: one an agent");
  v.field("interframe_s", s.interframe_s, time_span(true),
          "carrier-sense: the air must be free so long before slots are counted");
  v.field("window_min", s.window_min, between(1, 65536),
          "carrier-sense: back-off is below this many slots");
  v.field("window_max", s.window_max, between(1, 65536),
          "carrier-sense: the window doubles with each repetition up to this");
  v.field("capture_db", s.capture_db, at_least(0.0),
          "by position: a frame this much stronger than another survives; default: none does");
}

template <class V>
void describe(V& v, AcknowledgementSpec& s) {
  v.field("bytes", s.bytes, between(1, 65535), "of an acknowledgement on the air");
  v.field("interframe_s", s.interframe_s, time_span(true), "from arrival to acknowledgement");
  v.field("attempts_max", s.attempts_max, between(1, 1000), "then the sender gives up");
}

template <class V>
void describe(V& v, GossipSpec& s) {
  v.field("summary_period_s", s.summary_period_s, time_span(false),
          "an agent tells so often what it holds, so that others send what it lacks");
  v.field("summary_bytes_max", s.summary_bytes_max, between(128, 65535),
          "of a summary; the rest is in the next one");
  v.field("answers_max", s.answers_max, between(1, 65535),
          "packets sent in answer to a summary; the rest is sent in answer to later ones");
  v.field("buffer_packets_max", s.buffer_packets_max, between(1, 1e6),
          "held by an agent; bundles: the oldest makes room, slots: there is none for a new one");
  v.field("hops_max", s.hops_max, between(1, 255),
          "\"store-and-forward\": from agent to agent at most so often");
  v.field("lifetime_s", s.lifetime_s, time_span(false),
          "\"store-and-forward\": who is older is not delivered or held; default: no end");
}

template <class V>
void describe(V& v, RadioSpec& s) {
  v.field("topology", s.topology,
          one_of({"line", "ring", "star", "full", "binary-tree", "grid", "erdos-renyi",
                  "small-world", "random-geometric", "edges", "contacts", "disk", "by-position"}),
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
  v.field("header_bytes", s.header_bytes, between(0, 65535), "added to each frame on the air");
  v.field("mtu_bytes", s.mtu_bytes, between(1, 1e9),
          "the most of a packet that a frame takes; default: a packet is one frame");
  v.field("queue_packets_max", s.queue_packets_max, between(1, 1e6),
          "packets waiting or being sent at a transmitter");
  v.field("queue_bytes_max", s.queue_bytes_max, between(1, 1e9),
          "bytes, with headers, waiting or being sent at a transmitter; default: any");
  v.field("queue_policy", s.queue_policy, one_of({"drop-new", "drop-oldest", "replace"}),
          "what a full queue drops; \"replace\": news of a thing takes the place of older news");
  v.field("queue_wait_max_s", s.queue_wait_max_s, time_span(false),
          "who has waited longer is not sent; default: nobody");
  v.field("half_duplex", s.half_duplex, one_of({"on", "off"}),
          "whether who sends is deaf; default: on if the channel is shared");
  v.table("sharing", s.sharing, "how radios share the channel");
  v.table("acknowledgement", s.acknowledgement, "for packets that are to be acknowledged");
  v.table("gossip", s.gossip, "for the services \"store-and-forward\" and \"blackboard\"");
  v.field("latency_s", s.latency_s, time_span(true), "from the last bit sent to arrival");
  v.field("propagation_m_per_s", s.propagation_m_per_s, greater_than_zero(),
          "where links have lengths: arrival is later by length / speed; default: by nothing");
  v.table("jitter", s.jitter, "latency that differs from packet to packet");
  v.table("loss", s.loss, "how packets get lost");
  v.table("propagation", s.propagation,
          "for \"by-position\": how well a frame gets over a distance");
  v.table("jammers", s.jammers, "senders of noise");
}

}  // namespace hearsay
