#include <SQLiteCpp/Statement.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <map>
#include <thread>
#include <vector>

#include "sim/kernel/error.hpp"
#include "sim/record/database.hpp"
#include "sim/record/schema.hpp"
#include "sim/record/tables.hpp"

namespace hearsay {

using namespace record;

namespace {

constexpr int wait_ms = 10'000;

void wait_at_most(SQLite::Database& database, int ms) {
  sqlite3_busy_timeout(database.getHandle(), ms);
}

/// Begins the transaction that a writer always has open, so that there is one writer. SQLite has no
/// way to commit and begin at once; a second writer that comes just in between finds the file free
/// once, but not three times. Ends by itself when the process is killed.
void begin_alone(SQLite::Database& database) {
  wait_at_most(database, 500);  // the recovery of a killed writer's log may be under way
  for (int probe = 0; probe < 2; ++probe) {
    database.exec("BEGIN IMMEDIATE");
    database.exec("ROLLBACK");
    wait_at_most(database, 0);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  database.exec("BEGIN IMMEDIATE");
  wait_at_most(database, wait_ms);
}

void make_schema(SQLite::Database& database) {
  database.exec("PRAGMA application_id = " + std::to_string(application_id));
  database.exec("PRAGMA user_version = " + std::to_string(schema_version));
  database.exec(schema_sql);
}

/// Opens `file` with an immediate transaction begun. Makes the tables if there are none.
SQLite::Database open_to_write(const std::string& file) {
  const std::string path = plain_path(file);
  std::error_code ignored;
  const bool existed = std::filesystem::exists(path, ignored);
  try {
    SQLite::Database database(
        path, SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE | SQLite::OPEN_NOMUTEX, 500);
    is_new(database, file);  // before anything is written
    database.exec("PRAGMA synchronous = NORMAL");
    begin_alone(database);
    if (is_new(database, file)) make_schema(database);
    database.exec("COMMIT");
    database.exec("PRAGMA journal_mode = WAL");
    database.exec("PRAGMA wal_autocheckpoint = 4000");
    database.exec("BEGIN IMMEDIATE");
    return database;
  } catch (const SQLite::Exception& error) {
    // A file that is busy was made by someone else in the meantime.
    if (!existed && (error.getErrorCode() & 0xff) != SQLITE_BUSY) {
      for (const char* suffix : {"", "-journal", "-wal", "-shm"}) {
        std::filesystem::remove(path + suffix, ignored);
      }
    }
    fail(file, "written", error);
  }
}

/// Numbers in the database for the names of a record.
std::vector<std::int64_t> name_ids(const Record& record, NameTable& names) {
  std::vector<std::int64_t> ids;
  ids.reserve(record.names().size());
  for (const std::string& name : record.names()) ids.push_back(names.id(name));
  return ids;
}

}  // namespace

struct DatabaseWriter::Impl {
  explicit Impl(const std::string& file_name)
      : file(file_name),
        database(open_to_write(file)),
        feed(database),
        scalar_rows(database, feed, "scalar_row", "quantity, value", 2),
        series_rows(database, feed, "series_row", "t_s, quantity, value", 3),
        message_rows(database, feed, "message_row",
                     "sent_s, arrived_s, sender, receiver, kind, bytes, fate", 7),
        link_rows(database, feed, "link_row", "sender, receiver, fate, packets", 4),
        event_rows(database, feed, "event_row", "t_s, agent, kind, detail", 4),
        names(database),
        quantities(database, names),
        agent_lists(database, "agent_set", "agent, name, kind", 3),
        axis_lists(database, "axis_set", "name, value", 2),
        insert_run(database,
                   "INSERT INTO run_row VALUES(?, nullif(?, 0), ?, ?, nullif(?, 0), nullif(?, 0), "
                   "?, ?, ?, ?, ?, ?, ?, ?, ?)") {
    greatest_run = number("SELECT ifnull(max(id), 0) FROM run_row");
    removed = ids("SELECT id FROM removed_run");
    Query known(database, "SELECT id, name FROM study");
    while (known.step()) studies.emplace(known.text(1), known.integer(0));
  }

  std::int64_t number(const std::string& sql) { return database.execAndGet(sql).getInt64(); }

  std::set<std::int64_t> ids(const std::string& sql) {
    std::set<std::int64_t> found;
    Query query(database, sql);
    while (query.step()) found.insert(query.integer(0));
    return found;
  }

  /// Does what changes the file. After a failure the open transaction may hold half a run: it is
  /// given up, and nothing more is taken.
  template <typename Work>
  void write(Work work) {
    require(usable, "a database is used after it was closed or after writing to it had failed");
    usable = false;
    try {
      work();
      usable = true;
    } catch (const SQLite::Exception& error) {
      sqlite3_exec(database.getHandle(), "ROLLBACK", nullptr, nullptr, nullptr);
      fail(file, "written", error);
    }
  }

  void add_run_row(const RunRow& run, const Record& record);
  void add_rows(std::int64_t run, bool last, const Record& record);

  std::string file;
  SQLite::Database database;
  Feed feed;
  RowTable scalar_rows, series_rows, message_rows, link_rows, event_rows;
  NameTable names;
  QuantityTable quantities;
  ListTable agent_lists, axis_lists;
  SQLite::Statement insert_run;
  std::map<std::string, std::int64_t> studies;
  std::int64_t greatest_run = 0;
  std::set<std::int64_t> removed;  ///< runs that may be added although a later one is there
  bool usable = true;
};

void DatabaseWriter::Impl::add_run_row(const RunRow& run, const Record& record) {
  ListTable::List axes, agents;
  for (const auto& [name, label] : run.axes) axes.push_back({name, label});
  for (const AgentRow& row : record.agents()) {
    agents.push_back({std::to_string(row.agent), row.name, row.kind});
  }
  SQLite::Statement& row = insert_run;
  row.reset();
  row.bind(1, run.id);
  row.bind(2, run.study.empty() ? 0 : studies.at(run.study));
  row.bind(3, names.id(run.scenario));
  row.bind(4, names.id(run.parameters_json));
  row.bind(5, axis_lists.id(axes));
  row.bind(6, agent_lists.id(agents));
  row.bind(7, run.repetition);
  row.bind(8, static_cast<std::int64_t>(run.seed));
  row.bind(9, run.ok ? 1 : 0);
  row.bind(10, names.id(run.reason));
  row.bind(11, run.digest);
  row.bind(12, run.config_hash);
  row.bind(13, run.wall_s);
  row.bind(14, static_cast<std::int64_t>(run.events));
  row.bind(15, names.id(run.version));
  row.exec();
}

void DatabaseWriter::Impl::add_rows(std::int64_t run, bool last, const Record& record) {
  const std::vector<std::int64_t> name = name_ids(record, names);
  // A quantity must be stored before the statement that uses it runs.
  std::vector<std::int64_t> quantity;
  quantity.reserve(std::max(record.scalars().size(), record.series().size()));
  for (const ScalarRow& row : record.scalars()) {
    quantity.push_back(quantities.id(row.agent, 0, name.at(row.name)));
  }
  scalar_rows.insert(run, last, record.scalars().size(), [&](auto row, int column, Cell cell) {
    column == 0 ? cell.integer(quantity[row]) : cell.real(record.scalars()[row].value);
  });
  quantity.clear();
  for (const SeriesRow& row : record.series()) {
    quantity.push_back(quantities.id(row.agent, name.at(row.subject), name.at(row.name)));
  }
  series_rows.insert(run, last, record.series().size(), [&](auto row, int column, Cell cell) {
    const SeriesRow& value = record.series()[row];
    if (column == 0) return cell.seconds(value.time);
    column == 1 ? cell.integer(quantity[row]) : cell.real(value.value);
  });
  message_rows.insert(run, last, record.messages().size(), [&](auto row, int column, Cell cell) {
    const MessageRow& message = record.messages()[row];
    switch (column) {
      case 0:
        return cell.seconds(message.sent);
      case 1:
        return cell.seconds(message.arrived);
      case 2:
        return cell.agent(message.sender);
      case 3:
        return cell.agent(message.receiver);
      case 4:
        return cell.integer(name.at(message.kind));
      case 5:
        return cell.integer(message.bytes);
      default:
        return cell.integer(name.at(message.fate));
    }
  });
  link_rows.insert(run, last, record.links().size(), [&](auto row, int column, Cell cell) {
    const LinkRow& link = record.links()[row];
    switch (column) {
      case 0:
        return cell.agent(link.sender);
      case 1:
        return cell.agent(link.receiver);
      case 2:
        return cell.integer(name.at(link.fate));
      default:
        return cell.integer(static_cast<std::int64_t>(link.packets));
    }
  });
  event_rows.insert(run, last, record.events().size(), [&](auto row, int column, Cell cell) {
    const EventRow& event = record.events()[row];
    switch (column) {
      case 0:
        return cell.seconds(event.time);
      case 1:
        return cell.agent(event.agent);
      case 2:
        return cell.integer(name.at(event.kind));
      default:
        return cell.text(event.detail);
    }
  });
}

DatabaseWriter::DatabaseWriter(const std::string& file) {
  try {
    impl_ = std::make_unique<Impl>(file);
  } catch (const SQLite::Exception& error) {
    fail(file, "written", error);
  }
}

DatabaseWriter::~DatabaseWriter() = default;

void DatabaseWriter::add_study(const StudyRow& study) {
  impl_->write([&] {
    SQLite::Statement known(impl_->database, "SELECT config FROM study WHERE name = ?");
    known.bind(1, study.name);
    if (known.executeStep()) {
      if (known.getColumn(0).getString() == study.config) return;
      impl_->usable = true;  // nothing was written
      throw InputError(impl_->file, 0,
                       "has results of another version of the study '" + study.name +
                           "'; write to another file, or remove this one");
    }
    SQLite::Statement insert(impl_->database,
                             "INSERT INTO study(name, file, config) VALUES(?, ?, ?)");
    insert.bind(1, study.name);
    insert.bind(2, study.file);
    insert.bind(3, study.config);
    insert.exec();
    impl_->studies.emplace(study.name, impl_->database.getLastInsertRowid());
  });
}

std::set<std::int64_t> DatabaseWriter::run_ids() const {
  return impl_->ids("SELECT id FROM run_row");
}

std::set<std::int64_t> DatabaseWriter::failed_run_ids() const {
  return impl_->ids("SELECT id FROM run_row WHERE ok = 0");
}

std::optional<std::string> DatabaseWriter::config_hash(std::int64_t id) const {
  Query query(impl_->database, "SELECT config_hash FROM run_row WHERE id = ?1");
  query.bind(1, id);
  if (!query.step()) return std::nullopt;
  return std::string(query.text(0));
}

std::int64_t DatabaseWriter::next_run_id() const {
  const auto& removed = impl_->removed;
  return std::max(impl_->greatest_run, removed.empty() ? 0 : *removed.rbegin()) + 1;
}

void DatabaseWriter::remove_run(std::int64_t id) {
  impl_->write([&] {
    SQLite::Database& database = impl_->database;
    if (database.exec("DELETE FROM run_row WHERE id = " + std::to_string(id)) == 0) return;
    for (RowTable* rows : {&impl_->scalar_rows, &impl_->series_rows, &impl_->message_rows,
                           &impl_->link_rows, &impl_->event_rows}) {
      rows->remove(id);
    }
    database.exec("INSERT INTO removed_run VALUES(" + std::to_string(id) + ")");
    impl_->removed.insert(id);
    impl_->greatest_run = impl_->number("SELECT ifnull(max(id), 0) FROM run_row");
  });
}

void DatabaseWriter::add(const RunRow& run, const Record& record) {
  const bool again = impl_->removed.contains(run.id);
  require(run.id >= 1 && run.id <= run_id_max, "a run's id is not in 1 … 2^31 - 1");
  require(again || run.id >= next_run_id(), "runs are not added in ascending order of their ids");
  require(run.study.empty() || impl_->studies.contains(run.study),
          "a run of a study that was not added");
  impl_->write([&] {
    const bool last = run.id > impl_->greatest_run;
    impl_->add_run_row(run, record);
    impl_->add_rows(run.id, last, record);
    if (again) {
      impl_->database.exec("DELETE FROM removed_run WHERE id = " + std::to_string(run.id));
      impl_->removed.erase(run.id);
    }
    if (last) impl_->greatest_run = run.id;
  });
}

void DatabaseWriter::commit() {
  impl_->write([&] {
    impl_->database.exec("COMMIT");
    impl_->database.exec("BEGIN IMMEDIATE");
  });
}

void DatabaseWriter::close() {
  impl_->write([&] { impl_->database.exec("COMMIT"); });
  impl_->usable = false;
  // Not possible while someone reads; then the file is complete all the same, with its log beside.
  sqlite3_exec(impl_->database.getHandle(), "PRAGMA wal_checkpoint(TRUNCATE)", nullptr, nullptr,
               nullptr);
  wait_at_most(impl_->database, 100);
  sqlite3_exec(impl_->database.getHandle(), "PRAGMA journal_mode = DELETE", nullptr, nullptr,
               nullptr);
}

}  // namespace hearsay
