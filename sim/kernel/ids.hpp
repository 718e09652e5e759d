// Who is who: agents are numbered from 0 in the order of the scenario file.
#pragma once

#include <cstdint>

namespace hearsay {

/// Number of an agent in its run, from 0 in file order.
using AgentId = std::int32_t;

/// The central estimator, which hears every measurement at once.
inline constexpr AgentId central_agent = -1;

/// Nobody: an event or a failure that belongs to no agent, a broadcast's addressee.
inline constexpr AgentId no_agent = -2;

}  // namespace hearsay
