// The pending events of a run, ordered by (time, phase, sequence).
//
// Sequence is the order of insertion, so events of one instant and phase happen in the order in
// which they were scheduled. The phase ranks what happens at one instant: first the world moves,
// then sensors look, then packets and updates arrive, then agents act and talk, and last somebody
// takes samples. Phase and sequence share one 64-bit number, so an order is two comparisons.
//
// Today a binary heap of small keys over a slab of callbacks; cancelling marks the slab's slot, and
// the key is dropped when it surfaces (or when more than half of the heap is dead, by a sweep).
// Nothing outside this header knows that.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/kernel/callback.hpp"
#include "sim/kernel/time.hpp"

namespace hearsay {

/// Rank of an event among those of the same instant.
enum class Phase : std::uint8_t {
  world = 0,    ///< the truth moves, links appear and fail
  measure = 1,  ///< sensors look
  update = 2,   ///< packets arrive, beliefs are updated
  act = 3,      ///< agents decide, move and talk (the default)
  observe = 4,  ///< samples for a series; must schedule nothing at the same instant
};

/// Names one scheduled event; stays unique after the event has happened. Default: no event, and
/// cancelling that does nothing.
struct EventId {
  std::uint32_t slot = UINT32_MAX;
  std::uint32_t generation = 0;
  bool operator==(const EventId&) const = default;
};

class EventQueue {
 public:
  /// Schedules `callback`. At most 2^32 − 1 events pending and 2^60 scheduled over a run.
  EventId push(Time time, Phase phase, Callback callback);

  /// Takes back an event that has not happened. @return false if it has, or was cancelled already.
  bool cancel(EventId id);

  bool empty() const { return size_ == 0; }
  /// Number of live events.
  std::size_t size() const { return size_; }

  /// Time of the first event. The queue must not be empty.
  Time next_time();

  struct Event {
    Time time;
    Phase phase;
    Callback callback;
  };
  /// Removes and returns the first event. The queue must not be empty.
  Event pop();

 private:
  static constexpr std::uint32_t no_slot = UINT32_MAX;
  struct Key {
    std::int64_t time_ns;
    std::uint64_t order;  // phase in the top 4 bits, sequence below
    std::uint32_t slot;
    std::uint32_t generation;
  };
  struct Slot {
    Callback callback;
    std::uint32_t generation = 0;
    std::uint32_t next_free = no_slot;
  };
  static bool later(const Key& a, const Key& b);
  bool alive(const Key& key) const { return slots_[key.slot].generation == key.generation; }
  Callback release(std::uint32_t slot);
  void drop_dead_top();
  void sweep();

  std::vector<Key> heap_;
  std::vector<Slot> slots_;
  std::uint32_t first_free_ = no_slot;
  std::uint64_t next_sequence_ = 0;
  std::size_t size_ = 0;
};

}  // namespace hearsay
