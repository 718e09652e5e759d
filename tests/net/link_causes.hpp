// Random causes that forbid links, and who may hear whom under them, by the plainest way to say it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "net/link_plan.hpp"

namespace hearsay {

/// A small generator of its own, so that tests need none of the library.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : state_(seed * 2 + 1) {}
  int below(int n) {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<int>((state_ >> 33) % static_cast<std::uint64_t>(n));
  }
  /// Few different instants, so that many coincide.
  Time instant(int last) { return Time::nanoseconds(below(last + 1)); }

 private:
  std::uint64_t state_;
};

inline Groups random_groups(int agents, Dice& dice) {
  Groups groups(static_cast<std::size_t>(1 + dice.below(4)));
  for (AgentId agent = 0; agent < agents; ++agent) {
    groups[static_cast<std::size_t>(dice.below(static_cast<int>(groups.size())))].push_back(agent);
  }
  return groups;
}

inline LinkCauses random_causes(int agents, int last, Dice& dice) {
  LinkCauses causes;
  const auto span = [&](Time& begin, Time& end) {
    begin = dice.instant(last);
    end = dice.below(5) == 0 ? Time::never() : begin + Duration::nanoseconds(1 + dice.below(last));
  };
  for (int i = dice.below(8); i > 0; --i) {
    auto& outage = causes.outages.emplace_back();
    outage.a = dice.below(agents);
    outage.b = dice.below(agents);
    span(outage.down, outage.up);
  }
  for (int i = dice.below(3); i > 0; --i) {
    auto& partition = causes.partitions.emplace_back();
    partition.groups = random_groups(agents, dice);
    span(partition.from, partition.until);
  }
  for (int i = dice.below(3); i > 0; --i) {
    auto& rotation = causes.rotations.emplace_back();
    rotation.groups = random_groups(agents, dice);
    const int period = 1 + dice.below(last / 3);
    rotation.period = Duration::nanoseconds(period);
    rotation.cut = Duration::nanoseconds(1 + dice.below(period));
    span(rotation.from, rotation.until);
    rotation.until = std::min(rotation.until, Time::nanoseconds(2 * last));
  }
  return causes;
}

inline std::size_t group_with(const Groups& groups, AgentId agent) {
  std::size_t g = 0;
  while (std::find(groups[g].begin(), groups[g].end(), agent) == groups[g].end()) ++g;
  return g;
}

/// False if any cause has the link between a and b down at `time`.
inline bool allowed(const LinkCauses& causes, AgentId a, AgentId b, Time time) {
  for (const LinkOutage& outage : causes.outages) {
    const bool this_link = (outage.a == a && outage.b == b) || (outage.a == b && outage.b == a);
    if (this_link && outage.down <= time && time < outage.up) return false;
  }
  for (const Partition& partition : causes.partitions) {
    if (time < partition.from || time >= partition.until) continue;
    if (group_with(partition.groups, a) != group_with(partition.groups, b)) return false;
  }
  for (const Rotation& rotation : causes.rotations) {
    if (time < rotation.from || time >= rotation.until) continue;
    const std::int64_t since = (time - rotation.from).nanoseconds();
    const std::int64_t period = rotation.period.nanoseconds();
    if (since % period >= rotation.cut.nanoseconds()) continue;
    const std::size_t turn = static_cast<std::size_t>(since / period) % rotation.groups.size();
    const bool a_out = group_with(rotation.groups, a) == turn;
    const bool b_out = group_with(rotation.groups, b) == turn;
    if (a_out != b_out) return false;
  }
  return true;
}

/// A contact trace of some pairs, sorted, each pair's rows alternating.
inline std::vector<LinkChange> random_trace(int agents, int last, Dice& dice) {
  std::vector<LinkChange> trace;
  for (AgentId a = 0; a < agents; ++a) {
    for (AgentId b = a + 1; b < agents; ++b) {
      std::vector<Time> times;
      for (int i = dice.below(7); i > 0; --i) times.push_back(dice.instant(last));
      std::sort(times.begin(), times.end());
      bool up = false;
      for (const Time time : times) trace.push_back({time, a, b, up = !up});
    }
  }
  std::stable_sort(trace.begin(), trace.end(),
                   [](const LinkChange& x, const LinkChange& y) { return x.time < y.time; });
  return trace;
}

/// True if the trace has the link between a and b up at `time`.
inline bool in_contact(const std::vector<LinkChange>& trace, AgentId a, AgentId b, Time time) {
  bool up = false;
  for (const LinkChange& change : trace) {
    const bool this_link = change.a == std::min(a, b) && change.b == std::max(a, b);
    if (this_link && change.time <= time) up = change.up;
  }
  return up;
}

}  // namespace hearsay
