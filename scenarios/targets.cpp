#include "scenarios/targets.hpp"

#include <string>
#include <utility>

#include "scenarios/motion.hpp"

namespace hearsay {

std::optional<MotionModel> motion_model_of(const Scenario& scenario) {
  for (const AgentSpec& agent : scenario.agents) {
    const auto& psd = agent.estimator.acceleration_psd_m2_per_s3;
    if (agent.kind != "estimator" || !psd) continue;
    const Duration period = Duration::seconds(scenario.world.step_s.value());
    return MotionModel{.step = gaussian::white_noise_acceleration(2, period.seconds(), *psd),
                       .period = period};
  }
  return std::nullopt;
}

int window_steps_of(const EstimatorSpec& estimator, const WorldSpec& world) {
  if (!estimator.window_s) return 20;
  const Duration step = Duration::seconds(world.step_s.value());
  return static_cast<int>(Duration::seconds(*estimator.window_s).nanoseconds() /
                          step.nanoseconds());
}

void put_in_motion(std::vector<Subject>& subjects, const Scenario& scenario,
                   const MotionModel& model, Time end, std::uint64_t seed) {
  std::vector<std::vector<double>> states = target_states_of(scenario, end, seed);
  for (std::size_t i = 0; i < subjects.size(); ++i) {
    subjects[i].truth = std::move(states[i]);
    const std::optional<MotionSpec>& motion = scenario.world.targets[i].motion;
    if (motion && motion->kind != "white-noise-acceleration") continue;
    const double psd = motion ? motion->acceleration_psd_m2_per_s3.value() : 0.0;
    const double unit = model.period.seconds();
    // R is linear in the density.
    subjects[i].motion_noise = psd * gaussian::white_noise_acceleration(2, unit, 1.0).R;
  }
}

}  // namespace hearsay
