// Agents that explore an area, and what there is in it.
#pragma once

#include <memory>
#include <vector>

#include "agents/explorer_agent.hpp"
#include "scenarios/scenario.hpp"

namespace hearsay {

/// True if some agent explores.
bool has_explorers(const Scenario& scenario);

/// The cells of world.area, which is there.
grid::Area area_of(const WorldSpec& world);

/// Where targets are in a run; those of which the file does not say are anywhere in the area.
std::vector<grid::Point> target_places_of(const WorldSpec& world, std::uint64_t seed);

/// Of the run of `seed`. `place_of` says where agents are.
std::unique_ptr<GridWitness> make_grid_witness(const Scenario& scenario, Simulation& simulation,
                                               std::function<Point(AgentId)> place_of);

/// All but when it talks.
ExplorerAgent::Options explorer_options(const AgentSpec& spec, const WorldSpec& world);

}  // namespace hearsay
