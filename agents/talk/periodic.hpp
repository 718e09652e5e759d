// When to talk: every `period`, from a phase on.
#pragma once

#include <cstdint>

#include "sim/kernel/ids.hpp"
#include "sim/kernel/random.hpp"
#include "sim/kernel/time.hpp"

namespace hearsay {

/// How many of the instants start, start + period, … lie before `now`: what the next one is
/// numbered. period > 0.
inline std::uint64_t instants_before(Time now, Time start, Duration period) {
  const Duration since = now - start;
  if (since <= Duration()) return 0;
  return static_cast<std::uint64_t>((since.nanoseconds() + period.nanoseconds() - 1) /
                                    period.nanoseconds());
}

/// How the phases of a fleet's agents relate.
enum class TalkPhase {
  random,     ///< uniform on [0, period), a stream of its own
  staggered,  ///< agent i of n at i·period/n
  together,   ///< all at 0
};

struct PeriodicTalk {
  Duration period;  ///< > 0
  Duration phase;   ///< instant of tick 0, in [0, period)

  /// The instant of tick k ≥ 0. Ticks number the channel draws (contracts: pairing).
  Time tick(std::uint64_t k) const {
    return Time::at(phase + period * static_cast<std::int64_t>(k));
  }
  /// The first tick that is not before `now`.
  std::uint64_t next_tick(Time now) const { return instants_before(now, Time::at(phase), period); }
};

/// The phase of agent `agent` of `agents`.
Duration talk_phase(TalkPhase kind, Duration period, AgentId agent, int agents, std::uint64_t seed);

}  // namespace hearsay
