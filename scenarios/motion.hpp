// From agents.motion of a scenario to the paths of a run.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "net/path_source.hpp"
#include "scenarios/scenario.hpp"
#include "sim/world/motion.hpp"

namespace hearsay {

/// True if an entry of [[agents]] has a motion, or drives by itself.
bool has_motion(const Scenario& scenario);

/// The motion of agent `id`, one of the entry `spec`, that stands, or begins, at `place_m` if the
/// file says so. Without agents.motion it hovers there at altitude 0.
/// @throws InputError if the parameters do not fit together, or if it needs a place and has none.
std::unique_ptr<Motion> make_motion(const AgentSpec& spec,
                                    const std::optional<std::array<double, 2>>& place_m, AgentId id,
                                    std::uint64_t seed);

/// The same of target `target` of a scenario that was checked; of one that stands still, too. Not
/// for white-noise acceleration.
std::unique_ptr<Motion> make_motion(const TargetSpec& spec, int target, std::uint64_t seed);

/// What is true of each target at the stamps of a run (world.step_s), 4 numbers a stamp
/// (sim/world/target_states.hpp).
std::vector<std::vector<double>> target_states_of(const Scenario& scenario, Time end,
                                                  std::uint64_t seed);

/// The paths of all agents of a scenario that was checked.
class AgentPaths final : public PathSource {
 public:
  /// `places_m` as agent_positions(scenario). @throws InputError as make_motion().
  AgentPaths(const Scenario& scenario,
             const std::vector<std::optional<std::array<double, 2>>>& places_m, std::uint64_t seed);
  Leg next(AgentId agent, Time) override {
    return motions_[static_cast<std::size_t>(agent)]->next();
  }

 private:
  std::vector<std::unique_ptr<Motion>> motions_;
};

}  // namespace hearsay
