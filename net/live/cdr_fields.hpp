// Lists of fields as XCDR1, little-endian: one list serves to measure, to write and to read. Not
// for users.
#pragma once

#include <algorithm>
#include <bit>
#include <string>
#include <type_traits>

#include "filters/gaussian/belief.hpp"
#include "filters/gaussian/cdr.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay::live {

namespace cdr = gaussian::cdr;

/// Where a Writer would be.
class Measure {
 public:
  void octet(std::uint8_t) { ++offset_; }
  void u32(std::size_t) { offset_ = cdr::aligned(offset_, 4) + 4; }
  void u64(std::uint64_t) { offset_ = cdr::aligned(offset_, 8) + 8; }
  void f64(double) { u64(0); }
  void octets(std::span<const std::byte> bytes) { offset_ += bytes.size(); }
  std::size_t size() const { return offset_; }

 private:
  std::size_t offset_ = 0;
};

/// Fields to a Measure or a cdr::Writer; their lengths must be within bounds.
template <class W>
class Putter {
 public:
  explicit Putter(W& out) : out_(out) {}
  bool field(bool value) { return out_.octet(value ? 1 : 0), true; }
  bool field(std::uint32_t value) { return out_.u32(value), true; }
  bool field(std::uint64_t value) { return out_.u64(value), true; }
  bool field(std::int64_t value) { return out_.u64(static_cast<std::uint64_t>(value)), true; }
  bool field(double value) { return out_.f64(value), true; }
  template <class E>
  bool choice(E value, E last) {
    require(value <= last, "encode: an unknown choice");
    return out_.octet(static_cast<std::uint8_t>(value)), true;
  }
  bool text(const std::string& value, std::size_t most) {
    require(value.size() < most && value.find('\0') == std::string::npos,
            "encode: a text is too long, or has a NUL");
    out_.u32(value.size() + 1);
    out_.octets(std::as_bytes(std::span(value)));
    return out_.octet(0), true;
  }
  bool octets(std::span<const std::byte> value, std::size_t most) {
    length(value.size(), most);
    return out_.octets(value), true;
  }
  template <class T, class F>
  bool sequence(const std::vector<T>& values, std::size_t most, std::size_t, F&& each) {
    length(values.size(), most);
    for (const T& value : values) each(value);
    return true;
  }
  /// ξ, then the upper triangle of Ω by rows.
  bool belief(const gaussian::Belief& belief) {
    const Eigen::Index n = belief.xi.size();
    require(n >= 1 && belief.omega.rows() == n && belief.omega.cols() == n,
            "encode: a belief has no dimension, or Ω and ξ disagree");
    out_.u32(static_cast<std::size_t>(n));
    for (const double value : belief.xi) out_.f64(value);
    out_.u32(static_cast<std::size_t>(n * (n + 1) / 2));
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index j = i; j < n; ++j) out_.f64(belief.omega(i, j));
    }
    return true;
  }

 private:
  void length(std::size_t length, std::size_t most) {
    require(length <= most, "encode: a sequence is too long");
    out_.u32(length);
  }
  W& out_;
};

/// Fields from a cdr::Reader; false for what is not there or out of bounds.
class Getter {
 public:
  explicit Getter(cdr::Reader& in) : in_(in) {}
  bool field(bool& value) {
    std::uint8_t octet = 0;
    if (!in_.octet(octet) || octet > 1) return false;
    return value = octet == 1, true;
  }
  bool field(std::uint32_t& value) { return in_.u32(value); }
  bool field(std::uint64_t& value) { return word(value); }
  bool field(std::int64_t& value) { return word(value); }
  bool field(double& value) { return word(value); }
  template <class E>
  bool choice(E& value, E last) {
    std::uint8_t octet = 0;
    if (!in_.octet(octet) || octet > static_cast<std::uint8_t>(last)) return false;
    return value = static_cast<E>(octet), true;
  }
  bool text(std::string& value, std::size_t most) {
    std::uint32_t length = 0;
    if (!in_.u32(length) || length < 1 || length > most || length > in_.left()) return false;
    const std::span<const std::byte> bytes = in_.octets(length);
    if (std::find(bytes.begin(), bytes.end(), std::byte{0}) != bytes.end() - 1) return false;
    value.assign(reinterpret_cast<const char*>(bytes.data()), length - 1);
    return true;
  }
  bool octets(std::vector<std::byte>& value, std::size_t most) {
    std::span<const std::byte> bytes;
    if (!octets(bytes, most)) return false;
    value.assign(bytes.begin(), bytes.end());
    return true;
  }
  bool octets(std::span<const std::byte>& value, std::size_t most) {
    std::uint32_t length = 0;
    if (!in_.u32(length) || length > most || length > in_.left()) return false;
    value = in_.octets(length);
    return true;
  }
  /// `least`: bytes that one of them takes. Before any storage is taken: a length field must not
  /// make us allocate what cannot follow.
  template <class T, class F>
  bool sequence(std::vector<T>& values, std::size_t most, std::size_t least, F&& each) {
    std::uint32_t length = 0;
    if (!in_.u32(length) || length > most || length > in_.left() / least) return false;
    values.resize(length);
    return std::all_of(values.begin(), values.end(), each);
  }
  bool belief(gaussian::Belief& belief) {
    std::uint32_t n = 0, entries = 0;
    if (!in_.u32(n) || n < 1 || n > static_cast<std::uint32_t>(gaussian::dimension_max)) {
      return false;
    }
    if (!in_.has_f64(n)) return false;
    belief.xi.resize(n);
    for (double& value : belief.xi) value = in_.f64();
    if (!in_.u32(entries) || entries != n * (n + 1) / 2 || !in_.has_f64(entries)) return false;
    belief.omega.resize(n, n);
    for (Eigen::Index i = 0; i < belief.omega.rows(); ++i) {
      for (Eigen::Index j = i; j < belief.omega.cols(); ++j) {
        belief.omega(i, j) = belief.omega(j, i) = in_.f64();
      }
    }
    return true;
  }

 private:
  template <class T>
  bool word(T& value) {
    std::uint64_t bits = 0;
    if (!in_.u64(bits)) return false;
    return value = std::bit_cast<T>(bits), true;
  }
  cdr::Reader& in_;
};

}  // namespace hearsay::live
