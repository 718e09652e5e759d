#include "agents/talk/periodic.hpp"

namespace hearsay {

Duration talk_phase(TalkPhase kind, Duration period, AgentId agent, int agents,
                    std::uint64_t seed) {
  switch (kind) {
    case TalkPhase::together:
      return Duration();
    case TalkPhase::staggered:
      return Duration::nanoseconds(period.nanoseconds() / agents * agent +
                                   period.nanoseconds() % agents * agent / agents);
    case TalkPhase::random:
      break;
  }
  Stream draws(seed, Purpose("talk phase"), Entity::agent(agent));
  return Duration::nanoseconds(
      static_cast<std::int64_t>(draws.below(static_cast<std::uint64_t>(period.nanoseconds()))));
}

}  // namespace hearsay
