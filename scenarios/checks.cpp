#include "scenarios/checks.hpp"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/names.hpp"
#include "scenarios/reading.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

// Where `path` is written, or the innermost table around it that is in the file.
const TomlNode& locate(const TomlNode& root, const KeyPath& path) {
  if (!path.parent) return root;
  const TomlNode& around = locate(root, *path.parent);
  if (path.key.empty()) {
    const bool inside = path.index < around.children.size();
    return inside ? around.children[path.index] : around;
  }
  const TomlNode* entry = around.find(path.key);
  return entry ? *entry : around;
}

std::vector<std::size_t> sorted_by_name(const std::vector<std::string>& names) {
  std::vector<std::size_t> order(names.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    const int compared = names[a].compare(names[b]);
    return compared != 0 ? compared < 0 : a < b;
  });
  return order;
}

// The first one whose name an earlier one has, too.
std::optional<std::size_t> first_duplicate(const std::vector<std::string>& names,
                                           const std::vector<std::size_t>& order) {
  std::optional<std::size_t> first;
  for (std::size_t i = 1; i < order.size(); ++i) {
    const bool same = names[order[i - 1]] == names[order[i]];
    if (same && (!first || order[i] < *first)) first = order[i];
  }
  return first;
}

class Checker {
 public:
  Checker(const TomlNode& root, Scenario& scenario) : root_(root), s_(scenario) {}

  void all() {
    check_agents();
    check_world();
    for (std::size_t i = 0; i < s_.agents.size(); ++i) {
      check_agent(s_.agents[i], agents_[i]);
    }
    check_radio();
  }

 private:
  void check_agents();
  void check_agent_names();
  void check_world();
  void check_targets();
  void check_agent(const AgentSpec& agent, const KeyPath& path);
  void check_position_sensor(const AgentSpec& agent, const KeyPath& path);
  void check_radio();
  void resolve_edges();
  std::optional<std::size_t> agent_called(const std::string& name) const;
  int resolve_agent(const TomlNode& end, const KeyPath& path, int given);

  [[noreturn]] void fail(const KeyPath& path, const std::string& why) const {
    reject_key(locate(root_, path).origin, path.text(), why);
  }
  static bool placed(const AgentSpec& agent) { return agent.position_m || agent.circle; }

  const TomlNode& root_;
  Scenario& s_;
  std::vector<std::string> names_;    // of all agents
  std::vector<std::size_t> by_name_;  // agents sorted by name
  KeyPath top_;
  KeyPath agents_ = top_["agents"];
  KeyPath world_ = top_["world"];
  KeyPath radio_ = top_["radio"];
};

void Checker::check_agents() {
  if (s_.agents.empty()) {
    throw InputError(locate(root_, agents_).origin.text() +
                     ": there are no [[agents]]; a scenario needs at least one agent");
  }
  std::int64_t count = 0;
  for (const AgentSpec& agent : s_.agents) count += agent.count;
  if (count > 1'000'000) {
    fail(agents_, "there are " + std::to_string(count) + " agents; at most 1000000 are allowed");
  }
  check_agent_names();
}

void Checker::check_agent_names() {
  names_ = agent_names(s_);
  by_name_ = sorted_by_name(names_);
  const auto entry = [&](std::size_t agent) {
    std::size_t i = 0;
    for (; agent >= static_cast<std::size_t>(s_.agents[i].count); ++i) {
      agent -= static_cast<std::size_t>(s_.agents[i].count);
    }
    return i;
  };
  for (const char* reserved : {"central", "each", "max", "mean"}) {
    const auto agent = agent_called(reserved);
    if (!agent) continue;
    fail(agents_[entry(*agent)]["name"],
         std::string("'") + reserved + "' means something else in claims; take another name");
  }
  if (const auto agent = first_duplicate(names_, by_name_)) {
    fail(agents_[entry(*agent)]["name"], "two agents are called '" + names_[*agent] + "'");
  }
}

std::optional<std::size_t> Checker::agent_called(const std::string& name) const {
  const auto at = std::lower_bound(
      by_name_.begin(), by_name_.end(), name,
      [&](std::size_t agent, const std::string& wanted) { return names_[agent] < wanted; });
  if (at == by_name_.end() || names_[*at] != name) return std::nullopt;
  return *at;
}

void Checker::check_world() {
  const KeyPath log = world_["log"];
  if (s_.world.log) {
    if (s_.world.log->directory.empty()) {
      fail(log["directory"], "missing; say where the data set lies");
    }
    if (!s_.world.targets.empty()) {
      fail(world_["targets"], "not with [world.log], whose landmarks are the targets");
    }
    const bool read = std::any_of(s_.agents.begin(), s_.agents.end(),
                                  [](const AgentSpec& a) { return a.sensor.kind == "log"; });
    if (!read) fail(log, "no agent has a sensor of kind \"log\" that would read it");
  } else if (!s_.duration_s) {
    fail(top_["duration_s"], "missing; only with [world.log] does a run have a span of its own");
  }
  check_targets();
}

void Checker::check_targets() {
  const KeyPath targets = world_["targets"];
  std::vector<std::string> names;
  for (std::size_t i = 0; i < s_.world.targets.size(); ++i) {
    TargetSpec& target = s_.world.targets[i];
    if (target.position_m.empty()) fail(targets[i]["position_m"], "missing");
    if (target.name.empty()) target.name = "target" + std::to_string(i);
    names.push_back(target.name);
  }
  if (const auto i = first_duplicate(names, sorted_by_name(names))) {
    fail(targets[*i]["name"], "two targets are called '" + names[*i] + "'");
  }
}

void Checker::check_agent(const AgentSpec& agent, const KeyPath& path) {
  if (agent.position_m && agent.circle) {
    fail(path["circle"], "not together with position_m; give one of them");
  }
  const SensorSpec& sensor = agent.sensor;
  const KeyPath sensor_path = path["sensor"];
  if (sensor.end_s && *sensor.end_s < sensor.start_s) {
    fail(sensor_path["end_s"], "must not be before start_s (" + to_toml(sensor.start_s) + " s)");
  }
  if (sensor.kind == "position") check_position_sensor(agent, sensor_path);
  if (sensor.kind == "log" && !s_.world.log) {
    fail(sensor_path["kind"], "\"log\" needs a [world.log] to read");
  }
  if (agent.talk.phase_s && *agent.talk.phase_s >= agent.talk.period_s) {
    fail(path["talk"]["phase_s"],
         "must be less than period_s (" + to_toml(agent.talk.period_s) + " s)");
  }
}

void Checker::check_position_sensor(const AgentSpec& agent, const KeyPath& path) {
  const SensorSpec& sensor = agent.sensor;
  if (s_.world.targets.empty()) {
    fail(path["kind"], "\"position\" needs at least one target in world.targets");
  }
  const bool along = sensor.sigma_along_m.has_value();
  const bool across = sensor.sigma_across_m.has_value();
  if (sensor.sigma_m && (along || across)) {
    fail(path["sigma_m"], "not together with sigma_along_m and sigma_across_m");
  }
  if (along != across) {
    const char* given = along ? "sigma_along_m" : "sigma_across_m";
    fail(path[given],
         std::string("needs ") + (along ? "sigma_across_m" : "sigma_along_m") + ", too");
  }
  if (!sensor.sigma_m && !along) {
    fail(path, "kind \"position\" needs sigma_m, or sigma_along_m and sigma_across_m");
  }
  if (along && !placed(agent)) {
    fail(path["sigma_along_m"], "needs to know where the agent stands: position_m or circle");
  }
}

void Checker::check_radio() {
  const RadioSpec& radio = s_.radio;
  if (radio.loss.model == "none" && radio.loss.probability > 0.0) {
    fail(radio_["loss"]["probability"],
         "without effect; set radio.loss.model = \"bernoulli\", too");
  }
  if (radio.topology == "edges" && radio.edges.empty()) {
    fail(radio_["topology"], "\"edges\" needs radio.edges, as [[0, 1], [1, 2]]");
  }
  if (radio.topology != "edges" && !radio.edges.empty()) {
    fail(radio_["edges"], "only for topology = \"edges\"; found \"" + radio.topology + "\"");
  }
  resolve_edges();
  if (radio.propagation_m_per_s && radio.topology != "disk") {
    fail(radio_["propagation_m_per_s"],
         "only for topology = \"disk\", which knows how long links are; found \"" + radio.topology +
             "\"");
  }
  if (radio.topology != "disk") return;
  if (radio.range_m <= 0.0) fail(radio_["topology"], "\"disk\" needs radio.range_m above 0");
  for (std::size_t i = 0; i < s_.agents.size(); ++i) {
    if (placed(s_.agents[i])) continue;
    fail(agents_[i], "topology = \"disk\" needs to know where it stands: position_m or circle");
  }
}

void Checker::resolve_edges() {
  const KeyPath edges = radio_["edges"];
  for (std::size_t i = 0; i < s_.radio.edges.size(); ++i) {
    const KeyPath path = edges[i];
    const TomlNode& node = locate(root_, path);
    auto& [a, b] = s_.radio.edges[i];
    a = resolve_agent(node.children[0], path, a);
    b = resolve_agent(node.children[1], path, b);
    const int last = s_.agent_count() - 1;
    for (const int end : {a, b}) {
      if (end >= 0 && end <= last) continue;
      const std::string known =
          last == 0 ? "0 is the only one" : "they are 0 … " + std::to_string(last);
      reject(node, path, "there is no agent " + std::to_string(end) + "; " + known);
    }
    if (a == b) reject(node, path, "joins an agent to itself");
  }
}

int Checker::resolve_agent(const TomlNode& end, const KeyPath& path, int given) {
  if (end.type != TomlNode::Type::string) return given;
  if (const auto agent = agent_called(end.text)) return static_cast<int>(*agent);
  const auto near = nearest_name(end.text, names_);
  reject(end, path, "there is no such agent" + (near ? "; did you mean '" + *near + "'?" : ""));
}

}  // namespace

void finish(const TomlNode& root, Scenario& scenario) { Checker(root, scenario).all(); }

}  // namespace hearsay
