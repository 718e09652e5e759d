#include "filters/gaussian/transition.hpp"

#include <gtest/gtest.h>

#include "samples.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay::gaussian {
namespace {

void expect_near(const Eigen::MatrixXd& value, const Eigen::MatrixXd& expected, double within) {
  ASSERT_EQ(value.rows(), expected.rows());
  EXPECT_LE((value - expected).norm(), within * expected.norm()) << value << "\n\n" << expected;
}

TEST(WhiteNoiseAcceleration, IsThatOfTheEquation) {
  const Transition t = white_noise_acceleration(2, 2.0, 3.0);
  expect_near(t.A, matrix({{1, 0, 2, 0}, {0, 1, 0, 2}, {0, 0, 1, 0}, {0, 0, 0, 1}}), 0.0);
  expect_near(t.R, matrix({{8, 0, 6, 0}, {0, 8, 0, 6}, {6, 0, 6, 0}, {0, 6, 0, 6}}), 1e-15);
}

TEST(WhiteNoiseAcceleration, OfTwoSpansInARowIsThatOfTheirSum) {
  for (const int axes : {1, 2, 3}) {
    const Transition first = white_noise_acceleration(axes, 0.7, 0.5);
    const Transition second = white_noise_acceleration(axes, 1.9, 0.5);
    const Transition both = white_noise_acceleration(axes, 2.6, 0.5);
    expect_near(second.A * first.A, both.A, 1e-15);
    expect_near(second.A * first.R * second.A.transpose() + second.R, both.R, 1e-14);
  }
}

TEST(WhiteNoiseAcceleration, RefusesWhatCannotBe) {
  EXPECT_THROW(white_noise_acceleration(0, 1.0, 1.0), BrokenInvariant);
  EXPECT_THROW(white_noise_acceleration(5, 1.0, 1.0), BrokenInvariant);
  EXPECT_THROW(white_noise_acceleration(2, 0.0, 1.0), BrokenInvariant);
  EXPECT_THROW(white_noise_acceleration(2, 1.0, -1.0), BrokenInvariant);
  EXPECT_THROW(white_noise_acceleration(2, INFINITY, 1.0), BrokenInvariant);
}

TEST(Predict, IsThatOfAKalmanFilter) {
  Stream random = stream("predict");
  for (int trial = 0; trial < 200; ++trial) {
    const int n = 1 + trial % 6;
    const Matrix root = random_matrix(random, n, n + 1);
    const Matrix P = root * root.transpose();
    const Vector mean = random_matrix(random, n, 1);
    const Matrix noise = random_matrix(random, n, n);
    const Transition t{Matrix::Identity(n, n) + 0.2 * random_matrix(random, n, n),
                       noise * noise.transpose()};
    const Belief after = predict(Belief::from_moments(mean, P), t);
    expect_near(*covariance(after), t.A * P * t.A.transpose() + t.R, 1e-9);
    expect_near(*state(after), t.A * mean, 1e-8);
  }
}

TEST(Predict, LeavesUnknownWhatIsUnknown) {
  // A position alone, and the velocity never measured: nothing is known of the position later.
  Belief fresh = Belief::unknown(4);
  fresh += measurement_information(matrix({{1, 0, 0, 0}, {0, 1, 0, 0}}), diagonal({4.0, 9.0}),
                                   vector({3.0, 5.0}));
  const Belief later = predict(fresh, white_noise_acceleration(2, 1.0, 0.1));
  EXPECT_EQ(definiteness(later), Definiteness::singular);
  // What is known is where it was, x − v·dt, up to the motion's noise of variance q·dt³/3.
  const Matrix H = matrix({{1, 0, -1, 0}, {0, 1, 0, -1}});
  const Belief known =
      measurement_information(H, diagonal({4.0 + 0.1 / 3.0, 9.0 + 0.1 / 3.0}), vector({3.0, 5.0}));
  expect_near(later.omega, known.omega, 1e-12);
  expect_near(later.xi, known.xi, 1e-12);
  const Belief again = predict(Belief::unknown(4), white_noise_acceleration(2, 1.0, 0.1));
  EXPECT_EQ(again.omega.norm(), 0.0);
  EXPECT_EQ(again.xi.norm(), 0.0);
}

TEST(Predict, WithoutNoiseMovesInformationAlong) {
  const Transition still{Matrix::Identity(2, 2), Matrix::Zero(2, 2)};
  const Belief singular{matrix({{2, 2}, {2, 2}}), vector({4, 4})};
  expect_near(predict(singular, still).omega, singular.omega, 1e-15);
  expect_near(predict(singular, still).xi, singular.xi, 1e-15);
}

TEST(Predict, OfAnIndefiniteBeliefIsWhatItsUserWouldCompute) {
  const Belief faulty{matrix({{1, 0}, {0, -0.5}}), vector({1, 1})};
  const Transition t{Matrix::Identity(2, 2), diagonal({1.0, 1.0})};
  const Belief after = predict(faulty, t);
  expect_near(after.omega, diagonal({0.5, -1.0}), 1e-14);  // 1/(1/Ω + R)
  expect_near(after.xi, vector({0.5, 2.0}), 1e-14);
}

TEST(Predict, RefusesAMotionThatForgets) {
  const Transition forgets{Matrix::Zero(2, 2), Matrix::Identity(2, 2)};
  EXPECT_THROW(predict(Belief::unknown(2), forgets), BrokenInvariant);
  EXPECT_THROW(predict(Belief::unknown(3), white_noise_acceleration(1, 1.0, 1.0)), BrokenInvariant);
}

}  // namespace
}  // namespace hearsay::gaussian
