// A packet from its hand-over to the last of its fates, and the pool it comes from. For the rooms
// of the radio alone.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "net/packet.hpp"
#include "sim/kernel/event_queue.hpp"

namespace hearsay {

/// The number of a link that is not there: to somebody who cannot hear the sender.
inline constexpr std::uint32_t no_link = UINT32_MAX;

/// A potential receiver of a packet.
struct Ear {
  Duration delay;  ///< later than others by the way there
  AgentId agent;
  std::uint32_t link;  ///< its number; of no meaning where links are not numbered
};

/// Where a packet goes: everybody who may hear, in order of arrival.
struct Route {
  std::size_t size = 0;
  const AgentId* neighbours =
      nullptr;  ///< of whom links go on from first_link; they hear at once …
  std::uint32_t first_link = 0;
  const Ear* ears = nullptr;  ///< … unless this is not null
  bool reaches = true;        ///< false: addressed to somebody who cannot hear

  Ear ear(std::size_t i) const {
    if (ears) return ears[i];
    return {Duration(), neighbours[i], first_link + static_cast<std::uint32_t>(i)};
  }
  AgentId hearer(std::size_t i) const { return ears ? ears[i].agent : neighbours[i]; }
};

/// An absurdly slow radio must not overflow the clock: what would end after the last instant ends
/// never.
inline Time later(Time time, Duration span) {
  return span < Time::never() - time ? time + span : Time::never();
}

struct Transmission {
  std::vector<std::byte> bytes;        // vectors keep their room for the slot's next packet
  std::vector<Fate> fates;             // of the hearers in order of arrival, as far as known
  std::vector<std::uint64_t> numbers;  // of its draws at the hearers, if needed again
  std::vector<Ear> ears;               // if the route is this packet's own
  // Where the channel is shared: who is disturbed by a frame that is not for them. (What would be
  // its fate there is of no interest.)
  std::vector<AgentId> overhearers;
  std::vector<Fate> overheard;
  RiderPtr rider;
  EventId event;          // the next thing to happen to it, unless that is just happening
  Time sent, start, end;  // handed over; first bit of this attempt; last bit of what began
  Time arrives;           // at hearers without a delay of their own
  Route route;
  Duration way;  // to an addressee and back, without jitter
  std::uint64_t serial = 0;
  std::uint64_t index = 0;  // its number for draws: the tick if it has one
  std::uint64_t subject = 0;
  std::size_t settled = 0;  // hearers whose fate is known for good
  AgentId sender = no_agent;
  AgentId receiver = no_agent;  // no_agent: a broadcast
  std::uint32_t frames = 1;
  std::uint32_t frames_sent = 0;  // of this attempt
  int repetition = 0;
  Fate answer = Fate::lost;       // of the acknowledgement
  Time answer_start, answer_end;  // from its first bit to its last
  NameId kind = 0;
  bool has_tick = false;
  bool acknowledged = false;  // wants to be
  bool aimed = false;         // its route is known
  bool answering = false;     // an acknowledgement is on the air
  bool cut = false;           // its sender has failed meanwhile: nothing more of it is sent
  bool under_way = false;

  bool done() const { return settled == route.size; }
  Time next() const { return later(arrives, done() ? Duration() : route.ear(settled).delay); }
  Packet packet(AgentId hearer) const { return {sender, hearer, kind, bytes, sent, rider.get()}; }
  MessageRow row(Time now) const {
    return {sent, now, sender, no_agent, kind, static_cast<std::uint32_t>(bytes.size()), 0};
  }
};

/// Each transmission stays where it is: a receiver may send, and so grow the pool, during a
/// delivery.
class TransmissionPool {
 public:
  Transmission& operator[](std::uint32_t slot) { return *slots_[slot]; }

  /// Empty but for the room of its vectors, and under way.
  std::uint32_t take() {
    if (free_.empty()) {
      slots_.push_back(std::make_unique<Transmission>());
      free_.reserve(slots_.capacity());  // so that giving back never allocates
      free_.push_back(static_cast<std::uint32_t>(slots_.size() - 1));
    }
    const std::uint32_t slot = free_.back();
    free_.pop_back();
    Transmission& t = *slots_[slot];
    t.event = EventId();
    t.start = t.end = Time();
    t.settled = 0;
    t.frames_sent = 0;
    t.repetition = 0;
    t.aimed = false;
    t.answering = false;
    t.cut = false;
    t.under_way = true;
    t.serial = taken_++;
    return slot;
  }
  void release(std::uint32_t slot) {
    Transmission& t = *slots_[slot];
    t.under_way = false;
    t.rider = RiderPtr();
    free_.push_back(slot);
  }
  /// A buffer that must grow gets room for the largest packet so far, so that each grows rarely,
  /// however sizes vary.
  void fill(Transmission& t, std::span<const std::byte> bytes) {
    bytes_max_ = std::max(bytes_max_, bytes.size());
    if (t.bytes.capacity() < bytes.size()) t.bytes.reserve(std::bit_ceil(bytes_max_));
    t.bytes.assign(bytes.begin(), bytes.end());
  }
  /// The slots under way, oldest first: what is recorded must not depend on how slots are used
  /// again.
  std::vector<std::uint32_t> under_way() const {
    std::vector<std::uint32_t> slots;
    for (std::uint32_t slot = 0; slot < slots_.size(); ++slot) {
      if (slots_[slot]->under_way) slots.push_back(slot);
    }
    std::sort(slots.begin(), slots.end(), [this](std::uint32_t a, std::uint32_t b) {
      return slots_[a]->serial < slots_[b]->serial;
    });
    return slots;
  }

 private:
  std::vector<std::unique_ptr<Transmission>> slots_;
  std::vector<std::uint32_t> free_;
  std::uint64_t taken_ = 0;
  std::size_t bytes_max_ = 0;
};

}  // namespace hearsay
