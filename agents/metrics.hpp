// The names of what a run records, with unit and meaning: `hearsay list metrics`.
#pragma once

#include <span>
#include <string_view>

namespace hearsay {

/// Where a metric's values stand in the database.
enum class MetricTable {
  series,   ///< over time: agent, subject, instant
  scalar,   ///< once a run and agent
  derived,  ///< computed by claims and comparisons from recorded ones
};

/// How repetitions of a metric are summed up unless a claim says otherwise.
///   median  of times that may never come: those count as infinite
enum class Aggregate { mean, rms, median };

struct MetricInfo {
  std::string_view name;
  MetricTable table;
  Aggregate aggregate;
  bool ledger;               ///< needs record.ledger = "on"
  std::string_view meaning;  ///< with unit
};

/// All metrics of the built-in agents, series first.
std::span<const MetricInfo> metrics();

/// Positions in metrics() of the series; `Metric::nees` is metrics()[3].
enum class Metric {
  rms_error_m,
  claimed_sigma_m,
  true_sigma_m,
  nees,
  ledger_anees,
  ledger_nees,
  kl_to_central_nats,
  hellinger_to_central,
  entropy_nats,
  multiplicity_mean,
  multiplicity_max,
  multiplicity_share,
  reach_gap,
  not_positive,
  disagreement_m,
  velocity_error_m_per_s,
  claimed_velocity_sigma_m_per_s,
  x_m,
  y_m,
  x_error_m,
  y_error_m,
};
inline constexpr int series_metric_count = 21;

}  // namespace hearsay
