#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>

#include "filters/gaussian/fusion.hpp"
#include "sim/kernel/error.hpp"
#include "tests/filters/gaussian/samples.hpp"

namespace hearsay::gaussian {
namespace {

using Criterion = Intersection (*)(const Matrix&, const Matrix&);
constexpr Criterion both[] = {intersect_det, intersect_trace};

const Matrix A2 = diagonal({1.0 / 3.0, 2.5});
const Matrix B2 = matrix({{2, -0.8}, {-0.8, 1}}).inverse();
const Matrix A3 = matrix({{4, 1, 0.5}, {1, 3, -0.25}, {0.5, -0.25, 0.5}});
const Matrix B3 = matrix({{1, -0.5, 0}, {-0.5, 5, 0.75}, {0, 0.75, 2}});

/// The optimum by bisection of the derivative, with plain inverses.
double reference(bool trace, const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  const auto slope = [&](double omega) {
    const Eigen::MatrixXd inverse = (omega * a + (1 - omega) * b).inverse();
    return trace ? (inverse * (a - b) * inverse).trace() : (inverse * (a - b)).trace();
  };
  return zero_of_falling(slope);
}

void expect_omega(const Intersection& intersection, double omega, double within = 1e-12) {
  EXPECT_NEAR(intersection.omega, omega, within);
  EXPECT_EQ(intersection.skipped, nullptr);
}

void expect_skipped(const Intersection& intersection, const char* reason) {
  EXPECT_EQ(intersection.omega, 1.0);
  ASSERT_NE(intersection.skipped, nullptr);
  EXPECT_STREQ(intersection.skipped, reason);
}

TEST(CovarianceIntersection, ThreeDimensionsAsComputedElsewhere) {
  expect_omega(intersect_det(A3, B3), 0.3564275691243943);
  expect_omega(intersect_trace(A3, B3), 0.33401158385741875);
}

TEST(CovarianceIntersection, EqualsAPlainSearchInEveryDimension) {
  Stream random = stream("search");
  int interior = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const int n = 1 + trial % dimension_max;
    const Matrix a = random_information(random, n);
    const Matrix b = random_information(random, n);
    for (const bool trace : {false, true}) {
      const double omega = reference(trace, a, b);
      expect_omega(both[trace](a, b), omega, 1e-11);
      interior += omega > 0 && omega < 1;
    }
  }
  EXPECT_GT(interior, 2000);
}

TEST(CovarianceIntersection, OneDimensionTakesTheBetterBelief) {
  for (const Criterion intersect : both) {
    expect_omega(intersect(matrix({{2}}), matrix({{1}})), 1, 0);
    expect_omega(intersect(matrix({{1}}), matrix({{2}})), 0, 0);
    expect_omega(intersect(matrix({{2}}), matrix({{2}})), 0.5, 0);
  }
}

TEST(CovarianceIntersection, ABeliefThatIsBetterInEveryDirectionIsTakenWhole) {
  for (const Criterion intersect : both) {
    expect_omega(intersect(A3 + B3, B3), 1, 0);
    expect_omega(intersect(A3, A3 + B3), 0, 0);
    expect_omega(intersect(A2, 1.001 * A2), 0, 0);
    expect_omega(intersect(A2, A2 + diagonal({0.1, 0})), 0, 0);
  }
}

TEST(CovarianceIntersection, EqualBeliefsAreHalved) {
  for (const Criterion intersect : both) {
    expect_omega(intersect(A3, A3), 0.5, 0);
    expect_omega(intersect(A2, (1 + 1e-14) * A2), 0.5, 0);
    expect_omega(intersect(1e85 * A2, 1e85 * A2), 0.5, 0);
  }
}

TEST(CovarianceIntersection, ACommonFactorChangesNothing) {
  for (const Criterion intersect : both) {
    for (const double factor : {1e-290, 1e-85, 1e-6, 1e85, 1e290}) {
      expect_omega(intersect(factor * A2, factor * B2), intersect(A2, B2).omega);
      expect_omega(intersect(factor * A3, factor * B3), intersect(A3, B3).omega);
    }
  }
}

TEST(CovarianceIntersection, AHugeBeliefBesideAFaintOneIsTakenWhole) {
  for (const Criterion intersect : both) {
    expect_omega(intersect(1e85 * A2, 1e-6 * B2), 1, 0);
    expect_omega(intersect(1e-6 * A3, 1e85 * B3), 0, 0);
    expect_omega(intersect(1e300 * A3, 1e-300 * B3), 1, 0);
  }
}

TEST(CovarianceIntersection, TheDeterminantDoesNotDependOnUnits) {
  const Matrix units = diagonal({1e-6, 1e3, 7e9});
  expect_omega(intersect_det(units * A3 * units, units * B3 * units), intersect_det(A3, B3).omega);
}

TEST(CovarianceIntersection, TheTraceCountsSquareUnitsOfEachAxis) {
  const Matrix units = diagonal({1e-3, 1, 1e2});
  const Matrix a = units * A3 * units;
  const Matrix b = units * B3 * units;
  expect_omega(intersect_trace(a, b), reference(true, a, b), 1e-9);
}

TEST(CovarianceIntersection, OfOneWhoKnowsNothingTheOtherIsTaken) {
  const Matrix nothing = Matrix::Zero(2, 2);
  for (const Criterion intersect : both) {
    expect_omega(intersect(A2, nothing), 1, 0);
    expect_omega(intersect(nothing, A2), 0, 0);
    expect_omega(intersect(diagonal({1, 0}), nothing), 1, 0);
    expect_omega(intersect(nothing, diagonal({1, 0})), 0, 0);
    expect_omega(intersect(nothing, nothing), 0.5, 0);
    // Rounding residue beside a belief that knows one direction.
    expect_omega(intersect(diagonal({1, 0}), diagonal({1e-17, 1e-17})), 1, 0);
    expect_omega(intersect(diagonal({1e-17, 1e-17}), diagonal({1, 0})), 0, 0);
  }
}

TEST(CovarianceIntersection, OnACommonRangeASingularPairIsFusedAsTheSmallerPairItIs) {
  // The pair of two dimensions, laid into a plane of three.
  Stream random = stream("plane");
  const Eigen::MatrixXd g = random_matrix(random, 3, 3);
  const Eigen::MatrixXd q = Eigen::HouseholderQR<Eigen::MatrixXd>(g).householderQ();
  const Matrix plane = q.leftCols(2);
  const auto laid = [&](const Matrix& m) {
    const Matrix x = plane * m * plane.transpose();
    return Matrix(0.5 * (x + Matrix(x.transpose())));
  };
  for (const Criterion intersect : both) {
    expect_omega(intersect(laid(A2), laid(B2)), intersect(A2, B2).omega, 1e-11);
    expect_omega(intersect(laid(A2), laid(A2)), 0.5, 0);
    expect_omega(intersect(1e85 * laid(A2), laid(B2)), 1, 0);
    Matrix a = Matrix::Zero(3, 3);
    Matrix b = Matrix::Zero(3, 3);
    a.topLeftCorner(2, 2) = A2;
    b.topLeftCorner(2, 2) = B2;
    expect_omega(intersect(a, b), intersect(A2, B2).omega);
  }
}

TEST(CovarianceIntersection, WhatOnlyOneSideKnowsIsKept) {
  // log(1 + 3ω) + log ω + log(1 − ω), and 1/(1 + 3ω) + 1/ω + 1/(3(1 − ω)).
  expect_omega(intersect_det(diagonal({4, 1, 0}), diagonal({1, 0, 3})), 0.6228390306071099);
  expect_omega(intersect_trace(diagonal({4, 1, 0}), diagonal({1, 0, 3})), 0.6495961421227466);
  // One side knows a single direction, and that better: the ordinary criterion, log ω + log(1 − ω).
  for (const double much : {1e3, 1e12}) {
    const double d = much;
    const double omega = 0.5 * (1 - 1 / (d - 1));
    expect_omega(intersect_det(diagonal({d, 0}), diagonal({1, 1})), omega);
    expect_omega(intersect_det(diagonal({1, 1}), diagonal({d, 0})), 1 - omega);
  }
  // So it is along a slanted direction, where A's rounding must not pass for information.
  const double slanted = 0.5 * (1 - 1 / (1e12 - 1));
  const Matrix direction = matrix({{0.36, 0.48}, {0.48, 0.64}});
  expect_omega(intersect_det(1e12 * direction, Matrix::Identity(2, 2)), slanted, 1e-10);
  expect_omega(intersect_det(Matrix::Identity(2, 2), 1e12 * direction), 1 - slanted, 1e-10);
  // Known worse than by the other side: nothing to gain.
  for (const Criterion intersect : both) {
    expect_omega(intersect(diagonal({0.5, 0}), diagonal({1, 1})), 0, 0);
    expect_omega(intersect(diagonal({1, 1}), diagonal({1, 0})), 1, 0);
  }
}

TEST(CovarianceIntersection, WithoutACommonRangeOwnIsKept) {
  for (const Criterion intersect : both) {
    expect_skipped(intersect(diagonal({1, 0}), diagonal({0, 1})), "no common range");
    expect_skipped(intersect(matrix({{1, 1}, {1, 1}}), matrix({{1, -1}, {-1, 1}})),
                   "no common range");
    expect_skipped(intersect(diagonal({1, 0, 0}), diagonal({0, 2, 0})), "no common range");
    expect_skipped(intersect(diagonal({1e85, 0}), diagonal({0, 1e75})), "no common range");
  }
}

TEST(CovarianceIntersection, AnIndefiniteBeliefIsNotFused) {
  const Matrix indefinite = matrix({{1, 2}, {2, 1}});
  for (const Criterion intersect : both) {
    for (const double factor : {1e-6, 1.0, 1e85}) {
      expect_skipped(intersect(factor * indefinite, A2), "own belief is indefinite");
      expect_skipped(intersect(A2, factor * indefinite), "received belief is indefinite");
    }
    expect_skipped(intersect(diagonal({-1, -1}), A2), "own belief is indefinite");
  }
}

TEST(CovarianceIntersection, AnOverflownBeliefIsNotFused) {
  Matrix bad = A2;
  for (const double value : {std::numeric_limits<double>::infinity(), std::nan("")}) {
    bad(0, 1) = bad(1, 0) = value;
    for (const Criterion intersect : both) {
      expect_skipped(intersect(bad, A2), "overflow");
      expect_skipped(intersect(A2, bad), "overflow");
    }
  }
}

TEST(CovarianceIntersection, OmegaIsANumberForWhateverIsSemiDefinite) {
  // Ranks, sizes and units thrown together.
  Stream random = stream("anything");
  for (int trial = 0; trial < 20000; ++trial) {
    const int n = 1 + static_cast<int>(random.below(4));
    const auto sample = [&] {
      const int rank = 1 + static_cast<int>(random.below(static_cast<std::uint64_t>(n)));
      Matrix w = random_matrix(random, rank, n);
      for (int i = 0; i < rank; ++i) w.row(i) *= std::pow(10.0, random.uniform(-8, 8));
      for (int j = 0; j < n; ++j) w.col(j) *= std::pow(10.0, random.uniform(-60, 60));
      Matrix omega(n, n);
      for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) omega(i, j) = w.col(i).dot(w.col(j));
      }
      return omega;
    };
    const Matrix a = sample();
    const Matrix b = sample();
    for (const Criterion intersect : both) {
      const Intersection result = intersect(a, b);
      EXPECT_GE(result.omega, 0.0);
      EXPECT_LE(result.omega, 1.0);
    }
  }
}

TEST(CovarianceIntersection, MatricesOfDifferentSizesAreRefused) {
  for (const Criterion intersect : both) {
    EXPECT_THROW(intersect(A2, A3), BrokenInvariant);
    EXPECT_THROW(intersect(Matrix(), Matrix()), BrokenInvariant);
  }
}

}  // namespace
}  // namespace hearsay::gaussian
