#include "scenarios/estimators.hpp"

#include <string>

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

}  // namespace

gaussian::MessageForm message_form_of(const AgentSpec& agent) {
  const gaussian::Rule rule = gaussian::rule_by_name(agent.estimator.fusion).value();
  return message_form(rule, content_of(agent, rule));
}

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

}  // namespace hearsay
