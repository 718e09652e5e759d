// Numbers and texts one behind the other, little-endian, without padding: what a world and an agent
// elsewhere tell each other, and what an agent remembers. (What goes over radios is XCDR1, see the
// codecs of filters/.)
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hearsay {

class Packer {
 public:
  /// Appends to `out`, which outlives this.
  explicit Packer(std::vector<std::byte>& out) : out_(out) {}
  void flag(bool value) { u8(value ? 1 : 0); }
  void u8(std::uint8_t value) { out_.push_back(static_cast<std::byte>(value)); }
  void u32(std::uint32_t value) { number(value); }
  void u64(std::uint64_t value) { number(value); }
  void i64(std::int64_t value) { number(static_cast<std::uint64_t>(value)); }
  void f32(float value) { number(std::bit_cast<std::uint32_t>(value)); }
  void f64(double value) { number(std::bit_cast<std::uint64_t>(value)); }
  void count(std::size_t value) { u32(static_cast<std::uint32_t>(value)); }
  void bytes(std::span<const std::byte> value) {
    count(value.size());
    out_.insert(out_.end(), value.begin(), value.end());
  }
  void text(std::string_view value) { bytes(std::as_bytes(std::span(value))); }
  void numbers(std::span<const double> values) {
    count(values.size());
    for (const double value : values) f64(value);
  }

 private:
  template <class T>
  void number(T value) {
    for (std::size_t i = 0; i < sizeof(T); ++i) u8(static_cast<std::uint8_t>(value >> (8 * i)));
  }
  std::vector<std::byte>& out_;
};

/// Reads what a Packer wrote. Where bytes are missing all that is read from there on is 0 or empty,
/// and good() false.
class Unpacker {
 public:
  explicit Unpacker(std::span<const std::byte> bytes) : left_(bytes) {}
  bool flag() { return u8() != 0; }
  std::uint8_t u8() { return number<std::uint8_t>(); }
  std::uint32_t u32() { return number<std::uint32_t>(); }
  std::uint64_t u64() { return number<std::uint64_t>(); }
  std::int64_t i64() { return static_cast<std::int64_t>(u64()); }
  float f32() { return std::bit_cast<float>(u32()); }
  double f64() { return std::bit_cast<double>(u64()); }
  /// How many things follow that take at least `bytes_each` each.
  std::size_t count(std::size_t bytes_each) {
    const std::size_t value = u32();
    if (value > left_.size() / bytes_each) return fail();
    return value;
  }
  std::span<const std::byte> bytes() {
    const std::size_t size = count(1);
    const std::span<const std::byte> value = left_.first(size);
    left_ = left_.subspan(size);
    return value;
  }
  std::string text() {
    const std::span<const std::byte> value = bytes();
    return std::string(reinterpret_cast<const char*>(value.data()), value.size());
  }
  std::vector<double> numbers() {
    std::vector<double> values(count(8));
    for (double& value : values) value = f64();
    return values;
  }
  /// Whether all was there so far.
  bool good() const { return good_; }
  /// Whether all was there and nothing is left.
  bool done() const { return good_ && left_.empty(); }
  std::size_t fail() {
    good_ = false;
    left_ = {};
    return 0;
  }

 private:
  template <class T>
  T number() {
    if (left_.size() < sizeof(T)) return static_cast<T>(fail());
    T value = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      value = static_cast<T>(value | static_cast<T>(std::to_integer<T>(left_[i]) << (8 * i)));
    }
    left_ = left_.subspan(sizeof(T));
    return value;
  }
  std::span<const std::byte> left_;
  bool good_ = true;
};

}  // namespace hearsay
