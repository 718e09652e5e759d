// What is on the air at each radio: who hears which frames now, and what they do to one another.
//
// A frame is on the air at all who can hear it from its first bit to its last. Two at one radio
// collide, unless the stronger is stronger by the capture ratio and so survives. A radio that sends
// hears nothing if it is half-duplex. Overlaps are judged by the times at the senders: the way is
// short against a frame. A frame that begins at the instant at which another ends does not meet it,
// whichever of the two is told first.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "net/packet.hpp"
#include "sim/kernel/ids.hpp"
#include "sim/kernel/time.hpp"

namespace hearsay {

/// Makes `fate` the graver of the two; see Fate for the order. Both are fates of what was sent.
inline void worsen(Fate& fate, Fate other) {
  constexpr auto gravity = [] {
    std::array<std::uint8_t, fate_count> rank{};
    std::uint8_t next = 0;
    for (const Fate f :
         {Fate::delivered, Fate::lost, Fate::collided, Fate::jammed, Fate::half_duplex,
          Fate::out_of_range, Fate::receiver_down, Fate::sender_down}) {
      rank[static_cast<std::size_t>(f)] = next++;
    }
    return rank;
  }();
  if (gravity[static_cast<std::size_t>(other)] > gravity[static_cast<std::size_t>(fate)]) {
    fate = other;
  }
}

/// Told when the air around a radio is taken and when it is free again.
class AirListener {
 public:
  virtual ~AirListener() = default;
  virtual void air_taken(AgentId radio) = 0;
  /// `garbled`: something of what was heard since the air was taken could not be read.
  virtual void air_free(AgentId radio, bool garbled) = 0;
};

/// From the first bit of a frame to its last.
struct OnAir {
  Time begin;
  Time end;  ///< not before begin
};

class Receptions {
 public:
  struct Options {
    bool half_duplex = true;
    bool collisions = true;
    /// A frame stronger than another by this ratio survives the overlap, in dB, ≥ 0. Infinite: none
    /// does.
    double capture_db = std::numeric_limits<double>::infinity();
  };
  /// `listener`, if not null, outlives this.
  Receptions(int radios, const Options& options, AirListener* listener);

  /// A frame begins at `hearer`. Until end() `fate` stays where it is and is made graver by what
  /// happens to the frame there. `power_dbm` matters for capture alone.
  void begin(AgentId hearer, Fate& fate, double power_dbm, const OnAir& span);
  void end(AgentId hearer, const Fate& fate);
  /// A frame will soon begin there: asks the cache for what that needs.
  void expect(AgentId hearer) const { __builtin_prefetch(&radios_[index(hearer)]); }
  void begin_sending(AgentId radio, const OnAir& span);
  void end_sending(AgentId radio);
  /// Takes everything off the air.
  void clear();
  /// When it has sent the last bit of what it has begun to send so far.
  Time sends_until(AgentId radio) const { return radios_[index(radio)].sends_until; }
  /// True if it sends, or hears anything. At the end of a frame it is true until end().
  bool taken(AgentId radio) const { return taken(radios_[index(radio)]); }

 private:
  struct Frame {
    Fate* fate = nullptr;  // null: no frame
    double power_dbm = 0.0;
    Time end;
  };
  struct alignas(64) Ears {     // a line of the cache
    Frame first;                // on the air here: most frames are alone
    std::vector<Frame> others;  // beside a first; their order does not matter
    Time sends_until;
    int sending = 0;  // frames; 2 between the begin of one and the end of another at one instant
    bool garbled = false;
    /// Calls visit(frame) for each that is on the air here.
    template <class Visit>
    void each(Visit visit) const {
      if (first.fate != nullptr) visit(first);
      for (const Frame& frame : others) visit(frame);
    }
  };
  static std::size_t index(AgentId radio) { return static_cast<std::size_t>(radio); }
  static bool taken(const Ears& ears) { return ears.sending > 0 || ears.first.fate != nullptr; }
  void maybe_free(AgentId radio);

  Options options_;
  AirListener* listener_;
  std::vector<Ears> radios_;
};

}  // namespace hearsay
