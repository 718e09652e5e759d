#include "filters/gaussian/codec.hpp"

#include <limits>

#include "filters/gaussian/cdr.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay::gaussian {
namespace {

using cdr::aligned;
using cdr::Reader;
using cdr::Writer;

constexpr std::size_t triangle(std::size_t n) { return n * (n + 1) / 2; }

/// Where a belief of dimension n ends that begins at `offset`; offsets from the end of the header.
constexpr std::size_t end_of_belief(std::size_t offset, std::size_t n) {
  offset = aligned(offset, 4) + 8;
  offset = aligned(offset, 8) + 8 * n + 4;
  return aligned(offset, 8) + 8 * triangle(n);
}

constexpr std::size_t belief_bytes_min = end_of_belief(0, 1);

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
  const std::size_t fixed = cdr::header.size() + 12;
  if (beliefs == 0) return fixed;
  // The first belief begins 4 bytes off an 8-byte boundary, every other one on it.
  const auto size = static_cast<std::size_t>(n);
  return cdr::header.size() + end_of_belief(12, size) + (beliefs - 1) * end_of_belief(0, size);
}

namespace {

/// Where the body of a message ends that begins at a multiple of 8.
std::size_t end_of_message(const Message& message) {
  require(message.beliefs.size() <= std::numeric_limits<std::uint32_t>::max(),
          "encode: too many beliefs for one message");
  std::size_t end = 12;
  for (const BeliefEntry& entry : message.beliefs) {
    const int n = entry.belief.dimension();
    require(n >= 1 && entry.belief.omega.rows() == n && entry.belief.omega.cols() == n,
            "encode: a belief has no dimension, or Ω and ξ disagree");
    end = end_of_belief(end, static_cast<std::size_t>(n));
  }
  return end;
}

void write(const Message& message, Writer& writer) {
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

bool read(Reader& in, Message& out) {
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

}  // namespace

void encode(const Message& message, std::vector<std::byte>& out) {
  Writer writer = cdr::begin(end_of_message(message), out);
  write(message, writer);
}

void encode(const StampedMessage& message, std::vector<std::byte>& out) {
  Writer writer = cdr::begin(stamp_bytes + end_of_message(message.message), out);
  writer.u64(static_cast<std::uint64_t>(message.stamp));
  write(message.message, writer);
}

bool decode(std::span<const std::byte> bytes, Message& out) {
  auto in = cdr::body_of(bytes);
  return in && read(*in, out);
}

bool decode(std::span<const std::byte> bytes, StampedMessage& out) {
  auto in = cdr::body_of(bytes);
  if (!in || !in->has_f64(1)) return false;
  out.stamp = in->i64();
  return read(*in, out.message);
}

}  // namespace hearsay::gaussian
