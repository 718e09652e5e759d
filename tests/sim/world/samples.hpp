// Random motions as samples: one value an agent, and what its law says of it. Seeds are fixed, so a
// test passes always or never; a right motion would fail a bound with probability below 1e-4 (4
// standard errors, or the quantile of the Kolmogorov–Smirnov distance).
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "sim/world/motion.hpp"
#include "tests/sim/world/paths.hpp"

namespace hearsay::motion {

constexpr int agents = 20'000;
constexpr double pi = 3.14159265358979323846;
constexpr Rectangle square{{-50.0, 200.0}, {50.0, 300.0}};  // 100 m a side
constexpr double side_m = 100.0;

using Sample = std::vector<double>;

// √n times the largest distance between the sample's distribution and `cdf`; 2 exp(−2 x²) = 1e-4.
constexpr double distance_max = 2.23;
inline double distance(Sample values, const std::function<double(double)>& cdf) {
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

struct Moments {
  explicit Moments(const Sample& values) {
    for (const double v : values) mean += v / static_cast<double>(values.size());
    for (const double v : values) {
      variance += (v - mean) * (v - mean) / static_cast<double>(values.size());
    }
    error = std::sqrt(variance / static_cast<double>(values.size()));
  }
  double mean = 0.0, variance = 0.0, error = 0.0;
};
inline void expect_mean(const Sample& values, double expected) {
  const Moments m(values);
  EXPECT_NEAR(m.mean, expected, 4.0 * m.error);
}
inline double correlation(const Sample& a, const Sample& b) {
  const Moments ma(a), mb(b);
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - ma.mean) * (b[i] - mb.mean);
  return sum / static_cast<double>(a.size()) / std::sqrt(ma.variance * mb.variance);
}

inline double length_m(const Point& p) { return std::sqrt(squared_distance_m2(p, {})); }

// One value for each agent: of its leg at a time, and where it is then.
template <class Options, class Value>
Sample sample(const Options& options, double time_s, Value value) {
  Sample values;
  for (AgentId a = 0; a < agents; ++a) {
    Path path(make(options, 1, a));
    const Time time = at_s(time_s);
    values.push_back(value(path.leg_at(time), path.at(time)));
  }
  return values;
}
inline const auto x_of = [](const Leg&, const Point& p) {
  return (p[0] - square.min_m[0]) / side_m;
};
inline const auto y_of = [](const Leg&, const Point& p) {
  return (p[1] - square.min_m[1]) / side_m;
};
inline const auto speed_of = [](const Leg& leg, const Point&) {
  return length_m(leg.velocity_m_per_s);
};

template <class Options>
std::vector<Point> places(const Options& options, std::uint64_t seed, AgentId agent, int asked) {
  Path path(make(options, seed, agent));
  std::vector<Point> all;
  for (int k = 0; k <= 600 * asked; ++k) {
    const Point p = path.at(Time::at(100_ms * k / asked));
    if (k % asked == 0) all.push_back(p);
  }
  return all;
}
template <class Options>
void expect_reproducible(const Options& options) {
  const std::vector<Point> path = places(options, 5, 7, 1);
  EXPECT_EQ(path, places(options, 5, 7, 13)) << "asked more often";
  EXPECT_NE(path, places(options, 6, 7, 1));
  EXPECT_NE(path, places(options, 5, 8, 1));
  // Side by side with another one.
  Path mine(make(options, 5, 7)), other(make(options, 5, 8));
  for (int k = 0; k <= 600; ++k) {
    other.at(Time::at(300_ms * k));
    ASSERT_EQ(mine.at(Time::at(100_ms * k)), path[static_cast<std::size_t>(k)]);
  }
}
template <class Options>
void expect_independent(const Options& options, double time_s) {
  const Sample x = sample(options, time_s, x_of);
  EXPECT_NEAR(correlation(Sample(x.begin(), x.end() - 1), Sample(x.begin() + 1, x.end())), 0.0,
              4.0 / std::sqrt(agents));
}

}  // namespace hearsay::motion
