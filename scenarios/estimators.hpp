// Estimators as a scenario describes them.
#pragma once

#include "agents/estimator_agent.hpp"
#include "scenarios/scenario.hpp"

namespace hearsay {

/// How the agent's messages are encoded; its rule and content go together.
gaussian::MessageForm message_form_of(const AgentSpec& agent);

/// Fills in how the agent fuses and what it says: rule, content, policy.
void set_rule(const AgentSpec& agent, const Scenario& scenario, EstimatorAgent::Options& options);

}  // namespace hearsay
