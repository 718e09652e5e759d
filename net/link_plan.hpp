// When links are up: a graph of all links that ever are, and what changes in it over time.
//
// A link is up while nothing forbids it. What may forbid it: an outage of the link, a partition or
// a rotation that has its ends in different parts, and, where contacts were recorded, that there is
// no contact. Causes that overlap are counted, so a link comes back when the last one ends. Spans
// include their first instant and exclude their last.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "net/topology.hpp"
#include "sim/kernel/time.hpp"

namespace hearsay {

/// From `time` on, the link between a and b is up or down, both ways. a < b.
struct LinkChange {
  Time time;
  AgentId a = 0;
  AgentId b = 0;
  bool up = false;
  auto operator<=>(const LinkChange&) const = default;
};

struct LinkPlan {
  Topology topology;  ///< with every link that may be up
  /// Sorted by (time, a, b). Each link is up before its first change, which is down; a link that is
  /// not up at the start has that one at time 0. No two changes of a link say the same or are at
  /// one instant.
  std::vector<LinkChange> changes;
};

/// The link between two agents is down from `down` until `up`.
struct LinkOutage {
  AgentId a = 0;
  AgentId b = 0;
  Time down;                ///< ≥ 0
  Time up = Time::never();  ///< > down
};

/// Every agent stands in exactly one group.
using Groups = std::vector<std::vector<AgentId>>;

/// From `from` until `until` all links between different groups are down.
struct Partition {
  Groups groups;
  Time from;                   ///< ≥ 0
  Time until = Time::never();  ///< > from
};

/// Groups are cut off in turn. Period k begins at from + k·period; in its first `cut` all links
/// between group k mod m and the others are down (those among the other groups stay up).
struct Rotation {
  Groups groups;
  Duration period;  ///< > 0
  Duration cut;     ///< > 0, at most the period
  Time from;        ///< ≥ 0
  Time until;       ///< > from; what is still cut off then is so no more
};

struct LinkCauses {
  std::vector<LinkOutage> outages;
  std::vector<Partition> partitions;
  std::vector<Rotation> rotations;
};

/// Beginnings and ends of causes, counted for each link that they forbid.
inline constexpr std::size_t link_changes_max = 10'000'000;

/// The links of `topology`, each up but for `causes`. An outage of a link that is not in the graph
/// changes nothing: whether a graph drawn at random has it depends on the seed.
/// @throws InputError for an agent that is not there, groups that leave out an agent or name one
/// twice, a span that is empty or begins before 0, or more than link_changes_max changes.
LinkPlan plan_links(Topology topology, const LinkCauses& causes);

/// The links of a contact trace: up from a row `up` until the row `down` that follows, but for
/// `causes`. `trace` is sorted by time; each link's rows alternate, beginning with `up`.
/// @throws InputError as plan_links() does. BrokenInvariant if the trace is not as said.
LinkPlan plan_contacts(int agents, std::span<const LinkChange> trace, const LinkCauses& causes);

}  // namespace hearsay
