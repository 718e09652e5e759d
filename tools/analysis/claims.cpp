#include "tools/analysis/claims.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "sim/kernel/error.hpp"
#include "tools/analysis/comparison.hpp"
#include "tools/analysis/estimate.hpp"
#include "tools/analysis/values.hpp"

namespace hearsay::analysis {
namespace {

/// The study's cells, in order, with their runs.
std::vector<CellRuns> cells_with_runs(const Study& study, const Values& values,
                                      std::size_t& runs_without_cell) {
  std::vector<CellRuns> result;
  std::map<Labels, std::size_t> places;  // by labels in order of the axes' names
  const auto sorted = [](Labels labels) {
    std::sort(labels.begin(), labels.end());
    return labels;
  };
  for (const Cell& cell : cells(study)) {
    CellRuns runs;
    for (const auto& [axis, label] : cell.labels) {
      runs.labels.emplace_back(axis, label_text(label));
    }
    places.emplace(sorted(runs.labels), result.size());
    result.push_back(std::move(runs));
  }
  for (std::size_t run = 0; run < values.runs().size(); ++run) {
    const StoredRun& stored = values.runs()[run];
    const auto place = places.find(sorted(stored.labels));
    if (place == places.end()) {
      ++runs_without_cell;
      continue;
    }
    CellRuns& cell = result[place->second];
    if (stored.ok) {
      cell.runs.emplace(stored.repetition, run);
    } else {
      ++cell.failed;
    }
  }
  for (CellRuns& cell : result) {
    if (!cell.runs.empty()) cell.agents = values.agents(cell.runs.begin()->second);
  }
  return result;
}

std::string joined(const std::vector<std::string>& notes) {
  std::string text;
  for (const std::string& note : notes) text += text.empty() ? note : "; " + note;
  return text;
}

/// Keeps the findings of a claim and picks the one to show.
class Tally {
 public:
  explicit Tally(ClaimResult& result) : result_(result) {}

  void add(const Finding& finding, const Comparison& comparison) {
    result_.failing += finding.side == Side::other;
    result_.open += finding.side == Side::open;
    result_.missing_values += finding.left_out;
    half_widths_.push_back(finding.half_width);
    const int n = static_cast<int>(comparison.a.size());
    result_.repetitions = first_ ? n : std::min(result_.repetitions, n);
    // One that decides the verdict is shown before one that does not.
    const int rank = finding.side == Side::other ? 2 : finding.side == Side::open ? 1 : 0;
    if (first_ || rank > rank_ || (rank == rank_ && finding.margin < margin_)) {
      rank_ = rank;
      margin_ = finding.margin;
      result_.worst = finding.interval;
      result_.worst_where = comparison.where;
      result_.bound_low = finding.bound_low;
      result_.bound_high = finding.bound_high;
    }
    first_ = false;
  }

  /// How sharp the intervals of an agreement are: one that is wider than its value says little.
  std::string sharpness() {
    std::sort(half_widths_.begin(), half_widths_.end());
    if (half_widths_.empty() || half_widths_.back() <= 0.0) return "";
    const auto vague =
        half_widths_.end() - std::upper_bound(half_widths_.begin(), half_widths_.end(), 1.0);
    return fmt::format(
        "intervals are ±{:.2g} % wide (median), ±{:.2g} % at most; beyond ±100 %: {}",
        100.0 * half_widths_[half_widths_.size() / 2], 100.0 * half_widths_.back(), vague);
  }

 private:
  ClaimResult& result_;
  bool first_ = true;
  int rank_ = 0;
  double margin_ = 0.0;
  std::vector<double> half_widths_;
};

ClaimResult judge_claim(const Study& study, const ClaimRules& rules, const Values& values,
                        const std::vector<CellRuns>& cells, std::size_t runs_without_cell) {
  ClaimResult result;
  result.claim = *rules.claim;
  result.quantity = quantity(rules);
  result.worst.estimate = std::numeric_limits<double>::quiet_NaN();
  result.worst.low = -std::numeric_limits<double>::infinity();
  result.worst.high = std::numeric_limits<double>::infinity();
  Comparisons comparisons = take_apart(rules, values, cells);
  result.comparisons = comparisons.list.size();
  result.missing_values = comparisons.missing_values;

  Tally tally(result);
  std::size_t too_few = 0;
  std::ptrdiff_t infinite = 0;
  for (const Comparison& comparison : comparisons.list) {
    const Finding finding = examine(rules, comparison, comparisons.list.size());
    tally.add(finding, comparison);
    too_few += comparison.a.size() < 2;
    infinite += std::count_if(comparison.a.begin(), comparison.a.end(),
                              [](double value) { return std::isinf(value); });
  }
  if (result.comparisons > 0 && result.failing == 0 && result.open == 0) {
    result.verdict = Verdict::reproduced;
  } else if (result.failing > 0) {
    result.verdict = Verdict::not_reproduced;
  }

  std::vector<std::string>& notes = comparisons.notes;
  if (result.comparisons == 0) notes.push_back("nothing to compare");
  if (infinite > 0) notes.push_back(fmt::format("infinite values, which count: {}", infinite));
  if (study.repetitions == 1) {
    notes.push_back("one run, no interval");
  } else if (too_few > 0) {
    notes.push_back(fmt::format("comparisons with fewer than two values: {}", too_few));
  }
  if (rules.claim->expect.kind == Expectation::Kind::agrees_with) {
    if (const std::string text = tally.sharpness(); !text.empty()) notes.push_back(text);
  }
  if (runs_without_cell > 0) {
    notes.push_back(
        fmt::format("runs of cells that the study does not have: {}", runs_without_cell));
  }
  result.note = joined(notes);
  return result;
}

}  // namespace

const char* to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::reproduced:
      return "reproduced";
    case Verdict::not_reproduced:
      return "not reproduced";
    case Verdict::undecided:
      return "undecided";
  }
  return "undecided";
}

std::vector<ClaimResult> judge(const std::string& database_file, const Study& study) {
  std::vector<ClaimRules> rules;
  std::set<std::string> metrics;
  for (const Claim& claim : study.claims) {
    rules.push_back(rules_of(study, claim));
    add_stored_names(rules.back().metric, metrics);
    add_stored_names(rules.back().other, metrics);
    if (rules.back().over) add_stored_names(*rules.back().over, metrics);
  }
  const Values values(database_file, study.name, metrics);
  std::size_t runs_without_cell = 0;
  const std::vector<CellRuns> cells = cells_with_runs(study, values, runs_without_cell);
  std::vector<ClaimResult> results;
  for (const ClaimRules& rule : rules) {
    results.push_back(judge_claim(study, rule, values, cells, runs_without_cell));
  }
  return results;
}

}  // namespace hearsay::analysis
