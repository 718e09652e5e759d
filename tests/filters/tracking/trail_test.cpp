// Trails against dense algebra and closed forms, and two targets whose states are equal.
#include "filters/tracking/trail.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "filters/tracking/association.hpp"
#include "filters/tracking/tracker.hpp"
#include "tests/filters/gaussian/dense_trajectory.hpp"
#include "tests/filters/gaussian/samples.hpp"

namespace hearsay::tracking {
namespace {

using gaussian::Belief;
using gaussian::Matrix;
using gaussian::PositionMeasurement;
using gaussian::stream;
using gaussian::Trajectory;
using gaussian::Vector;
using gaussian::vector;
using gaussian::white_noise_acceleration;

constexpr gaussian::Stamp second = 1'000'000'000;
constexpr std::uint32_t peer = 1;

/// P(χ² > x) with an even number of degrees: Poisson's probability of less than half as many.
double exceeds(double x, int degrees) {
  double term = std::exp(-0.5 * x), sum = 0.0;
  for (int j = 0; j < degrees / 2; ++j) {
    sum += term;
    term *= 0.5 * x / (j + 1);
  }
  return sum;
}

TEST(EquivalentGate, IsExceededAsRarelyAsTheGateOfOneState) {
  for (const int n : {4, 6}) {
    EXPECT_NEAR(equivalent_gate(9.0, n, n), 9.0, 1e-12);
    for (const double gate : {4.0, 9.0, 16.0}) {
      for (const int steps : {2, 5, 20, 100}) {
        const double probability = exceeds(gate, n);
        EXPECT_NEAR(exceeds(equivalent_gate(gate, n, n * steps), n * steps), probability,
                    0.06 * probability)
            << n << " " << gate << " " << steps;
      }
    }
  }
}

/// Seen at some of the stamps 0, 1, …, and always at the first two and the last.
Trajectory seen(Stream& random, const Vector& start, int stamps) {
  Matrix M = Matrix::Zero(2, 4);
  M(0, 0) = M(1, 1) = 1.0;
  Trajectory t(4, 0);
  for (int k = 0; k < stamps; ++k) {
    if (k > 1 && k + 1 < stamps && random.bernoulli(0.3)) continue;
    if (k > 0) {
      t.augment(k, white_noise_acceleration(2, static_cast<double>(k - t.stamps().back()), 0.2));
    }
    const Vector z = start.head(2) + k * start.tail(2) + gaussian::random_vector(random, 2);
    t.update(t.steps() - 1, gaussian::measurement_information(M, Matrix::Identity(2, 2), z));
  }
  return t;
}

/// d² over common stamps from the inverse of the whole matrices, and how many there are.
std::pair<double, int> dense_distance(const Trajectory& a, const Trajectory& b) {
  const Eigen::MatrixXd A = dense(a).inverse(), B = dense(b).inverse();
  const Eigen::VectorXd mean_a = A * dense_vector(a), mean_b = B * dense_vector(b);
  std::vector<int> of_a, of_b;
  for (int k = 0; k < a.steps(); ++k) {
    const auto l = b.find(a.stamps()[static_cast<std::size_t>(k)]);
    if (!l) continue;
    for (int i = 0; i < 4; ++i) of_a.push_back(4 * k + i);
    for (int i = 0; i < 4; ++i) of_b.push_back(4 * *l + i);
  }
  const Eigen::VectorXd difference = mean_a(of_a) - mean_b(of_b);
  const Eigen::MatrixXd sum = A(of_a, of_a) + B(of_b, of_b);
  return {difference.dot(sum.inverse() * difference), static_cast<int>(of_a.size()) / 4};
}

TEST(TrailSeparation, IsTheDenseDistanceInTheUnitOfTheGate) {
  Stream random = stream("separation");
  for (int trial = 0; trial < 20; ++trial) {
    const Trajectory a = seen(random, vector({0, 0, 1, 0}), 12);
    const Trajectory b = seen(random, vector({0, trial % 3 * 2.0, 1, 0}), 10);
    const auto [squared, stamps] = dense_distance(a, b);
    const double expected = squared * 9.0 / equivalent_gate(9.0, 4, 4 * stamps);
    EXPECT_NEAR(trail_separation(a, b, 9.0).value(), expected, 1e-8 * expected);
  }
}

TEST(TrailSeparation, WithoutCommonStampsIsNothing) {
  Stream random = stream("stamps");
  const Trajectory a = seen(random, vector({0, 0, 1, 0}), 5);
  Trajectory b(4, 100);
  b.update(0, gaussian::random_belief(random, 4));
  EXPECT_FALSE(trail_separation(a, b, 9.0));
}

// Four targets side by side, seen by two, told in another order.
TEST(TrailSeparation, PairsTrailsAsTheBestOfAllOrdersByDenseDistances) {
  Stream random = stream("orders");
  for (int trial = 0; trial < 10; ++trial) {
    std::vector<Trajectory> mine, theirs;
    for (int i = 0; i < 4; ++i) {
      mine.push_back(seen(random, vector({0, 1.5 * i, 1, 0}), 10));
      theirs.push_back(seen(random, vector({0, 1.5 * (3 - i), 1, 0}), 10));
    }
    Table costs(4, 4);
    std::vector<std::vector<double>> dense_costs(4, std::vector<double>(4));
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < 4; ++j) {
        const auto row = static_cast<std::size_t>(i), column = static_cast<std::size_t>(j);
        costs(i, j) = trail_separation(theirs[row], mine[column], 9.0).value();
        const auto [squared, stamps] = dense_distance(theirs[row], mine[column]);
        dense_costs[row][column] =
            std::min(100.0, squared * 9.0 / equivalent_gate(9.0, 4, 4 * stamps));
      }
    }
    std::vector<int> order{0, 1, 2, 3}, best;
    double least = 1e9;
    do {
      double cost = 0.0;
      for (std::size_t i = 0; i < 4; ++i) {
        cost += dense_costs[i][static_cast<std::size_t>(order[i])];
      }
      if (cost < least) {
        least = cost;
        best = order;
      }
    } while (std::next_permutation(order.begin(), order.end()));
    EXPECT_EQ(pair_within(costs, 100.0, Pairing::optimal), best);
  }
}

PositionMeasurement plot(Stream& random, double x, double y, double sigma) {
  return {vector({x + sigma * random.normal(), y + sigma * random.normal()}),
          Matrix(sigma * sigma * Matrix::Identity(2, 2))};
}

Tracker::Options with_trails(gaussian::Stamp trail) {
  return {.q = 0.5,
          .birth_speed_sigma = 20,
          .gate = 16,
          .pairing = Pairing::optimal,
          .confirm_hits = 1,
          .confirm_scans = 1,
          .rule = gaussian::Rule::ci_det,
          .trail = trail};
}

TEST(Trail, SaysOfThePresentWhatTheTrackSays) {
  Stream random = stream("present");
  Tracker tracker(with_trails(5 * second), 0);
  for (int k = 0; k < 30; ++k) {
    if (k % 7 == 3) {
      tracker.scan(k * second, {});  // missed
      continue;
    }
    tracker.scan(k * second, std::vector{plot(random, 3.0 * k, 0.1 * k * k, 1.0)});
    ASSERT_EQ(tracker.tracks().size(), 1u);
    const Track& track = tracker.tracks()[0];
    ASSERT_TRUE(track.trail);
    const Belief now = gaussian::present(*track.trail);
    EXPECT_LE(gaussian::relative(now.omega, track.belief.omega), 1e-9);
    EXPECT_LE(gaussian::relative(now.xi, track.belief.xi), 1e-9);
    EXPECT_GE(track.trail->stamps().front(), (k - 5) * second);
    EXPECT_EQ(track.trail->stamps().back(), k * second);
  }
  EXPECT_EQ(tracker.reports()[0].trail->stamps().size(), 5u);  // 24 missed
}

TEST(Trail, IsOfOwnPlotsAlone) {
  Stream random = stream("own");
  Tracker a(with_trails(5 * second), 0), b(with_trails(5 * second), 0);
  a.scan(0, std::vector{plot(random, 0, 0, 1.0)});
  b.heard(peer, 0, a.reports());
  ASSERT_EQ(b.tracks().size(), 1u);
  EXPECT_FALSE(b.tracks()[0].trail);
  b.scan(second, std::vector{plot(random, 0, 0, 1.0)});
  ASSERT_EQ(b.tracks().size(), 1u);
  ASSERT_TRUE(b.tracks()[0].trail);
  EXPECT_EQ(b.tracks()[0].trail->steps(), 1);
}

/// How often two tracks were paired with the right ones, how often crosswise.
struct Pairs {
  int right = 0, wrong = 0;
  /// Of trackers that number the same two targets in opposite order.
  void count(const LabelTable& labels) {
    right += labels.mine_of(peer, 0) == 1u && labels.mine_of(peer, 1) == 0u;
    wrong += labels.mine_of(peer, 0) == 0u && labels.mine_of(peer, 1) == 1u;
  }
};

// Two targets at (20t, ±t³/100): at t = 0 they have the same place, velocity and acceleration. Two
// trackers have watched them for ten seconds and begin to talk at that instant.
Pairs of_those_that_meet(gaussian::Stamp trail, int draws) {
  Stream random = stream("meeting");
  Pairs out;
  for (int draw = 0; draw < draws; ++draw) {
    Tracker a(with_trails(trail), -11 * second), b(with_trails(trail), -11 * second);
    for (int t = -10; t <= 0; ++t) {
      const double x = 20.0 * t, y = 0.01 * t * t * t;
      a.scan(t * second, std::vector{plot(random, x, y, 0.5), plot(random, x, -y, 0.5)});
      b.scan(t * second, std::vector{plot(random, x, -y, 0.5), plot(random, x, y, 0.5)});
    }
    b.heard(peer, 0, a.reports());
    out.count(b.labels());
  }
  return out;
}

TEST(Trail, TellsTargetsApartWhereTheirStatesAreEqual) {
  const int draws = 200;
  const Pairs by_trails = of_those_that_meet(10 * second, draws);
  const Pairs by_states = of_those_that_meet(0, draws);
  EXPECT_GT(by_states.wrong, draws / 4);
  EXPECT_EQ(by_trails.wrong, 0);
  EXPECT_GT(by_trails.right, draws * 9 / 10);
}

// Two targets 6 m apart on parallel ways. What a says is half a minute old when b hears it: moved
// on to now it could mean either; of the past both know enough.
Pairs of_those_told_late(gaussian::Stamp trail, int draws) {
  Stream random = stream("late");
  Pairs out;
  for (int draw = 0; draw < draws; ++draw) {
    Tracker::Options options = with_trails(trail);
    options.sigma_max = 1000;
    Tracker a(options, -1 * second), b(options, -1 * second);
    for (int t = 0; t <= 40; ++t) {
      const double x = 10.0 * t;
      if (t <= 10)
        a.scan(t * second, std::vector{plot(random, x, 3, 0.5), plot(random, x, -3, 0.5)});
      b.scan(t * second, std::vector{plot(random, x, -3, 0.5), plot(random, x, 3, 0.5)});
    }
    b.heard(peer, 10 * second, a.reports());
    out.count(b.labels());
  }
  return out;
}

TEST(Trail, TellsTargetsApartOfWhichItHearsLate) {
  const int draws = 100;
  const Pairs by_trails = of_those_told_late(40 * second, draws);
  const Pairs by_states = of_those_told_late(0, draws);
  EXPECT_GT(by_states.wrong, draws / 10);
  EXPECT_EQ(by_trails.right, draws);
}

}  // namespace
}  // namespace hearsay::tracking
