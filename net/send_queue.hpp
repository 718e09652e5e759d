// What a transmitter has to send, as far as a FIFO needs to know: when each packet's sending ends.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "sim/kernel/time.hpp"

namespace hearsay {

/// Ends of sending, ascending. Those that have passed are dropped when somebody looks, so a queue
/// costs no event of its own. It grows to what the traffic needs and keeps its room.
class SendQueue {
 public:
  /// Number of packets that wait or are being sent at `now`, which never goes back.
  std::size_t occupancy(Time now) {
    while (size_ > 0 && ends_[head_] <= now) {
      head_ = head_ + 1 == ends_.size() ? 0 : head_ + 1;
      --size_;
    }
    return size_;
  }

  /// When the sender has sent all it was given; the start of the run if that is nothing.
  Time free_at() const { return free_at_; }

  /// One packet more, whose sending ends at `end` ≥ free_at().
  void push(Time end) {
    if (size_ == ends_.size()) grow();
    const std::size_t tail = head_ + size_;
    ends_[tail < ends_.size() ? tail : tail - ends_.size()] = end;
    ++size_;
    free_at_ = end;
  }

 private:
  void grow() {
    std::rotate(ends_.begin(), ends_.begin() + static_cast<std::ptrdiff_t>(head_), ends_.end());
    head_ = 0;
    ends_.resize(std::max<std::size_t>(4, 2 * ends_.size()));
  }

  std::vector<Time> ends_;  // a ring from head_
  std::size_t head_ = 0;
  std::size_t size_ = 0;
  Time free_at_;
};

}  // namespace hearsay
