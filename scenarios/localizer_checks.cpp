// What must fit together in robots that localize themselves.
#include <string>

#include "scenarios/scenario_under_check.hpp"

namespace hearsay {
namespace {

constexpr double memory_max_s = 3600.0;
constexpr double sigma_min = 1e-6;  // of a measurement, in m or rad

// A pose that is known badly is what the filter itself finds out.
void check_noise(const ScenarioUnderCheck& file, const SensorSpec& sensor, const KeyPath& path) {
  const SensorSpec plain;
  const auto useless = [&](const char* key, double value, double otherwise) {
    if (value == otherwise) return;
    file.fail(path[key], "without effect: a localizer finds out itself how well it knows its pose");
  };
  useless("sigma_heading_rad", sensor.sigma_heading_rad, plain.sigma_heading_rad);
  useless("sigma_position_m", sensor.sigma_position_m, plain.sigma_position_m);
  const auto too_sure = [&](const char* key, double value) {
    if (value < sigma_min) file.fail(path[key], "must be at least 1e-06 for a localizer");
  };
  too_sure("sigma_range_m", sensor.sigma_range_m);
  too_sure("sigma_bearing_rad", sensor.sigma_bearing_rad);
}

void check_localizer(const ScenarioUnderCheck& file, const AgentSpec& agent, const KeyPath& path) {
  const KeyPath sensor = path["sensor"];
  const KeyPath talk = path["talk"];
  const KeyPath localizer = path["localizer"];
  const KeyPath top;
  const KeyPath world = top["world"];
  const KeyPath log = world["log"];
  if (!file.scenario.world.log) {
    file.fail(path["kind"], "\"localizer\" needs a [world.log] with odometry");
  }
  if (file.scenario.world.log->subjects != "landmarks") {
    file.fail(log["subjects"],
              "without effect: agents of kind \"localizer\" believe in their own poses alone");
  }
  if (agent.sensor.kind != "log") {
    file.fail(sensor["kind"],
              "agents of kind \"localizer\" have a sensor of kind \"log\"; found \"" +
                  agent.sensor.kind + "\"");
  }
  if (agent.estimator != EstimatorSpec()) {
    file.fail(path["estimator"],
              "without effect: kind = \"localizer\" has agents.localizer instead");
  }
  if (agent.talk.policy != "periodic" && agent.talk.policy != "never") {
    file.fail(talk["policy"],
              "kind \"localizer\" knows \"periodic\" and \"never\" alone; found \"" +
                  agent.talk.policy + "\"");
  }
  if (agent.talk.content != "belief") {
    file.fail(talk["content"],
              "kind \"localizer\" says whole beliefs; found \"" + agent.talk.content + "\"");
  }
  check_noise(file, agent.sensor, sensor);
  if (agent.localizer.memory_s > memory_max_s) {
    file.fail(localizer["memory_s"], "more than an hour (3600 s) is not kept");
  }
}

}  // namespace

void check_localizers(const ScenarioUnderCheck& file) {
  const KeyPath top;
  const KeyPath agents = top["agents"];
  bool localizers = false, estimators = false;
  for (std::size_t i = 0; i < file.scenario.agents.size(); ++i) {
    const AgentSpec& agent = file.scenario.agents[i];
    const KeyPath path = agents[i];
    localizers = localizers || agent.kind == "localizer";
    estimators = estimators || agent.kind == "estimator";
    if (localizers && estimators) {
      file.fail(path["kind"],
                "a run has a central filter of poses or one of targets: not both "
                "\"localizer\" and \"estimator\"");
    }
    if (agent.kind == "localizer") {
      check_localizer(file, agent, path);
    } else if (agent.localizer != LocalizerSpec()) {
      file.fail(path["localizer"], "only for kind = \"localizer\"; found \"" + agent.kind + "\"");
    }
  }
}

}  // namespace hearsay
