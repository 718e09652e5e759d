#include "sim/kernel/event_order.hpp"

#include <algorithm>
#include <array>
#include <bit>

namespace hearsay {

namespace {

constexpr std::size_t keys_a_bucket = 6;
constexpr std::size_t sort_whole_below = 48;  // keys: a window is not worth its while
constexpr std::size_t samples = 32;
constexpr std::size_t room_min = 64;
constexpr std::size_t late_min = 64;   // keys: before that, `late` is cheap however it came about
constexpr std::size_t late_share = 4;  // `late` holds at most one key in four

bool after(const EventKey& a, const EventKey& b) { return b < a; }

// Each key goes where as many stand before it as are smaller. For a few keys in random order that
// is faster than a sort with branches, half of which would be mispredicted.
template <std::size_t max>
void sort_by_rank(const EventKey (&keys)[max], std::size_t count, EventKey* sorted) {
  std::uint32_t rank[max];
  for (std::uint32_t i = 0; i < count; ++i) {
    std::uint32_t smaller = i;
    for (std::uint32_t j = 0; j < i; ++j) {
      const std::uint32_t after = keys[i] < keys[j];
      smaller -= after;
      rank[j] += after;
    }
    rank[i] = smaller;
  }
  for (std::size_t i = 0; i < count; ++i) sorted[rank[i]] = keys[i];
}

void sort(std::vector<EventKey>& keys) {
  if (!std::is_sorted(keys.begin(), keys.end())) std::sort(keys.begin(), keys.end());
}

// The time that half of the keys come before, roughly: the median of every so many-th key.
std::int64_t median_time_ns(const std::vector<EventKey>& keys) {
  std::array<std::int64_t, samples> times_ns;
  const std::size_t step = keys.size() / samples;
  for (std::size_t i = 0; i < samples; ++i) times_ns[i] = keys[i * step].time_ns;
  std::nth_element(times_ns.begin(), times_ns.begin() + samples / 2, times_ns.end());
  return times_ns[samples / 2];
}

}  // namespace

// Room for what few events need at most, so that a new record of crowding, rare as it may be, does
// not allocate in the middle of a run.
EventOrder::EventOrder() {
  sorted_.reserve(room_min);
  late_.reserve(room_min);
  top_.reserve(room_min);
}

EventKey EventOrder::pop_late() {
  const EventKey first = late_.front();
  std::pop_heap(late_.begin(), late_.end(), after);
  late_.pop_back();
  return first;
}

void EventOrder::add_chunk(Bucket& chain) {
  std::uint32_t added = free_chunk_;
  if (added != none) {
    free_chunk_ = chunks_[added].next;
  } else {
    added = static_cast<std::uint32_t>(chunks_.size());
    chunks_.emplace_back();
  }
  chunks_[added].next = none;
  (chain.last == none ? chain.first : chunks_[chain.last].next) = added;
  chain.last = added;
  chain.in_last = 0;
}

// Into the span of `sorted`.
void EventOrder::push_near(EventKey key) {
  if (next_ == sorted_.size() || sorted_.back() < key) {
    if (sorted_.size() == sorted_.capacity() && next_ > sorted_.size() / 2) {
      sorted_.erase(sorted_.begin(), sorted_.begin() + static_cast<std::ptrdiff_t>(next_));
      next_ = 0;
    }
    sorted_.push_back(key);
    return;
  }
  late_.push_back(key);
  std::push_heap(late_.begin(), late_.end(), after);
  if (late_.size() > late_min && late_.size() > size_ / late_share) gather();
}

void EventOrder::refill() {
  sorted_.clear();
  next_ = 0;
  if (sort_next_bucket()) return;
  if (top_.size() < sort_whole_below) {
    sort_top();
  } else {
    spread_top();
    sort_next_bucket();
  }
}

bool EventOrder::sort_next_bucket() {
  while (current_ < buckets_used_ && buckets_[current_].first == none) ++current_;
  if (current_ == buckets_used_) return false;
  Bucket& bucket = buckets_[current_];
  if (bucket.first == bucket.last) {  // the usual case: one chunk
    sorted_.resize(bucket.in_last);
    sort_by_rank(chunks_[bucket.first].keys, bucket.in_last, sorted_.data());
    free_first_chunk(bucket);
  } else {
    drain(bucket, &sorted_);
    sort(sorted_);
  }
  changed_ = true;
  return true;
}

EventOrder::Ahead EventOrder::ahead() const {
  Ahead ahead{std::span(sorted_).subspan(next_), {}};
  if (current_ + 1 < buckets_used_ && buckets_[current_ + 1].first != none) {
    const Bucket& after = buckets_[current_ + 1];
    ahead.after = std::span(chunks_[after.first].keys)
                      .first(after.first == after.last ? after.in_last : chunk_keys);
  }
  return ahead;
}

void EventOrder::sort_top() {
  sorted_.swap(top_);
  top_first_ns_ = INT64_MAX;
  sort(sorted_);
  buckets_used_ = 0;
  current_ = 0;
  const std::int64_t last_ns = sorted_.back().time_ns;
  window_end_ns_ = last_ns == INT64_MAX ? last_ns : last_ns + 1;
  window_start_ns_ = window_end_ns_;  // no buckets: all before counts as the current one
}

void EventOrder::spread_top() {
  if (top_first_ns_ == INT64_MAX) return sort_top();  // no window ends after that
  window_start_ns_ = top_first_ns_;
  const auto start = static_cast<std::uint64_t>(window_start_ns_);
  const std::uint64_t span = static_cast<std::uint64_t>(median_time_ns(top_)) - start;
  const std::uint64_t buckets = std::bit_ceil(top_.size() / 2 / keys_a_bucket + 1);
  const auto bits = [](std::uint64_t value) { return static_cast<int>(std::bit_width(value)); };
  bucket_shift_ = std::max(0, bits(span) - bits(buckets) + 1);
  buckets_used_ = static_cast<std::size_t>(span >> bucket_shift_) + 1;
  if (buckets_.size() < buckets_used_) buckets_.resize(std::bit_ceil(buckets_used_));
  current_ = 0;
  const std::uint64_t room = static_cast<std::uint64_t>(INT64_MAX) - start;
  window_end_ns_ = buckets_used_ <= room >> bucket_shift_
                       ? static_cast<std::int64_t>(start + (buckets_used_ << bucket_shift_))
                       : INT64_MAX;

  // Which keys stay is random, so there is no branch on it: both copies are made, one is kept.
  std::array<EventKey, 64> leaving;
  std::size_t kept = 0;
  top_first_ns_ = INT64_MAX;
  for (std::size_t block = 0; block < top_.size(); block += leaving.size()) {
    std::size_t left = 0;
    const std::size_t end = std::min(top_.size(), block + leaving.size());
    for (std::size_t i = block; i < end; ++i) {
      const EventKey key = top_[i];
      const bool leaves = key.time_ns < window_end_ns_;
      top_first_ns_ = std::min(top_first_ns_, leaves ? INT64_MAX : key.time_ns);
      leaving[left] = key;
      left += leaves;
      top_[kept] = key;
      kept += !leaves;
    }
    for (std::size_t i = 0; i < left; ++i) put(bucket_of(leaving[i].time_ns), leaving[i]);
  }
  top_.resize(kept);
}

void EventOrder::free_first_chunk(Bucket& bucket) {
  const std::uint32_t freed = bucket.first;
  bucket.first = chunks_[freed].next;
  if (bucket.first == none) bucket = Bucket();
  chunks_[freed].next = free_chunk_;
  free_chunk_ = freed;
}

// Hands all keys of a bucket on, in order of insertion.
void EventOrder::drain(Bucket& bucket, std::vector<EventKey>* into) {
  while (bucket.first != none) {
    const EventKey* const keys = chunks_[bucket.first].keys;
    const std::size_t count = bucket.first == bucket.last ? bucket.in_last : chunk_keys;
    into->insert(into->end(), keys, keys + count);
    free_first_chunk(bucket);
  }
}

// Throws everything back into the top.
void EventOrder::gather() {
  top_.insert(top_.end(), sorted_.begin() + static_cast<std::ptrdiff_t>(next_), sorted_.end());
  top_.insert(top_.end(), late_.begin(), late_.end());
  for (std::size_t i = current_; i < buckets_used_; ++i) drain(buckets_[i], &top_);
  sorted_.clear();
  late_.clear();
  next_ = 0;
  buckets_used_ = 0;
  current_ = 0;
  window_start_ns_ = INT64_MIN;
  window_end_ns_ = INT64_MIN;
  note_first();
}

void EventOrder::note_first() {
  top_first_ns_ = INT64_MAX;
  for (const EventKey& key : top_) top_first_ns_ = std::min(top_first_ns_, key.time_ns);
}

}  // namespace hearsay
