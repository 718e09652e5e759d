// The pending events of a run, ordered by (time, phase, sequence).
//
// Sequence is the order of insertion, so events of one instant and phase happen in the order in
// which they were scheduled. The phase ranks what happens at one instant: first the world moves,
// then sensors look, then packets and updates arrive, then agents act and talk, and last somebody
// takes samples.
//
// Two halves: what happens stands in a slab of 64-byte nodes, used again last freed first; when it
// happens is a 16-byte key in an EventOrder, which knows nothing of nodes. A key is the time, then
// one word that holds phase, sequence and the number of the node:
//
//     | phase 3 bits | sequence 37 bits | node 24 bits |
//
// The word is unique, so it is also the event's name. A node bears the name of the event it holds;
// cancelling empties the node, and the key, whose name no node bears any more, is passed over when
// it comes out. When more keys are dead than alive, all dead ones are thrown out.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/kernel/callback.hpp"
#include "sim/kernel/error.hpp"
#include "sim/kernel/event_order.hpp"
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
  std::uint64_t name = UINT64_MAX;
  bool operator==(const EventId&) const = default;
};

class EventQueue {
 public:
  static constexpr std::size_t pending_max = (std::size_t{1} << 24) - 1;
  static constexpr std::uint64_t scheduled_max = std::uint64_t{1} << 37;

  /// Schedules `callback`, which must not be empty.
  /// @throws BrokenInvariant beyond pending_max pending events or scheduled_max over a run.
  template <class Function>
  EventId push(Time time, Phase phase, Function&& callback) {
    if (first_free_ == no_node) add_node();
    const std::uint32_t taken = first_free_;
    Node& node = nodes_[taken];
    node.callback = std::forward<Function>(callback);  // built in its place
    require(static_cast<bool>(node.callback), "an event was scheduled without a callback");
    first_free_ = node.next_free;
    node.name = next_name(phase, taken);
    order_.push({time.nanoseconds(), node.name});
    return {node.name};
  }

  /// Takes back an event that has not happened. @return false if it has, or was cancelled already.
  bool cancel(EventId id);

  bool empty() const { return size() == 0; }
  /// Number of live events.
  std::size_t size() const { return order_.size() - dead_; }

  /// Time of the first event. The queue must not be empty.
  Time next_time() {
    require(!empty(), "the time of the next event was asked of an empty queue");
    EventKey first = order_.front();
    while (!alive(first)) {
      --dead_;
      order_.pop();
      first = order_.front();
    }
    return Time::nanoseconds(first.time_ns);
  }

  struct Event {
    Time time;
    Phase phase;
    Callback callback;
  };
  /// Removes and returns the first event. The queue must not be empty.
  Event pop() {
    require(!empty(), "an event was taken from an empty queue");
    EventKey key = order_.pop();
    while (!alive(key)) {
      --dead_;
      key = order_.pop();
    }
    if (order_.looks_ahead()) fetch_ahead();
    return {Time::nanoseconds(key.time_ns), static_cast<Phase>(key.order >> phase_shift),
            release(node_of(key.order))};
  }

 private:
  static constexpr std::uint32_t no_node = UINT32_MAX;
  static constexpr int node_bits = 24;
  static constexpr int phase_shift = 61;
  struct alignas(64) Node {  // a line of the cache
    Callback callback;
    std::uint64_t name = UINT64_MAX;  // of the event that it holds
    std::uint32_t next_free = no_node;
  };
  static std::uint32_t node_of(std::uint64_t name) { return name & pending_max; }
  bool alive(const EventKey& key) const { return nodes_[node_of(key.order)].name == key.order; }
  std::uint64_t next_name(Phase phase, std::uint32_t node) {
    require(next_sequence_ < scheduled_max, "more than 2^37 events were scheduled in one run");
    return (static_cast<std::uint64_t>(phase) << phase_shift) | (next_sequence_++ << node_bits) |
           node;
  }
  Callback release(std::uint32_t node) {
    Node& freed = nodes_[node];
    freed.name = UINT64_MAX;
    freed.next_free = first_free_;
    first_free_ = node;
    return std::move(freed.callback);
  }
  void add_node();
  void fetch_ahead() const;

  EventOrder order_;
  std::vector<Node> nodes_;
  std::uint32_t first_free_ = no_node;
  std::uint64_t next_sequence_ = 0;
  std::size_t dead_ = 0;  // keys of events that were taken back
};

}  // namespace hearsay
