// The order of pending events: small keys in, the smallest key out.
//
// A heap moves each key log N times, through memory that no cache foresees. Here a key moves two or
// three times, whatever N is, and nearly always to the end of something:
//
//     pushed            <- sooner                                                later ->
//       |
//       |    late        sorted             buckets of the window               top
//       |    +---+   +-------------+   +-----+ +-----+ +-----+ +-----+   +-----------------+
//       +--->| . |   |. . . . . . .|   |.. . | |  ...| |     | |. ..  |   |. .   . ... . .  |
//            +---+   +-------------+   +-----+ +-----+ +-----+ +-----+   +-----------------+
//              |       |         ^        |                         ^                    |
//              +---+---+         +--------+ sort the next bucket    +--------------------+
//                  v                        once the one before     spread the sooner half
//               popped                      is used up              once the window is used up
//
//   top      everything from the end of the window on, in no order.
//   buckets  the window: equal spans of time, each with a few keys in order of insertion.
//   sorted   one bucket, in order, used up from its front.
//   late     a heap of what was pushed into the span of `sorted` after it had been sorted.
//
// A push finds its place by one shift of its time. When `sorted` and `late` are empty, the next
// bucket that is not empty becomes `sorted`; when no bucket is left, the sooner half of the top
// (by a sample of its times) is spread over a new window with a bucket for every few keys.
//
// What could go wrong, and what is done about it:
//   - Many keys at one instant: they share a bucket in order of insertion, so there is nothing to
//     sort. A push at the instant that is being used up, the usual case of "now", goes to the end
//     of `sorted`.
//   - A window whose spans do not fit what is pushed later (a quiet top, then a burst): `late`
//     grows to a share of all keys, and everything is thrown back into the top and spread anew.
//   - Few keys: no window, the top is sorted as a whole.
// The idea is the ladder queue's (Tang, Goh, Thng, ACM TOMACS 15, 2005), with one rung.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace hearsay {

/// 16 bytes that say when an event happens: the smaller key first.
struct EventKey {
  std::int64_t time_ns;
  std::uint64_t order;  ///< among those of one instant

  friend bool operator<(const EventKey& a, const EventKey& b) { return a.wide() < b.wide(); }

 private:
  // One comparison of 128 bits has no branch to mispredict.
  __extension__ using Wide = __int128;
  Wide wide() const { return (static_cast<Wide>(time_ns) << 64) | order; }
};

class EventOrder {
 public:
  EventOrder();

  /// Number of keys.
  std::size_t size() const { return size_; }

  void push(EventKey key) {
    ++size_;
    if (key.time_ns >= window_end_ns_) {
      top_first_ns_ = std::min(top_first_ns_, key.time_ns);
      return top_.push_back(key);
    }
    const std::size_t bucket = bucket_of(key.time_ns);
    if (bucket > current_) return put(bucket, key);
    push_near(key);
  }

  /// The smallest key. There must be one.
  EventKey front() {
    if (next_ == sorted_.size() && late_.empty()) refill();
    return late_first() ? late_.front() : sorted_[next_];
  }

  /// Takes the smallest key out. There must be one.
  EventKey pop() {
    if (next_ == sorted_.size() && late_.empty()) refill();
    --size_;
    return late_first() ? pop_late() : sorted_[next_++];
  }

  /// Throws out every key for which keep(key) is false. Costs a visit to each.
  template <class Keep>
  void retain(const Keep& keep) {
    gather();
    std::erase_if(top_, [&](const EventKey& key) { return !keep(key); });
    size_ = top_.size();
    note_first();
  }

  /// What comes out next, in order, and what comes after that, for whoever wants to have in the
  /// cache what keys stand for. Told once at each change of bucket; valid until the next push.
  struct Ahead {
    std::span<const EventKey> next;
    std::span<const EventKey> after;
  };
  bool looks_ahead() { return std::exchange(changed_, false); }
  Ahead ahead() const;

 private:
  static constexpr std::uint32_t none = UINT32_MAX;
  static constexpr std::size_t chunk_keys = 7;
  // Buckets are chains of chunks from one pool, in order of insertion; all are full but the last.
  // How many keys that one has stands in the bucket, so that a push only writes to a chunk and need
  // not wait for it to come into the cache.
  struct Chunk {
    EventKey keys[chunk_keys];
    std::uint32_t next;
  };
  struct Bucket {
    std::uint32_t first = none;
    std::uint32_t last = none;
    std::uint32_t in_last = chunk_keys;
  };

  bool late_first() const {
    return !late_.empty() && (next_ == sorted_.size() || late_.front() < sorted_[next_]);
  }
  std::size_t bucket_of(std::int64_t time_ns) const {
    if (time_ns < window_start_ns_) return 0;
    return (static_cast<std::size_t>(time_ns) - static_cast<std::size_t>(window_start_ns_)) >>
           bucket_shift_;
  }
  void put(std::size_t bucket, EventKey key) {
    Bucket& chain = buckets_[bucket];
    if (chain.in_last == chunk_keys) add_chunk(chain);
    chunks_[chain.last].keys[chain.in_last++] = key;
  }
  EventKey pop_late();
  void push_near(EventKey key);
  void add_chunk(Bucket& chain);
  void refill();
  bool sort_next_bucket();
  void sort_top();
  void spread_top();
  void free_first_chunk(Bucket& bucket);
  void drain(Bucket& bucket, std::vector<EventKey>* into);
  void gather();
  void note_first();

  std::vector<EventKey> sorted_;
  std::size_t next_ = 0;  // what stands before it in `sorted_` is used up
  std::vector<EventKey> late_;
  std::vector<Bucket> buckets_;
  std::size_t buckets_used_ = 0;
  std::size_t current_ = 0;  // the bucket that is, or was, `sorted_`
  std::int64_t window_start_ns_ = INT64_MIN;
  std::int64_t window_end_ns_ = INT64_MIN;  // exclusive
  int bucket_shift_ = 0;                    // a bucket spans 2^shift ns
  std::vector<EventKey> top_;
  std::int64_t top_first_ns_ = INT64_MAX;
  std::size_t size_ = 0;
  std::vector<Chunk> chunks_;
  std::uint32_t free_chunk_ = none;
  bool changed_ = false;  // of bucket, since somebody looked ahead
};

}  // namespace hearsay
