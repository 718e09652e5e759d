#include "filters/gaussian/symmetric.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>

#include "sim/kernel/error.hpp"
#include "tests/filters/gaussian/samples.hpp"

namespace hearsay::gaussian {
namespace {

Matrix random_symmetric(Stream& random, int n) {
  const Matrix m = random_matrix(random, n, n);
  return m + Matrix(m.transpose());
}

TEST(SymmetricMatrices, EigenvaluesEqualThoseOfEigen) {
  Stream random = stream("eigenvalues");
  for (int n = 1; n <= dimension_max; ++n) {
    for (int trial = 0; trial < 50; ++trial) {
      const Matrix m = random_symmetric(random, n);
      const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> reference{Eigen::MatrixXd(m)};
      const Eigenpairs e = eigenpairs(m);
      const double size = Eigen::MatrixXd(m).norm();
      EXPECT_LT((e.values - reference.eigenvalues()).norm(), 1e-14 * n * size);
      EXPECT_LT((eigenvalues(m) - e.values).norm(), 1e-14 * n * size);
      EXPECT_LT((m * e.vectors - e.vectors * e.values.asDiagonal()).norm(), 1e-14 * n * size);
      EXPECT_LT((e.vectors.transpose() * e.vectors - Matrix::Identity(n, n)).norm(), 1e-14 * n);
    }
  }
}

TEST(SymmetricMatrices, ScalingIsExactAndBringsTheDiagonalToOne) {
  Stream random = stream("scaling");
  for (int trial = 0; trial < 100; ++trial) {
    Matrix omega = random_information(random, 4);
    Vector units(4);
    for (double& unit : units) unit = std::pow(10.0, random.uniform(-100, 100));
    omega = units.asDiagonal() * omega * units.asDiagonal();
    omega = 0.5 * (omega + Matrix(omega.transpose()));
    const Scaled scaled = scale(omega);
    EXPECT_EQ(scaled.definiteness, Definiteness::positive);
    EXPECT_EQ(scaled.rank, 4);
    for (int i = 0; i < 4; ++i) {
      EXPECT_GE(scaled.matrix(i, i), 0.5);
      EXPECT_LT(scaled.matrix(i, i), 2.0);
      for (int j = 0; j < 4; ++j) {
        EXPECT_EQ(scaled.matrix(i, j) / scaled.factor(i) / scaled.factor(j), omega(i, j));
      }
    }
  }
}

TEST(SymmetricMatrices, RankCountsTheDirectionsThatAreKnown) {
  Stream random = stream("rank");
  for (int n = 2; n <= dimension_max; ++n) {
    for (int rank = 0; rank < n; ++rank) {
      const Matrix w = random_matrix(random, std::max(rank, 1), n);
      const Scaled scaled = scale(rank == 0 ? Matrix::Zero(n, n) : gram(w));
      EXPECT_EQ(scaled.rank, rank);
      EXPECT_EQ(scaled.definiteness, Definiteness::singular);
      EXPECT_FALSE(scaled.invertible());
      EXPECT_EQ(scaled.cholesky.size(), 0);
      EXPECT_THROW(solve(scaled, Matrix::Identity(n, n)), BrokenInvariant);
    }
  }
}

TEST(SymmetricMatrices, TheShortCutOfScaleAgreesWithTheEigenvalues) {
  Stream random = stream("short cut");
  for (int trial = 0; trial < 4000; ++trial) {
    const int n = 1 + trial % dimension_max;
    const Scaled scaled = scale(random_information(random, n, random.uniform(0.0, 18.0)));
    const Vector values = eigenvalues(scaled.matrix);
    const auto known = (values.array().abs() > n * 1e-13 * values(n - 1)).count();
    EXPECT_EQ(scaled.rank, known);
    EXPECT_EQ(scaled.definiteness == Definiteness::positive, known == n && values(0) > 0);
    EXPECT_EQ(scaled.cholesky.size() > 0, scaled.definiteness == Definiteness::positive);
  }
}

TEST(SymmetricMatrices, ARoundedZeroOnTheDiagonalIsNotANegativeDirection) {
  EXPECT_EQ(scale(matrix({{1, 0}, {0, -1e-16}})).definiteness, Definiteness::singular);
  EXPECT_EQ(scale(matrix({{1, 1e-17}, {1e-17, 0}})).definiteness, Definiteness::singular);
  EXPECT_EQ(scale(matrix({{1, 1e-12}, {1e-12, 1e-26}})).definiteness, Definiteness::singular);
  EXPECT_EQ(scale(matrix({{1, 0}, {0, -1e-9}})).definiteness, Definiteness::indefinite);
}

TEST(SymmetricMatrices, SolvesDefiniteAndIndefiniteSystems) {
  Stream random = stream("solve");
  for (int n = 1; n <= dimension_max; ++n) {
    for (const bool definite : {true, false}) {
      Matrix omega = random_information(random, n);
      if (!definite) {
        omega(n - 1, n - 1) -= 2 * omega.trace();  // one negative direction
      }
      const Scaled scaled = scale(omega);
      EXPECT_EQ(scaled.definiteness, definite ? Definiteness::positive : Definiteness::indefinite);
      ASSERT_TRUE(scaled.invertible());
      const Matrix rhs = random_matrix(random, n, 3 <= n ? 3 : n);
      const Eigen::MatrixXd x = solve(scaled, rhs);
      EXPECT_LT(relative(x, Eigen::MatrixXd(scaled.matrix).fullPivLu().solve(Eigen::MatrixXd(rhs))),
                1e-11);
    }
  }
}

TEST(SymmetricMatrices, CholeskyFactorsMultiplyBack) {
  Stream random = stream("cholesky");
  for (int n = 1; n <= dimension_max; ++n) {
    const Scaled scaled = scale(random_information(random, n));
    const Matrix l = scaled.cholesky;
    EXPECT_LT(relative(l * l.transpose(), scaled.matrix), 1e-14);
    for (int i = 0; i < n; ++i) {
      for (int j = i + 1; j < n; ++j) EXPECT_EQ(l(i, j), 0.0);
    }
  }
}

}  // namespace
}  // namespace hearsay::gaussian
