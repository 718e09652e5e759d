#include "scenarios/checks.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/scenario_under_check.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

class Checker {
 public:
  explicit Checker(ScenarioUnderCheck& file) : file_(file), s_(file.scenario) {}

  void all() {
    check_agents();
    check_world();
    check_foragers(file_);
    for (std::size_t i = 0; i < s_.agents.size(); ++i) {
      check_agent(s_.agents[i], agents_[i]);
    }
    check_services(file_);
    check_talk(file_);
    check_motion(file_);
    check_localizers(file_);
    check_explorers(file_);
    check_estimators(file_);
    check_sensors(file_);
    check_trackers(file_);
    check_traffic(file_);
    check_radio(file_);
    check_agreement();
  }

 private:
  void check_agents();
  void check_agent_names();
  void check_world();
  void check_targets();
  void check_agent(const AgentSpec& agent, const KeyPath& path);
  void check_position_sensor(const AgentSpec& agent, const KeyPath& path);
  void check_agreement();

  [[noreturn]] void fail(const KeyPath& path, const std::string& why) const {
    file_.fail(path, why);
  }

  ScenarioUnderCheck& file_;
  Scenario& s_;
  KeyPath top_;
  KeyPath agents_ = top_["agents"];
  KeyPath world_ = top_["world"];
};

void Checker::check_agents() {
  if (s_.agents.empty()) {
    throw InputError(file_.locate(agents_).origin.text() +
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
  file_.name_agents();
  const auto entry = [&](std::size_t agent) {
    std::size_t i = 0;
    for (; agent >= static_cast<std::size_t>(s_.agents[i].count); ++i) {
      agent -= static_cast<std::size_t>(s_.agents[i].count);
    }
    return i;
  };
  for (const char* reserved : {"central", "each", "max", "mean"}) {
    const auto agent = file_.agent_called(reserved);
    if (!agent) continue;
    fail(agents_[entry(*agent)]["name"],
         std::string("'") + reserved + "' means something else in claims; take another name");
  }
  if (const auto agent = first_duplicate(file_.agents())) {
    fail(agents_[entry(*agent)]["name"], "two agents are called '" + file_.agents()[*agent] + "'");
  }
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
    const bool anywhere = s_.world.area.has_value();
    if (!target.position_m && !target.motion && !anywhere)
      fail(targets[i]["position_m"], "missing");
    if (target.name.empty()) target.name = "target" + std::to_string(i);
    names.push_back(target.name);
  }
  if (const auto i = first_duplicate(names)) {
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
  if (sensor.kind == "position" || sensor.kind == "scan") {
    check_position_sensor(agent, sensor_path);
  }
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
  if (sensor.kind == "position" && s_.world.targets.empty()) {
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
    fail(path, "kind \"" + sensor.kind + "\" needs sigma_m, or sigma_along_m and sigma_across_m");
  }
  if ((along || sensor.range_max_m) && !has_place(agent)) {
    fail(path[along ? "sigma_along_m" : "range_max_m"],
         "needs to know where the agent stands: position_m, circle or motion");
  }
}

void Checker::check_agreement() {
  if (!s_.record.agreement) return;
  const KeyPath record = top_["record"];
  const KeyPath path = record["agreement"];
  const AgreementSpec& agreement = *s_.record.agreement;
  if (!agreement.within_m) fail(path["within_m"], "missing; how near is agreement?");
  if (s_.duration_s && agreement.from_s >= *s_.duration_s) {
    fail(path["from_s"], "must be before the end of the run (" + to_toml(*s_.duration_s) + " s)");
  }
  const bool any = std::any_of(s_.agents.begin(), s_.agents.end(),
                               [](const AgentSpec& agent) { return agent.kind == "estimator"; });
  if (!any) fail(path, "no agent of kind \"estimator\" is there to agree with another");
}

}  // namespace

void finish(const TomlNode& root, Scenario& scenario) {
  ScenarioUnderCheck file(root, scenario);
  Checker(file).all();
}

}  // namespace hearsay
