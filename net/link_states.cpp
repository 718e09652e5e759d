#include "net/link_states.hpp"

#include "sim/kernel/error.hpp"

namespace hearsay {

LinkStates::LinkStates(const Topology& topology, std::span<const LinkChange> changes)
    : topology_(&topology), changes_(changes) {
  if (changes.empty()) return;
  up_.assign(topology.links(), 1);
  changed_.assign(topology.links(), Time::nanoseconds(INT64_MIN));
  advance(Time());
}

void LinkStates::advance(Time now) {
  require(now >= now_, "states of links cannot go back in time");
  now_ = now;
  for (; next_change() <= now && next_ < changes_.size(); ++next_) {
    const LinkChange& change = changes_[next_];
    const std::int64_t there = topology_->link(change.a, change.b);
    const std::int64_t back = topology_->link(change.b, change.a);
    require(there >= 0 && back >= 0, "a change of a link that is not in the topology");
    for (const std::int64_t link : {there, back}) {
      up_[static_cast<std::size_t>(link)] = change.up ? 1 : 0;
      changed_[static_cast<std::size_t>(link)] = change.time;
    }
  }
}

}  // namespace hearsay
