// Agents that track, and what there is for them to find.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "agents/track_witness.hpp"
#include "agents/tracker_agent.hpp"
#include "scenarios/scenario.hpp"

namespace hearsay {

struct PreparedScenario;

/// True if some agent tracks.
bool has_trackers(const Scenario& scenario);

/// Where every target is in a run up to `end`.
std::vector<TargetTruth> target_truths_of(const Scenario& scenario, Time end, std::uint64_t seed);

/// `targets` outlive the witness.
std::unique_ptr<TrackWitness> make_track_witness(const Scenario& scenario, Simulation& simulation,
                                                 const std::vector<TargetTruth>& targets);

/// Of an agent that tracks, in the run of this seed. `scanner`: null for who has no sensor.
TrackerAgent::Options tracker_options(const PreparedScenario& prepared, AgentId id,
                                      std::uint64_t seed, PlotSource* scanner);

/// Whether it has a sensor, and which.
std::optional<ScanSensor::Options> scan_sensor_of(const AgentSpec& spec);

}  // namespace hearsay
