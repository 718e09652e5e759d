// Who may send when, where radios share a channel: slotted ALOHA, carrier sense, time division.
//
// A radio that has a frame asks; sooner or later it is granted the air at that very instant. In the
// slotted ways every frame begins with a slot of its own. Draws are keyed by (seed, radio, number
// of the request), so what one radio draws does not depend on the others.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "net/receptions.hpp"
#include "sim/kernel/simulation.hpp"

namespace hearsay {

enum class Sharing : std::uint8_t {
  none,           ///< everybody sends at will, packets pass through one another
  slotted_aloha,  ///< at the next slot, with a probability (Abramson 1970, Roberts 1975)
  carrier_sense,  ///< listens, waits a random number of idle slots (IEEE 802.11 DCF)
  tdma,           ///< radio i sends in slots i, i + slots, i + 2·slots, …
};

struct AccessOptions {
  Sharing sharing = Sharing::none;
  Duration slot;                  ///< > 0; not for none
  double send_probability = 1.0;  ///< slotted ALOHA: of taking a slot, [0.001, 1]
  int slots = 0;                  ///< tdma: in a cycle; 0: as many as radios
  /// Carrier sense: the air must be free so long before slots are counted, ≥ 0.
  Duration interframe;
  /// Carrier sense: added to interframe after something that could not be read, ≥ 0, so that an
  /// acknowledgement that others expect is not disturbed.
  Duration interframe_garbled;
  int window_min = 16;  ///< carrier sense: the back-off is below this many slots, 1 … 65536, …
  int window_max = 1024;  ///< … doubled with each repetition of a frame up to this
};

/// Is granted the air.
class AccessUser {
 public:
  virtual ~AccessUser() = default;
  virtual void granted(AgentId radio) = 0;
};

class Access {
 public:
  virtual ~Access() = default;
  /// `radio`, which neither sends nor has asked, wants to send a frame for the `repetition`-th time
  /// after the first. AccessUser::granted(radio) follows from an event of its own.
  virtual void request(AgentId radio, int repetition) = 0;
  /// It does not want to any more. Nothing happens if it did not ask.
  virtual void withdraw(AgentId radio) = 0;
  /// Wants to know about the air; null if it does not care.
  virtual AirListener* listener() { return nullptr; }
};

/// Null for Sharing::none. `simulation` and `user` outlive it.
/// @throws InputError for an option outside its range.
std::unique_ptr<Access> make_access(const AccessOptions& options, Simulation& simulation,
                                    int radios, AccessUser& user);

}  // namespace hearsay
