// What the gossip services send, as bytes: little-endian, without padding, the first byte says what
// it is.
//
//   bundle         1, u8 hops left, u16 kind, u32 origin, u32 incarnation, u32 sequence,
//                  u32 addressee, i64 written (ns); the payload
//   bundles seen   2, u64 first, u64 last; for each source in ascending order: u64 source,
//                  u32 base, u8 words, u64 each (SeenWindow)
//   slot           3, u64 key, u32 writer, i64 written (ns); the payload
//   slots held     4, u64 first, u64 last; for each slot in ascending order: u64 key, u32 writer,
//                  i64 written (ns)
//
// A source is an agent between two losses of its memory. A summary ("seen", "held") speaks of all
// keys from `first` to `last`: of those that it does not name, nothing is there.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "net/packet.hpp"
#include "net/seen_window.hpp"

namespace hearsay::gossip {

/// Says which bundle it is and how it travels.
struct Bundle {
  Time written;
  AgentId origin = 0;
  std::uint32_t incarnation = 0;  ///< how often the origin had lost its memory
  std::uint32_t sequence = 0;     ///< number among the bundles of the incarnation, below 2^32 − 1
  AgentId addressee = no_agent;   ///< no_agent: everybody
  NameId kind = 0;
  std::uint8_t hops_left = 0;  ///< how much further it may go from whoever has it

  std::uint64_t source() const {
    return std::uint64_t{static_cast<std::uint32_t>(origin)} << 32 | incarnation;
  }
};
inline constexpr std::size_t bundle_bytes = 28;  ///< before the payload

/// A later version of a slot takes the place of an earlier one: later by the clock of who wrote it;
/// of two written at one instant the one by the agent with the higher number.
struct Version {
  Time written;
  AgentId writer = 0;
  auto operator<=>(const Version&) const = default;
};
/// A slot is what messages of one kind say of one subject (below 2^48), whoever writes it.
struct Slot {
  std::uint64_t key = 0;
  Version version;

  static std::uint64_t key_of(NameId kind, std::uint64_t subject) {
    return std::uint64_t{kind} << 48 | subject;
  }
  NameId kind() const { return static_cast<NameId>(key >> 48); }
};
inline constexpr std::uint64_t subjects_max = std::uint64_t{1} << 48;
inline constexpr std::size_t slot_bytes = 21;  ///< before the payload

/// Which bundles of a source were seen.
struct Seen {
  std::uint64_t source = 0;
  SeenWindow window;
};

/// Which keys a summary speaks of, both included.
struct Range {
  std::uint64_t first = 0;
  std::uint64_t last = UINT64_MAX;
};
inline constexpr std::size_t range_bytes = 17;  ///< of a summary without entries
std::size_t encoded_size(const Seen& entry);
inline std::size_t encoded_size(const Slot&) { return 20; }
/// The most of an entry of either summary.
inline constexpr std::size_t entry_bytes_max = 13 + 8 * SeenWindow::words;

/// A summary with its entries, by ascending key.
template <class Entry>
struct Summary {
  Range range;
  std::vector<Entry> entries;
};

/// Writes a frame, in place of what `out` held; its room is used again.
void encode(const Bundle& bundle, std::span<const std::byte> payload, std::vector<std::byte>& out);
void encode(const Slot& slot, std::span<const std::byte> payload, std::vector<std::byte>& out);
void encode(const Range& range, std::span<const Seen> entries, std::vector<std::byte>& out);
void encode(const Range& range, std::span<const Slot> entries, std::vector<std::byte>& out);

/// Reads a frame. False, the results unspecified, unless it is exactly one of that type, with times
/// from 0 on, agents from 0 on and entries in order within the range.
bool decode(std::span<const std::byte> frame, Bundle& bundle, std::span<const std::byte>& payload);
bool decode(std::span<const std::byte> frame, Slot& slot, std::span<const std::byte>& payload);
bool decode(std::span<const std::byte> frame, Summary<Seen>& summary);
bool decode(std::span<const std::byte> frame, Summary<Slot>& summary);

}  // namespace hearsay::gossip
