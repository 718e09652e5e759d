#include "tools/analysis/values.hpp"

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "scenarios/names.hpp"
#include "sim/kernel/error.hpp"
#include "sim/record/database.hpp"

namespace hearsay::analysis {
namespace {

constexpr int agent_shift = 16;
constexpr int instant_shift = 36;

std::unique_ptr<SQLite::Database> open(const std::string& file) {
  check_database(file);
  return std::make_unique<SQLite::Database>(file, SQLite::OPEN_READONLY | SQLite::OPEN_NOMUTEX);
}

/// Does `work` and turns the library's exceptions into ours, with the file's name.
template <typename Work>
auto reading(const std::string& file, const Work& work) {
  try {
    return work();
  } catch (const SQLite::Exception& error) {
    throw InputError(file, 0, fmt::format("cannot be read: {}", error.what()));
  }
}

double number_or_nan(const SQLite::Column& column) {
  return column.isNull() ? std::numeric_limits<double>::quiet_NaN() : column.getDouble();
}

/// Numbers things in the order in which they first come.
template <typename Key>
class Numbering {
 public:
  int operator()(const Key& key) {
    if (last_ >= 0 && keys_[static_cast<std::size_t>(last_)] == key) return last_;
    const auto [at, is_new] = numbers_.try_emplace(key, static_cast<int>(keys_.size()));
    if (is_new) keys_.push_back(key);
    return last_ = at->second;
  }
  const std::vector<Key>& keys() const { return keys_; }

 private:
  std::map<Key, int> numbers_;
  std::vector<Key> keys_;
  int last_ = -1;
};

}  // namespace

std::uint64_t Column::key(AgentId agent, int subject, int instant) {
  return (static_cast<std::uint64_t>(instant) << instant_shift) |
         (static_cast<std::uint64_t>(agent - no_agent) << agent_shift) |
         static_cast<std::uint64_t>(subject);
}

int Column::instant_of(std::uint64_t key) { return static_cast<int>(key >> instant_shift); }

std::optional<double> Column::value(std::size_t run, AgentId agent, int subject,
                                    int instant) const {
  const auto begin = rows_.begin() + static_cast<std::ptrdiff_t>(first_[run]);
  const auto end = rows_.begin() + static_cast<std::ptrdiff_t>(first_[run + 1]);
  const std::uint64_t wanted = key(agent, subject, instant);
  const auto at = std::lower_bound(begin, end, wanted,
                                   [](const Row& row, std::uint64_t k) { return row.key < k; });
  if (at == end || at->key != wanted) return std::nullopt;
  return at->value;
}

int Column::last_instant(std::size_t run) const {
  if (first_[run] == first_[run + 1]) return no_instant;
  return instant_of(rows_[first_[run + 1] - 1].key);
}

std::vector<int> Column::instants(std::size_t run) const {
  std::vector<int> found;
  for (std::size_t i = first_[run]; i < first_[run + 1]; ++i) {
    const int instant = instant_of(rows_[i].key);
    if (found.empty() || found.back() != instant) found.push_back(instant);
  }
  return found;
}

std::vector<int> Column::subjects(std::size_t run) const {
  std::set<int> found;
  for (std::size_t i = first_[run]; i < first_[run + 1]; ++i) {
    found.insert(static_cast<int>(rows_[i].key & ((std::uint64_t{1} << agent_shift) - 1)));
  }
  return {found.begin(), found.end()};
}

void Column::index(std::size_t runs) {
  const auto before = [](const Row& a, const Row& b) {
    return a.run != b.run ? a.run < b.run : a.key < b.key;
  };
  if (!std::is_sorted(rows_.begin(), rows_.end(), before)) {
    std::sort(rows_.begin(), rows_.end(), before);
  }
  first_.assign(runs + 1, 0);
  for (const Row& row : rows_) ++first_[row.run + 1];
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
}

std::vector<std::string> studies_in(const std::string& file) {
  return reading(file, [&] {
    const std::unique_ptr<SQLite::Database> database = open(file);
    std::vector<std::string> names;
    SQLite::Statement query(*database,
                            "SELECT DISTINCT study FROM run WHERE study IS NOT NULL AND study <> ''"
                            " ORDER BY study");
    while (query.executeStep()) names.push_back(query.getColumn(0).getString());
    return names;
  });
}

Values::Values(const std::string& file, const std::string& study,
               const std::set<std::string>& metrics)
    : file_(file), database_(reading(file, [&] { return open(file); })) {
  load_runs(study);
  load_rows(metrics);
  for (auto& [name, column] : columns_) column.index(runs_.size());
}

Values::~Values() = default;

void Values::load_runs(const std::string& study) {
  reading(file_, [&] {
    SQLite::Statement query(*database_,
                            "SELECT id, repetition, status FROM run WHERE study = ? ORDER BY id");
    query.bind(1, study);
    std::map<std::int64_t, std::size_t> places_of_all;
    while (query.executeStep()) {
      StoredRun run;
      run.id = query.getColumn(0).getInt64();
      run.repetition = query.getColumn(1).getInt();
      run.ok = query.getColumn(2).getString() == "ok";
      places_of_all.emplace(run.id, runs_.size());
      if (run.ok) place_of_run_.emplace(run.id, runs_.size());
      runs_.push_back(std::move(run));
    }
    SQLite::Statement axes(*database_, "SELECT run, name, value FROM axis");
    while (axes.executeStep()) {
      const auto place = places_of_all.find(axes.getColumn(0).getInt64());
      if (place == places_of_all.end()) continue;
      runs_[place->second].labels.emplace_back(axes.getColumn(1).getString(),
                                               stored_label_text(axes.getColumn(2).getString()));
    }
  });
  if (!runs_.empty()) return;
  const std::vector<std::string> studies = studies_in(file_);
  throw InputError(file_, 0,
                   fmt::format("no run of study '{}'{}", study, allowed_names(study, studies)));
}

void Values::load_rows(const std::set<std::string>& metrics) {
  Numbering<double> instants;
  reading(file_, [&] {
    // The tables beneath the views: joining names to millions of rows takes most of the time.
    std::vector<Source> sources;  // by quantity
    Numbering<std::string> subjects;
    SQLite::Statement quantities(*database_, "SELECT id, agent, subject, name FROM quantity");
    while (quantities.executeStep()) {
      const std::string name = quantities.getColumn(3).getString();
      if (!metrics.contains(name)) continue;
      const auto id = static_cast<std::size_t>(quantities.getColumn(0).getInt64());
      if (sources.size() <= id) sources.resize(id + 1);
      const bool is_series = !quantities.getColumn(2).isNull();
      Column& column = columns_[name];
      column.is_series_ = column.is_series_ || is_series;
      const int subject = is_series ? subjects(quantities.getColumn(2).getString()) : 0;
      sources[id] = {&column, quantities.getColumn(1).getInt(), subject};
    }
    subjects_ = subjects.keys();
    load_table("SELECT quantity, id >> 32, value, 0.0 FROM scalar_row", false, sources,
               [](double) { return 0; });
    load_table("SELECT quantity, id >> 32, value, t_s FROM series_row", true, sources,
               std::ref(instants));
  });
  // Known as a name, but not in any finished run.
  std::erase_if(columns_, [](const auto& entry) { return entry.second.rows_.empty(); });
  number_instants(instants.keys());
}

void Values::load_table(const char* sql, bool series, const std::vector<Source>& sources,
                        const std::function<int(double)>& instant_of) {
  SQLite::Statement query(*database_, sql);
  std::int64_t run_id = -1;
  auto run = place_of_run_.end();
  while (query.executeStep()) {
    const auto quantity = static_cast<std::size_t>(query.getColumn(0).getInt64());
    if (quantity >= sources.size()) continue;
    const Source& source = sources[quantity];
    // A name that is both a scalar and a series is read as a series.
    if (source.column == nullptr || source.column->is_series_ != series) continue;
    const std::int64_t id = query.getColumn(1).getInt64();
    if (std::exchange(run_id, id) != id) run = place_of_run_.find(id);
    if (run == place_of_run_.end()) continue;
    const int instant = instant_of(query.getColumn(3).getDouble());
    source.column->rows_.push_back({Column::key(source.agent, source.subject, instant),
                                    static_cast<std::uint32_t>(run->second),
                                    number_or_nan(query.getColumn(2))});
  }
}

void Values::number_instants(const std::vector<double>& as_they_came) {
  instants_s_ = as_they_came;
  std::sort(instants_s_.begin(), instants_s_.end());
  if (instants_s_ == as_they_came) return;
  std::vector<int> sorted(as_they_came.size());
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    const auto at = std::lower_bound(instants_s_.begin(), instants_s_.end(), as_they_came[i]);
    sorted[i] = static_cast<int>(at - instants_s_.begin());
  }
  for (auto& [name, column] : columns_) {
    if (!column.is_series_) continue;
    for (Column::Row& row : column.rows_) {
      const auto old = static_cast<std::size_t>(Column::instant_of(row.key));
      const std::uint64_t rest = row.key & ((std::uint64_t{1} << instant_shift) - 1);
      row.key = (static_cast<std::uint64_t>(sorted[old]) << instant_shift) | rest;
    }
  }
}

const Column* Values::find(const std::string& metric) const {
  const auto at = columns_.find(metric);
  return at == columns_.end() ? nullptr : &at->second;
}

std::map<AgentId, std::string> Values::agents(std::size_t run) const {
  return reading(file_, [&] {
    std::map<AgentId, std::string> agents;
    SQLite::Statement query(*database_, "SELECT id, name FROM agent WHERE run = ?");
    query.bind(1, runs_.at(run).id);
    while (query.executeStep()) {
      agents.emplace(query.getColumn(0).getInt(), query.getColumn(1).getString());
    }
    return agents;
  });
}

std::vector<std::string> Values::known_metrics() const {
  return reading(file_, [&] {
    std::set<std::string> names;
    for (const char* table : {"scalar", "series"}) {
      SQLite::Statement query(*database_, fmt::format("SELECT DISTINCT name FROM {}", table));
      while (query.executeStep()) names.insert(query.getColumn(0).getString());
    }
    return std::vector<std::string>(names.begin(), names.end());
  });
}

}  // namespace hearsay::analysis
