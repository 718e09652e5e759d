// Intervals over independent repetitions. Quantiles from Boost.Math; nothing here touches a run.
//
// Which interval, and why. A claim that speaks of 500 comparisons needs each interval at
// alpha = 0.05/500 = 1e-4. No bootstrap of a few thousand resamples reaches that far into the tail,
// and the plain t interval of a skewed quantity does not either: for squares of normal errors and
// 100 repetitions its lower side is missed 23 to 50 times as often as it says at alpha = 1e-4
// (2 times at 0.05). So:
//   means that can have either sign (paired differences, slopes)   t on the mean
//   means of what cannot be negative (squares, NEES)               t on mean^(-1/3)
//   ratios                                                          t on the logarithm
// with variances by the delta method (equal to the infinitesimal jackknife). With x distributed
// as a gamma variable of any shape, mean^(-1/3) is the power whose studentized statistic has no
// skewness to order 1/√n; at alpha = 1e-4 and 100 repetitions it misses about twice as often as it
// says. The bootstrap serves as a cross-check in the tests.
//   medians (of times that may never come)                          order statistics
//
// `alpha` is in (0, 1) everywhere, two-sided. Values must be finite (but for medians); paired spans
// are of one length. @throws BrokenInvariant otherwise, and for no values at all. From one value no
// width is known: the interval then is as wide as the quantity's range, (−∞, ∞) or [0, ∞). Values
// that are all equal (to rounding) give an interval of width zero.
#pragma once

#include <cstddef>
#include <span>

namespace hearsay::analysis {

struct Interval {
  double estimate = 0.0;
  double low = 0.0;
  double high = 0.0;
};

/// Mean with its t interval.
Interval mean_t(std::span<const double> values, double alpha);

/// Mean of values ≥ 0 with an interval by t on mean^(-1/3). The upper end is ∞ where the spread is
/// too wide for a finite one.
Interval mean_of_nonnegative(std::span<const double> values, double alpha);

/// Root mean square, its interval from that of the mean square.
Interval rms_interval(std::span<const double> values, double alpha);

/// √(mean a²)/√(mean b²) over paired values. Undefined (NaN, −∞ … ∞) if either is zero.
Interval ratio_of_rms(std::span<const double> a, std::span<const double> b, double alpha);

/// mean a / mean b over paired values. Undefined (NaN, −∞ … ∞) unless both means are positive.
Interval ratio_of_means(std::span<const double> a, std::span<const double> b, double alpha);

/// √(mean a²) − √(mean b²) over paired values.
Interval difference_of_rms(std::span<const double> a, std::span<const double> b, double alpha);

/// One factor of a product of aggregates: its root mean square or its mean, to the power +1 or −1.
struct Factor {
  std::span<const double> values;
  bool rms = false;
  int power = 1;
};
/// Product of the factors over paired values, t on its logarithm. Undefined (NaN, −∞ … ∞) unless
/// every aggregate is positive.
Interval product(std::span<const Factor> factors, double alpha);

/// Median of values that may be infinite (not NaN), with the interval between two order statistics
/// that holds it with at least 1 − alpha whatever the law of the values: (−∞, ∞) where so few
/// values cannot. The mean of the two middle values where their number is even.
Interval median(std::span<const double> values, double alpha);

/// Share of successes in n ≥ 1 trials with Wilson's interval.
Interval share(std::size_t successes, std::size_t n, double alpha);

/// χ² band of an ANEES over `runs` ≥ 1 runs of an n-dimensional state, n ≥ 1, divided by n: the
/// interval that holds it with probability 1 − alpha in all of `comparisons` ≥ 1 places together
/// (Bonferroni). The estimate is the expected value, 1.
Interval anees_band(int n, int runs, double alpha, std::size_t comparisons);

/// Slope of y against x by least squares; at least two different x.
double slope(std::span<const double> x, std::span<const double> y);

}  // namespace hearsay::analysis
