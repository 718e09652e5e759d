#include "tools/analysis/comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include "scenarios/names.hpp"
#include "sim/kernel/error.hpp"
#include "tools/analysis/statistics.hpp"

namespace hearsay::analysis {
namespace {

constexpr double same_instant_s = 1e-6;

std::optional<double> as_number(const std::string& text) {
  double number = 0.0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc() || stop != end) return std::nullopt;
  return number;
}

/// Builds the comparisons of one claim.
class Builder {
 public:
  Builder(const ClaimRules& rules, const Values& values, const std::vector<CellRuns>& cells)
      : rules_(rules),
        expect_(rules.claim->expect),
        values_(values),
        cells_(cells),
        metric_(values, rules.metric, rules.keeps_infinite()),
        other_(values, rules.other, rules.keeps_infinite()) {
    if (rules.over) over_.emplace(values, *rules.over);
  }

  Comparisons build() {
    check_axes(expect_.where);
    check_axes(expect_.than);
    bool any_cell = false;
    for (const CellRuns& cell : cells_) {
      if (!matches(cell)) continue;
      any_cell = true;
      count_runs(cell);
      for (const CellRuns* other : others(cell)) add_cell(cell, *other);
    }
    if (!any_cell) result_.notes.push_back("no cell of the study matches");
    note_what_was_left_out();
    return std::move(result_);
  }

 private:
  [[noreturn]] void refuse(const std::string& message) const {
    throw InputError(rules_.study->file, rules_.claim->line, message);
  }

  void check_axes(const Where& where) const {
    std::vector<std::string> axes;
    for (const Axis& axis : rules_.study->axes) axes.push_back(axis.name);
    for (const auto& [axis, labels] : where) {
      if (std::find(axes.begin(), axes.end(), axis) == axes.end()) {
        refuse(fmt::format("no axis '{}'{}", axis, allowed_names(axis, axes)));
      }
    }
  }

  bool matches(const CellRuns& cell) const {
    for (const auto& [axis, label] : cell.labels) {
      const auto wanted = expect_.where.find(axis);
      if (wanted == expect_.where.end()) continue;
      const auto same = [text = label](const Value& value) { return label_text(value) == text; };
      if (std::none_of(wanted->second.begin(), wanted->second.end(), same)) return false;
    }
    return true;
  }

  void count_runs(const CellRuns& cell) {
    runs_expected_ += static_cast<std::size_t>(rules_.study->repetitions);
    runs_there_ += cell.runs.size();
    runs_failed_ += cell.failed;
  }

  /// The cells that `cell` is compared with: itself unless `than` names labels.
  std::vector<const CellRuns*> others(const CellRuns& cell) {
    if (!rules_.paired || expect_.than.empty()) return {&cell};
    std::vector<Labels> wanted = {cell.labels};
    for (const auto& [axis, replacements] : expect_.than) {
      std::vector<Labels> next;
      for (const Labels& labels : wanted) {
        for (const Value& value : replacements) {
          Labels changed = labels;
          for (auto& [name, label] : changed) {
            if (name == axis) label = label_text(value);
          }
          next.push_back(std::move(changed));
        }
      }
      wanted = std::move(next);
    }
    std::vector<const CellRuns*> found;
    for (const Labels& labels : wanted) {
      const auto same = [&](const CellRuns& candidate) { return candidate.labels == labels; };
      const auto at = std::find_if(cells_.begin(), cells_.end(), same);
      if (at == cells_.end()) {
        ++cells_without_other_;
      } else if (&*at != &cell || expect_.than_agent || expect_.than_metric) {
        found.push_back(&*at);
      }
    }
    return found;
  }

  void add_cell(const CellRuns& cell, const CellRuns& other) {
    if (cell.runs.empty() || other.runs.empty()) {
      // Kept as a comparison without values: a claim must not be reproduced by what did not run.
      if (cells_without_runs_++ == 0) {
        first_without_runs_ = to_string(cell.runs.empty() ? cell.labels : other.labels);
      }
      result_.list.emplace_back().where = to_string(cell.labels);
      return;
    }
    for (const Who& who : agents(cell, expect_.agents)) {
      Who other_who = who;
      if (rules_.paired && expect_.than_agent) {
        other_who = agents(other, *expect_.than_agent).front();
      }
      for (const int subject : subjects(cell)) add_instants(cell, other, who, other_who, subject);
    }
  }

  std::vector<Who> agents(const CellRuns& cell, const std::string& selector) const {
    if (selector == "mean") return {{Who::Kind::mean}};
    if (selector == "max") return {{Who::Kind::largest}};
    if (selector == "central") return {{Who::Kind::one, central_agent}};
    if (selector == "each") {
      std::vector<Who> all;
      for (const AgentId agent : cell.numbered_agents()) all.push_back({Who::Kind::one, agent});
      if (all.empty()) refuse(fmt::format("the runs of {} have no agents", to_string(cell.labels)));
      return all;
    }
    std::vector<std::string> names = {"each", "mean", "max", "central"};
    for (const auto& [agent, name] : cell.agents) {
      if (name == selector || std::to_string(agent) == selector) return {{Who::Kind::one, agent}};
      names.push_back(name);
    }
    refuse(fmt::format("no agent '{}'{}", selector, allowed_names(selector, names)));
  }

  const Column* column() const { return metric_.column(); }

  std::vector<int> subjects(const CellRuns& cell) {
    if (column() == nullptr || !column()->is_series()) return {all_subjects};
    const auto present = [&] { return column()->subjects(cell.runs.begin()->second); };
    if (!expect_.subjects.empty()) return named_subjects(cell);
    if (!rules_.metric.each_subject) {
      subjects_averaged_ = subjects_averaged_ || values_.subjects().size() > 1;
      return {all_subjects};
    }
    return present();
  }

  /// Not all runs need to have them: some make more trips than others.
  std::vector<int> named_subjects(const CellRuns& cell) const {
    std::set<int> of_any;
    for (const auto& [repetition, run] : cell.runs) {
      for (const int subject : column()->subjects(run)) of_any.insert(subject);
    }
    const std::vector<int> present(of_any.begin(), of_any.end());
    std::vector<int> chosen;
    std::vector<std::string> names;
    for (const int subject : present) {
      names.push_back(values_.subjects()[static_cast<std::size_t>(subject)]);
    }
    for (const std::string& name : expect_.subjects) {
      const auto at = std::find(names.begin(), names.end(), name);
      if (at == names.end()) {
        refuse(fmt::format("no subject '{}'{}", name, allowed_names(name, names)));
      }
      chosen.push_back(present[static_cast<std::size_t>(at - names.begin())]);
    }
    return chosen;
  }

  std::vector<int> instants(const CellRuns& cell) const {
    if (column() == nullptr || !column()->is_series() || rules_.trend || expect_.at == "end") {
      return {no_instant};
    }
    if (expect_.at == "all") return column()->instants(cell.runs.begin()->second);
    const std::optional<double> t_s = as_number(expect_.at);
    if (!t_s) refuse(fmt::format("at = '{}' is none of \"end\", \"all\", seconds", expect_.at));
    double nearest_s = values_.instants_s().front();
    for (std::size_t i = 0; i < values_.instants_s().size(); ++i) {
      const double sample_s = values_.instants_s()[i];
      if (std::abs(sample_s - *t_s) <= same_instant_s) return {static_cast<int>(i)};
      if (std::abs(sample_s - *t_s) < std::abs(nearest_s - *t_s)) nearest_s = sample_s;
    }
    refuse(fmt::format("no sample at {:.9g} s in the database; the nearest is at {:.9g} s", *t_s,
                       nearest_s));
  }

  void add_instants(const CellRuns& cell, const CellRuns& other, const Who& who,
                    const Who& other_who, int subject) {
    // In a claim on all instants, those before anything is known are no comparisons.
    bool may_leave_out = expect_.at == "all" && !rules_.trend;
    const std::vector<int> all = instants(cell);
    for (const int instant : all) {
      const std::size_t missing_before = result_.missing_values;
      Comparison comparison =
          fill(cell, other, {who, subject, instant}, {other_who, subject, instant});
      if (may_leave_out && comparison.a.empty() && instant != all.back()) {
        result_.missing_values = missing_before;
        ++instants_left_out_;
        continue;
      }
      may_leave_out = false;
      result_.list.push_back(std::move(comparison));
    }
  }

  Comparison fill(const CellRuns& cell, const CellRuns& other, const Place& place,
                  const Place& other_place) {
    Comparison comparison;
    comparison.where = metric_.describe(cell, place);
    if (rules_.claim->expect.chi2_band) {
      comparison.state_dimension = metric_.state_dimension(cell.runs.begin()->second);
    }
    for (const auto& [repetition, run] : cell.runs) {
      const auto other_run = other.runs.find(repetition);
      if (other_run == other.runs.end()) {
        ++runs_without_partner_;
        continue;
      }
      if (rules_.trend) {
        const double slope_of_run = trend(cell, run, place);
        if (std::isfinite(slope_of_run)) comparison.a.push_back(slope_of_run);
        continue;
      }
      const OneSide a = side(metric_, cell, run, place);
      const OneSide b = rules_.paired ? side(other_, other, other_run->second, other_place) : a;
      if (!a.complete || !b.complete) continue;
      comparison.a.push_back(a.value);
      comparison.a_over.push_back(a.over);
      if (!rules_.paired) continue;
      comparison.b.push_back(b.value);
      comparison.b_over.push_back(b.over);
    }
    return comparison;
  }

  /// One side's value in a repetition, and the value its aggregate is divided by.
  struct OneSide {
    double value = 0.0;
    double over = 1.0;
    bool complete = false;
  };
  bool counts(double value) const {
    return rules_.keeps_infinite() ? !std::isnan(value) : std::isfinite(value);
  }
  OneSide side(const Reader& reader, const CellRuns& cell, std::size_t run, const Place& place) {
    std::size_t& missing = result_.missing_values;
    OneSide result;
    result.value = reader.value(cell, run, place, missing);
    if (over_) result.over = over_->value(cell, run, place, missing);
    if (!counts(result.value) || !std::isfinite(result.over)) return result;
    if (rules_.ratio_within_repetition()) {
      result.value /= std::exchange(result.over, 1.0);
      if (rules_.log10) result.value = result.value > 0.0 ? std::log10(result.value) : NAN;
      if (!counts(result.value)) {
        ++missing;
        return result;
      }
    }
    result.complete = true;
    return result;
  }

  /// Slope over the run's instants; NaN with fewer than two usable ones.
  double trend(const CellRuns& cell, std::size_t run, Place place) {
    if (column() == nullptr) {
      ++result_.missing_values;
      return NAN;
    }
    const bool power_law = expect_.kind == Expectation::Kind::falls_as;
    std::vector<double> x;
    std::vector<double> y;
    for (const int instant : column()->instants(run)) {
      const double t_s = values_.instants_s()[static_cast<std::size_t>(instant)];
      if (power_law && t_s <= 0.0) continue;
      place.instant = instant;
      const OneSide at = side(metric_, cell, run, place);
      if (!at.complete) continue;
      x.push_back(power_law ? std::log10(t_s) : t_s);
      y.push_back(at.value);
    }
    return x.size() < 2 ? NAN : slope(x, y);
  }

  void note_what_was_left_out() {
    std::vector<std::string>& notes = result_.notes;
    if (runs_there_ < runs_expected_) {
      notes.push_back(fmt::format("missing runs: {} of {} (failed: {})",
                                  runs_expected_ - runs_there_, runs_expected_, runs_failed_));
    }
    if (runs_without_partner_ > 0) {
      notes.push_back(fmt::format("repetitions without a finished run to pair them with: {}",
                                  runs_without_partner_));
    }
    if (cells_without_runs_ > 0) {
      notes.push_back(fmt::format("cells without a finished run: {}, the first {}",
                                  cells_without_runs_,
                                  first_without_runs_.empty() ? "of all" : first_without_runs_));
    }
    if (cells_without_other_ > 0) {
      notes.push_back(fmt::format("comparisons left out, for the study skips the other cell: {}",
                                  cells_without_other_));
    }
    if (instants_left_out_ > 0) {
      notes.push_back(
          fmt::format("instants left out before the first value: {}", instants_left_out_));
    }
    if (subjects_averaged_) notes.push_back("subjects averaged within each run");
    if (column() == nullptr) {
      notes.push_back(fmt::format("the database has no values of {}", rules_.metric.stored));
    }
  }

  const ClaimRules& rules_;
  const Expectation& expect_;
  const Values& values_;
  const std::vector<CellRuns>& cells_;
  Reader metric_;
  Reader other_;
  std::optional<Reader> over_;
  Comparisons result_;
  std::size_t runs_expected_ = 0;
  std::size_t runs_there_ = 0;
  std::size_t runs_failed_ = 0;
  std::size_t runs_without_partner_ = 0;
  std::size_t cells_without_runs_ = 0;
  std::string first_without_runs_;
  std::size_t cells_without_other_ = 0;
  std::size_t instants_left_out_ = 0;
  bool subjects_averaged_ = false;
};

}  // namespace

Comparisons take_apart(const ClaimRules& rules, const Values& values,
                       const std::vector<CellRuns>& cells) {
  return Builder(rules, values, cells).build();
}

}  // namespace hearsay::analysis
