// What must fit together in agents that track.
#include <string>

#include "scenarios/scenario_under_check.hpp"
#include "sim/kernel/time.hpp"
#include "sim/math/functions.hpp"

namespace hearsay {
namespace {

constexpr double false_alarms_max = 1000.0;  // in a scan, on average
constexpr double trail_scans_max = 1e4;

class TrackerChecker {
 public:
  explicit TrackerChecker(ScenarioUnderCheck& file) : file_(file), world_(file.scenario.world) {}

  void all() {
    for (std::size_t i = 0; i < file_.scenario.agents.size(); ++i) {
      const AgentSpec& agent = file_.scenario.agents[i];
      const KeyPath agents = top_["agents"];
      const KeyPath path = agents[i];
      check_sensor_keys(agent.sensor, path["sensor"]);
      if (agent.kind == "tracker") {
        check_tracker(agent, path);
      } else {
        check_other(agent, path);
      }
    }
  }

 private:
  void check_sensor_keys(const SensorSpec& sensor, const KeyPath& path) const;
  void check_other(const AgentSpec& agent, const KeyPath& path) const;
  void check_tracker(const AgentSpec& agent, const KeyPath& path);
  void check_scan(const SensorSpec& sensor, const KeyPath& path) const;
  void check_motion(const AgentSpec& agent, const KeyPath& path);
  void require_multiple(const KeyPath& path, double value_s) const;

  ScenarioUnderCheck& file_;
  const WorldSpec& world_;
  KeyPath top_;
  const TrackerSpec* first_ = nullptr;
};

void TrackerChecker::check_sensor_keys(const SensorSpec& sensor, const KeyPath& path) const {
  if (sensor.kind == "scan") return;
  const std::string why = "only for kind = \"scan\"; found \"" + sensor.kind + "\"";
  if (sensor.detection_probability) file_.fail(path["detection_probability"], why);
  if (sensor.false_alarms_per_km2) file_.fail(path["false_alarms_per_km2"], why);
}

void TrackerChecker::check_other(const AgentSpec& agent, const KeyPath& path) const {
  if (agent.tracker != TrackerSpec()) {
    file_.fail(path["tracker"], "only for kind = \"tracker\"; found \"" + agent.kind + "\"");
  }
  if (agent.sensor.kind == "scan") {
    const KeyPath sensor = path["sensor"];
    file_.fail(sensor["kind"],
               "\"scan\" does not say which target was seen: only for agents of "
               "kind \"tracker\"");
  }
}

void TrackerChecker::check_tracker(const AgentSpec& agent, const KeyPath& path) {
  const KeyPath sensor = path["sensor"];
  if (agent.estimator != EstimatorSpec()) {
    file_.fail(path["estimator"], "without effect: kind = \"tracker\" has agents.tracker instead");
  }
  if (world_.log) file_.fail(path["kind"], "\"tracker\" does not go with [world.log]");
  const KeyPath talk = path["talk"];
  if (agent.talk.policy != "periodic" && agent.talk.policy != "never") {
    file_.fail(talk["policy"], "kind \"tracker\" knows \"periodic\" and \"never\" alone; found \"" +
                                   agent.talk.policy + "\"");
  }
  if (agent.talk.content != "belief") {
    file_.fail(talk["content"],
               "kind \"tracker\" says whole beliefs; found \"" + agent.talk.content + "\"");
  }
  if (agent.sensor.kind == "scan") {
    check_scan(agent.sensor, sensor);
  } else if (agent.sensor.kind != "none") {
    file_.fail(sensor["kind"], "agents of kind \"tracker\" have a sensor of kind \"scan\" or none");
  }
  const KeyPath tracker = path["tracker"];
  if (agent.tracker.confirm_hits > agent.tracker.confirm_scans) {
    file_.fail(tracker["confirm_hits"], "must not be more than confirm_scans (" +
                                            std::to_string(agent.tracker.confirm_scans) + ")");
  }
  if (agent.tracker.trail_s && !agent.tracker.acceleration_psd_m2_per_s3) {
    file_.fail(tracker["trail_s"],
               "needs acceleration_psd_m2_per_s3: trails are of targets that move");
  }
  if (agent.tracker.trail_s.value_or(0.0) / agent.sensor.period_s > trail_scans_max) {
    file_.fail(tracker["trail_s"], "more than 10000 scans (sensor.period_s) are not kept");
  }
  check_motion(agent, path);
}

void TrackerChecker::check_scan(const SensorSpec& sensor, const KeyPath& path) const {
  if (sensor.false_alarms_per_km2.value_or(0.0) == 0.0) return;
  if (!sensor.range_max_m) {
    file_.fail(path["false_alarms_per_km2"], "needs range_max_m: false alarms lie within it");
  }
  const double area_km2 = math::pi * 1e-6 * *sensor.range_max_m * *sensor.range_max_m;
  if (*sensor.false_alarms_per_km2 * area_km2 > false_alarms_max) {
    file_.fail(path["false_alarms_per_km2"],
               "more than 1000 false alarms in a scan, on average, within range_max_m (" +
                   to_toml(*sensor.range_max_m) + " m)");
  }
}

void TrackerChecker::check_motion(const AgentSpec& agent, const KeyPath& path) {
  const KeyPath tracker = path["tracker"];
  for (const TargetSpec& target : world_.targets) {
    if (!target.motion || agent.tracker.acceleration_psd_m2_per_s3) continue;
    file_.fail(tracker,
               "without acceleration_psd_m2_per_s3 it believes that targets stand still, "
               "but \"" +
                   target.name + "\" moves");
  }
  if (first_ == nullptr) first_ = &agent.tracker;
  if (first_->acceleration_psd_m2_per_s3.has_value() !=
      agent.tracker.acceleration_psd_m2_per_s3.has_value()) {
    file_.fail(tracker, "acceleration_psd_m2_per_s3: all trackers of a run have it, or none");
  }
  if (!world_.step_s) return;
  const KeyPath sensor = path["sensor"];
  require_multiple(sensor["period_s"], agent.sensor.period_s);
  require_multiple(sensor["start_s"], agent.sensor.start_s);
}

void TrackerChecker::require_multiple(const KeyPath& path, double value_s) const {
  const Duration step = Duration::seconds(*world_.step_s);
  if (Duration::seconds(value_s).nanoseconds() % step.nanoseconds() == 0) return;
  file_.fail(path, "must be a multiple of world.step_s (" + to_toml(*world_.step_s) +
                       " s), for targets that move are looked at there alone");
}

}  // namespace

void check_trackers(ScenarioUnderCheck& file) { TrackerChecker(file).all(); }

}  // namespace hearsay
