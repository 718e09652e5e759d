// What a run leaves behind, in memory: scalars, series, packets' fates, events.
//
// Everything recorded is also fed, in order and in a canonical byte form, to a digest: two runs
// with the same digest recorded the same things in the same order. Rows that come from the rumour
// ledger go to a second digest, so that switching the ledger off changes the first in nothing.
// Fates are digested one by one even where only their counts are kept.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/kernel/canon.hpp"
#include "sim/kernel/error.hpp"
#include "sim/kernel/ids.hpp"
#include "sim/kernel/time.hpp"

namespace hearsay {

/// A name within one Record; equal text, equal id. Ids count from 0 in order of first use.
using NameId = std::uint16_t;

struct ScalarRow {
  AgentId agent;
  NameId name;
  double value;  ///< NaN: not defined for this run (stored as NULL)
};
struct SeriesRow {
  Time time;
  AgentId agent;
  NameId subject;
  NameId name;
  double value;  ///< NaN: not defined at this instant (stored as NULL)
};
struct MessageRow {
  Time sent;
  Time arrived;  ///< when its fate was settled
  AgentId sender;
  AgentId receiver;
  NameId kind;
  std::uint32_t bytes;
  NameId fate;
};
/// How many packets met a fate on a directed link, over the whole run.
struct LinkRow {
  AgentId sender;
  AgentId receiver;
  NameId fate;
  std::uint64_t packets;
};
struct EventRow {
  Time time;
  AgentId agent;  ///< no_agent if it belongs to none
  NameId kind;
  std::string detail;
};
struct AgentRow {
  AgentId agent;
  std::string name;
  std::string kind;
};

/// Which part of a record a row belongs to.
enum class Origin : std::uint8_t {
  run,     ///< what happened
  ledger,  ///< what the out-of-band ledger says about it
};

/// Gets rows in place of a record that is kept elsewhere.
class RecordTap {
 public:
  virtual ~RecordTap() = default;
  virtual void on_scalar(const ScalarRow& row, Origin origin) = 0;
  virtual void on_series(const SeriesRow& row, Origin origin) = 0;
  virtual void on_event(Time time, AgentId agent, std::string_view kind,
                        std::string_view detail) = 0;
};

class Record {
 public:
  struct Options {
    bool keep_messages = false;           ///< keep a row a packet and receiver, not only the counts
    std::size_t events_max = 100'000;     ///< events kept; more are digested and counted only
    DigestSink* digest = nullptr;         ///< for Origin::run; not owned
    DigestSink* ledger_digest = nullptr;  ///< for Origin::ledger; not owned
    RecordTap* tap = nullptr;  ///< gets scalars, series and events, which are not kept; not owned
  };
  explicit Record(const Options& options);

  /// The id of `text`, new or known. At most 65,535 names a run (else BrokenInvariant). Naming
  /// alone leaves every digest as it is.
  NameId name(std::string_view text);
  const std::string& text(NameId id) const { return names_.at(id); }

  void agent(AgentId agent, std::string_view name, std::string_view kind);
  void scalar(AgentId agent, NameId name, double value, Origin origin = Origin::run);
  void series(Time time, AgentId agent, NameId subject, NameId name, double value,
              Origin origin = Origin::run);
  void message(const MessageRow& row) {
    require_open();
    run_canon_.row('M', row.sent, row.arrived, row.sender, row.receiver, hash(row.kind),
                   std::uint64_t{row.bytes}, hash(row.fate));
    if (options_.keep_messages) keep(row);
  }
  void link(const LinkRow& row);
  void event(Time time, AgentId agent, std::string_view kind, std::string_view detail);

  /// Passes what is still buffered to the digests. Call once, after the last row: a row that comes
  /// later is a BrokenInvariant, since no digest would show it.
  void finish();

  std::span<const std::string> names() const { return names_; }
  std::span<const AgentRow> agents() const { return agents_; }
  std::span<const ScalarRow> scalars() const { return scalars_; }
  std::span<const SeriesRow> series() const { return series_; }
  std::span<const MessageRow> messages() const { return messages_; }
  std::span<const LinkRow> links() const { return links_; }
  std::span<const EventRow> events() const { return events_; }
  /// Events beyond `events_max`.
  std::uint64_t events_not_kept() const { return events_not_kept_; }

 private:
  Canon& canon(Origin origin) { return origin == Origin::run ? run_canon_ : ledger_canon_; }
  std::uint64_t hash(NameId id) const { return hashes_.at(id); }
  void require_open() const {
    require(!finished_, "something was recorded after the record was finished");
  }
  void keep(MessageRow row);

  Options options_;
  std::vector<std::string> names_;
  std::vector<std::uint64_t> hashes_;  // of names_: 64-bit FNV-1a
  std::map<std::string, NameId, std::less<>> ids_;
  std::vector<AgentRow> agents_;
  std::vector<ScalarRow> scalars_;
  std::vector<SeriesRow> series_;
  std::vector<MessageRow> messages_;
  std::vector<LinkRow> links_;
  std::vector<EventRow> events_;
  std::uint64_t events_not_kept_ = 0;
  bool finished_ = false;
  Canon run_canon_;
  Canon ledger_canon_;
};

}  // namespace hearsay
