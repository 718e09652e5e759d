// Estimators as a scenario describes them.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "agents/estimator_agent.hpp"
#include "agents/lookout.hpp"
#include "scenarios/scenario.hpp"

namespace hearsay {

struct PreparedScenario;

/// How the agent's messages are encoded; its rule and content go together.
gaussian::MessageForm message_form_of(const AgentSpec& agent);

/// n of what is estimated; there is something.
int dimension_of(const PreparedScenario& prepared);

/// Of an agent of kind "estimator", in the run of this seed.
EstimatorAgent::Options estimator_options(const PreparedScenario& prepared, AgentId id,
                                          std::uint64_t seed);

/// Its sensors, or what a log has of it. `subjects`: with the truth of this run. All outlive it.
std::unique_ptr<Lookout> make_lookout(const PreparedScenario& prepared, AgentId id,
                                      Context& context, Witness& witness,
                                      MeasurementReceiver& receiver,
                                      std::span<const Subject> subjects);

}  // namespace hearsay
