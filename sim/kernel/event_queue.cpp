#include "sim/kernel/event_queue.hpp"

namespace hearsay {

namespace {

// Below this many dead keys throwing them out is not worth its call.
constexpr std::size_t retain_from = 64;
// Of fewer events the objects on which they act are in the cache anyway.
constexpr std::size_t fetch_from = 2048;

}  // namespace

bool EventQueue::cancel(EventId id) {
  const std::uint32_t node = node_of(id.name);
  if (node >= nodes_.size() || nodes_[node].name != id.name) return false;
  // The callable dies at the end, with the queue in order again: its destructor may come back here.
  const Callback dying = release(node);
  ++dead_;
  if (dead_ >= retain_from && dead_ > order_.size() / 2) {
    order_.retain([this](const EventKey& key) { return alive(key); });
    dead_ = 0;
  }
  return true;
}

// Nodes of the bucket after the next, which will be here when that bucket is the next; of the next
// one the objects on which their callbacks act, since by now its nodes are here.
void EventQueue::fetch_ahead() const {
  const auto [next, after] = order_.ahead();
  for (const EventKey& key : after) __builtin_prefetch(&nodes_[node_of(key.order)]);
  if (nodes_.size() < fetch_from) return;
  for (const EventKey& key : next) nodes_[node_of(key.order)].callback.prefetch();
}

void EventQueue::add_node() {
  require(nodes_.size() < pending_max, "more than 2^24 - 1 events are pending");
  first_free_ = static_cast<std::uint32_t>(nodes_.size());
  nodes_.emplace_back();
}

}  // namespace hearsay
