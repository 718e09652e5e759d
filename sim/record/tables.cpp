#include "sim/record/tables.hpp"

#include "sim/kernel/error.hpp"

namespace hearsay::record {

namespace {

constexpr int feed_columns = 7;

// SQLite's interface for a table of one's own: structures that begin with SQLite's part.
struct FeedTable {
  sqlite3_vtab base;
  const Feed* feed;
};
struct FeedCursor {
  sqlite3_vtab_cursor base;
  std::size_t row;
};

const Feed& feed_of(sqlite3_vtab_cursor* cursor) {
  return *reinterpret_cast<FeedTable*>(cursor->pVtab)->feed;
}

int feed_connect(sqlite3* database, void* feed, int, const char* const*, sqlite3_vtab** table,
                 char**) {
  const int code =
      sqlite3_declare_vtab(database, "CREATE TABLE feed(id, c0, c1, c2, c3, c4, c5, c6)");
  if (code != SQLITE_OK) return code;
  *table = &(new FeedTable{{}, static_cast<const Feed*>(feed)})->base;
  return SQLITE_OK;
}

int feed_disconnect(sqlite3_vtab* table) {
  delete reinterpret_cast<FeedTable*>(table);
  return SQLITE_OK;
}

int feed_plan(sqlite3_vtab*, sqlite3_index_info*) { return SQLITE_OK; }

int feed_open(sqlite3_vtab*, sqlite3_vtab_cursor** cursor) {
  *cursor = &(new FeedCursor{{}, 0})->base;
  return SQLITE_OK;
}

int feed_close(sqlite3_vtab_cursor* cursor) {
  delete reinterpret_cast<FeedCursor*>(cursor);
  return SQLITE_OK;
}

int feed_rewind(sqlite3_vtab_cursor* cursor, int, const char*, int, sqlite3_value**) {
  reinterpret_cast<FeedCursor*>(cursor)->row = feed_of(cursor).first;
  return SQLITE_OK;
}

int feed_next(sqlite3_vtab_cursor* cursor) {
  ++reinterpret_cast<FeedCursor*>(cursor)->row;
  return SQLITE_OK;
}

int feed_end(sqlite3_vtab_cursor* cursor) {
  const Feed& feed = feed_of(cursor);
  return reinterpret_cast<FeedCursor*>(cursor)->row >= feed.first + feed.count;
}

int feed_rowid(sqlite3_vtab_cursor* cursor, sqlite3_int64* id) {
  *id = feed_of(cursor).id + static_cast<std::int64_t>(reinterpret_cast<FeedCursor*>(cursor)->row);
  return SQLITE_OK;
}

int feed_cell(sqlite3_vtab_cursor* cursor, sqlite3_context* context, int column) {
  if (column == 0) {
    sqlite3_int64 id = 0;
    feed_rowid(cursor, &id);
    sqlite3_result_int64(context, id);
  } else {
    const std::size_t row = reinterpret_cast<FeedCursor*>(cursor)->row;
    (*feed_of(cursor).cell_of)(row, column - 1, Cell(context));
  }
  return SQLITE_OK;
}

sqlite3_module feed_module() {
  sqlite3_module module = {};
  module.xConnect = feed_connect;  // and no xCreate: the table is there without being created
  module.xBestIndex = feed_plan;
  module.xDisconnect = feed_disconnect;
  module.xOpen = feed_open;
  module.xClose = feed_close;
  module.xFilter = feed_rewind;
  module.xNext = feed_next;
  module.xEof = feed_end;
  module.xColumn = feed_cell;
  module.xRowid = feed_rowid;
  return module;
}

/// "c0, c1, …"
std::string feed_column_list(int number) {
  std::string list = "c0";
  for (int i = 1; i < number; ++i) list += ", c" + std::to_string(i);
  return list;
}

}  // namespace

void Cell::real(double value) {
  if (value != value) {
    sqlite3_result_null(context_);
  } else {
    sqlite3_result_double(context_, value == 0.0 ? 0.0 : value);
  }
}

void Cell::agent(AgentId agent) {
  if (agent == no_agent) {
    sqlite3_result_null(context_);
  } else {
    sqlite3_result_int64(context_, agent);
  }
}

void Cell::text(const std::string& value) {
  sqlite3_result_text64(context_, value.data(), value.size(), SQLITE_STATIC, SQLITE_UTF8);
}

Feed::Feed(SQLite::Database& database) {
  static const sqlite3_module module = feed_module();
  const int code = sqlite3_create_module(database.getHandle(), "feed", &module, this);
  if (code != SQLITE_OK) throw SQLite::Exception(database.getHandle(), code);
}

// Without an id in the statement SQLite takes the greatest plus one, and goes to the end of the
// table without a search: the way for all rows of a run but its first, if it is the last run.
RowTable::RowTable(SQLite::Database& database, Feed& feed, const std::string& table,
                   const std::string& columns, int number)
    : feed_(feed),
      insert_(database, "INSERT INTO " + table + "(id, " + columns + ") SELECT id, " +
                            feed_column_list(number) + " FROM feed"),
      append_(database, "INSERT INTO " + table + "(" + columns + ") SELECT " +
                            feed_column_list(number) + " FROM feed"),
      remove_(database, "DELETE FROM " + table + " WHERE id >= ?1 AND id < ?2") {
  require(number <= feed_columns, "a table has more columns than its feed");
}

void RowTable::insert(std::int64_t run, bool last, std::size_t count, const CellOf& cell_of) {
  if (count == 0) return;
  require(static_cast<std::int64_t>(count) < run_stride, "a run has more rows than can be stored");
  feed_.id = first_row(run);
  feed_.first = 0;
  feed_.count = last ? 1 : count;
  feed_.cell_of = &cell_of;
  insert_.step();
  if (last && count > 1) {
    feed_.first = 1;
    feed_.count = count - 1;
    append_.step();
  }
  feed_.cell_of = nullptr;
}

void RowTable::remove(std::int64_t run) {
  remove_.bind(1, first_row(run));
  remove_.bind(2, first_row(run + 1));
  remove_.step();
}

NameTable::NameTable(SQLite::Database& database)
    : insert_(database, "INSERT INTO name(id, text) VALUES(?, ?)") {
  SQLite::Statement known(database, "SELECT id, text FROM name");
  while (known.executeStep()) {
    ids_.emplace(known.getColumn(1).getString(), known.getColumn(0).getInt64());
  }
}

std::int64_t NameTable::id(const std::string& text) {
  const auto [entry, added] = ids_.try_emplace(text, static_cast<std::int64_t>(ids_.size()) + 1);
  if (added) {
    insert_.reset();
    insert_.bind(1, entry->second);
    insert_.bindNoCopy(2, entry->first);
    insert_.exec();
  }
  return entry->second;
}

QuantityTable::QuantityTable(SQLite::Database& database, NameTable& names)
    : insert_(database,
              "INSERT INTO quantity(id, agent, subject, name) SELECT ?1, ?2, "
              "(SELECT text FROM name WHERE id = ?3), (SELECT text FROM name WHERE id = ?4)") {
  SQLite::Statement known(database, "SELECT id, agent, subject, name FROM quantity");
  while (known.executeStep()) {
    const auto subject = known.getColumn(2);
    const Key key{known.getColumn(1).getInt64(),
                  subject.isNull() ? 0 : names.id(subject.getString()),
                  names.id(known.getColumn(3).getString())};
    known_.emplace(key, Known{key, known.getColumn(0).getInt64()});
  }
}

std::int64_t QuantityTable::id(AgentId agent, std::int64_t subject, std::int64_t name) {
  const Key key{agent, subject, name};
  Known* known = last_->next;  // rows come in the same order at every instant
  if (known == nullptr || known->key != key) {
    const auto [found, added] =
        known_.try_emplace(key, Known{key, static_cast<std::int64_t>(known_.size()) + 1});
    known = &found->second;
    last_->next = known;
    if (added) {
      insert_.reset();
      insert_.bind(1, known->id);
      insert_.bind(2, key.agent);
      insert_.bind(3, key.subject);
      insert_.bind(4, key.name);
      insert_.exec();
    }
  }
  last_ = known;
  return known->id;
}

ListTable::ListTable(SQLite::Database& database, const std::string& table,
                     const std::string& columns, int number)
    : insert_(
          database, "INSERT INTO " + table + "(id, place, " + columns + ") VALUES(?, ?" + [&] {
            std::string marks;
            for (int i = 0; i < number; ++i) marks += ", ?";
            return marks;
          }() + ")") {
  SQLite::Statement known(database,
                          "SELECT id, " + columns + " FROM " + table + " ORDER BY id, place");
  std::map<std::int64_t, List> lists;
  while (known.executeStep()) {
    std::vector<std::string> row;
    for (int i = 1; i <= number; ++i) row.push_back(known.getColumn(i).getString());
    lists[known.getColumn(0).getInt64()].push_back(std::move(row));
  }
  for (auto& [id, list] : lists) ids_.emplace(std::move(list), id);
}

std::int64_t ListTable::id(const List& list) {
  if (list.empty()) return 0;
  const auto [entry, added] = ids_.try_emplace(list, static_cast<std::int64_t>(ids_.size()) + 1);
  if (!added) return entry->second;
  for (std::size_t place = 0; place < list.size(); ++place) {
    insert_.reset();
    insert_.bind(1, entry->second);
    insert_.bind(2, static_cast<std::int64_t>(place) + 1);
    int parameter = 2;
    for (const std::string& text : list[place]) insert_.bind(++parameter, text);
    insert_.exec();
  }
  return entry->second;
}

}  // namespace hearsay::record
