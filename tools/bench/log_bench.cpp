// How fast runs get into a file: a series row each, 200 rows a run.
//
// floor/log: SQLite alone, one prepared INSERT a row into a plain table, one transaction.
// ours/log: the same values through Record and DatabaseWriter::add, one commit. Both make the file
// anew each time and end with the rows in it.

#include <SQLiteCpp/SQLiteCpp.h>
#include <benchmark/benchmark.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <string>

#include "sim/record/database.hpp"

namespace {

using namespace hearsay;

constexpr int runs = 1000;
constexpr int instants = 5;
constexpr int agents = 5;
constexpr int names = 8;
constexpr int rows = runs * instants * agents * names;

double value_of(int row) { return 1.0 / (row + 1); }

class File {
 public:
  File()
      : name_((std::filesystem::temp_directory_path() /
               ("hearsay-log-bench-" + std::to_string(getpid()) + ".db"))
                  .string()) {
    remove();
  }
  ~File() { remove(); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  const std::string& name() const { return name_; }

 private:
  void remove() const {
    for (const char* suffix : {"", "-wal", "-shm", "-journal"}) {
      std::filesystem::remove(name_ + suffix);
    }
  }
  std::string name_;
};

/// Calls take(run, second, agent, name, row) for each row.
template <typename Take>
void each_row_of_run(int run, Take take) {
  int row = (run - 1) * instants * agents * names;
  for (int instant = 1; instant <= instants; ++instant) {
    for (int agent = 0; agent < agents; ++agent) {
      for (int name = 0; name < names; ++name) take(20 * instant, agent, name, row++);
    }
  }
}

void floor_log(benchmark::State& state) {
  for (auto _ : state) {
    const File file;
    SQLite::Database database(file.name(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
    database.exec("PRAGMA journal_mode = WAL; PRAGMA synchronous = NORMAL");
    database.exec(
        "CREATE TABLE series(run INTEGER, t_s REAL, agent INTEGER, subject INTEGER, "
        "name INTEGER, value REAL)");
    SQLite::Statement insert(database, "INSERT INTO series VALUES(?, ?, ?, ?, ?, ?)");
    database.exec("BEGIN");
    for (int run = 1; run <= runs; ++run) {
      each_row_of_run(run, [&](int second, int agent, int name, int row) {
        insert.bind(1, run);
        insert.bind(2, static_cast<double>(second));
        insert.bind(3, agent);
        insert.bind(4, 1);
        insert.bind(5, name);
        insert.bind(6, value_of(row));
        insert.exec();
        insert.reset();
      });
    }
    database.exec("COMMIT");
  }
  state.counters["rows/s"] =
      benchmark::Counter(rows, benchmark::Counter::kIsIterationInvariantRate);
}

void ours_log(benchmark::State& state) {
  double bytes = 0;
  for (auto _ : state) {
    const File file;
    DatabaseWriter writer(file.name());
    for (int run = 1; run <= runs; ++run) {
      Record record({});
      const NameId subject = record.name("alarm");
      std::array<NameId, names> ids;
      for (int name = 0; name < names; ++name) {
        ids[static_cast<std::size_t>(name)] = record.name("metric " + std::to_string(name));
      }
      each_row_of_run(run, [&](int second, int agent, int name, int row) {
        record.series(Time::nanoseconds(second * std::int64_t{1'000'000'000}), agent, subject,
                      ids[static_cast<std::size_t>(name)], value_of(row));
      });
      RunRow row;
      row.id = run;
      writer.add(row, record);
    }
    writer.commit();
    state.PauseTiming();
    writer.close();
    bytes = static_cast<double>(std::filesystem::file_size(file.name()));
    state.ResumeTiming();
  }
  state.counters["rows/s"] =
      benchmark::Counter(rows, benchmark::Counter::kIsIterationInvariantRate);
  state.counters["bytes/row"] = bytes / rows;
}

BENCHMARK(floor_log)->Name("floor/log")->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(ours_log)->Name("ours/log")->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
