#include "net/packet.hpp"

namespace hearsay {

const char* to_string(Fate fate) {
  switch (fate) {
    case Fate::delivered:
      return "delivered";
    case Fate::lost:
      return "lost";
    case Fate::out_of_range:
      return "out_of_range";
    case Fate::queue_full:
      return "queue_full";
    case Fate::in_flight_at_end:
      return "in_flight_at_end";
  }
  return "unknown fate";
}

}  // namespace hearsay
