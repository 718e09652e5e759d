// What a metric's name means to the analysis, and its value within one run.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "sim/kernel/ids.hpp"
#include "tools/analysis/values.hpp"

namespace hearsay::analysis {

struct MetricRule {
  std::string name;
  std::string stored;          ///< what the database calls what it is made from
  std::string over = "";       ///< … and what its aggregate is divided by, if it is a quotient
  bool per_dimension = false;  ///< divided by the scalar state_dimension
  bool rms = false;            ///< averaged as a root mean square
  bool median = false;         ///< a time that may never come: infinite values count
  bool consistency = false;    ///< a measure of consistency
  bool each_subject = false;   ///< subjects are never averaged: each counts, or is a threshold
};
/// "anees" is nees a dimension; with `chi2_band` so are nees and ledger_nees.
MetricRule metric_rule(const std::string& name, bool chi2_band = false);

/// The names that reading the metric takes from the database.
void add_stored_names(const MetricRule& rule, std::set<std::string>& names);

/// One agent, or all of them brought together within a run.
struct Who {
  enum class Kind { one, mean, largest };
  Kind kind = Kind::one;
  AgentId agent = 0;
};

inline constexpr int all_subjects = -1;

/// Which of a metric's values in a run.
struct Place {
  Who who;
  int subject = all_subjects;  ///< averaged, as the metric is
  int instant = no_instant;    ///< no_instant: the last of the run; ignored for scalars
};

/// Finished and failed runs of one cell.
struct CellRuns {
  Labels labels;
  std::map<int, std::size_t> runs;  ///< finished: repetition → place in Values::runs()
  std::size_t failed = 0;
  std::map<AgentId, std::string> agents;  ///< of its first finished run
  /// Agents from 0 up, ascending.
  std::vector<AgentId> numbered_agents() const;
};

/// Reads one metric. Refers to the values it was made with.
class Reader {
 public:
  /// `keeps_infinite`: infinite values count as values; else as missing.
  Reader(const Values& values, const MetricRule& rule, bool keeps_infinite = false);

  const MetricRule& rule() const { return rule_; }
  /// Null if the database has no values of the metric.
  const Column* column() const { return column_; }
  /// The metric's value in a run of `cell`, NaN if it has none. `missing` grows by the values met
  /// that are NULL or infinite (unless these count), and by one if there is no row at all.
  double value(const CellRuns& cell, std::size_t run, const Place& place,
               std::size_t& missing) const;
  /// Dimension of the state of a run's beliefs; 0 if it was not recorded.
  int state_dimension(std::size_t run) const;
  /// "rule=naive agent=2 landmark3 t=120 s".
  std::string describe(const CellRuns& cell, const Place& place) const;

 private:
  /// Nothing if the run has no row of the agent.
  std::optional<double> value_of_agent(std::size_t run, AgentId agent, const Place& place,
                                       std::size_t& missing) const;

  const Values* values_;
  MetricRule rule_;
  bool keeps_infinite_;
  const Column* column_;
  const Column* dimension_;
};

}  // namespace hearsay::analysis
