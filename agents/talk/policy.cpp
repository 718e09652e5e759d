#include "agents/talk/policy.hpp"

#include <algorithm>

namespace hearsay {

TalkPolicy::Decision TalkPolicy::decide(const Situation& now) {
  switch (options_.kind) {
    case TalkPolicyKind::on_update:
      return {.talks = now.measured};
    case TalkPolicyKind::event_triggered:
      return {.talks = now.divergence_nats > options_.divergence_nats};
    case TalkPolicyKind::adaptive:
      stretch_ = now.waiting > 0 ? std::min(2 * stretch_, stretch_max)
                                 : std::max<std::uint64_t>(stretch_ / 2, 1);
      return {.talks = now.waiting == 0, .ticks = stretch_};
    case TalkPolicyKind::periodic:
      break;
  }
  return {};
}

}  // namespace hearsay
