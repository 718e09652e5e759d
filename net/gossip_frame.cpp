#include "net/gossip_frame.hpp"

#include <type_traits>

namespace hearsay::gossip {
namespace {

enum class Type : std::uint8_t { bundle = 1, bundles_seen = 2, slot = 3, slots_held = 4 };

template <class T>
void put(std::vector<std::byte>& out, T value) {
  auto bits = static_cast<std::make_unsigned_t<T>>(value);
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    out.push_back(static_cast<std::byte>(bits & 0xff));
    if constexpr (sizeof(T) > 1) bits >>= 8;
  }
}

void begin(std::vector<std::byte>& out, Type type) {
  out.clear();
  put(out, static_cast<std::uint8_t>(type));
}

void append(std::vector<std::byte>& out, std::span<const std::byte> payload) {
  out.insert(out.end(), payload.begin(), payload.end());
}

// Takes numbers from the front. Once too little is left it is not `ok` and gives zeros.
class Reader {
 public:
  Reader(std::span<const std::byte> frame, Type type) : left_(frame) {
    ok_ = take<std::uint8_t>() == static_cast<std::uint8_t>(type) && ok_;
  }
  template <class T>
  T take() {
    if (left_.size() < sizeof(T)) {
      ok_ = false;
      left_ = {};
      return {};
    }
    std::make_unsigned_t<T> bits = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      bits = static_cast<std::make_unsigned_t<T>>(
          bits | std::to_integer<std::make_unsigned_t<T>>(left_[i]) << (8 * i));
    }
    left_ = left_.subspan(sizeof(T));
    return static_cast<T>(bits);
  }
  AgentId take_agent() {
    const auto agent = take<AgentId>();
    ok_ = ok_ && agent >= 0;
    return agent;
  }
  Time take_time() {
    const auto ns = take<std::int64_t>();
    ok_ = ok_ && ns >= 0 && ns < Time::never().nanoseconds();
    return Time::nanoseconds(ns);
  }
  bool ok() const { return ok_; }
  std::span<const std::byte> left() const { return left_; }

 private:
  std::span<const std::byte> left_;
  bool ok_ = true;
};

void put_entry(std::vector<std::byte>& out, const Seen& entry) {
  put(out, entry.source);
  put(out, entry.window.base());
  const std::size_t words = entry.window.words_used();
  put(out, static_cast<std::uint8_t>(words));
  for (std::size_t w = 0; w < words; ++w) put(out, entry.window.bits()[w]);
}

void put_entry(std::vector<std::byte>& out, const Slot& entry) {
  put(out, entry.key);
  put(out, entry.version.writer);
  put(out, entry.version.written.nanoseconds());
}

bool take_entry(Reader& in, Seen& entry) {
  entry.source = in.take<std::uint64_t>();
  const auto base = in.take<std::uint32_t>();
  const auto words = in.take<std::uint8_t>();
  if (words > SeenWindow::words) return false;
  std::array<std::uint64_t, SeenWindow::words> bits{};
  for (std::size_t w = 0; w < words; ++w) bits[w] = in.take<std::uint64_t>();
  entry.window = SeenWindow::of(base, bits);
  return in.ok();
}

bool take_entry(Reader& in, Slot& entry) {
  entry.key = in.take<std::uint64_t>();
  entry.version.writer = in.take_agent();
  entry.version.written = in.take_time();
  return in.ok();
}

std::uint64_t key_of(const Seen& entry) { return entry.source; }
std::uint64_t key_of(const Slot& entry) { return entry.key; }

template <class Entry>
void encode_summary(Type type, const Range& range, std::span<const Entry> entries,
                    std::vector<std::byte>& out) {
  begin(out, type);
  put(out, range.first);
  put(out, range.last);
  for (const Entry& entry : entries) put_entry(out, entry);
}

template <class Entry>
bool decode_summary(Type type, std::span<const std::byte> frame, Summary<Entry>& summary) {
  Reader in(frame, type);
  summary.range.first = in.take<std::uint64_t>();
  summary.range.last = in.take<std::uint64_t>();
  summary.entries.clear();
  if (!in.ok() || summary.range.first > summary.range.last) return false;
  std::uint64_t least = summary.range.first;
  while (!in.left().empty()) {
    Entry& entry = summary.entries.emplace_back();
    if (!take_entry(in, entry)) return false;
    if (key_of(entry) < least || key_of(entry) > summary.range.last) return false;
    least = key_of(entry) + 1;
    if (least == 0 && !in.left().empty()) return false;
  }
  return true;
}

}  // namespace

std::size_t encoded_size(const Seen& entry) { return 13 + 8 * entry.window.words_used(); }

void encode(const Bundle& bundle, std::span<const std::byte> payload, std::vector<std::byte>& out) {
  begin(out, Type::bundle);
  put(out, bundle.hops_left);
  put(out, bundle.kind);
  put(out, bundle.origin);
  put(out, bundle.incarnation);
  put(out, bundle.sequence);
  put(out, bundle.addressee);
  put(out, bundle.written.nanoseconds());
  append(out, payload);
}

void encode(const Slot& slot, std::span<const std::byte> payload, std::vector<std::byte>& out) {
  begin(out, Type::slot);
  put_entry(out, slot);
  append(out, payload);
}

void encode(const Range& range, std::span<const Seen> entries, std::vector<std::byte>& out) {
  encode_summary(Type::bundles_seen, range, entries, out);
}

void encode(const Range& range, std::span<const Slot> entries, std::vector<std::byte>& out) {
  encode_summary(Type::slots_held, range, entries, out);
}

bool decode(std::span<const std::byte> frame, Bundle& bundle, std::span<const std::byte>& payload) {
  Reader in(frame, Type::bundle);
  bundle.hops_left = in.take<std::uint8_t>();
  bundle.kind = in.take<NameId>();
  bundle.origin = in.take_agent();
  bundle.incarnation = in.take<std::uint32_t>();
  bundle.sequence = in.take<std::uint32_t>();
  bundle.addressee = in.take<AgentId>();
  bundle.written = in.take_time();
  payload = in.left();
  const bool addressed = bundle.addressee >= 0 || bundle.addressee == no_agent;
  return in.ok() && addressed && bundle.sequence != UINT32_MAX;
}

bool decode(std::span<const std::byte> frame, Slot& slot, std::span<const std::byte>& payload) {
  Reader in(frame, Type::slot);
  const bool whole = take_entry(in, slot);
  payload = in.left();
  return whole;
}

bool decode(std::span<const std::byte> frame, Summary<Seen>& summary) {
  return decode_summary(Type::bundles_seen, frame, summary);
}

bool decode(std::span<const std::byte> frame, Summary<Slot>& summary) {
  return decode_summary(Type::slots_held, frame, summary);
}

}  // namespace hearsay::gossip
