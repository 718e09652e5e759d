#include "sim/kernel/record.hpp"

namespace hearsay {

namespace {

constexpr std::size_t names_max = 65'535;

std::uint64_t fnv1a(std::string_view text) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  return hash;
}

}  // namespace

Record::Record(const Options& options)
    : options_(options), run_canon_(options.digest), ledger_canon_(options.ledger_digest) {}

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
  if (options_.tap) return options_.tap->on_scalar({agent, name, value}, origin);
  canon(origin).row('C', agent, hash(name), value);
  scalars_.push_back({agent, name, value});
}

void Record::series(Time time, AgentId agent, NameId subject, NameId name, double value,
                    Origin origin) {
  require_open();
  if (options_.tap) return options_.tap->on_series({time, agent, subject, name, value}, origin);
  canon(origin).row('S', time, agent, hash(subject), hash(name), value);
  series_.push_back({time, agent, subject, name, value});
}

void Record::keep(MessageRow row) { messages_.push_back(row); }

void Record::link(const LinkRow& row) {
  require_open();
  run_canon_.row('L', row.sender, row.receiver, hash(row.fate), row.packets);
  links_.push_back(row);
}

void Record::event(Time time, AgentId agent, std::string_view kind, std::string_view detail) {
  require_open();
  if (options_.tap) return options_.tap->on_event(time, agent, kind, detail);
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
