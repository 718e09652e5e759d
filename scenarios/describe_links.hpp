// What a scenario file may say of when links are up; see describe.hpp.
#pragma once

#include "scenarios/link_spec.hpp"
#include "scenarios/reading.hpp"

namespace hearsay {

template <class V>
void describe(V& v, OutageSpec& s) {
  v.field("links", s.links, anything(), "pairs of agents, by number or name");
  v.field("down_s", s.down_s, time_span(true), "from when on these links are down");
  v.field("up_s", s.up_s, time_span(false), "when they are up again; default: never");
}

template <class V>
void describe(V& v, PartitionSpec& s) {
  v.field("groups", s.groups, anything(), "each agent in one group, by number or name");
  v.field("from_s", s.from_s, time_span(true), "from when on groups do not hear one another");
  v.field("until_s", s.until_s, time_span(false), "when it heals; default: never");
}

template <class V>
void describe(V& v, RotationSpec& s) {
  v.field("groups", s.groups, anything(), "each agent in one group, by number or name");
  v.field("period_s", s.period_s, time_span(false),
          "in period k group k mod m is cut off from the others, which hear one another");
  v.field("cut_s", s.cut_s, time_span(false),
          "only in so much of each period; default: in all of it");
  v.field("from_s", s.from_s, time_span(true), "begin of period 0");
  v.field("until_s", s.until_s, time_span(false),
          "nobody is cut off from then on; default: duration_s");
}

}  // namespace hearsay
