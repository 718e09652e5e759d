// Items that are held, in places that are used again. For the stores of the gossip services alone.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "net/gossip_frame.hpp"
#include "net/packet.hpp"

namespace hearsay::gossip {

/// Takes room as it fills and keeps it, up to a bound that its user minds.
template <class Header>
class Shelf {
 public:
  struct Item {
    Header header;
    std::vector<std::byte> payload;
    RiderPtr rider;
    std::optional<Time> sent;  ///< from here, last
    std::uint64_t serial = 0;
  };

  Item& operator[](std::uint32_t place) { return items_[place]; }
  const Item& operator[](std::uint32_t place) const { return items_[place]; }
  std::size_t size() const { return items_.size() - free_.size(); }

  std::uint32_t put(const Header& header, std::span<const std::byte> payload, RiderPtr rider) {
    if (free_.empty()) {
      items_.emplace_back();
      free_.reserve(items_.capacity());  // so that giving back never allocates
      free_.push_back(static_cast<std::uint32_t>(items_.size() - 1));
    }
    const std::uint32_t place = free_.back();
    free_.pop_back();
    fill(place, header, payload, std::move(rider));
    return place;
  }
  void fill(std::uint32_t place, const Header& header, std::span<const std::byte> payload,
            RiderPtr rider) {
    Item& item = items_[place];
    bytes_max_ = std::max(bytes_max_, payload.size());
    if (item.payload.capacity() < payload.size()) item.payload.reserve(std::bit_ceil(bytes_max_));
    item.header = header;
    item.payload.assign(payload.begin(), payload.end());
    item.rider = std::move(rider);
    item.sent.reset();
    item.serial = serials_++;
  }
  void take_out(std::uint32_t place) {
    items_[place].rider = RiderPtr();
    free_.push_back(place);
  }

 private:
  std::vector<Item> items_;
  std::vector<std::uint32_t> free_;
  std::uint64_t serials_ = 0;
  std::size_t bytes_max_ = 0;
};

/// Chooses what goes into a summary of bounded size: where all do not fit, the next summary goes on
/// where this one ends.
class SummaryCursor {
 public:
  template <class Entry>
  struct Part {
    Range range;
    std::span<const Entry> entries;
  };
  /// `entries` by ascending key_of(entry).
  template <class Entry, class KeyOf>
  Part<Entry> next(std::span<const Entry> entries, std::size_t bytes_max, KeyOf key_of) {
    const auto begin = std::find_if(entries.begin(), entries.end(),
                                    [&](const Entry& entry) { return key_of(entry) >= next_; });
    std::size_t bytes = range_bytes;
    auto end = begin;
    for (; end != entries.end(); ++end) {
      bytes += encoded_size(*end);
      if (end != begin && bytes > bytes_max) break;
    }
    Part<Entry> part{{.first = next_}, {begin, end}};
    next_ = end == entries.end() ? 0 : key_of(*end);
    part.range.last = next_ - 1;  // of 0: all the rest
    return part;
  }

 private:
  std::uint64_t next_ = 0;
};

/// Whether an item is to be sent once more in answer to a summary.
template <class Item>
bool rested(const Item& item, Time now, Duration period) {
  return !item.sent || now - *item.sent >= period;
}

}  // namespace hearsay::gossip
