// Private to sim/record: the tables, how a file is recognized, and a prepared statement.
//
// The rows of a run are stored under ids that contain the run: run · 2^32 + place in the record.
// So a run is found, read in order and removed by its ids alone, no row repeats the run's number,
// no index is needed, and the ids do not depend on what was added before. What a value is of
// (agent, subject, name) is one number into `quantity`; lists that many runs share (agents, axes)
// are stored once. The views undo all this.
#pragma once

#include <SQLiteCpp/Database.h>
#include <SQLiteCpp/Exception.h>
#include <sqlite3.h>

#include <cstdint>
#include <string>
#include <string_view>

namespace hearsay::record {

/// Makes all tables and views of schema_version.
extern const char* const schema_sql;

/// Tables and views that analysis may rely on, in the order of an export.
inline constexpr const char* public_tables[] = {"study",  "run",     "axis", "agent", "scalar",
                                                "series", "message", "link", "event"};

/// Runs and rows a run are below this.
inline constexpr std::int64_t run_stride = std::int64_t{1} << 32;
inline constexpr std::int64_t run_id_max = (std::int64_t{1} << 31) - 1;

/// Id of the first row of a run; the last is below first_row(run + 1).
constexpr std::int64_t first_row(std::int64_t run) { return run * run_stride; }

/// Throws an InputError that names the file and says in a user's words what SQLite found.
/// `doing`: "read" or "written".
[[noreturn]] void fail(const std::string& file, const char* doing, const SQLite::Exception& error);

/// Path by which SQLite opens `file`: absolute, so that ":memory:" or "file:x" are plain names.
std::string plain_path(const std::string& file);

/// True if the database has no content yet. @throws InputError if it is neither empty nor a
/// hearsay database of this schema version.
bool is_new(SQLite::Database& database, const std::string& file);

/// Opens for reading. @throws InputError: missing, not a hearsay database, version.
SQLite::Database open_to_read(const std::string& file);

/// The shortest decimal text that reads back as the same double.
std::string shortest(double value);

/// A prepared statement without the cost of a wrapper a cell, for loops over many rows.
class Query {
 public:
  Query(SQLite::Database& database, const std::string& sql);
  ~Query() { sqlite3_finalize(statement_); }
  Query(const Query&) = delete;
  Query& operator=(const Query&) = delete;

  void bind(int parameter, std::int64_t value) { sqlite3_bind_int64(statement_, parameter, value); }
  /// To the next row; false at the end, after which the statement can be bound and run again.
  bool step();
  void reset() { sqlite3_reset(statement_); }

  int columns() const { return sqlite3_column_count(statement_); }
  const char* column_name(int column) const { return sqlite3_column_name(statement_, column); }
  int type(int column) const { return sqlite3_column_type(statement_, column); }
  std::int64_t integer(int column) const { return sqlite3_column_int64(statement_, column); }
  double real(int column) const { return sqlite3_column_double(statement_, column); }
  /// Valid until the next step.
  std::string_view text(int column) const;

 private:
  sqlite3* database_;
  sqlite3_stmt* statement_ = nullptr;
};

}  // namespace hearsay::record
