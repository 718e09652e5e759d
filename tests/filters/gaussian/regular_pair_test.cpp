// The fast way of covariance intersection, against methods of another kind.
#include "filters/gaussian/regular_pair.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

#include "filters/gaussian/fusion.hpp"
#include "filters/gaussian/symmetric.hpp"
#include "tests/filters/gaussian/samples.hpp"

namespace hearsay::gaussian {
namespace {

/// log |ωA + (1−ω)B| up to a constant, by the generalised eigenvalues of A − B beside A + B.
class LogDeterminant {
 public:
  LogDeterminant(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b)
      : k_(Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(a - b, a + b).eigenvalues()) {}
  double operator()(double omega) const {
    double sum = 0;
    for (const double k : k_) sum += std::log1p((2 * omega - 1) * k);
    return sum;
  }
  /// Its maximum by golden section.
  double best_omega() const {
    const double golden = 0.5 * (std::sqrt(5.0) - 1);
    double low = 0;
    double high = 1;
    for (int i = 0; i < 80; ++i) {
      const double left = high - golden * (high - low);
      const double right = low + golden * (high - low);
      ((*this)(left) < (*this)(right) ? low : high) = (*this)(left) < (*this)(right) ? left : right;
    }
    double best = 0.5 * (low + high);
    for (const double end : {0.0, 1.0}) {
      if ((*this)(end) > (*this)(best)) best = end;
    }
    return best;
  }
  /// The same by bisection of the derivative, to the last digits.
  double zero_of_slope() const {
    const auto slope = [this](double omega) {
      return (k_.array() / (1 + (2 * omega - 1) * k_.array())).sum();
    };
    return zero_of_falling(slope);
  }

 private:
  Eigen::VectorXd k_;
};

/// A matrix with the eigenvalues 1 … 1/condition, spread evenly by their logarithm.
Matrix conditioned(Stream& random, int n, double condition) {
  const Eigen::MatrixXd g = random_matrix(random, n, n);
  const Eigen::MatrixXd q = Eigen::HouseholderQR<Eigen::MatrixXd>(g).householderQ();
  Eigen::VectorXd d(n);
  for (int i = 0; i < n; ++i) d(i) = std::pow(condition, -i / (n - 1.0));
  const Eigen::MatrixXd m = q * d.asDiagonal() * q.transpose();
  return 0.5 * (m + m.transpose());
}

TEST(RegularPairs, ReachTheDeterminantOfAGoldenSection) {
  Stream random = stream("golden section");
  int regular = 0;
  int general = 0;
  for (int trial = 0; trial < 4200; ++trial) {
    const int n = 2 + trial % 7;
    const double condition = std::pow(10.0, trial / 7 % 13);
    const Matrix a = conditioned(random, n, condition);
    const Matrix b = conditioned(random, n, condition) * std::pow(10.0, random.uniform(-1, 1));
    const LogDeterminant log_det(a, b);
    const double reference = log_det.best_omega();
    const Intersection result = intersect_det(a, b);
    ASSERT_EQ(result.skipped, nullptr);
    // What rounding of the matrices' entries may do to the criterion.
    const double slack = 1e-15 * n * condition + 1e-13;
    EXPECT_GE(log_det(result.omega), log_det(reference) - slack) << n << ' ' << condition;
    // The maximum is flat: golden section finds it to the root of a rounding error.
    if (condition <= 1e4) {
      EXPECT_NEAR(result.omega, reference, 1e-6) << n << ' ' << condition;
    }
    (omega_of_regular_pair(a, b) ? regular : general) += 1;
  }
  EXPECT_GT(regular, 1000);
  EXPECT_GT(general, 1000);
}

TEST(RegularPairs, AreAsExactAsTheirEigenvalues) {
  Stream random = stream("exact");
  int regular = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const int n = 3 + trial % 6;
    const Matrix a = random_information(random, n);
    const Matrix b = random_information(random, n);
    const auto omega = omega_of_regular_pair(a, b);
    if (!omega) continue;
    ++regular;
    EXPECT_NEAR(*omega, LogDeterminant(a, b).zero_of_slope(), 1e-12);
  }
  EXPECT_GT(regular, 2900);
}

TEST(RegularPairs, AreNoneOfASingularOrAFaintBelief) {
  Stream random = stream("irregular");
  for (int n = 3; n <= dimension_max; ++n) {
    const Matrix a = random_information(random, n);
    const Matrix singular = gram(random_matrix(random, n - 1, n));
    Matrix indefinite = a;
    indefinite(0, 0) = -1;
    Matrix overflown = a;
    overflown(n - 1, 0) = overflown(0, n - 1) = std::numeric_limits<double>::infinity();
    const Matrix nothing = Matrix::Zero(n, n);
    const Matrix others[] = {singular, indefinite, overflown, nothing, 1e-12 * a, 1e12 * a, a};
    for (const Matrix& other : others) {
      EXPECT_FALSE(omega_of_regular_pair(a, other));
      EXPECT_FALSE(omega_of_regular_pair(other, a));
    }
    EXPECT_FALSE(omega_of_regular_pair(1e40 * a, 2e40 * a));
  }
  EXPECT_FALSE(omega_of_regular_pair(diagonal({1, 2}), diagonal({2, 1})));
}

TEST(RegularPairs, StayRegularInOtherUnits) {
  Stream random = stream("units");
  for (int n = 3; n <= dimension_max; ++n) {
    const Matrix a = random_information(random, n);
    const Matrix b = random_information(random, n);
    const auto omega = omega_of_regular_pair(a, b);
    ASSERT_TRUE(omega);
    Vector units(n);
    for (int i = 0; i < n; ++i) units(i) = std::ldexp(1.0, static_cast<int>(random.below(80)) - 40);
    const auto scaled = [&](const Matrix& m) {
      return Matrix(units.asDiagonal() * m * units.asDiagonal());
    };
    EXPECT_EQ(omega_of_regular_pair(scaled(a), scaled(b)), omega);
  }
}

TEST(RegularPairs, ThatAreNearlyEqualAreWeighedByTheirDifference) {
  // Either is better in some directions and worse in others, by as much: ω = ½, however small it
  // is.
  Stream random = stream("nearly equal");
  for (int n = 3; n <= dimension_max; ++n) {
    const Matrix a = random_information(random, n);
    const Eigen::MatrixXd l = Eigen::LLT<Eigen::MatrixXd>(Eigen::MatrixXd(a)).matrixL();
    Eigen::VectorXd signs = random_vector(random, n);
    signs.array() -= signs.mean();
    const Eigen::MatrixXd difference = l * signs.asDiagonal() * l.transpose();
    for (const double e : {1e-2, 1e-3, 1e-4}) {
      const double slack = 1e-14 / (e * e);  // what rounding of the entries does to ω
      const Matrix b = a + e * difference;
      const Matrix c = a - e * difference;
      ASSERT_TRUE(omega_of_regular_pair(b, c));
      EXPECT_NEAR(intersect_det(b, c).omega, 0.5, slack);
      const Matrix d = a - 0.5 * e * difference;
      EXPECT_NEAR(intersect_det(b, d).omega, LogDeterminant(b, d).zero_of_slope(), slack);
    }
    EXPECT_EQ(intersect_det(a, a + 1e-16 * difference).omega, 0.5);
    EXPECT_EQ(intersect_det(a, a).omega, 0.5);
  }
}

TEST(RegularPairs, TheOneThatDominatesIsTakenWhole) {
  Stream random = stream("dominating");
  for (int n = 3; n <= dimension_max; ++n) {
    const Matrix a = random_information(random, n);
    const Matrix b = random_information(random, n);
    EXPECT_EQ(*omega_of_regular_pair(a + b, b), 1);
    EXPECT_EQ(*omega_of_regular_pair(a, a + b), 0);
    EXPECT_EQ(*omega_of_regular_pair(a, 1.001 * a), 0);
    // Better along one axis, equal along the others.
    Matrix better = a;
    better(0, 0) *= 2;
    EXPECT_EQ(*omega_of_regular_pair(better, a), 1);
  }
}

TEST(RegularPairs, AgreeWithTheGeneralWayWhereTheTwoMeet) {
  // The same pair from regular to nearly singular: nothing jumps where the way changes.
  Stream random = stream("switch");
  for (int n = 3; n <= dimension_max; ++n) {
    const Eigen::MatrixXd g = random_matrix(random, n, n);
    const Eigen::MatrixXd q = Eigen::HouseholderQR<Eigen::MatrixXd>(g).householderQ();
    const Matrix b = random_information(random, n);
    const auto a = [&](double faint) {
      Eigen::VectorXd d = Eigen::VectorXd::Constant(n, 3.0);
      d(0) = faint;
      const Eigen::MatrixXd m = q * d.asDiagonal() * q.transpose();
      return Matrix(0.5 * (m + m.transpose()));
    };
    const auto regular = [&](double faint) {
      return omega_of_regular_pair(a(faint), b).has_value();
    };
    double low = 1e-12;
    double high = 1.0;
    ASSERT_TRUE(regular(high) && !regular(low));
    for (int i = 0; i < 60; ++i) {
      const double middle = std::sqrt(low * high);
      (regular(middle) ? high : low) = middle;
    }
    EXPECT_LT(high / low, 1 + 1e-12);
    EXPECT_NEAR(intersect_det(a(low), b).omega, intersect_det(a(high), b).omega, 1e-11);
  }
}

}  // namespace
}  // namespace hearsay::gaussian
