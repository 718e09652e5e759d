// Agents that explore an area, and what there is in it.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "agents/explorer_agent.hpp"
#include "scenarios/scenario.hpp"

namespace hearsay {

struct PreparedScenario;

/// True if some agent explores.
bool has_explorers(const Scenario& scenario);

/// The cells of world.area, which is there.
grid::Area area_of(const WorldSpec& world);

/// Where targets are in a run; those of which the file does not say are anywhere in the area.
std::vector<grid::Point> target_places_of(const WorldSpec& world, std::uint64_t seed);

/// Of the run of `seed`. `place_of` says where agents are.
std::unique_ptr<GridWitness> make_grid_witness(const Scenario& scenario, Simulation& simulation,
                                               std::function<Point(AgentId)> place_of);

/// Of an agent that explores, in the run of this seed. `looks`: null for who has no sensor.
ExplorerAgent::Options explorer_options(const PreparedScenario& prepared, AgentId id,
                                        std::uint64_t seed, LookSource* looks);

/// Whether it has a sensor, and which.
std::optional<GridSensor::Options> grid_sensor_of(const AgentSpec& spec, const WorldSpec& world);

}  // namespace hearsay
