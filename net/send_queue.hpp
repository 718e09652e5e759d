// What a transmitter has to send, as far as a FIFO needs to know: when each packet's sending ends.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "sim/kernel/time.hpp"

namespace hearsay {

/// Costs no event of its own: what has been sent is forgotten when somebody looks. Grows to what
/// the traffic needs and keeps its room.
class SendQueue {
 public:
  /// Number of packets that wait or are being sent at `now`, which never goes back.
  std::size_t occupancy(Time now) {
    if (free_at_ <= now) {
      size_ = 0;
      return 0;
    }
    while (size_ > 0 && ends_[head_] <= now) {
      head_ = head_ + 1 == ends_.size() ? 0 : head_ + 1;
      --size_;
    }
    return size_ + 1;
  }

  /// When the sender has sent all it was given; the start of the run if that is nothing.
  Time free_at() const { return free_at_; }

  /// One packet more at `now`, whose sending ends at `end` ≥ free_at().
  void push(Time now, Time end) {
    if (occupancy(now) > 0) put_back(free_at_);
    free_at_ = end;
  }

 private:
  void put_back(Time end) {
    if (size_ == ends_.size()) grow();
    const std::size_t tail = head_ + size_;
    ends_[tail < ends_.size() ? tail : tail - ends_.size()] = end;
    ++size_;
  }
  void grow() {
    std::rotate(ends_.begin(), ends_.begin() + static_cast<std::ptrdiff_t>(head_), ends_.end());
    head_ = 0;
    ends_.resize(std::max<std::size_t>(4, 2 * ends_.size()));
  }

  Time free_at_;            // end of the last packet's sending
  std::vector<Time> ends_;  // of those before it, ascending: a ring from head_
  std::size_t head_ = 0;
  std::size_t size_ = 0;
};

}  // namespace hearsay
