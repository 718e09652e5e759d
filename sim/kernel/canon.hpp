// The canonical bytes of a record, on their way to a digest.
//
// Little-endian, −0 as +0, every NaN as one pattern. A row is one byte that says its kind, then its
// fields: numbers as 64 bits (agents sign-extended), text as its length and bytes, names as the
// hash of their text, so that ids do not matter.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <vector>

#include "sim/kernel/ids.hpp"
#include "sim/kernel/time.hpp"

namespace hearsay {

/// Takes canonical bytes. Implemented in sim/record by XXH3; may be absent.
class DigestSink {
 public:
  virtual ~DigestSink() = default;
  virtual void update(std::span<const std::byte> bytes) = 0;
};

/// Collects the rows of one digest and passes them on in pieces.
class Canon {
 public:
  /// `sink` outlives this. Null: everything is dropped.
  explicit Canon(DigestSink* sink);

  /// The beginning of a row, of at most 7 numbers: they go straight to their place.
  template <class... Numbers>
  void row(char kind, Numbers... numbers) {
    static_assert(1 + 8 * sizeof...(numbers) <= row_bytes_max);
    if (sink_ == nullptr) return;
    std::byte* at = buffer_.data() + used_;
    used_ += 1 + 8 * sizeof...(numbers);
    *at++ = static_cast<std::byte>(kind);
    ((put(word(numbers), at), at += 8), ...);
    if (used_ >= piece_bytes) pass_on();
  }
  void text(std::string_view value);
  void flush();

 private:
  // What a digest gets at a time, and room for a row that begins within that.
  static constexpr std::size_t piece_bytes = 4096;
  static constexpr std::size_t row_bytes_max = 64;

  static std::uint64_t word(std::uint64_t value) { return value; }
  static std::uint64_t word(std::int64_t value) { return static_cast<std::uint64_t>(value); }
  static std::uint64_t word(AgentId value) { return word(std::int64_t{value}); }
  static std::uint64_t word(Time value) { return word(value.nanoseconds()); }
  static std::uint64_t word(double value) {
    constexpr std::uint64_t one_nan = 0x7ff8000000000000;
    if (value != value) return one_nan;
    return std::bit_cast<std::uint64_t>(value == 0.0 ? 0.0 : value);
  }
  // Little-endian. The loop alone would do; gcc does not make one store of it.
  static void put(std::uint64_t value, std::byte* at) {
    if constexpr (std::endian::native == std::endian::little) {
      std::memcpy(at, &value, sizeof value);
    } else {
      for (int i = 0; i < 8; ++i) at[i] = static_cast<std::byte>(value >> (8 * i));
    }
  }
  void pass_on();

  DigestSink* sink_;
  std::vector<std::byte> buffer_;  // empty without a sink
  std::size_t used_ = 0;           // less than a piece, between rows
};

}  // namespace hearsay
