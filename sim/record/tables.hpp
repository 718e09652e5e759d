// Private to sim/record: how rows and shared lists get into their tables.
#pragma once

#include <SQLiteCpp/Statement.h>

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "sim/kernel/ids.hpp"
#include "sim/kernel/record.hpp"
#include "sim/record/schema.hpp"

namespace hearsay::record {

/// What SQLite calls a result: where one cell of a row is put.
class Cell {
 public:
  explicit Cell(sqlite3_context* context) : context_(context) {}
  void integer(std::int64_t value) { sqlite3_result_int64(context_, value); }
  /// NaN becomes NULL, −0 becomes +0 (as in the digest).
  void real(double value);
  /// Seconds, the nearest double.
  void seconds(Time time) { real(static_cast<double>(time.nanoseconds()) / 1e9); }
  /// NULL for no_agent.
  void agent(AgentId agent);
  /// Must live until the row is stored.
  void text(const std::string& value);

 private:
  sqlite3_context* context_;
};

/// Puts the cell of a row and column (both from 0) of the rows being stored.
using CellOf = std::function<void(std::size_t row, int column, Cell cell)>;

/// Rows in memory as a table that SQLite reads, `feed(id, c0 … c6)`: an INSERT … SELECT from it
/// stores a run's rows in one statement, at about twice the speed of one statement a row.
class Feed {
 public:
  /// Lives as long as `database` is used.
  explicit Feed(SQLite::Database& database);
  Feed(const Feed&) = delete;
  Feed& operator=(const Feed&) = delete;

  std::int64_t id = 0;    ///< id of the first row
  std::size_t first = 0;  ///< row that comes first
  std::size_t count = 0;  ///< number of rows
  const CellOf* cell_of = nullptr;
};

/// A table of rows whose ids contain the run.
class RowTable {
 public:
  /// `columns`: those after the id, separated by commas; `number` of them, at most 7.
  RowTable(SQLite::Database& database, Feed& feed, const std::string& table,
           const std::string& columns, int number);
  /// Stores rows 0 … count−1 of a run. `last`: no run with a greater id is in the table.
  void insert(std::int64_t run, bool last, std::size_t count, const CellOf& cell_of);
  void remove(std::int64_t run);

 private:
  Feed& feed_;
  Query insert_;
  Query append_;
  Query remove_;
};

/// Texts by number, from 1 in order of first use.
class NameTable {
 public:
  explicit NameTable(SQLite::Database& database);
  std::int64_t id(const std::string& text);

 private:
  SQLite::Statement insert_;
  std::map<std::string, std::int64_t> ids_;
};

/// What a value is of: an agent, a subject (none for scalars) and a name, by number from 1.
class QuantityTable {
 public:
  QuantityTable(SQLite::Database& database, NameTable& names);
  QuantityTable(const QuantityTable&) = delete;
  QuantityTable& operator=(const QuantityTable&) = delete;
  /// `subject`, `name`: numbers in the name table, 0 for no subject.
  std::int64_t id(AgentId agent, std::int64_t subject, std::int64_t name);

 private:
  struct Key {
    std::int64_t agent = 0, subject = 0, name = 0;
    auto operator<=>(const Key&) const = default;
  };
  struct Known {
    Key key;
    std::int64_t id = 0;
    Known* next = nullptr;  ///< what was asked for after this the last time
  };
  SQLite::Statement insert_;
  std::map<Key, Known> known_;
  Known first_;  ///< stands before any was asked for
  Known* last_ = &first_;
};

/// Lists that many runs share, each stored once under a number from 1.
class ListTable {
 public:
  using List = std::vector<std::vector<std::string>>;
  /// `table(id, place, <columns>)`, with `number` columns.
  ListTable(SQLite::Database& database, const std::string& table, const std::string& columns,
            int number);
  /// 0 for an empty list.
  std::int64_t id(const List& list);

 private:
  SQLite::Statement insert_;
  std::map<List, std::int64_t> ids_;
};

}  // namespace hearsay::record
