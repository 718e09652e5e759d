// Targets that move: what is true of them in a run, and what agents think of how they move.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "agents/witness.hpp"
#include "scenarios/scenario.hpp"

namespace hearsay {

/// How all agents that estimate think that targets move; nothing: not at all.
std::optional<MotionModel> motion_model_of(const Scenario& scenario);

/// T in stamps of one that believes in trajectories.
int window_steps_of(const EstimatorSpec& estimator, const WorldSpec& world);

/// Gives each target of `subjects` its true state at every stamp of a run up to `end`, and the
/// noise of its motion where that follows `model`.
void put_in_motion(std::vector<Subject>& subjects, const Scenario& scenario,
                   const MotionModel& model, Time end, std::uint64_t seed);

}  // namespace hearsay
