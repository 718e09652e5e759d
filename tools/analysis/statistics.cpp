#include "tools/analysis/statistics.hpp"

#include <algorithm>
#include <bit>
#include <boost/math/distributions/binomial.hpp>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>
#include <vector>

#include "sim/kernel/error.hpp"

namespace hearsay::analysis {
namespace {

/// Boost's default computes in long double, ten times as slowly, for digits nobody sees.
using Policy = boost::math::policies::policy<boost::math::policies::promote_double<false>>;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double undefined = std::numeric_limits<double>::quiet_NaN();
/// Spreads below this, relative to the values, are rounding.
constexpr double rounding = 64 * std::numeric_limits<double>::epsilon();

void check(std::span<const double> values, double alpha) {
  require(!values.empty(), "an interval needs at least one value");
  require(alpha > 0.0 && alpha < 1.0, "alpha must be in (0, 1)");
  for (const double value : values) require(std::isfinite(value), "values must be finite");
}

void check(std::span<const double> a, std::span<const double> b, double alpha) {
  check(a, alpha);
  check(b, alpha);
  require(a.size() == b.size(), "paired values must be of one length");
}

/// Two-sided quantile of Student's t for n values.
double t_quantile(std::size_t n, double alpha) {
  const boost::math::students_t_distribution<double, Policy> distribution(
      static_cast<double>(n - 1));
  return quantile(complement(distribution, alpha / 2.0));
}

double largest(std::span<const double> values) {
  double scale = 0.0;
  for (const double value : values) scale = std::max(scale, std::abs(value));
  return scale;
}

/// Mean and standard error of the mean; of one value the standard error is ∞. Both are computed on
/// values divided by the largest, so that neither overflows.
struct Moments {
  double mean = 0.0;
  double error = 0.0;
};
Moments moments(std::span<const double> values) {
  const auto n = static_cast<double>(values.size());
  Moments result;
  for (const double value : values) result.mean += value / n;
  if (values.size() < 2) return {result.mean, infinity};
  const double scale = largest(values);
  if (scale == 0.0) return result;
  double sum = 0.0;
  for (const double value : values) {
    const double d = (value - result.mean) / scale;
    sum += d * d;
  }
  const double deviation = std::sqrt(sum / (n - 1.0));
  if (deviation > rounding) result.error = scale * deviation / std::sqrt(n);
  return result;
}

/// How an aggregate answers to each value: A ≈ A₀ + mean of the influences (relative: to ln A).
struct Aggregate {
  double value = 0.0;
  std::vector<double> relative_influence;
};
Aggregate aggregate(std::span<const double> values, bool rms) {
  Aggregate result;
  result.relative_influence.assign(values.size(), 0.0);
  const double scale = largest(values);
  if (scale == 0.0) return result;
  const auto n = static_cast<double>(values.size());
  double mean = 0.0;
  for (const double value : values) {
    const double x = value / scale;
    mean += (rms ? x * x : x) / n;
  }
  result.value = scale * (rms ? std::sqrt(mean) : mean);
  if (mean == 0.0) return result;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double x = values[i] / scale;
    result.relative_influence[i] = rms ? 0.5 * (x * x / mean - 1.0) : x / mean - 1.0;
  }
  return result;
}

/// Standard error of a quantity from its influences, which sum to zero. Below `scale`·rounding it
/// counts as zero.
double error_of(std::span<const double> influences, double scale) {
  const auto n = static_cast<double>(influences.size());
  double sum = 0.0;
  for (const double influence : influences) {
    const double d = influence / scale;
    sum += d * d;
  }
  const double deviation = std::sqrt(sum / (n - 1.0));
  return deviation > rounding ? scale * deviation / std::sqrt(n) : 0.0;
}

}  // namespace

Interval mean_t(std::span<const double> values, double alpha) {
  check(values, alpha);
  const Moments m = moments(values);
  if (values.size() < 2) return {m.mean, -infinity, infinity};
  const double half = t_quantile(values.size(), alpha) * m.error;
  return {m.mean, m.mean - half, m.mean + half};
}

Interval mean_of_nonnegative(std::span<const double> values, double alpha) {
  check(values, alpha);
  for (const double value : values) require(value >= 0.0, "values must not be negative");
  const Moments m = moments(values);
  if (values.size() < 2) return {m.mean, 0.0, infinity};
  if (m.mean == 0.0 || m.error == 0.0) return {m.mean, m.mean, m.mean};
  // d(m^(-1/3)) = -1/3 m^(-4/3) dm, hence the relative half-width on that scale.
  const double half = t_quantile(values.size(), alpha) * m.error / m.mean / 3.0;
  const double low = 1.0 + half;
  const double high = 1.0 - half;
  return {m.mean, m.mean / (low * low * low),
          high > 0.0 ? m.mean / (high * high * high) : infinity};
}

Interval rms_interval(std::span<const double> values, double alpha) {
  check(values, alpha);
  const double scale = largest(values);
  if (scale == 0.0) return {0.0, 0.0, values.size() < 2 ? infinity : 0.0};
  std::vector<double> squares(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    squares[i] = (values[i] / scale) * (values[i] / scale);
  }
  const Interval mean = mean_of_nonnegative(squares, alpha);
  return {scale * std::sqrt(mean.estimate), scale * std::sqrt(mean.low),
          scale * std::sqrt(mean.high)};
}

Interval product(std::span<const Factor> factors, double alpha) {
  require(!factors.empty(), "a product needs at least one factor");
  const std::size_t n = factors.front().values.size();
  std::vector<double> influences(n, 0.0);
  double estimate = 1.0;
  for (const Factor& factor : factors) {
    check(factor.values, alpha);
    require(factor.values.size() == n, "paired values must be of one length");
    const Aggregate a = aggregate(factor.values, factor.rms);
    if (!(a.value > 0.0)) return {undefined, -infinity, infinity};
    estimate *= factor.power > 0 ? a.value : 1.0 / a.value;
    for (std::size_t i = 0; i < n; ++i) influences[i] += factor.power * a.relative_influence[i];
  }
  if (!std::isfinite(estimate)) return {undefined, -infinity, infinity};
  if (n < 2) return {estimate, 0.0, infinity};
  const double half = t_quantile(n, alpha) * error_of(influences, 1.0);
  return {estimate, estimate * std::exp(-half), estimate * std::exp(half)};
}

Interval ratio_of_rms(std::span<const double> a, std::span<const double> b, double alpha) {
  const Factor factors[] = {{a, true, 1}, {b, true, -1}};
  return product(factors, alpha);
}

Interval ratio_of_means(std::span<const double> a, std::span<const double> b, double alpha) {
  const Factor factors[] = {{a, false, 1}, {b, false, -1}};
  return product(factors, alpha);
}

Interval difference_of_rms(std::span<const double> a, std::span<const double> b, double alpha) {
  check(a, b, alpha);
  const Aggregate of_a = aggregate(a, true);
  const Aggregate of_b = aggregate(b, true);
  const double estimate = of_a.value - of_b.value;
  if (a.size() < 2) return {estimate, -infinity, infinity};
  const double scale = std::max(of_a.value, of_b.value);
  if (scale == 0.0) return {estimate, estimate, estimate};
  std::vector<double> influences(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    influences[i] =
        of_a.value * of_a.relative_influence[i] - of_b.value * of_b.relative_influence[i];
  }
  const double half = t_quantile(a.size(), alpha) * error_of(influences, scale);
  return {estimate, estimate - half, estimate + half};
}

Interval median(std::span<const double> values, double alpha) {
  require(!values.empty(), "an interval needs at least one value");
  require(alpha > 0.0 && alpha < 1.0, "alpha must be in (0, 1)");
  std::vector<double> sorted(values.begin(), values.end());
  for (const double value : sorted) require(!std::isnan(value), "values must be numbers");
  std::sort(sorted.begin(), sorted.end());
  const std::size_t n = sorted.size();
  const double below = sorted[(n - 1) / 2];
  const double above = sorted[n / 2];
  Interval result{below == above ? below : 0.5 * (below + above), -infinity, infinity};
  // The median lies below the k-th smallest if fewer than k values do: a binomial of n halves.
  const boost::math::binomial_distribution<double, Policy> halves(static_cast<double>(n), 0.5);
  std::size_t k = 0;  // the largest with P(fewer than k) at most alpha / 2
  for (std::size_t step = std::bit_floor(n); step > 0; step /= 2) {
    const std::size_t candidate = k + step;
    if (candidate > n / 2) continue;
    if (cdf(halves, static_cast<double>(candidate - 1)) <= 0.5 * alpha) k = candidate;
  }
  if (k > 0) {
    result.low = sorted[k - 1];
    result.high = sorted[n - k];
  }
  return result;
}

Interval share(std::size_t successes, std::size_t n, double alpha) {
  require(n >= 1 && successes <= n, "a share needs at least one trial");
  require(alpha > 0.0 && alpha < 1.0, "alpha must be in (0, 1)");
  const double z =
      quantile(complement(boost::math::normal_distribution<double, Policy>(), alpha / 2.0));
  const auto trials = static_cast<double>(n);
  const double p = static_cast<double>(successes) / trials;
  const double weight = 1.0 / (1.0 + z * z / trials);
  const double center = weight * (p + z * z / (2.0 * trials));
  const double half =
      weight * z * std::sqrt(p * (1.0 - p) / trials + z * z / (4.0 * trials * trials));
  // At the ends of the range the interval touches them exactly, not but for rounding.
  return {p, successes == 0 ? 0.0 : center - half, successes == n ? 1.0 : center + half};
}

Interval anees_band(int n, int runs, double alpha, std::size_t comparisons) {
  require(n >= 1 && runs >= 1 && comparisons >= 1, "a band needs a dimension, runs, comparisons");
  require(alpha > 0.0 && alpha < 1.0, "alpha must be in (0, 1)");
  const double freedom = static_cast<double>(n) * runs;
  const double tail = alpha / static_cast<double>(comparisons) / 2.0;
  const boost::math::chi_squared_distribution<double, Policy> distribution(freedom);
  return {1.0, quantile(distribution, tail) / freedom,
          quantile(complement(distribution, tail)) / freedom};
}

double slope(std::span<const double> x, std::span<const double> y) {
  require(x.size() == y.size() && x.size() >= 2, "a slope needs two points or more");
  const auto n = static_cast<double>(x.size());
  double mean_x = 0.0;
  double mean_y = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    mean_x += x[i] / n;
    mean_y += y[i] / n;
  }
  double xx = 0.0;
  double xy = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += (x[i] - mean_x) * (x[i] - mean_x);
    xy += (x[i] - mean_x) * (y[i] - mean_y);
  }
  require(xx > 0.0, "a slope needs two different x");
  return xy / xx;
}

}  // namespace hearsay::analysis
