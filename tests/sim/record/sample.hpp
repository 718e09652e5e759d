// Runs to store, and ways to look at what was stored.
#pragma once

#include <SQLiteCpp/SQLiteCpp.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include "sim/record/database.hpp"
#include "sim/record/digest.hpp"

namespace hearsay::sample {

/// A directory of its own that is gone afterwards.
class Directory {
 public:
  Directory() {
    std::string name = (std::filesystem::temp_directory_path() / "hearsay-record-XXXXXX").string();
    path_ = mkdtemp(name.data());
  }
  ~Directory() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Directory(const Directory&) = delete;
  Directory& operator=(const Directory&) = delete;
  std::string operator/(const std::string& name) const { return (path_ / name).string(); }
  std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(path_)) {
      names.push_back(entry.path().filename().string());
    }
    return names;
  }

 private:
  std::filesystem::path path_;
};

/// A record of three agents at two instants that depends on `id`.
inline void fill(Record& record, std::int64_t id) {
  const NameId alarm = record.name("alarm");
  const NameId nees = record.name("nees");
  const NameId mood = record.name("mood " + std::to_string(id % 5));
  for (AgentId agent = -1; agent < 2; ++agent) {
    record.agent(agent, "agent " + std::to_string(agent), agent < 0 ? "central" : "estimator");
  }
  for (const int second : {20, 40}) {
    const Time time = Time::at(Duration::nanoseconds(second * 1'000'000'000LL));
    for (AgentId agent = -1; agent < 2; ++agent) {
      record.series(time, agent, alarm, nees, static_cast<double>(id) + agent / 7.0);
      record.series(time, agent, alarm, mood, second / 3.0);
    }
    record.message({time, time + 10_ms, 0, 1, record.name("belief"), 48,
                    record.name(id % 2 == 0 ? "delivered" : "lost")});
    record.event(time, id % 2 == 0 ? AgentId{1} : no_agent, "overflow", "at " + std::to_string(id));
  }
  record.link({0, 1, record.name("delivered"), static_cast<std::uint64_t>(id)});
  record.link({1, 0, record.name("lost"), 2});
  record.scalar(0, record.name("fusions"), static_cast<double>(id));
  record.scalar(central_agent, record.name("state_dimension"), 2.0);
}

inline RunRow row(std::int64_t id) {
  RunRow run;
  run.id = id;
  run.study = "rumour";
  run.scenario = "ring.toml";
  run.parameters_json = R"({"agents.estimator.fusion":"ci-det"})";
  run.axes = {{"rule", id % 3 == 0 ? "\"naive\"" : "\"ci-det\""}, {"loss", "0.1"}};
  run.repetition = static_cast<int>(id);
  run.seed = 100 + static_cast<std::uint64_t>(id);
  run.ok = id % 4 != 0;
  run.reason = run.ok ? "time reached" : "agent 1 failed at 3 s";
  run.config_hash = text_digest("config " + std::to_string(id));
  run.wall_s = 0.25;
  run.events = 1000 + static_cast<std::uint64_t>(id);
  run.version = "0.1.0";
  return run;
}

/// Adds run `id`, with its digest.
inline void add(DatabaseWriter& writer, std::int64_t id, double wall_s = 0.25) {
  Xxh3Digest digest;
  Record::Options options;
  options.keep_messages = true;
  options.digest = &digest;
  Record record(options);
  fill(record, id);
  record.finish();
  RunRow run = row(id);
  run.digest = digest_text(digest, nullptr);
  run.wall_s = wall_s;
  writer.add(run, record);
}

inline const StudyRow study = {"rumour", "/somewhere/study.toml", "repetitions = 3\nseed = 1\n"};

/// A closed database of runs 1 … `runs`.
inline std::string make(const Directory& directory, const std::string& name, int runs) {
  const std::string file = directory / name;
  DatabaseWriter writer(file);
  writer.add_study(study);
  for (int id = 1; id <= runs; ++id) add(writer, id);
  writer.close();
  return file;
}

/// Result of a query: a line a row, cells separated by '|'.
inline std::string query(const std::string& file, const std::string& sql) {
  SQLite::Database database(file);
  SQLite::Statement statement(database, sql);
  std::string text;
  while (statement.executeStep()) {
    for (int column = 0; column < statement.getColumnCount(); ++column) {
      if (column > 0) text += '|';
      const auto cell = statement.getColumn(column);
      text += cell.isNull() ? "NULL" : cell.getString();
    }
    text += '\n';
  }
  return text;
}

inline void change(const std::string& file, const std::string& sql) {
  SQLite::Database database(file, SQLite::OPEN_READWRITE);
  database.exec(sql);
}

/// All that a file holds but wall times: schema and every table with its row ids.
inline std::string everything(const std::string& file) {
  std::string text = query(file, "SELECT type, name, sql FROM sqlite_schema ORDER BY rowid");
  std::istringstream tables(
      query(file, "SELECT name FROM sqlite_schema WHERE type = 'table' ORDER BY name"));
  for (std::string table; std::getline(tables, table);) {
    SQLite::Database database(file);
    std::string columns;
    SQLite::Statement info(database, "SELECT name FROM pragma_table_info('" + table + "')");
    while (info.executeStep()) {
      const std::string column = info.getColumn(0).getString();
      if (column != "wall_s") columns += (columns.empty() ? "quote(" : ", quote(") + column + ")";
    }
    text += "-- " + table + "\n" + query(file, "SELECT " + columns + " FROM " + table);
  }
  return text;
}

}  // namespace hearsay::sample
