// What goes over a radio: bytes, their kind, and a rider that is not on the air.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "sim/kernel/ids.hpp"
#include "sim/kernel/record.hpp"
#include "sim/kernel/time.hpp"

namespace hearsay {

/// Carries the simulator's own knowledge beside a packet, such as the rumour ledger of a belief.
/// It costs no air time and no agent may act on it. Counted by its users, given back to its pool
/// when the last lets go. One thread.
class Rider {
 public:
  virtual ~Rider() = default;
  void retain() { ++users_; }
  void release() {
    if (--users_ == 0) recycle();
  }

 private:
  virtual void recycle() = 0;
  std::uint32_t users_ = 0;
};

/// Owns one use of a Rider. Empty by default.
class RiderPtr {
 public:
  RiderPtr() = default;
  explicit RiderPtr(Rider* rider) : rider_(rider) {
    if (rider_) rider_->retain();
  }
  RiderPtr(const RiderPtr& other) : RiderPtr(other.rider_) {}
  RiderPtr(RiderPtr&& other) noexcept : rider_(other.rider_) { other.rider_ = nullptr; }
  RiderPtr& operator=(RiderPtr other) noexcept {
    Rider* mine = rider_;
    rider_ = other.rider_;
    other.rider_ = mine;
    return *this;
  }
  ~RiderPtr() {
    if (rider_) rider_->release();
  }
  Rider* get() const { return rider_; }

 private:
  Rider* rider_ = nullptr;
};

/// What became of a packet at one potential receiver. Exactly one fate each. Where several apply it
/// is the first of: sender_down, receiver_down, out_of_range, half_duplex, jammed, collided, lost.
enum class Fate : std::uint8_t {
  delivered,
  lost,              ///< the channel lost it, or one of its frames
  out_of_range,      ///< addressed to somebody the radio does not reach, or the link was down
  queue_full,        ///< the sender's queue had no room for it
  replaced,          ///< a newer packet took its place in the sender's queue
  collided,          ///< another frame was on the air at the receiver
  half_duplex,       ///< the receiver was sending meanwhile
  receiver_down,     ///< the receiver was down, or failed meanwhile
  sender_down,       ///< the sender was down, or failed before the last bit
  jammed,            ///< a jammer was stronger
  expired,           ///< waited in the sender's queue longer than it may
  in_flight_at_end,  ///< queued or on the air when the run ended
};
inline constexpr int fate_count = 12;
/// The name of the enumerator.
const char* to_string(Fate fate);

/// What an agent hands to its radio. The bytes and the rider are copied.
struct Outgoing {
  NameId kind = 0;                        ///< message kind, from Record::name
  std::span<const std::byte> bytes = {};  ///< the encoded payload; the radio adds its header
  AgentId receiver = no_agent;            ///< no_agent: everybody who can hear
  /// Number of the talk in the sender's schedule. Packets of one tick meet the same channel draw
  /// on a link, however many are sent. Without it the n-th packet on the link has draw n.
  std::optional<std::uint64_t> tick = {};
  RiderPtr rider = {};
  /// What the packet is about, for a queue that replaces: a packet of the same kind, receiver and
  /// subject is news of the same thing.
  std::uint64_t subject = 0;
  /// An addressed packet: the receiver's radio acknowledges it, the sender's repeats it otherwise,
  /// and the sender is told (Receiver::on_outcome).
  bool acknowledged = false;
};

/// What an agent gets. Valid during the call.
struct Packet {
  AgentId sender;
  AgentId receiver;  ///< who hears it now
  NameId kind;
  std::span<const std::byte> bytes;
  Time sent;  ///< when the sender handed it to its radio
  Rider* rider = nullptr;
};

}  // namespace hearsay
