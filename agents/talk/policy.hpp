// Whether to talk at a tick of the talk clock, and when to ask again.
#pragma once

#include <cstddef>
#include <cstdint>

namespace hearsay {

enum class TalkPolicyKind {
  periodic,         ///< at every tick
  on_update,        ///< at ticks before which something was measured since the last sending
  event_triggered,  ///< at ticks at which the belief has moved far enough from what was last sent
  adaptive,         ///< at every tick, but less often while what it said still waits to be sent
};

class TalkPolicy {
 public:
  /// An adaptive agent talks at least at every so many-th tick.
  static constexpr std::uint64_t stretch_max = 64;

  struct Options {
    TalkPolicyKind kind = TalkPolicyKind::periodic;
    double divergence_nats = 0.0;  ///< ≥ 0: event_triggered talks beyond it
  };
  explicit TalkPolicy(Options options) : options_(options) {}

  /// What an agent knows at a tick.
  struct Situation {
    bool measured = false;         ///< since the last sending
    double divergence_nats = 0.0;  ///< of the belief from what was last sent
    std::size_t waiting = 0;       ///< packets in the queue of its radio
  };
  struct Decision {
    bool talks = true;
    std::uint64_t ticks = 1;  ///< until it asks again
  };
  /// Adaptive: a queue that is not empty doubles the time to the next tick, up to stretch_max
  /// ticks, and nothing is said; an empty one halves it.
  Decision decide(const Situation& now);

  /// True if decide() looks at the divergence, which takes time to find.
  bool wants_divergence() const { return options_.kind == TalkPolicyKind::event_triggered; }

 private:
  Options options_;
  std::uint64_t stretch_ = 1;
};

}  // namespace hearsay
