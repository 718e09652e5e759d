#include "sim/kernel/record.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

#include "sim/kernel/error.hpp"

namespace hearsay {

namespace {

// What a digest gets at a time, and room for a row that begins within that.
constexpr std::size_t piece_bytes = 4096;
constexpr std::size_t row_bytes_max = 64;
constexpr std::size_t names_max = 65'535;
constexpr std::uint64_t one_nan = 0x7ff8000000000000;

std::uint64_t fnv1a(std::string_view text) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  return hash;
}

std::uint64_t word(std::uint64_t value) { return value; }
std::uint64_t word(std::int64_t value) { return static_cast<std::uint64_t>(value); }
std::uint64_t word(AgentId value) { return word(std::int64_t{value}); }
std::uint64_t word(Time value) { return word(value.nanoseconds()); }
std::uint64_t word(double value) {
  if (value != value) return one_nan;
  return std::bit_cast<std::uint64_t>(value == 0.0 ? 0.0 : value);
}

// Little-endian. The loop alone would do; gcc does not make one store of it.
void put(std::uint64_t value, std::byte* at) {
  if constexpr (std::endian::native == std::endian::little) {
    std::memcpy(at, &value, sizeof value);
  } else {
    for (int i = 0; i < 8; ++i) at[i] = static_cast<std::byte>(value >> (8 * i));
  }
}

}  // namespace

template <class... Numbers>
void Record::Canon::row(char kind, Numbers... numbers) {
  static_assert(1 + 8 * sizeof...(numbers) <= row_bytes_max);
  if (sink == nullptr) return;
  std::byte* at = buffer.data() + used;
  *at++ = static_cast<std::byte>(kind);
  ((put(word(numbers), at), at += 8), ...);
  used += 1 + 8 * sizeof...(numbers);
  if (used >= piece_bytes) pass_on();
}

void Record::Canon::text(std::string_view value) {
  if (sink == nullptr) return;
  put(value.size(), buffer.data() + used);
  used += 8;
  for (;;) {
    if (used >= piece_bytes) pass_on();
    if (value.empty()) return;
    const std::size_t part = std::min(value.size(), piece_bytes - used);
    std::memcpy(buffer.data() + used, value.data(), part);
    used += part;
    value.remove_prefix(part);
  }
}

void Record::Canon::pass_on() {
  sink->update(std::span(buffer).first(piece_bytes));
  used -= piece_bytes;
  std::memcpy(buffer.data(), buffer.data() + piece_bytes, used);
}

void Record::Canon::flush() {
  if (used == 0) return;
  sink->update(std::span(buffer).first(used));
  used = 0;
}

Record::Record(const Options& options) : options_(options) {
  run_canon_.sink = options.digest;
  ledger_canon_.sink = options.ledger_digest;
  for (Canon* canon : {&run_canon_, &ledger_canon_}) {
    if (canon->sink != nullptr) canon->buffer.resize(piece_bytes + row_bytes_max);
  }
}

void Record::require_open() const {
  require(!finished_, "something was recorded after the record was finished");
}

NameId Record::name(std::string_view text) {
  const auto known = ids_.find(text);
  if (known != ids_.end()) return known->second;
  require(names_.size() < names_max, "one run uses more than 65535 names");
  const NameId id = static_cast<NameId>(names_.size());
  names_.emplace_back(text);
  hashes_.push_back(fnv1a(text));
  ids_.emplace(text, id);
  return id;
}

void Record::agent(AgentId agent, std::string_view name, std::string_view kind) {
  require_open();
  run_canon_.row('A', agent);
  run_canon_.text(name);
  run_canon_.text(kind);
  agents_.push_back({agent, std::string(name), std::string(kind)});
}

void Record::scalar(AgentId agent, NameId name, double value, Origin origin) {
  require_open();
  canon(origin).row('C', agent, hash(name), value);
  scalars_.push_back({agent, name, value});
}

void Record::series(Time time, AgentId agent, NameId subject, NameId name, double value,
                    Origin origin) {
  require_open();
  canon(origin).row('S', time, agent, hash(subject), hash(name), value);
  series_.push_back({time, agent, subject, name, value});
}

void Record::message(const MessageRow& row) {
  require_open();
  run_canon_.row('M', row.sent, row.arrived, row.sender, row.receiver, hash(row.kind),
                 std::uint64_t{row.bytes}, hash(row.fate));
  if (options_.keep_messages) messages_.push_back(row);
}

void Record::link(const LinkRow& row) {
  require_open();
  run_canon_.row('L', row.sender, row.receiver, hash(row.fate), row.packets);
  links_.push_back(row);
}

void Record::event(Time time, AgentId agent, std::string_view kind, std::string_view detail) {
  require_open();
  run_canon_.row('E', time, agent, fnv1a(kind));
  run_canon_.text(detail);
  if (events_.size() < options_.events_max) {
    events_.push_back({time, agent, name(kind), std::string(detail)});
  } else {
    ++events_not_kept_;
  }
}

void Record::finish() {
  require_open();
  finished_ = true;
  run_canon_.flush();
  ledger_canon_.flush();
}

}  // namespace hearsay
