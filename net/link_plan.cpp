#include "net/link_plan.hpp"

#include <algorithm>
#include <string>
#include <tuple>
#include <utility>

#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

struct Pair {
  AgentId a;
  AgentId b;
};

// One cause more, or one less, that forbids a link.
struct Step {
  AgentId a;
  AgentId b;
  Time time;
  int causes;
};

class Planner {
 public:
  explicit Planner(Topology topology) : topology_(std::move(topology)) {}

  void add(const LinkCauses& causes) {
    for (const LinkOutage& outage : causes.outages) add(outage);
    for (const Partition& partition : causes.partitions) add(partition);
    for (const Rotation& rotation : causes.rotations) add(rotation);
  }
  void add(std::span<const LinkChange> trace);
  LinkPlan plan();

 private:
  void add(const LinkOutage& outage);
  void add(const Partition& partition);
  void add(const Rotation& rotation);
  void forbid(const Pair& link, Time from, Time until) {
    steps_.push_back({link.a, link.b, from, +1});
    if (until < Time::never()) steps_.push_back({link.a, link.b, until, -1});
  }
  void reserve(double steps);
  void check_agent(AgentId agent) const;
  std::vector<std::size_t> group_of_agents(const Groups& groups) const;
  template <typename Visit>
  void for_each_link(Visit visit) const;

  Topology topology_;
  std::vector<Step> steps_;
};

void check_span(Time from, Time until, const char* what) {
  if (from >= Time() && until > from) return;
  throw InputError(std::string(what) + " from " + std::to_string(from.seconds()) + " s until " +
                   std::to_string(until.seconds()) +
                   " s must begin at 0 or later, and end after it began");
}

void Planner::reserve(double steps) {
  if (static_cast<double>(steps_.size()) + steps > static_cast<double>(link_changes_max)) {
    throw InputError("links change too often: more than " + std::to_string(link_changes_max) +
                     " changes in a run");
  }
}

void Planner::check_agent(AgentId agent) const {
  if (agent >= 0 && agent < topology_.agents()) return;
  throw InputError("there is no agent " + std::to_string(agent) + " (agents are 0 … " +
                   std::to_string(topology_.agents() - 1) + ")");
}

template <typename Visit>
void Planner::for_each_link(Visit visit) const {
  for (AgentId a = 0; a < topology_.agents(); ++a) {
    for (const AgentId b : topology_.neighbours(a)) {
      if (a < b) visit(Pair{a, b});
    }
  }
}

std::vector<std::size_t> Planner::group_of_agents(const Groups& groups) const {
  const std::size_t nowhere = groups.size();
  std::vector<std::size_t> group_of(static_cast<std::size_t>(topology_.agents()), nowhere);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    for (const AgentId agent : groups[g]) {
      check_agent(agent);
      auto& group = group_of[static_cast<std::size_t>(agent)];
      if (group != nowhere) {
        throw InputError("agent " + std::to_string(agent) + " stands in groups twice");
      }
      group = g;
    }
  }
  const auto left_out = std::find(group_of.begin(), group_of.end(), nowhere);
  if (left_out != group_of.end()) {
    throw InputError("agent " + std::to_string(left_out - group_of.begin()) +
                     " stands in no group");
  }
  return group_of;
}

void Planner::add(const LinkOutage& outage) {
  check_agent(outage.a);
  check_agent(outage.b);
  check_span(outage.down, outage.up, "an outage");
  const auto [a, b] = std::minmax(outage.a, outage.b);
  if (topology_.link(a, b) < 0) return;
  reserve(2.0);
  forbid({a, b}, outage.down, outage.up);
}

void Planner::add(const Partition& partition) {
  check_span(partition.from, partition.until, "a partition");
  const std::vector<std::size_t> group_of = group_of_agents(partition.groups);
  std::vector<Pair> cut;
  for_each_link([&](const Pair& link) {
    const std::size_t a = group_of[static_cast<std::size_t>(link.a)];
    const std::size_t b = group_of[static_cast<std::size_t>(link.b)];
    if (a != b) cut.push_back(link);
  });
  reserve(2.0 * static_cast<double>(cut.size()));
  for (const Pair& link : cut) forbid(link, partition.from, partition.until);
}

void Planner::add(const Rotation& rotation) {
  check_span(rotation.from, rotation.until, "a rotation");
  if (rotation.cut <= Duration() || rotation.cut > rotation.period) {
    throw InputError("a rotation cuts off for more than 0 and at most its period of " +
                     std::to_string(rotation.period.seconds()) + " s, not " +
                     std::to_string(rotation.cut.seconds()) + " s");
  }
  const std::vector<std::size_t> group_of = group_of_agents(rotation.groups);
  std::vector<std::vector<Pair>> around(rotation.groups.size());  // links out of each group
  for_each_link([&](const Pair& link) {
    const std::size_t a = group_of[static_cast<std::size_t>(link.a)];
    const std::size_t b = group_of[static_cast<std::size_t>(link.b)];
    if (a == b) return;
    around[a].push_back(link);
    around[b].push_back(link);
  });
  const Duration span = rotation.until - rotation.from;
  const std::int64_t periods = (span - Duration::nanoseconds(1)) / rotation.period + 1;
  const auto groups = static_cast<std::int64_t>(around.size());
  for (std::int64_t g = 0; g < groups && g < periods; ++g) {
    const std::vector<Pair>& links = around[static_cast<std::size_t>(g)];
    const std::int64_t turns = (periods - 1 - g) / groups + 1;
    reserve(2.0 * static_cast<double>(links.size()) * static_cast<double>(turns));
    for (std::int64_t turn = 0; turn < turns && !links.empty(); ++turn) {
      const Time begin = rotation.from + rotation.period * (turn * groups + g);
      const bool whole = rotation.cut < rotation.until - begin;
      const Time end = whole ? begin + rotation.cut : rotation.until;
      for (const Pair& link : links) forbid(link, begin, end);
    }
  }
}

void Planner::add(std::span<const LinkChange> trace) {
  reserve(static_cast<double>(trace.size()) + static_cast<double>(topology_.links()) / 2.0);
  for_each_link([&](const Pair& link) { forbid(link, Time(), Time::never()); });
  for (const LinkChange& change : trace) {
    require(change.time >= Time(), "a contact before the start");
    steps_.push_back({change.a, change.b, change.time, change.up ? -1 : +1});
  }
}

LinkPlan Planner::plan() {
  const auto key = [](const Step& s) { return std::tuple(s.a, s.b, s.time); };
  std::sort(steps_.begin(), steps_.end(),
            [&](const Step& x, const Step& y) { return key(x) < key(y); });
  std::vector<LinkChange> changes;
  for (std::size_t i = 0; i < steps_.size();) {
    const auto [a, b, first] = key(steps_[i]);
    int causes = 0;
    bool up = true;
    // A link's steps; what happens at one instant is one step.
    while (i < steps_.size() && steps_[i].a == a && steps_[i].b == b) {
      const Time time = steps_[i].time;
      for (; i < steps_.size() && key(steps_[i]) == std::tuple(a, b, time); ++i) {
        causes += steps_[i].causes;
      }
      require(causes >= 0, "a link that nothing forbids was allowed once more");
      if (up == (causes == 0)) continue;
      up = !up;
      changes.push_back({time, a, b, up});
    }
  }
  std::sort(changes.begin(), changes.end());
  return {std::move(topology_), std::move(changes)};
}

}  // namespace

LinkPlan plan_links(Topology topology, const LinkCauses& causes) {
  Planner planner(std::move(topology));
  planner.add(causes);
  return planner.plan();
}

LinkPlan plan_contacts(int agents, std::span<const LinkChange> trace, const LinkCauses& causes) {
  std::vector<std::pair<AgentId, AgentId>> edges;
  for (const LinkChange& change : trace) {
    require(change.a < change.b, "a contact names its smaller agent first");
    edges.emplace_back(change.a, change.b);
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  Planner planner(Topology::edges(agents, edges));
  planner.add(trace);
  planner.add(causes);
  return planner.plan();
}

}  // namespace hearsay
