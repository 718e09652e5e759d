// From agents.talk.service and [radio.gossip] of a scenario to the services of a run.
#pragma once

#include <memory>

#include "net/gossip.hpp"
#include "scenarios/scenario.hpp"

namespace hearsay {

/// What agent `id` of the scenario says travels by; null for services of the radio itself.
std::unique_ptr<Gossip> make_gossip(const Scenario& scenario, const AgentSpec& spec, AgentId id,
                                    Simulation& simulation, Radio& radio);

/// Leaves the agent's sums in the record.
void record_gossip(Record& record, AgentId id, const GossipCounts& counts);

}  // namespace hearsay
