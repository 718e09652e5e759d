#include "agents/alone.hpp"

namespace hearsay {

Alone::Alone(int subjects, int n, const std::optional<MotionModel>& motion)
    : motion_(motion),
      held_(static_cast<std::size_t>(subjects), Held{.belief = gaussian::Belief::unknown(n)}) {}

void Alone::measured(int subject, const gaussian::Belief& information, std::int64_t now) {
  at(subject, now);
  held_[static_cast<std::size_t>(subject)].belief += information;
}

void Alone::forget() {
  for (Held& held : held_) held.belief = gaussian::Belief::unknown(held.belief.dimension());
}

const gaussian::Belief& Alone::at(int subject, std::int64_t now) {
  Held& held = held_[static_cast<std::size_t>(subject)];
  if (!motion_) return held.belief;
  // Who knows nothing knows nothing later.
  if (held.belief.omega.isZero(0.0)) held.stamp = now;
  for (; held.stamp < now; ++held.stamp) held.belief = predict(held.belief, motion_->step);
  return held.belief;
}

}  // namespace hearsay
