// When agents talk.
#pragma once

#include <cstdint>

#include "agents/talk/periodic.hpp"
#include "scenarios/run.hpp"

namespace hearsay {

/// The schedule of an agent that talks from time to time, in the run of this seed.
PeriodicTalk talk_of(const PreparedScenario& prepared, AgentId id, std::uint64_t seed);

}  // namespace hearsay
