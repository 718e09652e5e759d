#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "scenarios/names.hpp"
#include "sim/kernel/error.hpp"
#include "tools/analysis/claims.hpp"
#include "tools/analysis/quantity.hpp"
#include "tools/analysis/values.hpp"

namespace hearsay::analysis {
namespace {

constexpr double alpha = 0.05;
constexpr double equal_to_rounding = 1e-12;
constexpr double same_instant_s = 1e-6;

std::string only_study(const std::string& file, const CompareOptions& options) {
  if (options.study) return *options.study;
  const std::vector<std::string> studies = studies_in(file);
  if (studies.empty()) throw InputError(file, 0, "holds no study to compare");
  if (studies.size() > 1) {
    throw InputError(
        file, 0, fmt::format("holds several studies ({}): choose one with --study", join(studies)));
  }
  return studies.front();
}

/// One row before its interval: paired values of a label and of the baseline.
struct Pairs {
  CompareRow row;
  bool baseline = false;
  std::vector<double> a;  ///< all values of the label
  std::vector<double> paired_a;
  std::vector<double> paired_b;
};

class Comparer {
 public:
  Comparer(const std::string& file, const CompareOptions& options)
      : file_(file),
        options_(options),
        rule_(metric_rule(options.metric)),
        values_(file, only_study(file, options), stored_names(rule_)) {}

  std::vector<CompareRow> rows() {
    if (!rule_.over.empty()) {
      throw InputError(fmt::format("{} is a quotient of means, for claims; compare {} and {}",
                                   rule_.name, rule_.stored, rule_.over));
    }
    reader_.emplace(values_, rule_, rule_.median);
    column_ = reader_->column();
    if (column_ == nullptr) {
      std::vector<std::string> known = values_.known_metrics();
      if (std::find(known.begin(), known.end(), "nees") != known.end()) known.push_back("anees");
      throw InputError(
          file_, 0,
          fmt::format("no metric '{}'{}", options_.metric, allowed_names(options_.metric, known)));
    }
    find_axis();
    find_instant();
    group_runs();
    for (const auto& group : groups_) add_group(group);
    return finished();
  }

 private:
  /// Cells that differ only in the compared axis; by place of their labels on it.
  struct Group {
    Labels labels;
    std::map<std::size_t, CellRuns> cells;
  };

  static std::set<std::string> stored_names(const MetricRule& rule) {
    std::set<std::string> names;
    add_stored_names(rule, names);
    return names;
  }

  void find_axis() {
    std::vector<std::string> axes;
    for (const StoredRun& run : values_.runs()) {
      for (const auto& [axis, label] : run.labels) {
        if (std::find(axes.begin(), axes.end(), axis) == axes.end()) axes.push_back(axis);
        const bool is_new = std::find(labels_.begin(), labels_.end(), label) == labels_.end();
        if (axis == options_.by && is_new) labels_.push_back(label);
      }
    }
    if (labels_.empty()) {
      throw InputError(
          file_, 0, fmt::format("no axis '{}'{}", options_.by, allowed_names(options_.by, axes)));
    }
    const std::string wanted =
        options_.baseline ? stored_label_text(*options_.baseline) : labels_.front();
    const auto at = std::find(labels_.begin(), labels_.end(), wanted);
    if (at == labels_.end()) {
      throw InputError(file_, 0,
                       fmt::format("no label '{}' on axis '{}'{}", wanted, options_.by,
                                   allowed_names(wanted, labels_)));
    }
    baseline_ = static_cast<std::size_t>(at - labels_.begin());
  }

  void find_instant() {
    if (options_.at == "end" || !column_->is_series()) return;
    double t_s = 0.0;
    const char* end = options_.at.data() + options_.at.size();
    const auto [stop, error] = std::from_chars(options_.at.data(), end, t_s);
    if (error != std::errc() || stop != end) {
      throw InputError(fmt::format("at '{}' is neither \"end\" nor seconds", options_.at));
    }
    for (std::size_t i = 0; i < values_.instants_s().size(); ++i) {
      if (std::abs(values_.instants_s()[i] - t_s) <= same_instant_s) instant_ = static_cast<int>(i);
    }
    if (instant_ == no_instant) {
      throw InputError(file_, 0, fmt::format("no sample at {:.9g} s", t_s));
    }
  }

  void group_runs() {
    for (std::size_t run = 0; run < values_.runs().size(); ++run) {
      const StoredRun& stored = values_.runs()[run];
      Labels others = stored.labels;
      std::optional<std::string> label;
      std::erase_if(others, [&](const auto& axis_label) {
        if (axis_label.first != options_.by) return false;
        label = axis_label.second;
        return true;
      });
      if (!label) continue;
      const auto same = [&](const Group& group) { return group.labels == others; };
      auto group = std::find_if(groups_.begin(), groups_.end(), same);
      if (group == groups_.end()) group = groups_.insert(groups_.end(), {others, {}});
      const auto place = std::find(labels_.begin(), labels_.end(), *label) - labels_.begin();
      CellRuns& cell = group->cells[static_cast<std::size_t>(place)];
      cell.labels = stored.labels;
      if (!stored.ok) {
        ++cell.failed;
        continue;
      }
      if (cell.runs.empty()) cell.agents = values_.agents(run);
      cell.runs.emplace(stored.repetition, run);
    }
  }

  std::vector<std::pair<std::string, Who>> agents(const CellRuns& cell) const {
    const std::string& selector = options_.agents;
    if (selector == "mean") return {{"", {Who::Kind::mean}}};
    if (selector == "max") return {{"largest over agents", {Who::Kind::largest}}};
    if (selector == "central") return {{"agent=central", {Who::Kind::one, central_agent}}};
    std::vector<std::pair<std::string, Who>> found;
    std::vector<std::string> names = {"each", "mean", "max", "central"};
    for (const auto& [agent, name] : cell.agents) {
      names.push_back(name);
      const bool wanted =
          selector == "each" ? agent >= 0 : name == selector || std::to_string(agent) == selector;
      if (wanted) found.push_back({fmt::format("agent={}", agent), {Who::Kind::one, agent}});
    }
    if (found.empty()) {
      throw InputError(file_, 0,
                       fmt::format("no agent '{}'{}", selector, allowed_names(selector, names)));
    }
    return found;
  }

  void add_group(const Group& group) {
    const auto baseline = group.cells.find(baseline_);
    const CellRuns* reference = baseline == group.cells.end() ? nullptr : &baseline->second;
    const CellRuns* some = reference;
    for (const auto& [place, cell] : group.cells) {
      if (some == nullptr || some->runs.empty()) some = &cell;
    }
    if (some->runs.empty()) return;
    const bool each_subject = rule_.each_subject && column_->is_series();
    const std::vector<int> subjects =
        each_subject ? column_->subjects(some->runs.begin()->second) : std::vector{all_subjects};
    for (const auto& [name, who] : agents(*some)) {
      for (const int subject : subjects) {
        std::string text = to_string(group.labels);
        if (!name.empty()) text += (text.empty() ? "" : " ") + name;
        if (subjects.size() > 1) {
          text += (text.empty() ? "" : " ") + values_.subjects()[static_cast<std::size_t>(subject)];
        }
        for (const auto& [place, cell] : group.cells) {
          add_row(text, place, cell, reference, {who, subject, instant_});
        }
      }
    }
  }

  void add_row(const std::string& text, std::size_t label, const CellRuns& cell,
               const CellRuns* reference, const Place& place) {
    Pairs pairs;
    pairs.row.cell = text;
    pairs.row.label = labels_[label];
    pairs.baseline = label == baseline_;
    std::size_t missing = 0;
    for (const auto& [repetition, run] : cell.runs) {
      const double a = reader_->value(cell, run, place, missing);
      if (!counts(a)) continue;
      pairs.a.push_back(a);
      if (reference == nullptr) continue;
      const auto other = reference->runs.find(repetition);
      if (other == reference->runs.end()) continue;
      const double b = reader_->value(*reference, other->second, place, missing);
      if (!counts(b)) continue;
      pairs.paired_a.push_back(a);
      pairs.paired_b.push_back(b);
    }
    pairs.row.pairs = static_cast<int>(pairs.paired_a.size());
    pairs_.push_back(std::move(pairs));
  }

  bool counts(double value) const {
    return rule_.median ? !std::isnan(value) : std::isfinite(value);
  }

  Interval value_of(const std::vector<double>& values) const {
    if (values.empty()) return {NAN, -INFINITY, INFINITY};
    if (rule_.rms) return rms_interval(values, alpha);
    if (rule_.median) return median(values, alpha);
    const bool signed_values =
        std::any_of(values.begin(), values.end(), [](double value) { return value < 0.0; });
    return signed_values ? mean_t(values, alpha) : mean_of_nonnegative(values, alpha);
  }

  Interval difference_of(const Pairs& pairs, double row_alpha) const {
    if (pairs.paired_a.empty()) return {NAN, -INFINITY, INFINITY};
    if (rule_.rms) return difference_of_rms(pairs.paired_a, pairs.paired_b, row_alpha);
    std::vector<double> differences(pairs.paired_a.size());
    for (std::size_t i = 0; i < differences.size(); ++i) {
      const double a = pairs.paired_a[i], b = pairs.paired_b[i];
      differences[i] = a == b ? 0.0 : a - b;  // also of two that are infinite
    }
    return rule_.median ? median(differences, row_alpha) : mean_t(differences, row_alpha);
  }

  std::vector<CompareRow> finished() {
    const auto compared = std::count_if(pairs_.begin(), pairs_.end(),
                                        [](const Pairs& pairs) { return !pairs.baseline; });
    const double row_alpha = alpha / static_cast<double>(std::max<std::ptrdiff_t>(compared, 1));
    std::vector<CompareRow> rows;
    for (Pairs& pairs : pairs_) {
      CompareRow& row = pairs.row;
      row.value = value_of(pairs.a);
      row.difference = difference_of(pairs, row_alpha);
      if (pairs.baseline) {
        row.verdict = "baseline";
      } else if (row.pairs == 0) {
        row.verdict = "no pairs";
      } else {
        const double size = std::abs(row.value.estimate);
        const double rounding = std::isfinite(size) ? equal_to_rounding * size : 0.0;
        row.verdict = row.difference.high < -rounding ? "lower"
                      : row.difference.low > rounding ? "higher"
                                                      : "no difference seen";
      }
      rows.push_back(std::move(row));
    }
    return rows;
  }

  const std::string& file_;
  const CompareOptions& options_;
  MetricRule rule_;
  Values values_;
  std::optional<Reader> reader_;
  const Column* column_ = nullptr;
  std::vector<std::string> labels_;  ///< of the compared axis, as they first come
  std::size_t baseline_ = 0;
  int instant_ = no_instant;
  std::vector<Group> groups_;
  std::vector<Pairs> pairs_;
};

}  // namespace

std::vector<CompareRow> compare(const std::string& database_file, const CompareOptions& options) {
  return Comparer(database_file, options).rows();
}

}  // namespace hearsay::analysis
