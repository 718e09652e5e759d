// Runs in an SQLite file.
//
// Analysis may rely on these names (tables, or views of the same columns):
//   study(id, name, file, config)                        config: the study file's text
//   run(id, study, scenario, parameters, repetition, seed, status, reason, digest, config_hash,
//       wall_s, events, version)     study: its name or NULL; parameters: JSON; status "ok" |
//       "failed"
//   axis(run, name, value)     agent(run, id, name, kind)     scalar(run, agent, name, value)
//   series(run, t_s, agent, subject, name, value)
//   message(run, sent_s, arrived_s, sender, receiver, kind, bytes, fate)
//   link(run, sender, receiver, fate, packets)      how many packets met which fate on a link
//   event(run, t_s, agent, kind, detail)
// Names are stored once, as integers; the views show them as text. NaN is stored as NULL, −0 as 0;
// a sender, receiver or agent that is nobody is NULL. Times are the double nearest to the simulated
// nanoseconds. The rows of a run lie together and are found by its number, so a query is fast that
// gives the run first: run = …, run IN (SELECT run FROM axis …), or axis JOIN series in this order.
//
// A run is whole or absent: one transaction each batch of runs, write-ahead log, one writer. Runs
// must be added in ascending id, so a sweep that was killed leaves a prefix and its continuation
// ends with the same content. What was committed survives the end of the process, however it ends;
// when the machine loses power, the last commits may be lost, and the file stays sound.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "sim/kernel/record.hpp"

namespace hearsay {

/// Raised when tables change. A file of another version is refused by name of both.
inline constexpr int schema_version = 2;
/// SQLite application id of our files ("hrsy").
inline constexpr std::int32_t application_id = 0x68727379;

struct StudyRow {
  std::string name;
  std::string file;
  std::string config;
};

struct RunRow {
  std::int64_t id = 1;
  std::string study;     ///< name; empty: none
  std::string scenario;  ///< file name without directories
  std::string parameters_json = "{}";
  std::vector<std::pair<std::string, std::string>> axes;  ///< axis → label (JSON scalar text)
  int repetition = 1;
  std::uint64_t seed = 1;  ///< stored as signed 64 bits
  bool ok = true;
  std::string reason;  ///< of the end: "time reached", or a failure's message
  std::string digest;
  std::string config_hash;
  double wall_s = 0.0;
  std::uint64_t events = 0;
  std::string version;
};

/// One thread at a time.
class DatabaseWriter {
 public:
  /// Opens or makes `file`. It is this writer's alone until it is closed (others can read it).
  /// A file that could not be made is not left behind; an empty one counts as new.
  /// @throws InputError: not a hearsay database, another schema version, cannot be written, is
  /// being written by another process.
  explicit DatabaseWriter(const std::string& file);
  ~DatabaseWriter();
  DatabaseWriter(const DatabaseWriter&) = delete;
  DatabaseWriter& operator=(const DatabaseWriter&) = delete;

  /// Registers a study. If the file has it with another config: InputError (it would mix results).
  void add_study(const StudyRow& study);
  /// Ids already present (of any status), and those that failed.
  std::set<std::int64_t> run_ids() const;
  std::set<std::int64_t> failed_run_ids() const;
  /// config_hash of a stored run; nothing if absent.
  std::optional<std::string> config_hash(std::int64_t id) const;
  /// One more than the greatest id that is or was in the file.
  std::int64_t next_run_id() const;
  /// Removes a run, if it is there; afterwards it may be added again, also when a later one is
  /// there.
  void remove_run(std::int64_t id);

  /// Adds a whole run. Becomes visible at the next commit. The id is at least next_run_id(), or
  /// that of a run that was removed (@throws BrokenInvariant); its study was added before. A run
  /// may hold up to 2^32 rows a table, a file runs with ids up to 2^31 − 1. Here and below @throws
  /// InputError if the file cannot be written (disk full); what was not committed is lost then, and
  /// the writer takes no more.
  void add(const RunRow& run, const Record& record);
  /// Makes all added runs durable. The destructor does not commit.
  void commit();
  /// Commits and brings the file to one piece (empties the write-ahead log, sets the journal mode
  /// back so that no -wal file stays, unless someone is reading). Nothing can be added any more.
  void close();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Checks that `file` is a hearsay database of this schema version.
/// @throws InputError naming the file and what is wrong (missing, not a database, version).
void check_database(const std::string& file);

struct DiffOptions {
  /// Compare just these runs, whose ids then do not count. One alone: the same id in both files.
  std::optional<std::int64_t> run_a, run_b;
};

/// First difference of two databases, or of one run in each, as text that names table, key columns
/// and both values; nothing if they are equal. wall_s, the study's file and paths do not count.
///
/// Studies first, then runs by id. Of a run: what was asked (study, scenario, parameters, axes,
/// repetition, seed, config_hash, agents), then the earliest row in simulated time among series,
/// messages and events, then scalars, then what came out (status, reason, events, version, digest).
/// Of two chosen runs what was asked comes last, so that the first row that differs is seen.
/// Values are equal if they are the same bits; their text reads back as the same double.
/// @throws InputError: as check_database; a run is not there.
std::optional<std::string> first_difference(const std::string& file_a, const std::string& file_b,
                                            const DiffOptions& options);

/// Writes each table of the list above as <directory>/<table>.csv: RFC 4180 (lines end with CR LF),
/// a header line, NULL empty and an empty text as "", doubles in the shortest form that reads back
/// as the same. Makes the directory. Returns table and number of rows. All files are written under
/// temporary names first and renamed when the last is complete.
/// @throws InputError: as check_database; the directory or a file cannot be written.
std::vector<std::pair<std::string, std::int64_t>> export_csv(const std::string& file,
                                                             const std::string& directory);

}  // namespace hearsay
