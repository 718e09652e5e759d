// Robots that lay and follow trails, and the floor they drive on.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "agents/forager_agent.hpp"
#include "agents/robots/floor_body.hpp"
#include "agents/trails/trail_witness.hpp"
#include "scenarios/scenario.hpp"

namespace hearsay {

struct PreparedScenario;

/// True if some agent forages.
bool has_foragers(const Scenario& scenario);

/// The names of all events that robots are after, by trails::EventId: the sources, then places that
/// are no sources, in the order of the tasks.
std::vector<std::string> events_of(const Scenario& scenario);

/// The floor of a run, with all robots on it, in the order of their agents.
/// @throws InputError where there is no room for a robot.
std::unique_ptr<RobotWorld> make_robot_world(const Scenario& scenario, Simulation& simulation);

/// `up` says whether an agent is.
std::unique_ptr<TrailWitness> make_trail_witness(const Scenario& scenario, Simulation& simulation,
                                                 const RobotWorld& world,
                                                 std::function<bool(AgentId)> up);

/// The number on the floor of an agent that forages.
int robot_of(const PreparedScenario& prepared, AgentId id);

/// Of an agent that forages, in the run of this seed.
ForagerAgent::Options forager_options(const PreparedScenario& prepared, AgentId id,
                                      std::uint64_t seed);

/// Of the same.
FloorBody::Options body_options(const PreparedScenario& prepared, AgentId id);

}  // namespace hearsay
