// XCDR1, little-endian, for codecs: four bytes of encapsulation header, then
// natural alignment counted from the end of the header. Not for users.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace hearsay::gaussian::cdr {

inline constexpr std::array<std::byte, 4> header = {std::byte{0}, std::byte{1}, std::byte{0},
                                                    std::byte{0}};  // CDR_LE, no options

constexpr std::size_t aligned(std::size_t offset, std::size_t to) {
  return (offset + to - 1) / to * to;
}

template <typename T>
inline void store(std::byte* at, T value) {
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    at[i] = static_cast<std::byte>(value >> (8 * i));
  }
}

template <typename T>
inline T load(const std::byte* at) {
  T value = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    value |= static_cast<T>(std::to_integer<T>(at[i]) << (8 * i));
  }
  return value;
}

class Writer {
 public:
  explicit Writer(std::byte* body) : body_(body) {}
  void octet(std::uint8_t value) { body_[offset_++] = static_cast<std::byte>(value); }
  void u32(std::size_t value) {
    offset_ = aligned(offset_, 4);
    store(body_ + offset_, static_cast<std::uint32_t>(value));
    offset_ += 4;
  }
  void f64(double value) { u64(std::bit_cast<std::uint64_t>(value)); }
  void u64(std::uint64_t value) {
    offset_ = aligned(offset_, 8);
    store(body_ + offset_, value);
    offset_ += 8;
  }
  void octets(std::span<const std::byte> values) {
    std::copy(values.begin(), values.end(), body_ + offset_);
    offset_ += values.size();
  }

 private:
  std::byte* body_;
  std::size_t offset_ = 0;
};

class Reader {
 public:
  explicit Reader(std::span<const std::byte> body) : body_(body) {}
  bool octet(std::uint8_t& value) {
    if (offset_ >= body_.size()) return false;
    value = std::to_integer<std::uint8_t>(body_[offset_++]);
    return true;
  }
  bool u32(std::uint32_t& value) {
    const std::size_t at = aligned(offset_, 4);
    if (at + 4 > body_.size()) return false;
    value = load<std::uint32_t>(body_.data() + at);
    offset_ = at + 4;
    return true;
  }
  bool u64(std::uint64_t& value) {
    const std::size_t at = aligned(offset_, 8);
    if (at + 8 > body_.size()) return false;
    value = load<std::uint64_t>(body_.data() + at);
    offset_ = at + 8;
    return true;
  }
  /// Room for `count` doubles from here on?
  bool has_f64(std::size_t count) const {
    const std::size_t at = aligned(offset_, 8);
    return at <= body_.size() && (body_.size() - at) / 8 >= count;
  }
  /// Only after has_f64().
  double f64() {
    const std::size_t at = aligned(offset_, 8);
    offset_ = at + 8;
    return std::bit_cast<double>(load<std::uint64_t>(body_.data() + at));
  }
  /// Only after has_f64().
  std::int64_t i64() { return std::bit_cast<std::int64_t>(f64()); }
  std::size_t left() const { return body_.size() - offset_; }
  /// The next `count` octets; only if there are so many left.
  std::span<const std::byte> octets(std::size_t count) {
    offset_ += count;
    return body_.subspan(offset_ - count, count);
  }
  /// The same, of records that begin with a double: from the next multiple of 8 on.
  std::span<const std::byte> records(std::size_t count) {
    offset_ = aligned(offset_, 8);
    return octets(count);
  }

 private:
  std::span<const std::byte> body_;
  std::size_t offset_ = 0;
};

/// Room for a body of this size, header written.
inline Writer begin(std::size_t size, std::vector<std::byte>& out) {
  out.clear();
  out.resize(header.size() + size);  // padding is zero
  std::copy(header.begin(), header.end(), out.begin());
  return Writer(out.data() + header.size());
}

/// What follows the header; nothing if it is not there.
inline std::optional<Reader> body_of(std::span<const std::byte> bytes) {
  if (bytes.size() < header.size()) return std::nullopt;
  if (!std::equal(header.begin(), header.end(), bytes.begin())) return std::nullopt;
  return Reader(bytes.subspan(header.size()));
}

}  // namespace hearsay::gaussian::cdr
