#include "net/receptions.hpp"

#include <algorithm>

#include "sim/kernel/error.hpp"

namespace hearsay {
Receptions::Receptions(int radios, const Options& options, AirListener* listener)
    : options_(options), listener_(listener), radios_(static_cast<std::size_t>(radios)) {}

void Receptions::begin(AgentId hearer, Fate& fate, double power_dbm, const OnAir& span) {
  Ears& ears = radios_[index(hearer)];
  const bool was_taken = taken(ears);
  if (ears.sends_until > span.begin && options_.half_duplex) worsen(fate, Fate::half_duplex);
  if (options_.collisions) {
    ears.each([&](const Frame& other) {
      if (other.end <= span.begin) return;
      ears.garbled = true;
      if (!(power_dbm >= other.power_dbm + options_.capture_db)) worsen(fate, Fate::collided);
      if (!(other.power_dbm >= power_dbm + options_.capture_db)) {
        worsen(*other.fate, Fate::collided);
      }
    });
  }
  const Frame frame{&fate, power_dbm, span.end};
  if (ears.first.fate == nullptr) {
    ears.first = frame;
  } else {
    ears.others.push_back(frame);
  }
  if (!was_taken && listener_) listener_->air_taken(hearer);
}

void Receptions::end(AgentId hearer, const Fate& fate) {
  Ears& ears = radios_[index(hearer)];
  Frame* gone = &ears.first;
  if (gone->fate != &fate) {
    const auto other = std::find_if(ears.others.begin(), ears.others.end(),
                                    [&](const Frame& f) { return f.fate == &fate; });
    require(other != ears.others.end(), "radio: the end of a frame that nobody heard begin");
    gone = &*other;
  }
  if (ears.others.empty()) {
    *gone = Frame();
  } else {
    *gone = ears.others.back();
    ears.others.pop_back();
  }
  maybe_free(hearer);
}

void Receptions::begin_sending(AgentId radio, const OnAir& span) {
  Ears& ears = radios_[index(radio)];
  const bool was_taken = taken(ears);
  ++ears.sending;
  ears.sends_until = std::max(ears.sends_until, span.end);
  if (options_.half_duplex) {
    ears.each([&](const Frame& frame) {
      if (frame.end > span.begin) worsen(*frame.fate, Fate::half_duplex);
    });
  }
  if (!was_taken && listener_) listener_->air_taken(radio);
}

void Receptions::end_sending(AgentId radio) {
  Ears& ears = radios_[index(radio)];
  require(ears.sending > 0, "radio: the end of a frame that nobody sent");
  --ears.sending;
  maybe_free(radio);
}

void Receptions::clear() {
  for (std::size_t radio = 0; radio < radios_.size(); ++radio) {
    Ears& ears = radios_[radio];
    const bool was_taken = taken(ears);
    ears.first = Frame();
    ears.others.clear();
    ears.sending = 0;
    ears.sends_until = Time();
    if (was_taken) maybe_free(static_cast<AgentId>(radio));
  }
}

void Receptions::maybe_free(AgentId radio) {
  Ears& ears = radios_[index(radio)];
  if (taken(ears)) return;
  const bool garbled = ears.garbled;
  ears.garbled = false;
  if (listener_) listener_->air_free(radio, garbled);
}

}  // namespace hearsay
