// The recorded values of one study, read once from a database and held in memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "sim/kernel/ids.hpp"
#include "tools/analysis/labels.hpp"

namespace SQLite {
class Database;
}

namespace hearsay::analysis {

/// A run that the database has. Runs are known by their place in Values::runs().
struct StoredRun {
  std::int64_t id = 0;
  int repetition = 0;
  bool ok = false;  ///< finished; only these have values
  Labels labels;    ///< in the order in which the axes were stored
};

/// Instants and subjects are known by number: their places in Values::instants_s() and subjects().
inline constexpr int no_instant = -1;

/// One metric in all runs: a value an agent, and in a series also a subject and an instant.
class Column {
 public:
  /// Nothing if there is no such row, NaN if its value is NULL. For a scalar, `subject` and
  /// `instant` are 0.
  std::optional<double> value(std::size_t run, AgentId agent, int subject, int instant) const;
  bool is_series() const { return is_series_; }
  /// Latest instant with a row in that run; no_instant if it has none.
  int last_instant(std::size_t run) const;
  /// All instants with a row in that run, ascending.
  std::vector<int> instants(std::size_t run) const;
  /// All subjects with a row in that run, ascending.
  std::vector<int> subjects(std::size_t run) const;

 private:
  friend class Values;
  struct Row {
    std::uint64_t key;  ///< instant, agent, subject, from the highest bits to the lowest
    std::uint32_t run;
    double value;
  };
  static std::uint64_t key(AgentId agent, int subject, int instant);
  static int instant_of(std::uint64_t key);
  /// Sorts by run and key and notes where each run begins.
  void index(std::size_t runs);

  bool is_series_ = false;
  std::vector<Row> rows_;
  std::vector<std::size_t> first_;  ///< row of each run, and one past the last
};

/// Names of the studies that have runs in `file`, sorted.
/// @throws InputError if it is not a database of ours.
std::vector<std::string> studies_in(const std::string& file);

class Values {
 public:
  /// Reads the runs of `study` and, of the runs that finished, the `metrics` that are there.
  /// @throws InputError: not a database of ours, no such study.
  Values(const std::string& file, const std::string& study, const std::set<std::string>& metrics);

  ~Values();

  const std::vector<StoredRun>& runs() const { return runs_; }
  const std::vector<double>& instants_s() const { return instants_s_; }
  const std::vector<std::string>& subjects() const { return subjects_; }
  /// Nothing (nullptr) if no finished run of the study has this metric.
  const Column* find(const std::string& metric) const;
  /// Agents of a run: number → name; the central estimator among them, if it is there.
  std::map<AgentId, std::string> agents(std::size_t run) const;
  /// All names that the database has values of, sorted.
  std::vector<std::string> known_metrics() const;

 private:
  /// What the rows of one quantity are of.
  struct Source {
    Column* column = nullptr;  ///< of no metric that is read: null
    AgentId agent = 0;
    int subject = 0;
  };

  void load_runs(const std::string& study);
  void load_rows(const std::set<std::string>& metrics);
  void load_table(const char* sql, bool series, const std::vector<Source>& sources,
                  const std::function<int(double)>& instant_of);
  /// Numbers instants in ascending order, here and in all columns.
  void number_instants(const std::vector<double>& as_they_came);

  std::string file_;
  std::unique_ptr<SQLite::Database> database_;
  std::vector<StoredRun> runs_;
  std::map<std::int64_t, std::size_t> place_of_run_;  ///< of finished runs, by id
  std::vector<double> instants_s_;
  std::vector<std::string> subjects_;
  std::map<std::string, Column> columns_;
};

}  // namespace hearsay::analysis
