// Agents that track, and what there is for them to find.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "agents/track_witness.hpp"
#include "agents/tracker_agent.hpp"
#include "scenarios/scenario.hpp"

namespace hearsay {

/// True if some agent tracks.
bool has_trackers(const Scenario& scenario);

/// Where every target is in a run up to `end`.
std::vector<TargetTruth> target_truths_of(const Scenario& scenario, Time end, std::uint64_t seed);

/// `targets` outlive the witness.
std::unique_ptr<TrackWitness> make_track_witness(const Scenario& scenario, Simulation& simulation,
                                                 const std::vector<TargetTruth>& targets);

/// All but when it talks. `targets` outlive the agent.
TrackerAgent::Options tracker_options(const AgentSpec& spec,
                                      const std::vector<TargetTruth>& targets);

}  // namespace hearsay
