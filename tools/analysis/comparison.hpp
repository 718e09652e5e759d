// A claim taken apart into its comparisons: cells × agents × subjects × instants.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/study.hpp"
#include "tools/analysis/quantity.hpp"
#include "tools/analysis/values.hpp"

namespace hearsay::analysis {

/// How repetitions are brought together.
enum class Statistic { mean, rms, median, largest, smallest, any };

/// A claim with its names looked up.
struct ClaimRules {
  const Study* study = nullptr;
  const Claim* claim = nullptr;
  MetricRule metric;
  std::optional<MetricRule> over;
  MetricRule other;     ///< what it is compared with; the same metric unless another is named
  bool paired = false;  ///< less_than, greater_than, agrees_with
  bool trend = false;   ///< grows, falls_as
  bool log10 = false;
  std::optional<Statistic> statistic;  ///< nothing: by metric

  /// Infinite values count: the statistic has a meaning with them.
  bool keeps_infinite() const;
  /// Is this metric's aggregate over repetitions a root mean square?
  bool is_rms(const MetricRule& rule) const;
  /// Every value of a repetition is divided by its `over`, not the aggregates.
  bool ratio_within_repetition() const;
};
/// @throws InputError with the study's file and the claim's line for what has no meaning.
ClaimRules rules_of(const Study& study, const Claim& claim);

/// The values of one comparison, one each repetition in which all of them are there.
struct Comparison {
  std::string where;
  int state_dimension = 0;
  std::vector<double> a;       ///< the metric (a trend's slope; its logarithm; its ratio)
  std::vector<double> a_over;  ///< what its aggregate is divided by, if it is
  std::vector<double> b;       ///< paired: of the other side
  std::vector<double> b_over;
};

struct Comparisons {
  std::vector<Comparison> list;
  std::size_t missing_values = 0;
  std::vector<std::string> notes;  ///< what was left out, and why
};
/// @throws InputError for an axis, an agent or an instant that is not there.
Comparisons take_apart(const ClaimRules& rules, const Values& values,
                       const std::vector<CellRuns>& cells);

}  // namespace hearsay::analysis
