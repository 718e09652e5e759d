// What must fit together in how agents' words travel.
#include <string>

#include "filters/gaussian/fusion.hpp"
#include "scenarios/scenario_under_check.hpp"

namespace hearsay {
namespace {

// Why the rule cannot be heard from afar; null if it can.
const char* why_not(const gaussian::RuleInfo& rule, const std::string& service) {
  if (rule.sends == gaussian::Sends::belief_less_heard) {
    return "addresses each neighbour with what is new to it alone";
  }
  if (rule.sends == gaussian::Sends::belief_and_fresh) {
    return "counts on hearing what was measured before anybody passes it on";
  }
  if (rule.memory != gaussian::Memory::nothing && rule.memory != gaussian::Memory::held) {
    return "books what it says as known to its neighbours, and to nobody else";
  }
  if (rule.sends == gaussian::Sends::local_update && service == "blackboard") {
    return "says only what is new since it last spoke, and on a blackboard the next words would "
           "take the place of words that are not yet read";
  }
  return nullptr;
}

std::string rules_for(const std::string& service) {
  std::string names;
  for (const gaussian::RuleInfo& rule : gaussian::rules()) {
    if (why_not(rule, service)) continue;
    names += (names.empty() ? "" : ", ") + std::string(rule.name);
  }
  return names;
}

void check_rule(const ScenarioUnderCheck& file, const AgentSpec& agent, const KeyPath& path) {
  if (agent.kind != "estimator" || !is_gossip(agent.talk.service)) return;
  const auto rule = gaussian::rule_by_name(agent.estimator.fusion);
  const char* const why = rule ? why_not(gaussian::info(*rule), agent.talk.service) : nullptr;
  if (!why) return;
  file.fail(path["estimator"]["fusion"], "\"" + agent.estimator.fusion +
                                             "\" does not go with talk.service = \"" +
                                             agent.talk.service + "\": it " + why +
                                             "; allowed: " + rules_for(agent.talk.service));
}

}  // namespace

void check_services(ScenarioUnderCheck& file) {
  const KeyPath top;
  const KeyPath agents = top["agents"];
  const auto& specs = file.scenario.agents;
  for (std::size_t i = 0; i < specs.size(); ++i) {
    const KeyPath agent = agents[i];
    const TalkSpec& talk = specs[i].talk;
    const KeyPath talk_path = agent["talk"];
    const KeyPath service = talk_path["service"];
    if (talk.service == "acknowledged" && talk.policy == "never") {
      file.fail(service, "\"acknowledged\" is without effect: this agent never talks");
    }
    check_rule(file, specs[i], agent);
    const std::string& first = specs.front().talk.service;
    if (talk.service == first || (!is_gossip(talk.service) && !is_gossip(first))) continue;
    file.fail(service, "\"" + talk.service + "\" and \"" + first +
                           "\" of agents[0] do not understand each other: give all agents the "
                           "same service; agents that only carry have talk.policy = \"never\"");
  }
}

}  // namespace hearsay
