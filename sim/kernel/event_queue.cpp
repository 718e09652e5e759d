#include "sim/kernel/event_queue.hpp"

#include <algorithm>

#include "sim/kernel/error.hpp"

namespace hearsay {

namespace {

constexpr int sequence_bits = 60;
constexpr std::uint64_t sequence_end = std::uint64_t{1} << sequence_bits;
// Below this many keys a sweep is not worth its call.
constexpr std::size_t sweep_from = 64;

}  // namespace

bool EventQueue::later(const Key& a, const Key& b) {
  return a.time_ns != b.time_ns ? a.time_ns > b.time_ns : a.order > b.order;
}

EventId EventQueue::push(Time time, Phase phase, Callback callback) {
  require(static_cast<bool>(callback), "an event was scheduled without a callback");
  require(next_sequence_ < sequence_end, "more than 2^60 events were scheduled in one run");
  std::uint32_t slot = first_free_;
  if (slot != no_slot) {
    first_free_ = slots_[slot].next_free;
  } else {
    require(slots_.size() < no_slot, "more than 2^32 - 1 events are pending");
    slot = static_cast<std::uint32_t>(slots_.size());
    slots_.emplace_back();
  }
  slots_[slot].callback = std::move(callback);
  const std::uint32_t generation = slots_[slot].generation;
  const std::uint64_t order =
      (static_cast<std::uint64_t>(phase) << sequence_bits) | next_sequence_++;
  heap_.push_back({time.nanoseconds(), order, slot, generation});
  std::push_heap(heap_.begin(), heap_.end(), later);
  ++size_;
  return {slot, generation};
}

bool EventQueue::cancel(EventId id) {
  if (id.slot >= slots_.size() || slots_[id.slot].generation != id.generation) return false;
  // The callable dies at the end, with the queue in order again: its destructor may come back here.
  const Callback dying = release(id.slot);
  const std::size_t dead = heap_.size() - size_;
  if (heap_.size() >= sweep_from && dead > heap_.size() / 2) sweep();
  return true;
}

Time EventQueue::next_time() {
  require(size_ > 0, "the time of the next event was asked of an empty queue");
  drop_dead_top();
  return Time::nanoseconds(heap_.front().time_ns);
}

EventQueue::Event EventQueue::pop() {
  require(size_ > 0, "an event was taken from an empty queue");
  drop_dead_top();
  const Key key = heap_.front();
  std::pop_heap(heap_.begin(), heap_.end(), later);
  heap_.pop_back();
  return {Time::nanoseconds(key.time_ns), static_cast<Phase>(key.order >> sequence_bits),
          release(key.slot)};
}

Callback EventQueue::release(std::uint32_t slot) {
  Slot& freed = slots_[slot];
  Callback callback = std::move(freed.callback);
  --size_;
  ++freed.generation;
  // A slot whose generations are used up is not used again, so that ids stay unique.
  if (freed.generation != UINT32_MAX) {
    freed.next_free = first_free_;
    first_free_ = slot;
  }
  return callback;
}

void EventQueue::drop_dead_top() {
  while (!alive(heap_.front())) {
    std::pop_heap(heap_.begin(), heap_.end(), later);
    heap_.pop_back();
  }
}

void EventQueue::sweep() {
  std::erase_if(heap_, [this](const Key& key) { return !alive(key); });
  std::make_heap(heap_.begin(), heap_.end(), later);
}

}  // namespace hearsay
