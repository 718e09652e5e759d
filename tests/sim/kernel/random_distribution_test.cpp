// How the numbers are distributed. Seeds are fixed, so a test passes always or never; the bounds
// are quantiles of the statistic for a right generator, each crossed with probability below 1e-4.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <vector>

#include "sim/kernel/random.hpp"

namespace hearsay {
namespace {

constexpr int draws = 200'000;
constexpr double sigmas = 4.0;

Stream stream_for(const char* purpose) { return Stream(2024, Purpose(purpose), Entity::agent(0)); }

template <class Draw>
std::vector<double> sample(Draw draw) {
  std::vector<double> values(draws);
  for (double& value : values) value = draw();
  return values;
}

// √n times the largest distance between the sample's distribution and `cdf` (Kolmogorov–Smirnov).
template <class Cdf>
double distance(std::vector<double> values, Cdf cdf) {
  std::sort(values.begin(), values.end());
  const double n = static_cast<double>(values.size());
  double largest = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double p = cdf(values[i]);
    largest = std::max({largest, std::fabs(p - static_cast<double>(i) / n),
                        std::fabs(static_cast<double>(i + 1) / n - p)});
  }
  return std::sqrt(n) * largest;
}
constexpr double distance_max = 2.23;  // 2 exp(−2 x²) = 1e-4

// Mean of x^power, which for a right generator has the given expectation and variance.
void expect_moment(const std::vector<double>& values, int power, double mean, double variance) {
  double sum = 0.0;
  for (const double value : values) sum += std::pow(value, power);
  EXPECT_NEAR(sum / values.size(), mean, sigmas * std::sqrt(variance / values.size()))
      << "moment " << power;
}

TEST(UniformDraws, AreUniform) {
  Stream stream = stream_for("uniform");
  const std::vector<double> values = sample([&] { return stream.uniform(); });
  EXPECT_GE(*std::min_element(values.begin(), values.end()), 0.0);
  EXPECT_LT(*std::max_element(values.begin(), values.end()), 1.0);
  EXPECT_LT(distance(values, [](double x) { return x; }), distance_max);
  for (int k = 1; k <= 4; ++k) {
    const double mean = 1.0 / (k + 1);
    expect_moment(values, k, mean, 1.0 / (2 * k + 1) - mean * mean);
  }
}

TEST(UniformDraws, OfAnIntervalAreUniformOnIt) {
  Stream stream = stream_for("interval");
  const std::vector<double> values = sample([&] { return stream.uniform(-3.0, 5.0); });
  EXPECT_LT(distance(values, [](double x) { return (x + 3) / 8; }), distance_max);
}

TEST(NormalDraws, AreNormal) {
  Stream stream = stream_for("normal");
  const std::vector<double> values = sample([&] { return stream.normal(); });
  EXPECT_LT(distance(values, [](double x) { return 0.5 * std::erfc(-x / std::sqrt(2.0)); }),
            distance_max);
  // E x^2k = (2k − 1)!!, so the variances of the moments are 1, 3 − 1, 15, 105 − 9.
  expect_moment(values, 1, 0.0, 1.0);
  expect_moment(values, 2, 1.0, 2.0);
  expect_moment(values, 3, 0.0, 15.0);
  expect_moment(values, 4, 3.0, 96.0);
}

TEST(NormalDraws, ThatFollowEachOtherAreUncorrelated) {
  Stream stream = stream_for("pairs");
  double first = 0.0;
  double squares = 0.0;
  for (int i = 0; i < draws; ++i) {
    const double x = stream.normal();
    const double y = stream.normal();
    first += x * y;
    squares += (x * x - 1) * (y * y - 1);
  }
  EXPECT_NEAR(first / draws, 0.0, sigmas / std::sqrt(draws));
  EXPECT_NEAR(squares / draws, 0.0, sigmas * 2 / std::sqrt(draws));
}

TEST(NormalDraws, TakeMeanAndSigma) {
  Stream stream = stream_for("scaled");
  const std::vector<double> values = sample([&] { return stream.normal(7.0, 3.0); });
  EXPECT_LT(
      distance(values, [](double x) { return 0.5 * std::erfc(-(x - 7) / 3 / std::sqrt(2.0)); }),
      distance_max);
}

TEST(ExponentialDraws, AreExponential) {
  Stream stream = stream_for("exponential");
  const std::vector<double> values = sample([&] { return stream.exponential(2.5); });
  EXPECT_GE(*std::min_element(values.begin(), values.end()), 0.0);
  EXPECT_LT(distance(values, [](double x) { return -std::expm1(-2.5 * x); }), distance_max);
  expect_moment(values, 1, 0.4, 0.16);
  expect_moment(values, 2, 0.32, 0.0256 * 24 - 0.32 * 0.32);
}

TEST(BernoulliDraws, AreTrueAsOftenAsTheyShould) {
  for (const double p : {0.01, 0.3, 0.9}) {
    Stream stream = stream_for("bernoulli");
    int count = 0;
    for (int i = 0; i < draws; ++i) count += stream.bernoulli(p) ? 1 : 0;
    EXPECT_NEAR(count, draws * p, sigmas * std::sqrt(draws * p * (1 - p)));
  }
}

// (χ² − degrees of freedom)/σ of counts against expected ones; cells below 10 are put together.
double chi_square_excess(const std::map<std::uint64_t, int>& counts,
                         const std::map<std::uint64_t, double>& expected) {
  double chi_square = 0.0;
  double pending_expected = 0.0;
  double pending_count = 0.0;
  double all = 0.0;
  int cells = 0;
  double seen = 0.0;
  for (const auto& [value, mass] : expected) {
    const auto found = counts.find(value);
    pending_count += found == counts.end() ? 0 : found->second;
    pending_expected += mass;
    all += mass;
    if (pending_expected < 10) continue;
    chi_square +=
        (pending_count - pending_expected) * (pending_count - pending_expected) / pending_expected;
    seen += pending_count;
    pending_count = pending_expected = 0.0;
    ++cells;
  }
  // What is left over, and what lies outside the table, is one more cell.
  const double rest_expected = draws - all + pending_expected;
  const double rest = draws - seen;
  chi_square += (rest - rest_expected) * (rest - rest_expected) / std::max(rest_expected, 1.0);
  return (chi_square - cells) / std::sqrt(2.0 * cells);
}

TEST(BelowDraws, AreUniformOverTheNumbers) {
  for (const std::uint64_t n : {2u, 6u, 37u, 1000u}) {
    Stream stream = stream_for("below");
    std::map<std::uint64_t, int> counts;
    for (int i = 0; i < draws; ++i) ++counts[stream.below(n)];
    EXPECT_LT(counts.rbegin()->first, n);
    std::map<std::uint64_t, double> expected;
    for (std::uint64_t k = 0; k < n; ++k) expected[k] = static_cast<double>(draws) / n;
    EXPECT_LT(chi_square_excess(counts, expected), 5.0) << "n = " << n;
  }
}

TEST(PoissonDraws, ArePoissonOnBothSidesOfTheChangeOfMethod) {
  for (const double mean : {0.01, 0.5, 3.0, 9.99, 10.0, 12.5, 50.0, 1000.0, 12345.6}) {
    Stream stream = stream_for("poisson");
    std::map<std::uint64_t, int> counts;
    double sum = 0.0;
    double squares = 0.0;
    for (int i = 0; i < draws; ++i) {
      const std::uint64_t k = stream.poisson(mean);
      ++counts[k];
      sum += static_cast<double>(k) - mean;
      squares += (static_cast<double>(k) - mean) * (static_cast<double>(k) - mean);
    }
    EXPECT_NEAR(sum / draws, 0.0, sigmas * std::sqrt(mean / draws)) << "mean " << mean;
    // Fourth central moment of a Poisson variable: m + 3 m².
    EXPECT_NEAR(squares / draws, mean, sigmas * std::sqrt((mean + 2 * mean * mean) / draws))
        << "mean " << mean;

    std::map<std::uint64_t, double> expected;
    const double width = 8 * std::sqrt(mean) + 10;
    for (double k = std::max(0.0, std::floor(mean - width)); k <= mean + width; ++k) {
      expected[static_cast<std::uint64_t>(k)] =
          draws * std::exp(k * std::log(mean) - mean - std::lgamma(k + 1));
    }
    EXPECT_LT(chi_square_excess(counts, expected), 5.0) << "mean " << mean;
  }
}

TEST(PoissonDraws, OfTheLargestMeanHaveItsMoments) {
  Stream stream = stream_for("large poisson");
  const double mean = 1e9;
  double sum = 0.0;
  double squares = 0.0;
  for (int i = 0; i < draws; ++i) {
    const double x = (static_cast<double>(stream.poisson(mean)) - mean) / std::sqrt(mean);
    sum += x;
    squares += x * x;
  }
  EXPECT_NEAR(sum / draws, 0.0, sigmas / std::sqrt(draws));
  EXPECT_NEAR(squares / draws, 1.0, sigmas * std::sqrt(2.0 / draws));
}

TEST(KeyedDraws, OfNeighbouringCountsAndEntitiesAreIndependent) {
  // One draw each from a short stream: uniform over counts, over entities, and uncorrelated.
  std::vector<double> over_counts;
  std::vector<double> over_agents;
  double correlation = 0.0;
  for (int i = 0; i < draws; ++i) {
    over_counts.push_back(
        Stream::at(5, Purpose("loss"), Entity::link(0, 1), static_cast<std::uint64_t>(i))
            .uniform());
    over_agents.push_back(Stream(5, Purpose("loss"), Entity::agent(i)).uniform());
    if (i > 0) correlation += (over_counts[i] - 0.5) * (over_counts[i - 1] - 0.5);
  }
  EXPECT_LT(distance(over_counts, [](double x) { return x; }), distance_max);
  EXPECT_LT(distance(over_agents, [](double x) { return x; }), distance_max);
  EXPECT_NEAR(correlation / draws, 0.0, sigmas / 12 / std::sqrt(draws));
}

}  // namespace
}  // namespace hearsay
