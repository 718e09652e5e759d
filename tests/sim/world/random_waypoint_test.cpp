// Random waypoint against its stationary law.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/kernel/random.hpp"
#include "sim/world/motion.hpp"
#include "tests/sim/world/samples.hpp"

namespace hearsay::motion {
namespace {

constexpr RandomWaypoint wander{
    .area = square, .speed_min_m_per_s = 2.0, .speed_max_m_per_s = 20.0};
constexpr double unit_mean = 0.521405433;  // of the distance of two places in the unit square

// Distribution along x of random waypoint in the unit square, by integrating its density,
//     f(r) = ∫₀^π a b (a + b) dφ / mean distance,
// a and b being the ways from r to the edge in the directions φ and φ + π: E. Hyytiä, P. Lassila,
// J. Virtamo, Spatial node distribution of the random waypoint mobility model with applications,
// IEEE Trans. Mobile Computing 5(6), 2006, theorem 1.
class WaypointLaw {
 public:
  WaypointLaw() {
    for (std::size_t i = 0; i < cells; ++i) {
      double density = 0.0;
      for (std::size_t j = 0; j < cells; ++j) {
        density += at((i + 0.5) / cells, (j + 0.5) / cells) / cells;
      }
      cumulated[i + 1] = cumulated[i] + density / cells;
    }
  }
  double cdf(double x) const {
    const double place = std::clamp(x, 0.0, 1.0) * cells;
    const auto i = std::min(static_cast<std::size_t>(place), cells - 1);
    return cumulated[i] + (place - static_cast<double>(i)) * (cumulated[i + 1] - cumulated[i]);
  }
  double total() const { return cumulated[cells]; }

 private:
  static double at(double x, double y) {
    constexpr int angles = 128;
    double sum = 0.0;
    for (int k = 0; k < angles; ++k) {
      const double c = std::cos(pi * (k + 0.5) / angles), s = std::sin(pi * (k + 0.5) / angles);
      const double a = std::min((c > 0 ? 1 - x : -x) / c, (1 - y) / s);
      const double b = std::min((c > 0 ? x : x - 1) / c, y / s);
      sum += a * b * (a + b) * pi / angles;
    }
    return sum / unit_mean;
  }
  static constexpr std::size_t cells = 100;
  std::array<double, cells + 1> cumulated{};
};

double polynomial_cdf(double x) { return x * x * (3 - 2 * x); }  // of 6 x (1 − x)

TEST(RandomWaypoint, ItsLawIsNearlyTheKnownPolynomial) {
  const WaypointLaw law;
  EXPECT_NEAR(law.total(), 1.0, 1e-3);
  double largest = 0.0;
  for (double x = 0; x <= 1; x += 0.01) {
    largest = std::max(largest, std::fabs(law.cdf(x) / law.total() - polynomial_cdf(x)));
  }
  // 36 x (1 − x) y (1 − y) is an approximation; along x it is wrong by this much.
  EXPECT_NEAR(largest, 0.0112, 0.0002);
}

TEST(RandomWaypoint, PlacesHaveTheStationaryLawAtAnyTime) {
  const WaypointLaw law;
  const auto cdf = [&](double x) { return law.cdf(x) / law.total(); };
  for (const double time_s : {0.0, 3.0, 40.0}) {
    const Sample x = sample(wander, time_s, x_of);
    const Sample y = sample(wander, time_s, y_of);
    EXPECT_LT(distance(x, cdf), distance_max) << time_s << " s";
    EXPECT_LT(distance(y, cdf), distance_max) << time_s << " s";
    EXPECT_GT(distance(x, [](double u) { return u; }), 5.0) << "even";
    EXPECT_NEAR(correlation(x, y), 0.0, 4.0 / std::sqrt(agents)) << time_s << " s";
  }
}

TEST(RandomWaypoint, SpeedsHaveTheStationaryLawAtAnyTime) {
  const auto cdf = [](double v) { return std::log(v / 2.0) / std::log(10.0); };
  for (const double time_s : {0.0, 3.0, 40.0}) {
    const Sample speeds = sample(wander, time_s, speed_of);
    expect_mean(speeds, 18.0 / std::log(10.0));
    EXPECT_LT(distance(speeds, cdf), distance_max) << time_s << " s";
  }
}

TEST(RandomWaypoint, TheRestOfATripHasTheStationaryLawAtAnyTime) {
  // Of a trip chosen in proportion to its length d: E d² / (2 E d), E d² = 1/3 in the unit square.
  for (const double time_s : {0.0, 3.0, 40.0}) {
    const Sample rest = sample(wander, time_s, [](const Leg& leg, const Point& here) {
      return std::sqrt(squared_distance_m2(leg.at(leg.end), here)) / side_m;
    });
    expect_mean(rest, 1.0 / 6.0 / unit_mean);
  }
}

TEST(RandomWaypoint, TripsHaveTheMeanDistanceOfTwoPlaces) {
  Sample trips_m;
  for (AgentId a = 0; a < agents; ++a) {
    const auto motion = make(wander, 1, a);
    // What is left of a long trip, whose end favours the rim, and the trip from there.
    for (int k = 0; k < 2; ++k) motion->next();
    const Leg leg = motion->next();
    trips_m.push_back(std::sqrt(squared_distance_m2(leg.from_m, leg.at(leg.end))));
  }
  expect_mean(trips_m, side_m * unit_mean);
  EXPECT_NEAR(Moments(trips_m).mean / side_m, 0.5214, 0.008);
}

TEST(RandomWaypoint, PausesHaveTheStationaryLawAtAnyTime) {
  RandomWaypoint resting = wander;
  resting.pause_min = 2_s;
  resting.pause_max = 10_s;
  const double trip_s = side_m * unit_mean * std::log(10.0) / 18.0;
  const double pausing = 6.0 / (6.0 + trip_s);
  // What is left of a pause of length p is denser than q by P(p > q) / E p.
  const auto left_cdf = [](double q) {
    return q < 2.0 ? q / 6.0 : 1.0 - (10.0 - q) * (10.0 - q) / 16.0 / 6.0;
  };
  const WaypointLaw law;
  const auto x_cdf = [&](double x) {
    return pausing * x + (1.0 - pausing) * law.cdf(x) / law.total();
  };
  for (const double time_s : {0.0, 5.0, 60.0}) {
    Sample left_s;
    sample(resting, time_s, [&](const Leg& leg, const Point&) {
      if (leg.velocity_m_per_s == Point{}) left_s.push_back((leg.end - at_s(time_s)).seconds());
      return 0.0;
    });
    EXPECT_NEAR(static_cast<double>(left_s.size()) / agents, pausing,
                4.0 * std::sqrt(pausing * (1.0 - pausing) / agents));
    EXPECT_LT(distance(left_s, left_cdf), distance_max) << time_s << " s";
    EXPECT_LT(distance(sample(resting, time_s, x_of), x_cdf), distance_max) << time_s << " s";
  }
}

TEST(RandomWaypoint, ALongPathSpendsItsTimeAsTheLawSays) {
  // Another way to the same: averages over one path, cut into blocks that are nearly independent.
  RandomWaypoint resting = wander;
  resting.pause_max = 6_s;
  const double trip_s = side_m * unit_mean * std::log(10.0) / 18.0;
  Sample pausing, travelled_m;
  const auto motion = make(resting, 3, 0);
  for (int block = 0; block < 400; ++block) {
    double rest_s = 0.0, all_s = 0.0, way_m = 0.0;
    for (int k = 0; k < 200; ++k) {
      const Leg leg = motion->next();
      const double span_s = (leg.end - leg.begin).seconds();
      all_s += span_s;
      if (leg.velocity_m_per_s == Point{}) rest_s += span_s;
      way_m += span_s * length_m(leg.velocity_m_per_s);
    }
    pausing.push_back(rest_s / all_s);
    travelled_m.push_back(way_m / 100.0);
  }
  // A ratio of means of 100 trips and pauses is biased by some 1e-4, far less than its error.
  expect_mean(pausing, 3.0 / (3.0 + trip_s));
  expect_mean(travelled_m, side_m * unit_mean);
}

TEST(MeanDistance, IsThatOfPlacesDrawn) {
  EXPECT_NEAR(mean_distance_m(1, 1), unit_mean, 1e-9);
  EXPECT_NEAR(mean_distance_m(7, 7), 7 * unit_mean, 1e-8);
  // A thin rectangle is a segment: a third of its length.
  EXPECT_NEAR(mean_distance_m(3, 1e-7), 1.0, 1e-9);
  EXPECT_EQ(mean_distance_m(2, 5), mean_distance_m(5, 2));
  Stream stream(1, Purpose("places"), Entity::agent(0));
  Sample distances;
  for (int i = 0; i < 200'000; ++i) {
    distances.push_back(std::hypot(5 * (stream.uniform() - stream.uniform()),
                                   2 * (stream.uniform() - stream.uniform())));
  }
  expect_mean(distances, mean_distance_m(5, 2));
}

TEST(RandomWaypoint, DependsOnSeedAndAgentAndNotOnWhoLooks) {
  RandomWaypoint resting = wander;
  resting.pause_max = 3_s;
  expect_reproducible(wander);
  expect_reproducible(resting);
}

TEST(RandomWaypoint, OfDifferentAgentsIsIndependent) {
  for (const double time_s : {0.0, 20.0}) expect_independent(wander, time_s);
}

}  // namespace
}  // namespace hearsay::motion
