#include "tools/analysis/quantity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>

namespace hearsay::analysis {
namespace {

constexpr const char* dimension_name = "state_dimension";
constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

/// Brings values together, by mean, root mean square or maximum; those that are missing (NaN) stay
/// out. With an infinite one among them, mean and root mean square are infinite.
class Gatherer {
 public:
  enum class Way { mean, rms, largest };
  explicit Gatherer(Way way) : way_(way) {}

  void add(double value) {
    if (std::isnan(value)) return;
    ++count_;
    if (way_ != Way::largest && std::isinf(value)) {
      infinite_ += way_ == Way::rms ? std::abs(value) : value;
    } else if (way_ == Way::largest) {
      sum_ = count_ == 1 ? value : std::max(sum_, value);
    } else if (way_ == Way::mean) {
      sum_ += value;
    } else {
      add_square(std::abs(value));
    }
  }
  double result() const {
    if (count_ == 0) return nothing;
    if (way_ == Way::largest) return sum_;
    if (infinite_ != 0.0) return infinite_;
    const auto n = static_cast<double>(count_);
    return way_ == Way::mean ? sum_ / n : scale_ * std::sqrt(sum_ / n);
  }

 private:
  /// Squares are summed relative to the largest value so far: beliefs claim 1e-200 m and less.
  void add_square(double value) {
    if (value > scale_) {
      sum_ = sum_ * (scale_ / value) * (scale_ / value) + 1.0;
      scale_ = value;
    } else if (value > 0.0) {
      sum_ += (value / scale_) * (value / scale_);
    }
  }

  Way way_;
  std::size_t count_ = 0;
  double sum_ = 0.0;
  double scale_ = 0.0;
  double infinite_ = 0.0;
};

}  // namespace

Reader::Reader(const Values& values, const MetricRule& rule, bool keeps_infinite)
    : values_(&values),
      rule_(rule),
      keeps_infinite_(keeps_infinite),
      column_(values.find(rule.stored)),
      dimension_(values.find(dimension_name)) {
  if (dimension_ != nullptr && dimension_->is_series()) dimension_ = nullptr;
}

std::optional<double> Reader::value_of_agent(std::size_t run, AgentId agent, const Place& place,
                                             std::size_t& missing) const {
  const Column& column = *column_;
  const int instant = !column.is_series()           ? 0
                      : place.instant == no_instant ? column.last_instant(run)
                                                    : place.instant;
  if (instant == no_instant) return std::nullopt;
  const auto look = [&](int subject) {
    std::optional<double> value = column.value(run, agent, subject, instant);
    if (value && (keeps_infinite_ ? std::isnan(*value) : !std::isfinite(*value))) {
      ++missing;
      value = nothing;
    }
    return value;
  };
  if (!column.is_series()) return look(0);
  if (place.subject != all_subjects) return look(place.subject);
  const int subjects = static_cast<int>(values_->subjects().size());
  if (subjects == 1) return look(0);
  Gatherer gatherer(rule_.rms ? Gatherer::Way::rms : Gatherer::Way::mean);
  bool any_row = false;
  for (int subject = 0; subject < subjects; ++subject) {
    const std::optional<double> value = look(subject);
    if (!value) continue;
    any_row = true;
    gatherer.add(*value);
  }
  return any_row ? std::optional(gatherer.result()) : std::nullopt;
}

MetricRule metric_rule(const std::string& name, bool chi2_band) {
  static constexpr std::array<std::string_view, 9> root_mean_squares = {
      "rms_error_m",
      "claimed_sigma_m",
      "true_sigma_m",
      "final_claimed_sigma_m",
      "velocity_error_m_per_s",
      "claimed_velocity_sigma_m_per_s",
      "x_error_m",
      "y_error_m",
      "heading_error_rms_rad"};
  MetricRule rule{.name = name, .stored = name == "anees" ? "nees" : name};
  if (name == "bytes_per_m_saved") {
    rule.stored = "bytes_sent";
    rule.over = "distance_saved_m";
  }
  rule.rms = std::find(root_mean_squares.begin(), root_mean_squares.end(), name) !=
             root_mean_squares.end();
  rule.median = name == "agree_again_s" || name == "alarms_found_s" || name == "first_arrival_s" ||
                name == "recovery_s";
  rule.consistency = name.ends_with("nees");
  rule.each_subject = rule.consistency || name.starts_with("alarms_") ||
                      name.starts_with("alarm_") || name.starts_with("cells_");
  rule.per_dimension = name == "anees" || (chi2_band && (name == "nees" || name == "ledger_nees"));
  return rule;
}

void add_stored_names(const MetricRule& rule, std::set<std::string>& names) {
  names.insert(rule.stored);
  if (rule.consistency) names.insert(dimension_name);
}

std::vector<AgentId> CellRuns::numbered_agents() const {
  std::vector<AgentId> numbers;
  for (const auto& [agent, name] : agents) {
    if (agent >= 0) numbers.push_back(agent);
  }
  return numbers;
}

double Reader::value(const CellRuns& cell, std::size_t run, const Place& place,
                     std::size_t& missing) const {
  std::optional<double> value;
  if (column_ != nullptr && place.who.kind == Who::Kind::one) {
    value = value_of_agent(run, place.who.agent, place, missing);
  } else if (column_ != nullptr) {
    Gatherer gatherer(place.who.kind == Who::Kind::largest ? Gatherer::Way::largest
                      : rule_.rms                          ? Gatherer::Way::rms
                                                           : Gatherer::Way::mean);
    for (const auto& [agent, name] : cell.agents) {
      if (agent < 0) continue;
      const std::optional<double> of_agent = value_of_agent(run, agent, place, missing);
      if (!of_agent) continue;
      value = nothing;
      gatherer.add(*of_agent);
    }
    if (value) value = gatherer.result();
  }
  if (!value) {
    ++missing;
    return nothing;
  }
  if (!rule_.per_dimension) return *value;
  const int n = state_dimension(run);
  if (n > 0) return *value / n;
  ++missing;
  return nothing;
}

int Reader::state_dimension(std::size_t run) const {
  if (dimension_ == nullptr) return 0;
  const std::optional<double> n = dimension_->value(run, central_agent, 0, 0);
  return n && *n >= 1.0 ? static_cast<int>(*n) : 0;
}

std::string Reader::describe(const CellRuns& cell, const Place& place) const {
  std::string text = to_string(cell.labels);
  const auto append = [&text](const std::string& part) {
    text += text.empty() ? part : " " + part;
  };
  if (place.who.kind == Who::Kind::mean) {
    append("mean over agents");
  } else if (place.who.kind == Who::Kind::largest) {
    append("largest over agents");
  } else {
    append(place.who.agent == central_agent ? "agent=central"
                                            : fmt::format("agent={}", place.who.agent));
  }
  if (column_ == nullptr || !column_->is_series()) return text;
  if (place.subject != all_subjects && values_->subjects().size() > 1) {
    append(values_->subjects()[static_cast<std::size_t>(place.subject)]);
  }
  int instant = place.instant;
  if (instant == no_instant && !cell.runs.empty()) {
    instant = column_->last_instant(cell.runs.begin()->second);
  }
  if (instant != no_instant) {
    append(fmt::format("t={:.6g} s", values_->instants_s()[static_cast<std::size_t>(instant)]));
  }
  return text;
}

}  // namespace hearsay::analysis
