#include "filters/gaussian/message_forms.hpp"

#include <optional>

#include "filters/gaussian/cdr.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay::gaussian {
namespace {

using cdr::aligned;
using cdr::header;
using cdr::Reader;
using cdr::Writer;

constexpr std::size_t triangle(std::size_t n) { return n * (n + 1) / 2; }

/// Which fields a form has beside subject and ξ.
struct Fields {
  bool degree = false;
  bool diagonal = false;  ///< instead of Ω
  bool fresh_vector = false;
  bool fresh_matrix = false;
};
constexpr Fields fields_of(MessageForm form) {
  switch (form) {
    case MessageForm::split:
      return {.fresh_matrix = true};
    case MessageForm::consensus:
      return {.degree = true};
    case MessageForm::hybrid:
      return {.degree = true, .fresh_vector = true, .fresh_matrix = true};
    case MessageForm::diagonal:
      return {.diagonal = true};
    case MessageForm::plain:
    case MessageForm::quantised:
      break;
  }
  return {};
}

constexpr std::size_t body_octets(std::size_t n, int bits) {
  return 5 * n + (triangle(n) * static_cast<std::size_t>(bits) + 7) / 8;
}

/// Counts what a Writer would write.
class Counter {
 public:
  void octet(std::uint8_t) { ++offset_; }
  void u32(std::size_t) { offset_ = aligned(offset_, 4) + 4; }
  void f64(double) { u64(0); }
  void u64(std::uint64_t) { offset_ = aligned(offset_, 8) + 8; }
  std::size_t size() const { return offset_; }

 private:
  std::size_t offset_ = 0;
};

template <typename Out>
void write_vector(Out& out, const Vector& values) {
  out.u32(static_cast<std::size_t>(values.size()));
  for (const double value : values) out.f64(value);
}

template <typename Out>
void write_triangle(Out& out, const Matrix& m) {
  out.u32(triangle(static_cast<std::size_t>(m.rows())));
  for (Eigen::Index i = 0; i < m.rows(); ++i) {
    for (Eigen::Index j = i; j < m.cols(); ++j) out.f64(m(i, j));
  }
}

template <typename Out>
void write_quantised(Out& out, const QuantisedBelief& q, int bits) {
  const auto n = static_cast<std::size_t>(q.dimension);
  out.u32(body_octets(n, bits));
  for (std::size_t i = 0; i < n; ++i) {
    out.octet(static_cast<std::uint8_t>(q.exponents[i]));
    const auto mean = static_cast<std::uint32_t>(q.means[i]);
    for (int shift = 0; shift < 32; shift += 8) out.octet(static_cast<std::uint8_t>(mean >> shift));
  }
  std::uint32_t pending = 0;
  int held = 0;
  for (std::size_t k = 0; k < triangle(n); ++k) {
    pending |= static_cast<std::uint32_t>(q.entries[k]) << held;
    for (held += bits; held >= 8; held -= 8, pending >>= 8) {
      out.octet(static_cast<std::uint8_t>(pending));
    }
  }
  if (held > 0) out.octet(static_cast<std::uint8_t>(pending));
}

template <typename Out>
void write(Out& out, MessageForm form, const Message& message, const MessageExtras& extras) {
  const Fields fields = fields_of(form);
  out.u32(message.incarnation);
  out.u32(message.count);
  if (fields.degree) out.u32(extras.degree);
  const std::size_t count = message.beliefs.size();
  if (form == MessageForm::quantised) {
    out.octet(static_cast<std::uint8_t>(count == 0 ? 0 : extras.quantised[0].dimension));
    out.octet(static_cast<std::uint8_t>(extras.bits));
  }
  out.u32(count);
  for (std::size_t i = 0; i < count; ++i) {
    const BeliefEntry& entry = message.beliefs[i];
    out.u32(entry.subject);
    if (form == MessageForm::quantised) {
      write_quantised(out, extras.quantised[i], extras.bits);
      continue;
    }
    write_vector(out, entry.belief.xi);
    if (fields.diagonal) {
      write_vector(out, entry.belief.omega.diagonal());
    } else {
      write_triangle(out, entry.belief.omega);
    }
    if (fields.fresh_vector) write_vector(out, extras.fresh[i].xi);
    if (fields.fresh_matrix) write_triangle(out, extras.fresh[i].omega);
  }
}

/// A sequence of n doubles; for n = 0 any length a belief may have, which n then is.
bool read_vector(Reader& in, Vector& values, std::uint32_t n) {
  std::uint32_t length = 0;
  if (!in.u32(length) || (n != 0 && length != n)) return false;
  if (length < 1 || length > static_cast<std::uint32_t>(dimension_max)) return false;
  if (!in.has_f64(length)) return false;
  values.resize(length);
  for (double& value : values) value = in.f64();
  return true;
}

bool read_triangle(Reader& in, Matrix& m, std::uint32_t n) {
  std::uint32_t length = 0;
  if (!in.u32(length) || length != triangle(n) || !in.has_f64(length)) return false;
  m.resize(n, n);
  for (Eigen::Index i = 0; i < m.rows(); ++i) {
    for (Eigen::Index j = i; j < m.cols(); ++j) m(i, j) = m(j, i) = in.f64();
  }
  return true;
}

bool read_entry(Reader& in, const Fields& fields, BeliefEntry& entry, Belief& fresh) {
  Belief& belief = entry.belief;
  if (!in.u32(entry.subject) || !read_vector(in, belief.xi, 0)) return false;
  const auto n = static_cast<std::uint32_t>(belief.xi.size());
  if (fields.diagonal) {
    Vector diagonal;
    if (!read_vector(in, diagonal, n)) return false;
    belief.omega = diagonal.asDiagonal();
  } else if (!read_triangle(in, belief.omega, n)) {
    return false;
  }
  fresh.xi = Vector::Zero(n);
  if (fields.fresh_vector && !read_vector(in, fresh.xi, n)) return false;
  return !fields.fresh_matrix || read_triangle(in, fresh.omega, n);
}

bool read_quantised(Reader& in, std::uint32_t n, int bits, QuantisedBelief& q) {
  std::uint32_t length = 0;
  if (!in.u32(length) || length != body_octets(n, bits) || in.left() < length) return false;
  const std::span<const std::byte> body = in.octets(length);
  const auto octet = [&](std::size_t at) { return std::to_integer<std::uint32_t>(body[at]); };
  q.dimension = static_cast<int>(n);
  std::size_t at = 0;
  for (std::size_t i = 0; i < n; ++i, at += 5) {
    q.exponents[i] = static_cast<std::int8_t>(octet(at));
    q.means[i] = static_cast<std::int32_t>(octet(at + 1) | octet(at + 2) << 8 |
                                           octet(at + 3) << 16 | octet(at + 4) << 24);
  }
  std::uint32_t pending = 0;
  int held = 0;
  for (std::size_t k = 0; k < triangle(n); ++k) {
    for (; held < bits; held += 8) pending |= octet(at++) << held;
    q.entries[k] = static_cast<std::uint16_t>(pending & ((1u << bits) - 1u));
    pending >>= bits;
    held -= bits;
  }
  return pending == 0;  // the bits that fill up the last octet
}

bool read_all_quantised(Reader& in, Message& message, MessageExtras& extras) {
  std::uint8_t n = 0, bits = 0;
  std::uint32_t count = 0;
  if (!in.octet(n) || !in.octet(bits) || !in.u32(count)) return false;
  if (bits < quantised_bits_min || bits > quantised_bits_max) return false;
  if (count > 0 && (n < 1 || n > dimension_max)) return false;
  if (count > in.left() / (8 + body_octets(1, quantised_bits_min))) return false;
  extras.bits = bits;
  message.beliefs.resize(count);
  extras.quantised.resize(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    BeliefEntry& entry = message.beliefs[i];
    if (!in.u32(entry.subject) || !read_quantised(in, n, bits, extras.quantised[i])) return false;
    const auto belief = belief_of(extras.quantised[i], bits);
    if (!belief) return false;
    entry.belief = *belief;
  }
  return in.left() == 0;
}

}  // namespace

std::size_t encoded_size(MessageForm form, std::size_t beliefs, int n, int bits) {
  if (form == MessageForm::plain) return encoded_size(beliefs, n);
  require(n >= 1 && n <= dimension_max, "encoded_size: the dimension must be 1 to 8");
  const Message message{0, 0, std::vector<BeliefEntry>(beliefs, {0, Belief::unknown(n)})};
  MessageExtras extras;
  extras.fresh.assign(beliefs, Belief::unknown(n));
  extras.bits = bits;
  extras.quantised.assign(beliefs, QuantisedBelief{.dimension = n});
  Counter counter;
  write(counter, form, message, extras);
  return header.size() + counter.size();
}

namespace {

void encode_behind(std::optional<std::int64_t> stamp, MessageForm form, const Message& message,
                   const MessageExtras& extras, std::vector<std::byte>& out) {
  const bool fresh = fields_of(form).fresh_matrix;
  const std::size_t count = message.beliefs.size();
  require(!fresh || extras.fresh.size() >= count, "encode: a fresh part is missing");
  require(form != MessageForm::quantised || extras.quantised.size() >= count,
          "encode: a quantised belief is missing");
  Counter counter;
  if (stamp) counter.u64(0);
  write(counter, form, message, extras);
  Writer writer = cdr::begin(counter.size(), out);
  if (stamp) writer.u64(static_cast<std::uint64_t>(*stamp));
  write(writer, form, message, extras);
}

/// All that follows a stamp, if there is one.
bool read(Reader& in, MessageForm form, Message& message, MessageExtras& extras) {
  const Fields fields = fields_of(form);
  if (!in.u32(message.incarnation) || !in.u32(message.count)) return false;
  if (fields.degree && !in.u32(extras.degree)) return false;
  if (form == MessageForm::quantised) return read_all_quantised(in, message, extras);
  std::uint32_t count = 0;
  constexpr std::size_t entry_bytes_min = 4 + 4 + 8 + 4 + 8;
  if (!in.u32(count) || count > in.left() / entry_bytes_min) return false;
  message.beliefs.resize(count);
  extras.fresh.resize(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    if (!read_entry(in, fields, message.beliefs[i], extras.fresh[i])) return false;
  }
  return in.left() == 0;
}

}  // namespace

void encode(MessageForm form, const Message& message, const MessageExtras& extras,
            std::vector<std::byte>& out) {
  if (form == MessageForm::plain) return encode(message, out);
  encode_behind(std::nullopt, form, message, extras, out);
}

void encode(MessageForm form, const StampedMessage& message, const MessageExtras& extras,
            std::vector<std::byte>& out) {
  if (form == MessageForm::plain) return encode(message, out);
  encode_behind(message.stamp, form, message.message, extras, out);
}

bool decode(MessageForm form, std::span<const std::byte> bytes, Message& message,
            MessageExtras& extras) {
  if (form == MessageForm::plain) return decode(bytes, message);
  std::optional<Reader> in = cdr::body_of(bytes);
  return in && read(*in, form, message, extras);
}

bool decode(MessageForm form, std::span<const std::byte> bytes, StampedMessage& message,
            MessageExtras& extras) {
  if (form == MessageForm::plain) return decode(bytes, message);
  std::optional<Reader> in = cdr::body_of(bytes);
  if (!in || !in->has_f64(1)) return false;
  message.stamp = in->i64();
  return read(*in, form, message.message, extras);
}

}  // namespace hearsay::gaussian
