// What must fit together in what agents believe, and about what.
#include <string>

#include "agents/estimators/shared_trajectories.hpp"
#include "scenarios/scenario_under_check.hpp"
#include "sim/kernel/time.hpp"

namespace hearsay {
namespace {

constexpr double steps_max = 1e6;  // of a run
constexpr double window_steps_max = 1e4;

bool is_static(const EstimatorSpec& estimator) { return estimator.kind == "static-gaussian"; }

class EstimatorChecker {
 public:
  explicit EstimatorChecker(ScenarioUnderCheck& file) : file_(file), world_(file.scenario.world) {}

  void all() {
    check_step();
    for (std::size_t i = 0; i < file_.scenario.agents.size(); ++i) {
      const AgentSpec& agent = file_.scenario.agents[i];
      const KeyPath path = agents_[i];
      const KeyPath estimator = path["estimator"];
      check_keys(agent.estimator, estimator);
      if (agent.kind != "estimator") continue;
      if (is_static(agent.estimator)) {
        check_still(estimator);
      } else {
        check_moving(agent, path);
      }
      check_like_first(agent.estimator, estimator);
    }
  }

 private:
  void check_step() const;
  void check_keys(const EstimatorSpec& estimator, const KeyPath& path) const;
  void check_still(const KeyPath& path) const;
  void check_moving(const AgentSpec& agent, const KeyPath& path) const;
  void check_window(const EstimatorSpec& estimator, const KeyPath& path) const;
  void check_like_first(const EstimatorSpec& estimator, const KeyPath& path);
  void require_multiple(const KeyPath& path, double value_s) const;

  ScenarioUnderCheck& file_;
  const WorldSpec& world_;
  KeyPath top_;
  KeyPath agents_ = top_["agents"];
  const EstimatorSpec* first_ = nullptr;  // of the first agent that estimates
};

void EstimatorChecker::check_step() const {
  const KeyPath world = top_["world"];
  const KeyPath path = world["step_s"];
  if (!world_.step_s) {
    if (!world_.log || world_.log->subjects == "landmarks") return;
    file_.fail(path,
               "missing; the robots of [world.log] move, and are believed in at its multiples");
  }
  if (world_.log && world_.log->subjects == "landmarks") {
    file_.fail(path, "not with the landmarks of [world.log], which stand still");
  }
  if (file_.scenario.duration_s.value_or(0.0) / *world_.step_s > steps_max) {
    file_.fail(path, "the run would have more than 1000000 steps");
  }
}

void EstimatorChecker::check_keys(const EstimatorSpec& estimator, const KeyPath& path) const {
  if (estimator.window_s && estimator.kind != "trajectory-gaussian") {
    file_.fail(path["window_s"],
               "only for kind = \"trajectory-gaussian\"; found \"" + estimator.kind + "\"");
  }
  if (estimator.acceleration_psd_m2_per_s3 && is_static(estimator)) {
    file_.fail(path["acceleration_psd_m2_per_s3"],
               "not for kind = \"static-gaussian\", whose states stand still");
  }
}

void EstimatorChecker::check_still(const KeyPath& path) const {
  if (world_.log && world_.log->subjects == "robots") {
    file_.fail(path["kind"],
               "\"static-gaussian\" believes that all stands still, but the robots of [world.log] "
               "move; take \"moving-gaussian\" or \"trajectory-gaussian\"");
  }
  for (const TargetSpec& target : world_.targets) {
    if (!target.motion) continue;
    file_.fail(path["kind"], "\"static-gaussian\" believes that targets stand still, but \"" +
                                 target.name +
                                 "\" moves; take \"moving-gaussian\" or \"trajectory-gaussian\"");
  }
}

void EstimatorChecker::require_multiple(const KeyPath& path, double value_s) const {
  const Duration step = Duration::seconds(*world_.step_s);
  if (Duration::seconds(value_s).nanoseconds() % step.nanoseconds() == 0) return;
  file_.fail(path, "must be a multiple of world.step_s (" + to_toml(*world_.step_s) +
                       " s), for targets that move are looked at and believed in there alone");
}

void EstimatorChecker::check_moving(const AgentSpec& agent, const KeyPath& path) const {
  const KeyPath estimator = path["estimator"];
  const std::string kind = "kind \"" + agent.estimator.kind + "\"";
  if (world_.log && world_.log->subjects == "landmarks") {
    file_.fail(estimator["kind"], kind +
                                      " does not go with the landmarks of [world.log], which "
                                      "stand still; take world.log.subjects = \"robots\"");
  }
  if (!world_.step_s) file_.fail(estimator["kind"], kind + " needs world.step_s");
  if (!agent.estimator.acceleration_psd_m2_per_s3) {
    file_.fail(estimator, kind +
                              " needs acceleration_psd_m2_per_s3: how much it expects targets "
                              "to turn and change speed");
  }
  const KeyPath sensor = path["sensor"];
  if (agent.sensor.kind != "log") {  // what was logged comes when it comes
    require_multiple(sensor["period_s"], agent.sensor.period_s);
    require_multiple(sensor["start_s"], agent.sensor.start_s);
  }
  if (agent.estimator.kind == "trajectory-gaussian") check_window(agent.estimator, estimator);
}

void EstimatorChecker::check_window(const EstimatorSpec& estimator, const KeyPath& path) const {
  const auto rule = gaussian::rule_by_name(estimator.fusion);
  std::string allowed;
  bool found = false;
  for (const gaussian::Rule possible : trajectory_rules()) {
    allowed += (allowed.empty() ? "" : ", ") + std::string(gaussian::info(possible).name);
    found = found || possible == rule;
  }
  if (!found) {
    file_.fail(path["fusion"],
               "\"" + estimator.fusion +
                   "\" does not go with kind = \"trajectory-gaussian\"; allowed: " + allowed);
  }
  if (!estimator.window_s) return;
  require_multiple(path["window_s"], *estimator.window_s);
  if (*estimator.window_s / *world_.step_s > window_steps_max) {
    file_.fail(path["window_s"], "more than 10000 steps (world.step_s) are not kept");
  }
}

void EstimatorChecker::check_like_first(const EstimatorSpec& estimator, const KeyPath& path) {
  if (first_ == nullptr) first_ = &estimator;
  if (estimator.kind != first_->kind) {
    file_.fail(path["kind"],
               "all agents of a run share one kind; the first one's is \"" + first_->kind + "\"");
  }
  if (estimator.acceleration_psd_m2_per_s3 != first_->acceleration_psd_m2_per_s3) {
    file_.fail(path["acceleration_psd_m2_per_s3"],
               "all agents of a run share one model of the motion; the first one's is " +
                   to_toml(*first_->acceleration_psd_m2_per_s3));
  }
}

}  // namespace

void check_estimators(ScenarioUnderCheck& file) { EstimatorChecker(file).all(); }

}  // namespace hearsay
