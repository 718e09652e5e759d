// Estimators of moving states: when there is news, and what is said instead of whole beliefs.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "agents/estimators/gaussian.hpp"
#include "tests/filters/gaussian/samples.hpp"

namespace hearsay {
namespace {

using namespace gaussian;
using Dense = Eigen::MatrixXd;
using Options = GaussianEstimator::Options;

constexpr std::int64_t step_ns = 500'000'000;

MotionModel model() {
  return {.step = white_noise_acceleration(2, 0.5, 0.4), .period = Duration::seconds(0.5)};
}

Dense position_alone() {
  Dense M = Dense::Zero(2, 4);
  M.leftCols(2).setIdentity();
  return M;
}

/// Estimators of one moving state that all know one another.
class Fleet {
 public:
  Fleet(int agents, Options options) {
    book.set_motion(model().step.R);
    options.dimension = 4;
    options.motion = model();
    options.ledgers = &pool_;
    std::vector<AgentId> ids;
    for (AgentId id = 0; id < agents; ++id) ids.push_back(id);
    for (int i = 0; i < agents; ++i) {
      estimators_.push_back(std::make_unique<GaussianEstimator>(options, ids));
    }
  }
  GaussianEstimator& operator[](int i) { return *estimators_[static_cast<std::size_t>(i)]; }
  const Belief& belief(int i) { return (*this)[i].tracked(0).belief; }
  void advance(std::int64_t now) {
    for (auto& estimator : estimators_) estimator->advance(now);
  }
  /// Sees the position z (2) with covariance S (2×2).
  void measure(int i, const Vector& z, const Matrix& S) {
    const Belief seen = measurement_information(position_alone(), S, z);
    (*this)[i].measured(0, seen, book.add(seen));
  }
  struct Letter {
    std::vector<std::byte> bytes;
    RiderPtr rider;
  };
  Letter letter(int from) {
    Estimator::Speech speech = (*this)[from].speech(no_agent);
    Letter letter{{speech.bytes.begin(), speech.bytes.end()}, std::move(speech.rider)};
    if (!letter.bytes.empty()) (*this)[from].sent(no_agent);
    return letter;
  }
  void hears(int who, int from, const Letter& letter) {
    (*this)[who].heard(from, letter.bytes, letter.rider.get());
  }

  MeasurementBook book{4};

 private:
  LedgerPool pool_;
  std::vector<std::unique_ptr<GaussianEstimator>> estimators_;
};

/// The largest eigenvalue of a against b: a ≤ λb.
double most_ratio(const Dense& a, const Dense& b) {
  return Eigen::GeneralizedSelfAdjointEigenSolver<Dense>(a, b).eigenvalues().maxCoeff();
}

TEST(MovingNews, IsNoneForWhomPredictsTheSame) {
  Fleet fleet(1, {.rule = Rule::ci_det, .exact = false});
  EXPECT_EQ(fleet[0].news_nats(), 0.0);  // there is nothing to say
  std::int64_t now = 0;
  // The first belief is singular: it knows no velocity.
  for (int look = 0; look < 4; ++look) {
    fleet.measure(0, vector({3.0 + look, -1.0}), diagonal({4, 1}));
    EXPECT_GT(fleet[0].news_nats(), 0.0);
    fleet.letter(0);
    for (const std::int64_t end = now + 40; now < end; ++now) {
      fleet.advance(now);
      EXPECT_EQ(fleet[0].news_nats(), 0.0) << now;
    }
    fleet.advance(now += 25);  // nobody asked in between
    EXPECT_EQ(fleet[0].news_nats(), 0.0) << now;
  }
}

// A Kalman filter in covariance form beside it.
TEST(MovingNews, IsTheDivergenceFromThePredictionOfWhatWasLastSaid) {
  Fleet fleet(2, {.rule = Rule::ci_det, .exact = false});
  const Dense A = model().step.A, R = model().step.R, H = position_alone();
  const Matrix S = matrix({{4, 1}, {1, 2}});
  for (int i = 0; i < 2; ++i) {
    fleet[i].advance(i);
    for (const int at : {0, 3}) {
      fleet[i].advance(std::max(at, i));
      fleet.measure(i, vector({2.0 * at, 1.0 - at}), S);
    }
    EXPECT_EQ(fleet[i].news_nats(), std::numeric_limits<double>::infinity());
    fleet.letter(i);
  }
  // The first is asked at every step, the second once.
  Dense P = Dense(fleet.belief(0).omega).inverse();
  Eigen::VectorXd m = P * fleet.belief(0).xi;
  for (int now = 4; now <= 9; ++now) {
    fleet[0].advance(now);
    EXPECT_EQ(fleet[0].news_nats(), 0.0);
    m = A * m;
    P = A * P * A.transpose() + R;
  }
  fleet[1].advance(9);
  const Eigen::Vector2d z(23.0, -4.0);
  fleet.measure(0, z, S);
  fleet.measure(1, z, S);
  const Dense gain = P * H.transpose() * (H * P * H.transpose() + Dense(S)).inverse();
  const Eigen::VectorXd change = gain * (z - H * m);
  const Dense less = P - gain * H * P, inverse = P.inverse();
  const double expected = 0.5 * ((inverse * less).trace() + change.dot(inverse * change) - 4.0 +
                                 std::log(P.determinant() / less.determinant()));
  EXPECT_GT(expected, 0.1);
  EXPECT_NEAR(fleet[0].news_nats(), expected, 1e-9);
  EXPECT_FALSE(fleet[0].tracked(0).ledger.exact());
  const double asked_once = fleet[1].news_nats();
  EXPECT_GT(asked_once, 0.1);
  EXPECT_EQ(asked_once, fleet[1].news_nats());
  fleet.letter(0);
  EXPECT_EQ(fleet[0].news_nats(), 0.0);
}

TEST(MovingNews, WhoForgotHasNoneBeforeItLearns) {
  Fleet fleet(1, {.rule = Rule::ci_det, .exact = false});
  fleet.measure(0, vector({1, 2}), diagonal({1, 1}));
  fleet.letter(0);
  fleet.advance(7);
  fleet[0].forget();
  fleet.advance(9);
  EXPECT_EQ(fleet[0].news_nats(), 0.0);
  fleet.measure(0, vector({1, 2}), diagonal({1, 1}));
  EXPECT_EQ(fleet[0].news_nats(), std::numeric_limits<double>::infinity());
}

/// Looks at a moving state at random until its position and velocity are known.
void look_around(Fleet& fleet, Stream& random, std::int64_t& now) {
  for (int look = 0; look < 4; ++look) {
    fleet.advance(now += 1 + static_cast<std::int64_t>(random.below(4)));
    fleet.measure(0, 100.0 * random_vector(random, 2), random_information(random, 2, 4.0));
  }
}

// What is heard k steps later claims no less than the error of what its user computes: that of the
// belief, and the rounding q of its mean, however they are correlated, and the motion since.
TEST(MovingContents, ClaimNoMoreThanTheBeliefWheneverTheyAreHeard) {
  Stream random = stream("moving contents");
  const Dense A = model().step.A, R = model().step.R;
  for (int trial = 0; trial < 300; ++trial) {
    const bool quantised = trial % 2 == 0;
    const int bits = quantised_bits_min + trial / 2 % 13;
    // A naive listener who knows nothing believes what it hears.
    Fleet fleet(2, {.rule = Rule::naive,
                    .content = quantised ? Content::quantised : Content::diagonal,
                    .bits = bits});
    std::int64_t now = 0;
    look_around(fleet, random, now);
    Dense P = Dense(fleet.belief(0).omega).inverse();
    const Eigen::VectorXd m = *state(fleet.belief(0));
    const Fleet::Letter letter = fleet.letter(0);
    // Stamp 8, header 4, incarnation, count and the number of beliefs 12; subject and length 8.
    // Two vectors of four, each with a length; or two octets and padding, and the bits.
    const std::size_t body = 20 + static_cast<std::size_t>(10 * bits + 7) / 8;
    ASSERT_EQ(letter.bytes.size(),
              quantised ? 8 + 4 + 12 + 4 + 8 + body : 8u + 4 + 12 + 8 + 72 + 4);
    const int later = static_cast<int>(random.below(30));
    fleet.advance(now + later);
    fleet.hears(1, 0, letter);
    ASSERT_EQ(fleet[1].counts().fusions, 1u);

    Eigen::VectorXd predicted = m;
    Dense power = Dense::Identity(4, 4), moved = Dense::Zero(4, 4);
    for (int k = 0; k < later; ++k) {
      predicted = A * predicted;
      power = A * power;
      moved = A * moved * A.transpose() + R;
    }
    const Eigen::VectorXd q = *state(fleet.belief(1)) - predicted;
    const Dense claimed = Dense(fleet.belief(1).omega).inverse();
    Dense error = power * P * power.transpose() + moved;
    if (quantised) {
      const double slack = 1.0 / 4096.0;
      error = (1.0 + slack) * (power * P * power.transpose()) + moved +
              (1.0 + 1.0 / slack) * (q * q.transpose());
    } else {
      EXPECT_LT(q.norm(), 1e-6 * predicted.norm());
    }
    const double ratio = most_ratio(error, claimed);
    EXPECT_LE(ratio, 1.0 + 1e-7) << trial;
    EXPECT_GT(ratio, quantised && bits < 8 ? 0.05 : 0.5) << trial;
  }
}

TEST(MovingContents, PositionsAndVelocitiesMayBeInAnyUnits) {
  Stream random = stream("units");
  for (int trial = 0; trial < 100; ++trial) {
    Fleet fleet(1, {.rule = Rule::naive});
    std::int64_t now = 0;
    look_around(fleet, random, now);
    const Belief belief = fleet.belief(0);
    // Positions in 2^a m, velocities in 2^b m/s: x' = D⁻¹x.
    const int a = static_cast<int>(random.below(40)) - 20;
    const int b = static_cast<int>(random.below(40)) - 20;
    const double p = std::ldexp(1.0, a), v = std::ldexp(1.0, b);
    const Matrix D = diagonal({p, p, v, v});
    const Belief other{Matrix(D * belief.omega * D), Vector(D * belief.xi)};
    const Belief part = *diagonal_part(belief), other_part = *diagonal_part(other);
    EXPECT_LT(relative(other_part.omega, D * part.omega * D), 1e-12);
    const QuantisedBelief grid = *quantise(belief, 6), other_grid = *quantise(other, 6);
    EXPECT_EQ(grid.entries, other_grid.entries);
    EXPECT_EQ(grid.means, other_grid.means);
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_EQ(other_grid.exponents[i], grid.exponents[i] - (i < 2 ? a : b));
    }
  }
}

// The ledger knows the true covariance of diagonals, common motion included.
TEST(MovingContents, DiagonalBeliefsStayConservativeInANetworkAndTheLedgerExact) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Fleet fleet(4, {.rule = Rule::ci_det, .content = Content::diagonal});
    Stream random(seed, Purpose("moving diagonals"), Entity::agent(0));
    double most = 0.0;
    for (std::int64_t now = 0; now < 60; ++now) {
      fleet.advance(now);
      for (int i = 0; i < 4; ++i) {
        if (random.below(3) == 0) {
          fleet.measure(i, random_vector(random, 2), random_information(random, 2, 2.0));
        }
      }
      const int from = static_cast<int>(random.below(4));
      const Fleet::Letter letter = fleet.letter(from);
      if (letter.bytes.empty()) continue;
      fleet.hears((from + 1) % 4, from, letter);
      fleet.hears((from + 3) % 4, from, letter);
      for (int i = 0; i < 4; ++i) {
        const TrackedBelief& tracked = fleet[i].tracked(0);
        const auto P = covariance(tracked.belief);
        if (!P) continue;
        const auto real = true_covariance(tracked.belief.omega, tracked.ledger, fleet.book);
        ASSERT_TRUE(real);
        most = std::max(most, most_ratio(*real, *P));
      }
    }
    EXPECT_LT(most, 1.0 + 1e-7) << seed;
    EXPECT_GT(most, 0.5) << seed;
  }
}

TEST(MovingContents, AfterAQuantisedBeliefTheLedgerIsInexact) {
  Fleet fleet(2, {.rule = Rule::ci_det, .content = Content::quantised});
  for (int now = 0; now < 3; ++now) {
    fleet.advance(now);
    for (int i = 0; i < 2; ++i) fleet.measure(i, vector({1, 2}), diagonal({1, 2.0 + i}));
  }
  EXPECT_TRUE(fleet[1].tracked(0).ledger.exact());
  fleet.hears(1, 0, fleet.letter(0));
  EXPECT_EQ(fleet[1].counts().fusions, 1u);
  EXPECT_FALSE(fleet[1].tracked(0).ledger.exact());
  EXPECT_TRUE(fleet[0].tracked(0).ledger.exact());
}

TEST(MovingContents, OfANewTargetNothingIsSaidBeforeItsVelocityIsKnown) {
  for (const Content content : {Content::diagonal, Content::quantised}) {
    Fleet fleet(1, {.rule = Rule::ci_det, .content = content});
    fleet.measure(0, vector({1, 2}), diagonal({1, 1}));
    EXPECT_TRUE(fleet[0].speech(no_agent).bytes.empty());
    fleet.advance(1);
    fleet.measure(0, vector({1, 2}), diagonal({1, 1}));
    EXPECT_FALSE(fleet[0].speech(no_agent).bytes.empty());
  }
}

TEST(MovingContents, StampsOfTheFutureAndBetweenTheStepsAreRefused) {
  for (const Content content : {Content::diagonal, Content::quantised}) {
    Fleet fleet(2, {.rule = Rule::ci_det, .content = content});
    for (int now = 0; now < 3; ++now) {
      fleet.advance(now);
      fleet.measure(0, vector({1, 2}), diagonal({1, 1}));
    }
    const Fleet::Letter letter = fleet.letter(0);
    const auto with_stamp = [&](std::int64_t stamp) {
      std::vector<std::byte> bytes = letter.bytes;
      for (std::size_t i = 0; i < 8; ++i) {
        bytes[4 + i] = static_cast<std::byte>(static_cast<std::uint64_t>(stamp) >> (8 * i));
      }
      const auto before = fleet[1].counts().refused;
      fleet[1].heard(0, bytes, nullptr);
      return fleet[1].counts().refused == before;
    };
    EXPECT_FALSE(with_stamp(3 * step_ns));
    EXPECT_FALSE(with_stamp(step_ns + 1));
    EXPECT_FALSE(with_stamp(-step_ns));
    EXPECT_TRUE(with_stamp(2 * step_ns));
    std::vector<std::byte> bytes = letter.bytes;
    bytes.pop_back();
    fleet[1].heard(0, bytes, nullptr);
    EXPECT_EQ(fleet[1].counts().refused, 4u);
  }
}

}  // namespace
}  // namespace hearsay
