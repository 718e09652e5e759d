#include "net/packet.hpp"

#include <iterator>

namespace hearsay {

const char* to_string(Fate fate) {
  constexpr const char* names[] = {"delivered",   "lost",     "out_of_range", "queue_full",
                                   "replaced",    "collided", "half_duplex",  "receiver_down",
                                   "sender_down", "jammed",   "expired",      "in_flight_at_end"};
  static_assert(std::size(names) == fate_count);
  const auto f = static_cast<std::size_t>(fate);
  return f < fate_count ? names[f] : "unknown fate";
}

}  // namespace hearsay
