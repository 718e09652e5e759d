#include "scenarios/estimators.hpp"

#include <string>
#include <utility>

#include "scenarios/run.hpp"
#include "scenarios/talk.hpp"
#include "scenarios/targets.hpp"

namespace hearsay {
namespace {

Content content_of(const std::string& name) {
  if (name == "diagonal") return Content::diagonal;
  return name == "quantised" ? Content::quantised : Content::belief;
}

TalkPolicyKind policy_of(const std::string& name) {
  if (name == "on-update") return TalkPolicyKind::on_update;
  if (name == "event-triggered") return TalkPolicyKind::event_triggered;
  return name == "adaptive" ? TalkPolicyKind::adaptive : TalkPolicyKind::periodic;
}

/// How many agents estimate.
int estimators(const Scenario& scenario) {
  int count = 0;
  for (const AgentSpec& agent : scenario.agents) {
    if (agent.kind == "estimator") count += agent.count;
  }
  return count;
}

/// A rule that says nothing has no content.
Content content_of(const AgentSpec& agent, gaussian::Rule rule) {
  const bool speaks = gaussian::info(rule).sends != gaussian::Sends::nothing;
  return speaks ? content_of(agent.talk.content) : Content::belief;
}

/// Fills in how the agent fuses and what it says: rule, content, policy.
void set_rule(const AgentSpec& agent, const Scenario& scenario, EstimatorAgent::Options& options) {
  const EstimatorSpec& estimator = agent.estimator;
  options.rule = gaussian::rule_by_name(estimator.fusion).value();
  options.omega = estimator.omega.value_or(options.omega);
  const bool nodes = estimator.correction.value_or("nodes") == "nodes";
  options.correction = nodes ? static_cast<double>(estimators(scenario)) : 1.0;
  options.content = content_of(agent, options.rule);
  options.bits = agent.talk.bits.value_or(options.bits);
  options.policy = {.kind = policy_of(agent.talk.policy),
                    .divergence_nats = agent.talk.divergence_nats.value_or(0.0)};
  options.listens_only = agent.talk.policy == "never";
}

}  // namespace

gaussian::MessageForm message_form_of(const AgentSpec& agent) {
  const gaussian::Rule rule = gaussian::rule_by_name(agent.estimator.fusion).value();
  return message_form(rule, content_of(agent, rule));
}

int dimension_of(const PreparedScenario& prepared) {
  return prepared.motion ? static_cast<int>(prepared.motion->step.A.rows())
                         : static_cast<int>(prepared.subjects.front().truth.size());
}

EstimatorAgent::Options estimator_options(const PreparedScenario& prepared, AgentId id,
                                          std::uint64_t seed) {
  const AgentSpec& spec = *prepared.specs[static_cast<std::size_t>(id)];
  EstimatorAgent::Options options;
  set_rule(spec, prepared.scenario, options);
  options.subjects = static_cast<int>(prepared.subjects.size());
  options.motion = prepared.motion;
  if (spec.estimator.kind == "trajectory-gaussian") {
    options.window = window_steps_of(spec.estimator, prepared.scenario.world);
  }
  options.dimension = dimension_of(prepared);
  // Who never talks has ticks at which it takes in what it holds.
  const bool holds = gaussian::info(options.rule).memory == gaussian::Memory::held;
  if (!options.listens_only || holds) options.talk = talk_of(prepared, id, seed);
  return options;
}

std::unique_ptr<Lookout> make_lookout(const PreparedScenario& prepared, AgentId id,
                                      Context& context, Witness& witness,
                                      MeasurementReceiver& receiver,
                                      std::span<const Subject> subjects) {
  const auto i = static_cast<std::size_t>(id);
  const AgentSpec& spec = *prepared.specs[i];
  Lookout::Options options;
  options.dimension = dimension_of(prepared);
  options.motion = prepared.motion;
  options.sensors = prepared.sensors[i];
  options.moves = spec.motion.has_value();
  options.range_max_m = spec.sensor.range_max_m;
  options.targets = subjects;
  options.period = Duration::seconds(spec.sensor.period_s);
  options.start = Time::at(Duration::seconds(spec.sensor.start_s));
  if (spec.sensor.end_s) options.end = Time::at(Duration::seconds(*spec.sensor.end_s));
  options.observations = prepared.observations[i];
  return std::make_unique<Lookout>(context, witness, receiver, std::move(options));
}

}  // namespace hearsay
