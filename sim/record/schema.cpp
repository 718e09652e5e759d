#include "sim/record/schema.hpp"

#include <charconv>
#include <filesystem>

#include "sim/kernel/error.hpp"
#include "sim/record/database.hpp"

namespace hearsay {
namespace record {

// The unary plus keeps SQLite from building an index over all rows for a term like t_s = 120, and
// CROSS JOIN keeps it from reading all rows before it knows the run.
const char* const schema_sql = R"sql(
CREATE TABLE study(id INTEGER PRIMARY KEY, name TEXT NOT NULL UNIQUE, file TEXT NOT NULL,
                   config TEXT NOT NULL);
CREATE TABLE name(id INTEGER PRIMARY KEY, text TEXT NOT NULL UNIQUE);
CREATE TABLE quantity(id INTEGER PRIMARY KEY, agent INTEGER NOT NULL, subject TEXT,
                      name TEXT NOT NULL);
CREATE TABLE agent_set(id INTEGER NOT NULL, place INTEGER NOT NULL, agent INTEGER NOT NULL,
                       name TEXT NOT NULL, kind TEXT NOT NULL,
                       PRIMARY KEY(id, place)) WITHOUT ROWID;
CREATE TABLE axis_set(id INTEGER NOT NULL, place INTEGER NOT NULL, name TEXT NOT NULL,
                      value TEXT NOT NULL, PRIMARY KEY(id, place)) WITHOUT ROWID;
CREATE TABLE run_row(id INTEGER PRIMARY KEY, study INTEGER REFERENCES study,
                     scenario INTEGER NOT NULL REFERENCES name,
                     parameters INTEGER NOT NULL REFERENCES name, axes INTEGER, agents INTEGER,
                     repetition INTEGER NOT NULL, seed INTEGER NOT NULL, ok INTEGER NOT NULL,
                     reason INTEGER NOT NULL REFERENCES name, digest TEXT NOT NULL,
                     config_hash TEXT NOT NULL, wall_s REAL, events INTEGER NOT NULL,
                     version INTEGER NOT NULL REFERENCES name);
CREATE TABLE removed_run(id INTEGER PRIMARY KEY);
CREATE TABLE scalar_row(id INTEGER PRIMARY KEY, quantity INTEGER NOT NULL REFERENCES quantity,
                        value REAL);
CREATE TABLE series_row(id INTEGER PRIMARY KEY, t_s REAL NOT NULL,
                        quantity INTEGER NOT NULL REFERENCES quantity, value REAL);
CREATE TABLE message_row(id INTEGER PRIMARY KEY, sent_s REAL NOT NULL, arrived_s REAL NOT NULL,
                         sender INTEGER, receiver INTEGER, kind INTEGER NOT NULL REFERENCES name,
                         bytes INTEGER NOT NULL, fate INTEGER NOT NULL REFERENCES name);
CREATE TABLE link_row(id INTEGER PRIMARY KEY, sender INTEGER NOT NULL, receiver INTEGER NOT NULL,
                      fate INTEGER NOT NULL REFERENCES name, packets INTEGER NOT NULL);
CREATE TABLE event_row(id INTEGER PRIMARY KEY, t_s REAL NOT NULL, agent INTEGER,
                       kind INTEGER NOT NULL REFERENCES name, detail TEXT NOT NULL);

CREATE VIEW run(id, study, scenario, parameters, repetition, seed, status, reason, digest,
                config_hash, wall_s, events, version) AS
  SELECT r.id, study.name, scenario.text, parameters.text, r.repetition, r.seed,
         CASE r.ok WHEN 1 THEN 'ok' ELSE 'failed' END, reason.text, r.digest, r.config_hash,
         r.wall_s, r.events, version.text
  FROM run_row r LEFT JOIN study ON study.id = r.study
  LEFT JOIN name scenario ON scenario.id = r.scenario
  LEFT JOIN name parameters ON parameters.id = r.parameters
  LEFT JOIN name reason ON reason.id = r.reason LEFT JOIN name version ON version.id = r.version;
CREATE VIEW axis(run, name, value) AS
  SELECT r.id, a.name, a.value FROM run_row r JOIN axis_set a ON a.id = r.axes;
CREATE VIEW agent(run, id, name, kind) AS
  SELECT r.id, a.agent, a.name, a.kind FROM run_row r JOIN agent_set a ON a.id = r.agents;
CREATE VIEW scalar(run, agent, name, value) AS
  SELECT r.id, q.agent, q.name, +s.value
  FROM run_row r CROSS JOIN scalar_row s ON s.id >= r.id << 32 AND s.id < (r.id + 1) << 32
  CROSS JOIN quantity q ON q.id = +s.quantity;
CREATE VIEW series(run, t_s, agent, subject, name, value) AS
  SELECT r.id, +s.t_s, q.agent, q.subject, q.name, +s.value
  FROM run_row r CROSS JOIN series_row s ON s.id >= r.id << 32 AND s.id < (r.id + 1) << 32
  CROSS JOIN quantity q ON q.id = +s.quantity;
CREATE VIEW message(run, sent_s, arrived_s, sender, receiver, kind, bytes, fate) AS
  SELECT r.id, +m.sent_s, +m.arrived_s, +m.sender, +m.receiver, kind.text, +m.bytes, fate.text
  FROM run_row r CROSS JOIN message_row m ON m.id >= r.id << 32 AND m.id < (r.id + 1) << 32
  CROSS JOIN name kind ON kind.id = +m.kind CROSS JOIN name fate ON fate.id = +m.fate;
CREATE VIEW link(run, sender, receiver, fate, packets) AS
  SELECT r.id, +l.sender, +l.receiver, fate.text, +l.packets
  FROM run_row r CROSS JOIN link_row l ON l.id >= r.id << 32 AND l.id < (r.id + 1) << 32
  CROSS JOIN name fate ON fate.id = +l.fate;
CREATE VIEW event(run, t_s, agent, kind, detail) AS
  SELECT r.id, +e.t_s, +e.agent, kind.text, +e.detail
  FROM run_row r CROSS JOIN event_row e ON e.id >= r.id << 32 AND e.id < (r.id + 1) << 32
  CROSS JOIN name kind ON kind.id = +e.kind;
)sql";

void fail(const std::string& file, const char* doing, const SQLite::Exception& error) {
  std::string found = std::string("cannot be ") + doing + ": " + error.what();
  switch (error.getErrorCode() & 0xff) {
    case SQLITE_NOTADB:
      found = "is not a hearsay database (not an SQLite file)";
      break;
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      found = "is being written by another process";
      break;
    case SQLITE_CANTOPEN: {
      const std::filesystem::path path(plain_path(file));
      std::error_code ignored;
      if (std::filesystem::is_directory(path, ignored)) {
        found = std::string("cannot be ") + doing + ": it is a directory";
      } else if (!std::filesystem::is_directory(path.parent_path(), ignored)) {
        found = std::string("cannot be ") + doing + ": there is no directory " +
                path.parent_path().string();
      }
      break;
    }
    default:
      break;
  }
  throw InputError(file, 0, found);
}

std::string plain_path(const std::string& file) { return std::filesystem::absolute(file).string(); }

bool is_new(SQLite::Database& database, const std::string& file) {
  // SQLite takes a file of one byte for empty and would overwrite it.
  std::error_code ignored;
  if (std::filesystem::file_size(plain_path(file), ignored) == 1) {
    throw InputError(file, 0, "is not a hearsay database (not an SQLite file)");
  }
  const auto number = [&](const char* pragma) { return database.execAndGet(pragma).getInt(); };
  // A file that is just being made has a page already, but nothing in it.
  const bool bare = number("PRAGMA application_id") == 0 && number("PRAGMA user_version") == 0 &&
                    number("SELECT count(*) FROM sqlite_schema") == 0;
  if (bare) return true;
  if (number("PRAGMA application_id") != application_id) {
    throw InputError(file, 0, "is not a hearsay database (an SQLite file of another program)");
  }
  const int version = number("PRAGMA user_version");
  if (version != schema_version) {
    throw InputError(file, 0,
                     "has schema version " + std::to_string(version) + "; this program reads " +
                         std::to_string(schema_version));
  }
  return false;
}

SQLite::Database open_to_read(const std::string& file) {
  std::error_code ignored;
  const std::string path = plain_path(file);
  if (!std::filesystem::exists(path, ignored)) throw InputError(file, 0, "does not exist");
  try {
    SQLite::Database database(path, SQLite::OPEN_READONLY | SQLite::OPEN_NOMUTEX, 10'000);
    if (is_new(database, file)) {
      throw InputError(file, 0, "is not a hearsay database (it is empty)");
    }
    return database;
  } catch (const SQLite::Exception& error) {
    fail(file, "read", error);
  }
}

std::string shortest(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

Query::Query(SQLite::Database& database, const std::string& sql) : database_(database.getHandle()) {
  const int code = sqlite3_prepare_v3(database_, sql.c_str(), static_cast<int>(sql.size()),
                                      SQLITE_PREPARE_PERSISTENT, &statement_, nullptr);
  if (code != SQLITE_OK) throw SQLite::Exception(database_, code);
}

bool Query::step() {
  const int code = sqlite3_step(statement_);
  if (code == SQLITE_ROW) return true;
  const int end = sqlite3_reset(statement_);
  if (code != SQLITE_DONE) throw SQLite::Exception(database_, end);
  return false;
}

std::string_view Query::text(int column) const {
  // The text first: asking for it may convert, and the length is that of the last form.
  const unsigned char* text = sqlite3_column_text(statement_, column);
  return {reinterpret_cast<const char*>(text),
          static_cast<std::size_t>(sqlite3_column_bytes(statement_, column))};
}

}  // namespace record

void check_database(const std::string& file) { record::open_to_read(file); }

}  // namespace hearsay
