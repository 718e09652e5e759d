// The sensors of an agent, made from what its file says.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "agents/sensors/sensor.hpp"
#include "scenarios/scenario.hpp"

namespace hearsay {

/// One for each target; none for kinds that need no target. `place`: where the agent stands, if the
/// file says so. @throws InputError for a line of sight from a target to itself.
std::vector<Sensor> sensors_of(const AgentSpec& agent, const WorldSpec& world,
                               const std::optional<std::array<double, 2>>& place);

/// What the file says of ranges and bearings.
gaussian::RangeBearingNoise range_bearing_noise_of(const SensorSpec& sensor);

}  // namespace hearsay
