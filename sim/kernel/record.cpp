#include "sim/kernel/record.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

#include "sim/kernel/error.hpp"

namespace hearsay {

namespace {

constexpr std::size_t buffer_bytes = 4096;
constexpr std::size_t names_max = 65'535;
constexpr std::uint64_t one_nan = 0x7ff8000000000000;

std::uint64_t fnv1a(std::string_view text) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  return hash;
}

}  // namespace

void Record::Canon::bytes(std::span<const std::byte> value) {
  if (sink == nullptr) return;
  while (!value.empty()) {
    const std::size_t part = std::min(value.size(), buffer.size() - used);
    std::memcpy(buffer.data() + used, value.data(), part);
    used += part;
    value = value.subspan(part);
    if (used == buffer.size()) flush();
  }
}

void Record::Canon::row(char kind) {
  const std::byte byte = static_cast<std::byte>(kind);
  bytes({&byte, 1});
}

void Record::Canon::u64(std::uint64_t value) {
  std::byte little[8];
  for (int i = 0; i < 8; ++i) little[i] = static_cast<std::byte>(value >> (8 * i));
  bytes(little);
}

void Record::Canon::f64(double value) {
  if (value != value) return u64(one_nan);
  u64(std::bit_cast<std::uint64_t>(value == 0.0 ? 0.0 : value));
}

void Record::Canon::text(std::string_view value) {
  u64(value.size());
  bytes(std::as_bytes(std::span(value)));
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
    if (canon->sink != nullptr) canon->buffer.resize(buffer_bytes);
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
  run_canon_.row('A');
  run_canon_.i64(agent);
  run_canon_.text(name);
  run_canon_.text(kind);
  agents_.push_back({agent, std::string(name), std::string(kind)});
}

void Record::scalar(AgentId agent, NameId name, double value, Origin origin) {
  require_open();
  Canon& out = canon(origin);
  out.row('C');
  out.i64(agent);
  out.u64(hash(name));
  out.f64(value);
  scalars_.push_back({agent, name, value});
}

void Record::series(Time time, AgentId agent, NameId subject, NameId name, double value,
                    Origin origin) {
  require_open();
  Canon& out = canon(origin);
  out.row('S');
  out.i64(time.nanoseconds());
  out.i64(agent);
  out.u64(hash(subject));
  out.u64(hash(name));
  out.f64(value);
  series_.push_back({time, agent, subject, name, value});
}

void Record::message(const MessageRow& row) {
  require_open();
  run_canon_.row('M');
  run_canon_.i64(row.sent.nanoseconds());
  run_canon_.i64(row.arrived.nanoseconds());
  run_canon_.i64(row.sender);
  run_canon_.i64(row.receiver);
  run_canon_.u64(hash(row.kind));
  run_canon_.u64(row.bytes);
  run_canon_.u64(hash(row.fate));
  if (options_.keep_messages) messages_.push_back(row);
}

void Record::event(Time time, AgentId agent, std::string_view kind, std::string_view detail) {
  require_open();
  run_canon_.row('E');
  run_canon_.i64(time.nanoseconds());
  run_canon_.i64(agent);
  run_canon_.u64(fnv1a(kind));
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
