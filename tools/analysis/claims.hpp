// Claims: a paper's sentence as a test over a study's repetitions.
//
// A claim speaks of a set of cells (× agents × instants): its comparisons. For each one an interval
// is made at 95 % family-wise (Bonferroni over the comparisons of the claim; statistics.hpp says
// which interval):
//   reproduced      every interval lies wholly on the claimed side
//   not reproduced  some interval lies wholly on the other side
//   undecided       else: an interval straddles the bound, or has fewer than two values
//
// Who and when. Every agent ("each"), their mean or their largest in a run, one of them, or the
// central filter; at the last instant, at all, or at one. Several subjects are averaged in a run,
// except for measures of consistency (…nees) and of alarms (alarm…, cells_…: a threshold each),
// where each is a comparison of its own, and for those that `subjects` names. Under at = "all" the
// instants before a comparison's first value do not count.
//
// Over repetitions, `statistic`:
//   auto      root mean square for errors (rms_error_m, velocity_error_m_per_s, x_error_m,
//             y_error_m) and standard deviations (claimed_sigma_m, true_sigma_m,
//             final_claimed_sigma_m, claimed_velocity_sigma_m_per_s); median for times
//             that may never come (agree_again_s, alarms_found_s, first_arrival_s, recovery_s);
//             else the mean
//   mean, rms
//   median    with an interval between order statistics
//   max, min  an exact statement on the worst repetition, without an interval
//   any       the share of repetitions with a value above zero, with Wilson's interval
// Infinite values (a time that never came, a gap to an empty central filter) count under median,
// max, min and any, where of two infinite ones neither is the greater; mean and rms leave them out
// as missing, and are therefore refused for those two.
// anees is the mean of nees, divided by the state's dimension; bytes_per_m_saved is bytes_sent over
// distance_saved_m, quotients of means, and has no value where the latter is not positive. `over`
// divides the aggregate by that of another metric (with max, min, any or a scale of log10: each
// repetition's value). With scale log10 values, and the bounds, are logarithms; values that are not
// positive count as missing.
//
// Kinds:
//   at_most, at_least, within     the aggregate against bounds
//   less_than, greater_than       paired by repetition with another cell (the axes of `than`
//             replaced), agent or metric: the ratio of aggregates against 1 for root mean squares
//             and with `over`, else the mean (median, …) difference against 0. No cell is compared
//             with itself.
//   grows     each repetition's slope over time (a second) against 0
//   falls_as  each repetition's slope of log10 value against log10 time: the exponent, within
//   agrees_with   paired; reproduced unless the interval of the difference leaves 0 out (it is a
//             consistency check: the note says how wide the intervals are). For root mean squares
//             and …nees each repetition's value (squared) is divided by its counterpart, the
//             prediction for it; the relative difference of the mean is what must hold 0
//             (1e-9 is forgiven to rounding).
//   within, at_most, at_least "chi2-band", for anees, nees and ledger_nees (the latter two are
//             divided by the dimension). The ANEES of independent repetitions lies inside the band
//             with 95 % in all comparisons together, if the belief is consistent.
//             within, at_most: the estimate against the band's edges; one outside is enough for
//             "not reproduced". at_least, "overconfident": reproduced if all estimates are above
//             the upper edge; not if the interval of one lies wholly below the upper edge of the
//             band for a single comparison.
// Bounds are kept and broken to 1e-12 of their size: what is equal but for rounding is equal.
// A study with one repetition speaks of that run: its values count as exact, and the note says so.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/study.hpp"
#include "tools/analysis/statistics.hpp"

namespace hearsay::analysis {

enum class Verdict { reproduced, not_reproduced, undecided };
/// "reproduced", "not reproduced", "undecided".
const char* to_string(Verdict verdict);

struct ClaimResult {
  Claim claim;
  Verdict verdict = Verdict::undecided;
  std::string quantity;     ///< what is estimated: "anees, mean", "ratio of rms_error_m, …"
  Interval worst;           ///< of the comparison nearest to (or farthest beyond) the bound
  std::string worst_where;  ///< "rule=naive loss=0.1 agent=2 t=120 s"
  double bound_low = 0.0, bound_high = 0.0;  ///< what was claimed there, ±∞ where open
  std::size_t comparisons = 0;
  std::size_t failing = 0;         ///< wholly on the other side
  std::size_t open = 0;            ///< neither on this side nor on the other
  int repetitions = 0;             ///< fewest that a comparison has values of
  std::size_t missing_values = 0;  ///< NULL, or infinite where these do not count: left out
  std::string note;                ///< why undecided, what was left out
};

/// Judges all claims of `study` on the runs of that study in `database_file`.
/// @throws InputError: not a database, no run of this study, or a claim without a meaning there
/// (an unknown axis, agent or instant), with the study's file and line.
std::vector<ClaimResult> judge(const std::string& database_file, const Study& study);

/// Paired comparison of one metric along one axis against a baseline label.
struct CompareOptions {
  std::string metric;
  std::string by;
  std::optional<std::string> baseline;  ///< default: the axis's first label
  std::string agents = "mean";          ///< "each" | "mean" | "max" | "central" | a number or name
  std::string at = "end";               ///< "end" | seconds
  std::optional<std::string> study;     ///< needed where the database holds several
};
struct CompareRow {
  std::string cell;  ///< the other axes: "topology=ring loss=0.1", and agent and subject
  std::string label;
  int pairs = 0;        ///< repetitions with a value here and in the baseline
  Interval value;       ///< of the metric itself, 95 %
  Interval difference;  ///< paired, value − baseline, 95 % over all rows together
  std::string verdict;  ///< "lower" | "higher" | "no difference seen" | "baseline" | "no pairs"
};
/// Rows cell by cell, labels in the order of the axis.
/// @throws InputError for an unknown metric, axis, label, agent or study (nearest known name
/// offered), and for several studies without a choice.
std::vector<CompareRow> compare(const std::string& database_file, const CompareOptions& options);

/// Writes a Markdown report and a JSON twin, whole or not at all. In JSON, NaN is null and
/// infinities are the strings "inf" and "-inf".
/// @throws InputError if a file cannot be written.
void write_claims_report(const std::vector<ClaimResult>& results, const std::string& title,
                         const std::string& markdown_file, const std::string& json_file);

}  // namespace hearsay::analysis
