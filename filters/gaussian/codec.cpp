#include "filters/gaussian/codec.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>

#include "sim/kernel/error.hpp"

namespace hearsay::gaussian {
namespace {

constexpr std::array<std::byte, 4> header = {std::byte{0}, std::byte{1}, std::byte{0},
                                             std::byte{0}};  // CDR_LE, no options

constexpr std::size_t aligned(std::size_t offset, std::size_t to) {
  return (offset + to - 1) / to * to;
}

constexpr std::size_t triangle(std::size_t n) { return n * (n + 1) / 2; }

/// Where a belief of dimension n ends that begins at `offset`; offsets from the end of the header.
constexpr std::size_t end_of_belief(std::size_t offset, std::size_t n) {
  offset = aligned(offset, 4) + 8;
  offset = aligned(offset, 8) + 8 * n + 4;
  return aligned(offset, 8) + 8 * triangle(n);
}

constexpr std::size_t belief_bytes_min = end_of_belief(0, 1);

template <typename T>
void store(std::byte* at, T value) {
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    at[i] = static_cast<std::byte>(value >> (8 * i));
  }
}

template <typename T>
T load(const std::byte* at) {
  T value = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    value |= static_cast<T>(std::to_integer<T>(at[i]) << (8 * i));
  }
  return value;
}

class Writer {
 public:
  explicit Writer(std::byte* body) : body_(body) {}
  void u32(std::size_t value) {
    offset_ = aligned(offset_, 4);
    store(body_ + offset_, static_cast<std::uint32_t>(value));
    offset_ += 4;
  }
  void f64(double value) {
    offset_ = aligned(offset_, 8);
    store(body_ + offset_, std::bit_cast<std::uint64_t>(value));
    offset_ += 8;
  }

 private:
  std::byte* body_;
  std::size_t offset_ = 0;
};

class Reader {
 public:
  explicit Reader(std::span<const std::byte> body) : body_(body) {}
  bool u32(std::uint32_t& value) {
    const std::size_t at = aligned(offset_, 4);
    if (at + 4 > body_.size()) return false;
    value = load<std::uint32_t>(body_.data() + at);
    offset_ = at + 4;
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
  std::size_t left() const { return body_.size() - offset_; }

 private:
  std::span<const std::byte> body_;
  std::size_t offset_ = 0;
};

bool read_belief(Reader& in, BeliefEntry& entry) {
  std::uint32_t n = 0;
  if (!in.u32(entry.subject) || !in.u32(n)) return false;
  if (n < 1 || n > static_cast<std::uint32_t>(dimension_max) || !in.has_f64(n)) return false;
  Vector& xi = entry.belief.xi;
  xi.resize(n);
  for (Eigen::Index i = 0; i < xi.size(); ++i) xi(i) = in.f64();

  std::uint32_t entries = 0;
  if (!in.u32(entries) || entries != triangle(n) || !in.has_f64(entries)) return false;
  Matrix& omega = entry.belief.omega;
  omega.resize(n, n);
  for (Eigen::Index i = 0; i < omega.rows(); ++i) {
    for (Eigen::Index j = i; j < omega.cols(); ++j) omega(i, j) = omega(j, i) = in.f64();
  }
  return true;
}

}  // namespace

std::size_t encoded_size(std::size_t beliefs, int n) {
  require(n >= 1 && n <= dimension_max, "encoded_size: the dimension must be 1 to 8");
  const std::size_t fixed = header.size() + 12;
  if (beliefs == 0) return fixed;
  // The first belief begins 4 bytes off an 8-byte boundary, every other one on it.
  const auto size = static_cast<std::size_t>(n);
  return header.size() + end_of_belief(12, size) + (beliefs - 1) * end_of_belief(0, size);
}

void encode(const Message& message, std::vector<std::byte>& out) {
  require(message.beliefs.size() <= std::numeric_limits<std::uint32_t>::max(),
          "encode: too many beliefs for one message");
  std::size_t end = 12;
  for (const BeliefEntry& entry : message.beliefs) {
    const int n = entry.belief.dimension();
    require(n >= 1 && entry.belief.omega.rows() == n && entry.belief.omega.cols() == n,
            "encode: a belief has no dimension, or Ω and ξ disagree");
    end = end_of_belief(end, static_cast<std::size_t>(n));
  }
  out.clear();
  out.resize(header.size() + end);  // padding is zero
  std::copy(header.begin(), header.end(), out.begin());

  Writer writer(out.data() + header.size());
  writer.u32(message.incarnation);
  writer.u32(message.count);
  writer.u32(message.beliefs.size());
  for (const BeliefEntry& entry : message.beliefs) {
    const Belief& belief = entry.belief;
    const auto n = static_cast<std::size_t>(belief.dimension());
    writer.u32(entry.subject);
    writer.u32(n);
    for (const double value : belief.xi) writer.f64(value);
    writer.u32(triangle(n));
    for (Eigen::Index i = 0; i < belief.omega.rows(); ++i) {
      for (Eigen::Index j = i; j < belief.omega.cols(); ++j) writer.f64(belief.omega(i, j));
    }
  }
}

bool decode(std::span<const std::byte> bytes, Message& out) {
  if (bytes.size() < header.size()) return false;
  if (!std::equal(header.begin(), header.end(), bytes.begin())) return false;
  Reader in(bytes.subspan(header.size()));
  std::uint32_t count = 0;
  if (!in.u32(out.incarnation) || !in.u32(out.count) || !in.u32(count)) return false;
  // Before any storage is taken: a length field must not make us allocate what cannot follow.
  if (count > in.left() / belief_bytes_min) return false;
  out.beliefs.resize(count);
  for (BeliefEntry& entry : out.beliefs) {
    if (!read_belief(in, entry)) return false;
  }
  return in.left() == 0;
}

}  // namespace hearsay::gaussian
