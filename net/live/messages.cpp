#include "net/live/messages.hpp"

#include <concepts>

#include "net/live/cdr_fields.hpp"

namespace hearsay::live {
namespace {

template <class T, class Of>
concept Is = std::same_as<std::remove_const_t<T>, Of>;

// The fields in the order of live.idl: A is a Putter, or a Getter. In every list && stops at what
// is not there.

template <class A, Is<Hello> T>
bool fields(A& a, T& m) {
  return a.field(m.protocol) && a.field(m.agent) && a.field(m.process) &&
         a.text(m.scenario, name_bytes_max) && a.text(m.version, name_bytes_max) &&
         a.field(m.remembers);
}

template <class A, Is<Welcome> T>
bool fields(A& a, T& m) {
  return a.field(m.agent) && a.field(m.process) && a.field(m.accepted) && a.field(m.lockstep) &&
         a.field(m.seed) && a.field(m.now_ns) && a.field(m.speed) &&
         a.text(m.reason, text_bytes_max);
}

template <class A, Is<Frame> T>
bool fields(A& a, T& m) {
  return a.field(m.agent) && a.field(m.number) && a.octets(m.content, content_bytes_max);
}

template <class A, Is<Clock> T>
bool fields(A& a, T& m) {
  return a.field(m.now_ns) && a.field(m.end_ns) && a.field(m.speed) &&
         a.choice(m.state, Clock::State::ended) && a.text(m.reason, text_bytes_max);
}

template <class A, Is<Measurement> T>
bool fields(A& a, T& m) {
  return a.field(m.agent) && a.field(m.subject) && a.field(m.number) && a.field(m.now_ns) &&
         a.belief(m.information);
}

template <class A, Is<Truth> T>
bool fields(A& a, T& m) {
  return a.field(m.now_ns) && a.field(m.subject) &&
         a.sequence(m.state, numbers_max, 8, [&](auto& number) { return a.field(number); });
}

template <class A, Is<Row> T>
bool fields(A& a, T& m) {
  return a.choice(m.kind, Row::Kind::event) && a.field(m.now_ns) &&
         a.text(m.name, name_bytes_max) && a.text(m.text, text_bytes_max) && a.field(m.value);
}
constexpr std::size_t row_bytes_min = 1 + 8 + 5 + 5 + 8;

template <class A, Is<Counts> T>
bool fields(A& a, T& m) {
  return a.field(m.measurements) && a.field(m.fusions) && a.field(m.skipped) &&
         a.field(m.refused) && a.field(m.late) && a.field(m.fusion_gain_max);
}

template <class A, Is<gaussian::BeliefEntry> T>
bool fields(A& a, T& m) {
  return a.field(m.subject) && a.belief(m.belief);
}
constexpr std::size_t entry_bytes_min = 4 + 4 + 8 + 4 + 8;

template <class A, Is<Report> T>
bool fields(A& a, T& m) {
  const auto each = [&](auto& part) { return fields(a, part); };
  return a.field(m.agent) && a.field(m.now_ns) && a.field(m.last) && a.field(m.missed) &&
         fields(a, m.counts) && a.sequence(m.beliefs, beliefs_max, entry_bytes_min, each) &&
         a.sequence(m.rows, rows_max, row_bytes_min, each);
}

struct OctetsPacket {
  Envelope envelope;
  std::string kind;
  std::span<const std::byte> message;
};

template <class A, Is<Envelope> T>
bool fields(A& a, T& m) {
  return a.field(m.sender) && a.field(m.receiver) && a.field(m.number) && a.field(m.sent_ns) &&
         a.field(m.tick) && a.field(m.subject);
}

template <class A, Is<OctetsPacket> T>
bool fields(A& a, T& m) {
  return fields(a, m.envelope) && a.text(m.kind, name_bytes_max) &&
         a.octets(m.message, content_bytes_max);
}

template <class T>
void write(const T& message, std::vector<std::byte>& out) {
  Measure measure;
  Putter<Measure> first(measure);
  fields(first, message);
  require(cdr::header.size() + measure.size() <= sample_bytes_max,
          "encode: too much for one sample");
  cdr::Writer writer = cdr::begin(measure.size(), out);
  Putter<cdr::Writer> second(writer);
  fields(second, message);
}

template <class T>
bool read(std::span<const std::byte> bytes, T& out) {
  auto in = cdr::body_of(bytes);
  if (!in) return false;
  Getter getter(*in);
  return fields(getter, out) && in->left() == 0;
}

}  // namespace

void encode(const Hello& message, std::vector<std::byte>& out) { write(message, out); }
void encode(const Welcome& message, std::vector<std::byte>& out) { write(message, out); }
void encode(const Frame& message, std::vector<std::byte>& out) { write(message, out); }
void encode(const Clock& message, std::vector<std::byte>& out) { write(message, out); }
void encode(const Measurement& message, std::vector<std::byte>& out) { write(message, out); }
void encode(const Truth& message, std::vector<std::byte>& out) { write(message, out); }
void encode(const Report& message, std::vector<std::byte>& out) { write(message, out); }

bool decode(std::span<const std::byte> bytes, Hello& out) { return read(bytes, out); }
bool decode(std::span<const std::byte> bytes, Welcome& out) { return read(bytes, out); }
bool decode(std::span<const std::byte> bytes, Frame& out) { return read(bytes, out); }
bool decode(std::span<const std::byte> bytes, Clock& out) { return read(bytes, out); }
bool decode(std::span<const std::byte> bytes, Measurement& out) { return read(bytes, out); }
bool decode(std::span<const std::byte> bytes, Truth& out) { return read(bytes, out); }
bool decode(std::span<const std::byte> bytes, Report& out) { return read(bytes, out); }

void pack(const Envelope& envelope, std::span<const std::byte> message,
          std::vector<std::byte>& out) {
  require(cdr::body_of(message).has_value(), "pack: a message without its header");
  const std::span<const std::byte> body = message.subspan(cdr::header.size());
  cdr::Writer writer = cdr::begin(envelope_bytes + body.size(), out);
  Putter<cdr::Writer> putter(writer);
  fields(putter, envelope);
  writer.octets(body);
}

bool read_envelope(std::span<const std::byte> body, Envelope& envelope) {
  if (body.size() < envelope_bytes) return false;
  cdr::Reader in(body);
  Getter getter(in);
  return fields(getter, envelope);
}

bool unpack(std::span<std::byte> packet, Envelope& envelope, std::span<std::byte>& message) {
  if (!cdr::body_of(packet) || !read_envelope(packet.subspan(cdr::header.size()), envelope)) {
    return false;
  }
  message = packet.subspan(envelope_bytes);
  std::copy(cdr::header.begin(), cdr::header.end(), message.begin());
  return true;
}

void pack_octets(const Envelope& envelope, const std::string& kind,
                 std::span<const std::byte> message, std::vector<std::byte>& out) {
  write(OctetsPacket{envelope, kind, message}, out);
}

bool unpack_octets(std::span<const std::byte> packet, Envelope& envelope, std::string& kind,
                   std::span<const std::byte>& message) {
  OctetsPacket out;
  out.kind.swap(kind);  // for its storage
  const bool whole = read(packet, out);
  envelope = out.envelope;
  message = out.message;
  kind.swap(out.kind);
  return whole;
}

}  // namespace hearsay::live
