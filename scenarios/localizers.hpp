// Robots that localize themselves, and what they go through.
#pragma once

#include <memory>
#include <vector>

#include "agents/localizer_agent.hpp"
#include "scenarios/scenario.hpp"
#include "sim/world/mrclam.hpp"

namespace hearsay {

struct PreparedScenario;

/// True if some agent localizes itself.
bool has_localizers(const Scenario& scenario);

/// The robots of a log, with the truth at every instant `period` apart, and at `end`.
/// @throws InputError, of `file`, for a robot whose truth is not known at the start.
std::vector<Journey> journeys_of(const mrclam::Dataset& log, Duration period, Time end,
                                 const std::string& file);

std::vector<Eigen::Vector2d> landmarks_of(const mrclam::Dataset& log);

/// Of the robots of these journeys, in their order, all with the noises of `spec`.
localization::PoseFilter::Options pose_filter_options(const LocalizerSpec& spec,
                                                      std::span<const Journey> journeys);

/// Of an agent that localizes itself, in the run of this seed. `prepared` outlives the agent.
LocalizerAgent::Options localizer_options(const PreparedScenario& prepared, AgentId id,
                                          std::uint64_t seed);

}  // namespace hearsay
