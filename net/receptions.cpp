#include "net/receptions.hpp"

#include <algorithm>

#include "sim/kernel/error.hpp"

namespace hearsay {
Receptions::Receptions(int radios, const Options& options, AirListener* listener)
    : options_(options), listener_(listener), radios_(static_cast<std::size_t>(radios)) {}

void Receptions::begin(AgentId hearer, Fate& fate, double power_dbm) {
  Ears& ears = radios_[index(hearer)];
  const bool was_taken = taken(ears);
  if (ears.sending && options_.half_duplex) worsen(fate, Fate::half_duplex);
  if (options_.collisions) {
    for (const Frame& other : ears.frames) {
      ears.garbled = true;
      if (!(power_dbm >= other.power_dbm + options_.capture_db)) worsen(fate, Fate::collided);
      if (!(other.power_dbm >= power_dbm + options_.capture_db)) {
        worsen(*other.fate, Fate::collided);
      }
    }
  }
  ears.frames.push_back({&fate, power_dbm});
  if (!was_taken && listener_) listener_->air_taken(hearer);
}

void Receptions::end(AgentId hearer, const Fate& fate) {
  Ears& ears = radios_[index(hearer)];
  const auto frame = std::find_if(ears.frames.begin(), ears.frames.end(),
                                  [&](const Frame& f) { return f.fate == &fate; });
  require(frame != ears.frames.end(), "radio: the end of a frame that nobody heard begin");
  *frame = ears.frames.back();
  ears.frames.pop_back();
  maybe_free(hearer);
}

void Receptions::begin_sending(AgentId radio) {
  Ears& ears = radios_[index(radio)];
  const bool was_taken = taken(ears);
  ears.sending = true;
  if (options_.half_duplex) {
    for (const Frame& frame : ears.frames) worsen(*frame.fate, Fate::half_duplex);
  }
  if (!was_taken && listener_) listener_->air_taken(radio);
}

void Receptions::end_sending(AgentId radio) {
  radios_[index(radio)].sending = false;
  maybe_free(radio);
}

void Receptions::maybe_free(AgentId radio) {
  Ears& ears = radios_[index(radio)];
  if (taken(ears)) return;
  const bool garbled = ears.garbled;
  ears.garbled = false;
  if (listener_) listener_->air_free(radio, garbled);
}

}  // namespace hearsay
