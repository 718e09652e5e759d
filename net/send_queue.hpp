// Packets that wait at a transmitter, first in, first out: their numbers and sizes.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace hearsay {

/// A ring that grows to what the traffic needs and keeps its room.
class SendQueue {
 public:
  bool empty() const { return size_ == 0; }
  std::size_t size() const { return size_; }
  /// Sum of the sizes of all that wait.
  std::uint64_t bytes() const { return bytes_; }

  /// The i-th that waits, 0 … size()−1.
  std::uint32_t operator[](std::size_t i) const { return ring_[place(i)].packet; }

  void push(std::uint32_t packet, std::uint64_t bytes) {
    if (size_ == ring_.size()) grow();
    ring_[place(size_++)] = {packet, bytes};
    bytes_ += bytes;
  }
  /// Takes the first. The queue is not empty.
  std::uint32_t pop() {
    const Entry first = ring_[head_];
    head_ = head_ + 1 == ring_.size() ? 0 : head_ + 1;
    --size_;
    bytes_ -= first.bytes;
    return first.packet;
  }
  /// Puts another in the i-th place.
  void replace(std::size_t i, std::uint32_t packet, std::uint64_t bytes) {
    Entry& entry = ring_[place(i)];
    bytes_ += bytes - entry.bytes;
    entry = {packet, bytes};
  }

 private:
  struct Entry {
    std::uint32_t packet;
    std::uint64_t bytes;
  };
  std::size_t place(std::size_t i) const {
    const std::size_t p = head_ + i;
    return p < ring_.size() ? p : p - ring_.size();
  }
  void grow() {
    std::rotate(ring_.begin(), ring_.begin() + static_cast<std::ptrdiff_t>(head_), ring_.end());
    head_ = 0;
    ring_.resize(std::max<std::size_t>(4, 2 * ring_.size()));
  }

  std::vector<Entry> ring_;
  std::uint64_t bytes_ = 0;
  std::uint32_t head_ = 0;
  std::uint32_t size_ = 0;
};

}  // namespace hearsay
