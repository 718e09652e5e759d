// From agents.traffic to the traffic of a source.
#pragma once

#include <cstdint>

#include "agents/traffic/packet_sizes.hpp"
#include "scenarios/scenario.hpp"
#include "sim/kernel/ids.hpp"

namespace hearsay {

struct SourceTraffic;

PacketSizes packet_sizes(const TrafficSpec& spec);

/// The traffic of agent `agent` in a run with this seed, which settles a phase at random.
SourceTraffic traffic_of(const TrafficSpec& spec, AgentId agent, std::uint64_t seed);

}  // namespace hearsay
