#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "filters/gaussian/fusion.hpp"
#include "filters/ledger/ledger.hpp"
#include "sim/kernel/error.hpp"
#include "tests/filters/gaussian/samples.hpp"

namespace hearsay {
namespace {

using gaussian::Belief;
using gaussian::Matrix;
using gaussian::matrix;
using gaussian::random_information;
using gaussian::random_matrix;
using gaussian::random_vector;
using gaussian::relative;
using gaussian::stream;
using gaussian::Vector;

/// Weights by hand: ledgers are combined, never written, so count and scale.
void set_weights(Ledger& ledger, const std::vector<double>& weights) {
  ledger.clear();
  for (std::size_t k = 0; k < weights.size(); ++k) {
    Ledger one;
    one.measured(k);
    ledger.combine(1, weights[k], one, 0, nullptr);
  }
}

TEST(TrueCovariance, OfTheCentralFilterIsWhatItClaims) {
  Stream random = stream("central");
  for (int n = 1; n <= gaussian::dimension_max; ++n) {
    MeasurementBook book(n);
    Ledger ledger;
    Belief central = Belief::unknown(n);
    for (int k = 0; k < 20; ++k) {
      const Belief z = gaussian::measurement_information(random_matrix(random, 1, n),
                                                         matrix({{random.uniform(0.5, 2)}}),
                                                         random_vector(random, 1));
      ledger.measured(book.add(z));
      central += z;
    }
    EXPECT_LT(relative(*true_covariance(central.omega, ledger, book), *covariance(central)), 1e-10);
  }
}

TEST(TrueCovariance, CountingEverythingTwiceHalvesTheClaimAndNotTheError) {
  MeasurementBook book(1);
  Ledger ledger;
  for (int k = 0; k < 4; ++k) ledger.measured(book.add({matrix({{0.5}}), Vector::Zero(1)}));
  const Ledger same = ledger;
  ledger.combine(1, 1, same, 0, nullptr);
  const Belief belief = book.weighted_sum(ledger.weights());
  EXPECT_DOUBLE_EQ((*covariance(belief))(0, 0), 0.25);
  EXPECT_DOUBLE_EQ((*true_covariance(belief.omega, ledger, book))(0, 0), 0.5);
}

TEST(TrueCovariance, ByHandForUnequalWeights) {
  // Ω = 1·1 + 3·2 = 7; Σ w²I = 1 + 18 = 19.
  MeasurementBook book(1);
  book.add({matrix({{1.0}}), Vector::Zero(1)});
  book.add({matrix({{2.0}}), Vector::Zero(1)});
  Ledger ledger;
  set_weights(ledger, {1, 3});
  EXPECT_DOUBLE_EQ((*true_covariance(matrix({{7.0}}), ledger, book))(0, 0), 19.0 / 49.0);
}

TEST(TrueCovariance, AgreesWithMonteCarlo) {
  // Five measurements of one or two coordinates, weights as bad rules leave them: fractions,
  // double counting, and one negative. Ω stays definite; in the second case it does not.
  struct Sensor {
    Matrix M;
    Matrix S;
  };
  const Sensor sensors[] = {
      {matrix({{1, 0}}), matrix({{4}})},  {matrix({{0, 1}}), matrix({{1}})},
      {matrix({{1, 1}}), matrix({{2}})},  {Matrix::Identity(2, 2), matrix({{3, 1}, {1, 2}})},
      {matrix({{2, -1}}), matrix({{5}})},
  };
  const std::vector<double> cases[] = {{1, 2, 0.4, 3, -0.3}, {1, -4, 0.4, 0.2, 3}};
  const Vector truth = gaussian::vector({3, -7});
  constexpr int draws = 20000;
  for (const auto& weights : cases) {
    Ledger ledger;
    set_weights(ledger, weights);
    Stream random = stream("monte carlo");
    Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
    Matrix predicted;
    for (int i = 0; i < draws; ++i) {
      MeasurementBook book(2);
      for (const Sensor& sensor : sensors) {
        const Eigen::MatrixXd root = Eigen::MatrixXd(sensor.S).llt().matrixL();
        const Vector noise = root * random_vector(random, static_cast<int>(sensor.S.rows()));
        book.add(gaussian::measurement_information(sensor.M, sensor.S,
                                                   Vector(sensor.M * truth) + noise));
      }
      const Belief belief = book.weighted_sum(ledger.weights());
      const Eigen::Vector2d error = *state(belief) - truth;
      sum += error * error.transpose();
      if (i == 0) {
        predicted = *true_covariance(belief.omega, ledger, book);
        EXPECT_EQ(definiteness(belief) == gaussian::Definiteness::positive, &weights == &cases[0]);
      }
    }
    sum /= draws;
    for (int r = 0; r < 2; ++r) {
      for (int c = 0; c < 2; ++c) {
        const double variance =
            predicted(r, r) * predicted(c, c) + predicted(r, c) * predicted(r, c);
        EXPECT_NEAR(sum(r, c), predicted(r, c), 5 * std::sqrt(variance / draws));
      }
    }
  }
}

TEST(TrueCovariance, SurvivesWeightsWhoseSquaresOverflow) {
  MeasurementBook book(2);
  Stream random = stream("huge weights");
  std::vector<double> weights;
  for (int k = 0; k < 10; ++k) {
    book.add({random_information(random, 2), Vector::Zero(2)});
    weights.push_back(random.uniform(0.5, 2));
  }
  Ledger ledger;
  set_weights(ledger, weights);
  const Matrix reference = *true_covariance(book.weighted_sum(weights).omega, ledger, book);
  for (const double factor : {1e-200, 1e-40, 1e40, 1e85, 1e300}) {
    std::vector<double> huge = weights;
    for (double& w : huge) w *= factor;
    set_weights(ledger, huge);
    const auto p = true_covariance(book.weighted_sum(huge).omega, ledger, book);
    ASSERT_TRUE(p);
    EXPECT_LT(relative(*p, reference), 1e-12) << factor;
  }
}

TEST(TrueCovariance, DoesNotDependOnTheUnitsOfTheAxes) {
  Stream random = stream("units");
  const Matrix units = gaussian::diagonal({1e-60, 1e60});
  MeasurementBook book(2);
  MeasurementBook scaled(2);
  std::vector<double> weights;
  for (int k = 0; k < 6; ++k) {
    const Matrix information = random_information(random, 2);
    book.add({information, Vector::Zero(2)});
    scaled.add({Matrix(units * information * units), Vector::Zero(2)});
    weights.push_back(random.uniform(-0.2, 3));
  }
  Ledger ledger;
  set_weights(ledger, weights);
  const Matrix p = *true_covariance(book.weighted_sum(weights).omega, ledger, book);
  const Matrix q = *true_covariance(scaled.weighted_sum(weights).omega, ledger, scaled);
  EXPECT_LT(relative(units * q * units, p), 1e-12);
}

TEST(TrueCovariance, OfASingularOrOverflownBeliefDoesNotExist) {
  MeasurementBook book(2);
  Ledger ledger;
  ledger.measured(book.add({gaussian::diagonal({1, 0}), Vector::Zero(2)}));
  EXPECT_FALSE(true_covariance(gaussian::diagonal({1, 0}), ledger, book));
  EXPECT_FALSE(true_covariance(Matrix::Zero(2, 2), ledger, book));
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(true_covariance(gaussian::diagonal({1, infinity}), ledger, book));
  set_weights(ledger, {infinity});
  EXPECT_FALSE(true_covariance(gaussian::diagonal({1, 1}), ledger, book));
  EXPECT_THROW(true_covariance(Matrix::Identity(3, 3), ledger, book), BrokenInvariant);
}

}  // namespace
}  // namespace hearsay
