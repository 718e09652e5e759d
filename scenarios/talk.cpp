#include "scenarios/talk.hpp"

#include <string>

namespace hearsay {
namespace {

TalkPhase talk_phase_of(const std::string& name) {
  if (name == "staggered") return TalkPhase::staggered;
  return name == "together" ? TalkPhase::together : TalkPhase::random;
}

}  // namespace

PeriodicTalk talk_of(const PreparedScenario& prepared, AgentId id, std::uint64_t seed) {
  const TalkSpec& talk = prepared.specs[static_cast<std::size_t>(id)]->talk;
  const Duration period = Duration::seconds(talk.period_s);
  const Duration phase = talk.phase_s ? Duration::seconds(*talk.phase_s)
                                      : talk_phase(talk_phase_of(talk.phase), period, id,
                                                   static_cast<int>(prepared.specs.size()), seed);
  return PeriodicTalk{.period = period, .phase = phase};
}

}  // namespace hearsay
