// What must fit together in robots that localize themselves.
#include <string>

#include "scenarios/scenario_under_check.hpp"

namespace hearsay {
namespace {

constexpr double memory_max_s = 3600.0;

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
