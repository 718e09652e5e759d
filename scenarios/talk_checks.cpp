// What rules of fusion and of talk need, and what would be without effect.
#include <algorithm>
#include <optional>
#include <string>

#include "agents/estimators/gaussian.hpp"
#include "scenarios/estimators.hpp"
#include "scenarios/scenario_under_check.hpp"

namespace hearsay {
namespace {

std::string quoted(const std::string& text) { return "\"" + text + "\""; }

void check_rule(const ScenarioUnderCheck& file, const EstimatorSpec& estimator,
                const KeyPath& path) {
  const std::string& fusion = estimator.fusion;
  if (fusion == "ci-fixed" && !estimator.omega) {
    file.fail(path["omega"], "missing; fusion \"ci-fixed\" needs the weight of the own belief");
  }
  if (fusion != "ci-fixed" && estimator.omega) {
    file.fail(path["omega"],
              "without effect under fusion " + quoted(fusion) + "; only with \"ci-fixed\"");
  }
  if (fusion != "hybrid-consensus" && estimator.correction) {
    file.fail(path["correction"],
              "without effect under fusion " + quoted(fusion) + "; only with \"hybrid-consensus\"");
  }
}

void check_policy(const ScenarioUnderCheck& file, const TalkSpec& talk, const KeyPath& path) {
  const bool triggered = talk.policy == "event-triggered";
  if (triggered && !talk.divergence_nats) {
    file.fail(path["divergence_nats"],
              "missing; policy \"event-triggered\" needs to know how much news is worth a message");
  }
  if (!triggered && talk.divergence_nats) {
    file.fail(path["divergence_nats"], "without effect under policy " + quoted(talk.policy) +
                                           "; only with \"event-triggered\"");
  }
}

// The rules that may say less than whole beliefs.
std::string rules_that_say_less() {
  std::string names;
  for (const gaussian::RuleInfo& rule : gaussian::rules()) {
    if (can_say_less(rule.rule)) names += (names.empty() ? "" : ", ") + std::string(rule.name);
  }
  return names;
}

void check_content(const ScenarioUnderCheck& file, const AgentSpec& agent, const KeyPath& path) {
  const TalkSpec& talk = agent.talk;
  if (talk.bits && talk.content != "quantised") {
    file.fail(path["bits"],
              "without effect with content " + quoted(talk.content) + "; only with \"quantised\"");
  }
  const auto rule = gaussian::rule_by_name(agent.estimator.fusion);
  const bool speaks = rule && gaussian::info(*rule).sends != gaussian::Sends::nothing;
  if (talk.content == "belief" || agent.kind != "estimator" || !speaks) return;
  if (!can_say_less(*rule)) {
    file.fail(path["content"],
              quoted(talk.content) + " does not go with fusion " + quoted(agent.estimator.fusion) +
                  ", which counts on what exactly was said; allowed: " + rules_that_say_less());
  }
}

// What is known for states that stand still, or are of one instant, only.
void check_kind(const ScenarioUnderCheck& file, const AgentSpec& agent, const KeyPath& path) {
  const std::string& kind = agent.estimator.kind;
  if (kind == "static-gaussian" || agent.kind != "estimator") return;
  const KeyPath talk = path["talk"];
  if (kind == "trajectory-gaussian") {
    const std::string only =
        R"( goes with kinds "static-gaussian" and "moving-gaussian" alone; found )" + quoted(kind);
    if (agent.talk.policy == "event-triggered")
      file.fail(talk["policy"], "\"event-triggered\"" + only);
    if (agent.talk.content != "belief")
      file.fail(talk["content"], quoted(agent.talk.content) + only);
  }
  const auto rule = gaussian::rule_by_name(agent.estimator.fusion);
  const bool held = rule && gaussian::info(*rule).memory == gaussian::Memory::held;
  if (held || (rule && message_form(*rule, Content::belief) != gaussian::MessageForm::plain)) {
    const KeyPath estimator = path["estimator"];
    file.fail(estimator["fusion"], quoted(agent.estimator.fusion) +
                                       " goes with kind \"static-gaussian\" alone; found " +
                                       quoted(kind));
  }
}

// Agents that talk must encode alike to be understood.
void check_that_all_understand(const ScenarioUnderCheck& file, const KeyPath& agents) {
  std::optional<std::size_t> first;
  for (std::size_t i = 0; i < file.scenario.agents.size(); ++i) {
    const AgentSpec& agent = file.scenario.agents[i];
    if (agent.kind != "estimator" || agent.estimator.fusion == "none") continue;
    if (!first) first = i;
    const AgentSpec& other = file.scenario.agents[*first];
    if (message_form_of(agent) == message_form_of(other)) continue;
    const std::string number = std::to_string(*first);
    const KeyPath path = agents[i];
    if (agent.talk.content != other.talk.content) {
      file.fail(path["talk"]["content"],
                quoted(agent.talk.content) + " and " + quoted(other.talk.content) + " of agents[" +
                    number + "] do not understand each other: give all agents the same content");
    }
    file.fail(path["estimator"]["fusion"],
              quoted(agent.estimator.fusion) + " and " + quoted(other.estimator.fusion) +
                  " of agents[" + number +
                  "] do not understand each other: one of them sends more than beliefs");
  }
}

}  // namespace

void check_talk(const ScenarioUnderCheck& file) {
  const KeyPath top;
  const KeyPath agents = top["agents"];
  for (std::size_t i = 0; i < file.scenario.agents.size(); ++i) {
    const AgentSpec& agent = file.scenario.agents[i];
    const KeyPath path = agents[i];
    const KeyPath talk = path["talk"];
    check_rule(file, agent.estimator, path["estimator"]);
    check_policy(file, agent.talk, talk);
    check_content(file, agent, talk);
    check_kind(file, agent, path);
  }
  check_that_all_understand(file, agents);
}

}  // namespace hearsay
