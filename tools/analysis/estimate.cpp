#include "tools/analysis/estimate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace hearsay::analysis {
namespace {

using Kind = Expectation::Kind;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double undefined = std::numeric_limits<double>::quiet_NaN();
constexpr double forgiven_in_agreement = 1e-9;
/// Values that differ by less, relative to their size, count as equal.
constexpr double rounding = 1e-12;

bool none_negative(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double value) { return value >= 0.0; });
}

Interval mean_of(const std::vector<double>& values, double alpha) {
  return none_negative(values) ? mean_of_nonnegative(values, alpha) : mean_t(values, alpha);
}

std::vector<double> minus(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> differences(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double size = std::max(std::abs(a[i]), std::abs(b[i]));
    // Of two that are both infinite neither is the greater; one alone is greater than all others.
    const bool equal =
        std::isfinite(size) ? std::abs(a[i] - b[i]) <= rounding * size : a[i] == b[i];
    differences[i] = equal ? 0.0 : a[i] - b[i];
  }
  return differences;
}

Interval exactly(double value) { return {value, value, value}; }

/// Root mean squares and quotients of aggregates are compared by their ratio.
bool compares_ratio(const ClaimRules& rules) {
  if (!rules.paired || rules.claim->expect.kind == Kind::agrees_with) return false;
  if (rules.ratio_within_repetition()) return false;
  return rules.over || rules.is_rms(rules.metric) || rules.is_rms(rules.other);
}

bool agrees_relatively(const ClaimRules& rules) {
  if (rules.claim->expect.kind != Kind::agrees_with || rules.log10) return false;
  return rules.is_rms(rules.metric) || rules.metric.consistency;
}

/// Relative difference between a and its prediction b, repetition by repetition.
Interval relative_difference(const ClaimRules& rules, const Comparison& c, double alpha,
                             std::size_t& left_out) {
  const bool squares = rules.is_rms(rules.metric);
  std::vector<double> ratios;
  for (std::size_t i = 0; i < c.a.size(); ++i) {
    const double ratio = c.a[i] / c.b[i];
    // A prediction may be negative: eᵀΩe of an indefinite belief.
    if ((squares ? c.b[i] > 0.0 : c.b[i] != 0.0) && std::isfinite(ratio * ratio)) {
      ratios.push_back(squares ? ratio * ratio : ratio);
    } else {
      ++left_out;
    }
  }
  if (ratios.empty()) return {undefined, -infinity, infinity};
  Interval interval = mean_of(ratios, alpha);
  if (squares) {
    interval = {std::sqrt(interval.estimate), std::sqrt(interval.low), std::sqrt(interval.high)};
  }
  return {interval.estimate - 1.0, interval.low - 1.0, interval.high - 1.0};
}

Interval extreme(const std::vector<double>& values, Statistic statistic) {
  return exactly(statistic == Statistic::largest ? *std::max_element(values.begin(), values.end())
                                                 : *std::min_element(values.begin(), values.end()));
}

Interval ratio(const ClaimRules& rules, const Comparison& c, double alpha) {
  std::vector<Factor> factors = {{c.a, rules.is_rms(rules.metric), 1}};
  if (rules.over) factors.push_back({c.a_over, rules.is_rms(*rules.over), -1});
  if (rules.paired) {
    factors.push_back({c.b, rules.is_rms(rules.other), -1});
    if (rules.over) factors.push_back({c.b_over, rules.is_rms(*rules.over), 1});
  }
  return product(factors, alpha);
}

Interval estimate(const ClaimRules& rules, const Comparison& c, double alpha,
                  std::size_t& left_out) {
  const bool extremes =
      rules.statistic == Statistic::largest || rules.statistic == Statistic::smallest;
  if (rules.trend) return mean_t(c.a, alpha);
  if (agrees_relatively(rules)) return relative_difference(rules, c, alpha, left_out);
  if (extremes) return extreme(rules.paired ? minus(c.a, c.b) : c.a, *rules.statistic);
  if (rules.statistic == Statistic::median) {
    return median(rules.paired ? minus(c.a, c.b) : c.a, alpha);
  }
  if (rules.statistic == Statistic::any) {
    const auto positive =
        std::count_if(c.a.begin(), c.a.end(), [](double value) { return value > 0.0; });
    return share(static_cast<std::size_t>(positive), c.a.size(), alpha);
  }
  if (compares_ratio(rules) || (rules.over && !rules.ratio_within_repetition())) {
    return ratio(rules, c, alpha);
  }
  if (rules.paired) return mean_t(minus(c.a, c.b), alpha);
  return rules.is_rms(rules.metric) ? rms_interval(c.a, alpha) : mean_of(c.a, alpha);
}

/// The bounds that the interval is held against; at_most 3 is (−∞, 3].
void set_bounds(const ClaimRules& rules, Finding& finding) {
  const Expectation& expect = rules.claim->expect;
  if (expect.chi2_band) {  // depends on the number of values
    finding.bound_low = finding.bound_high = undefined;
    return;
  }
  const double neutral = compares_ratio(rules) ? 1.0 : 0.0;
  finding.bound_low = -infinity;
  finding.bound_high = infinity;
  switch (expect.kind) {
    case Kind::at_most:
      finding.bound_high = expect.high;
      break;
    case Kind::at_least:
      finding.bound_low = expect.low;
      break;
    case Kind::within:
    case Kind::falls_as:
      finding.bound_low = expect.low;
      finding.bound_high = expect.high;
      break;
    case Kind::less_than:
      finding.bound_high = neutral;
      break;
    case Kind::greater_than:
    case Kind::grows:
      finding.bound_low = neutral;
      break;
    case Kind::agrees_with:
      finding.bound_low = finding.bound_high = 0.0;
      break;
  }
}

void decide_band(const Comparison& c, std::size_t family, Kind kind, Finding& finding) {
  const int runs = static_cast<int>(c.a.size());
  const Interval band = anees_band(c.state_dimension, runs, family_alpha, family);
  const double x = finding.interval.estimate;
  finding.bound_low = kind == Kind::at_most ? -infinity : band.low;
  finding.bound_high = band.high;
  if (kind == Kind::at_least) {
    finding.bound_low = band.high;
    finding.bound_high = infinity;
    finding.margin = x / band.high - 1.0;
    const double edge = anees_band(c.state_dimension, runs, family_alpha, 1).high;
    finding.side = x > band.high                  ? Side::claimed
                   : finding.interval.high < edge ? Side::other
                                                  : Side::open;
    return;
  }
  // Distances to the edges in units of the edge's own distance from 1.
  finding.margin = (band.high - x) / (band.high - 1.0);
  if (kind == Kind::within) {
    finding.margin = std::min(finding.margin, (x - band.low) / (1.0 - band.low));
  }
  finding.side = finding.margin >= 0.0 ? Side::claimed : Side::other;
}

void decide_agreement(const Comparison& c, bool relative, Finding& finding) {
  const Interval& i = finding.interval;
  double scale = 1.0;
  if (!relative) {
    scale = 0.0;
    for (const double value : c.b) scale += std::abs(value) / static_cast<double>(c.b.size());
  }
  finding.half_width = 0.5 * (i.high - i.low) / (scale > 0.0 ? scale : 1.0);
  const double slack = forgiven_in_agreement * scale;
  finding.margin = std::min(i.high + slack, slack - i.low);
  finding.side = finding.margin >= 0.0 ? Side::claimed : Side::other;
  const double half = 0.5 * (i.high - i.low) + slack;
  if (std::isfinite(half) && half > 0.0) finding.margin /= half;
}

void decide(const Interval& i, bool strict, Finding& finding) {
  const bool open_below = finding.bound_low == -infinity;
  const bool open_above = finding.bound_high == infinity;
  finding.margin = std::min(open_below ? infinity : i.low - finding.bound_low,
                            open_above ? infinity : finding.bound_high - i.high);
  // Beyond a bound by more than this; equal to it is claimed unless the claim is strict.
  const double slack = rounding * std::max(open_below ? 0.0 : std::abs(finding.bound_low),
                                           open_above ? 0.0 : std::abs(finding.bound_high));
  const double beyond = std::max(open_below ? -infinity : finding.bound_low - i.high,
                                 open_above ? -infinity : i.low - finding.bound_high);
  if (strict ? finding.margin > slack : finding.margin >= -slack) {
    finding.side = Side::claimed;
  } else if (strict ? beyond >= -slack : beyond > slack) {
    finding.side = Side::other;
  }
}

}  // namespace

Finding examine(const ClaimRules& rules, const Comparison& comparison, std::size_t family) {
  const Expectation& expect = rules.claim->expect;
  const std::size_t n = comparison.a.size();
  Finding finding;
  finding.interval = {undefined, -infinity, infinity};
  finding.margin = -infinity;
  set_bounds(rules, finding);
  const bool single = n == 1 && rules.study->repetitions == 1;
  if (n < 2 && !single) return finding;
  if (expect.chi2_band && comparison.state_dimension < 1) return finding;

  finding.interval =
      estimate(rules, comparison, family_alpha / static_cast<double>(family), finding.left_out);
  const Interval& interval = finding.interval;
  if (rules.keeps_infinite() ? std::isnan(interval.estimate) : !std::isfinite(interval.estimate)) {
    return finding;
  }
  if (single) finding.interval = exactly(interval.estimate);
  if (expect.chi2_band) {
    decide_band(comparison, family, expect.kind, finding);
  } else if (expect.kind == Kind::agrees_with) {
    decide_agreement(comparison, agrees_relatively(rules), finding);
  } else {
    const bool strict = expect.kind == Kind::less_than || expect.kind == Kind::greater_than ||
                        expect.kind == Kind::grows;
    decide(interval, strict, finding);
  }
  return finding;
}

std::string quantity(const ClaimRules& rules) {
  const Expectation& expect = rules.claim->expect;
  const std::string scale = rules.log10 ? "log10 " : "";
  const std::string metric = rules.over && rules.metric.over.empty()
                                 ? fmt::format("{}{} / {}", scale, expect.metric, rules.over->name)
                                 : scale + expect.metric;
  if (expect.kind == Kind::falls_as) return "exponent of " + rules.metric.name + " over time";
  if (expect.kind == Kind::grows) return "slope of " + metric + " a second";
  if (expect.kind == Kind::agrees_with) {
    return fmt::format("{} difference of {} from {}",
                       agrees_relatively(rules) ? "relative" : "mean", metric, rules.other.name);
  }
  if (rules.paired) {
    if (compares_ratio(rules)) return fmt::format("ratio of {}, paired", metric);
    if (rules.statistic == Statistic::median) return "median difference of " + metric;
    if (rules.statistic == Statistic::largest) return "largest difference of " + metric;
    if (rules.statistic == Statistic::smallest) return "smallest difference of " + metric;
    return "mean difference of " + metric;
  }
  if (rules.statistic == Statistic::median) return "median of " + metric;
  if (rules.statistic == Statistic::largest) return "largest " + metric;
  if (rules.statistic == Statistic::smallest) return "smallest " + metric;
  if (rules.statistic == Statistic::any) return "share of repetitions with " + metric + " > 0";
  if (expect.chi2_band) return metric == "anees" ? metric : metric + " a dimension";
  if (rules.over && !rules.ratio_within_repetition()) return metric;
  return fmt::format("{} of {}", rules.is_rms(rules.metric) ? "root mean square" : "mean", metric);
}

}  // namespace hearsay::analysis
