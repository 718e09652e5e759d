// Rules that weigh direction by direction, against their formulas in covariances with plain
// inverses.
#include "filters/gaussian/directional.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "filters/ledger/ledger.hpp"
#include "tests/filters/gaussian/samples.hpp"

namespace hearsay::gaussian {
namespace {

using Dense = Eigen::MatrixXd;

struct Moments {
  Eigen::VectorXd x;
  Dense P;
};
Moments moments(const Belief& belief) {
  const Dense P = Dense(belief.omega).inverse();
  return {P * belief.xi, P};
}

Moments inverse_intersection(const Moments& a, const Moments& b, double omega) {
  const Dense A = a.P.inverse(), B = b.P.inverse();
  const Dense M = Dense(omega * a.P + (1.0 - omega) * b.P).inverse();
  const Dense P = Dense(A + B - M).inverse();
  return {P * (A - omega * M) * a.x + P * (B - (1.0 - omega) * M) * b.x, P};
}

/// The formulas as published, η small.
Moments ellipsoids(const Moments& a, const Moments& b) {
  const Eigen::Index n = a.x.size();
  const Eigen::SelfAdjointEigenSolver<Dense> first(a.P);
  const Dense root = first.eigenvectors() * first.eigenvalues().cwiseSqrt().asDiagonal();
  const Dense down = first.eigenvalues().cwiseSqrt().cwiseInverse().asDiagonal() *
                     first.eigenvectors().transpose();
  const Eigen::SelfAdjointEigenSolver<Dense> second(Dense(down * b.P * down.transpose()));
  const Dense T = root * second.eigenvectors();
  const Dense gamma = T * second.eigenvalues().cwiseMax(1.0).asDiagonal() * T.transpose();
  const Dense A = a.P.inverse(), B = b.P.inverse(), G = gamma.inverse();
  const Dense eta = 1e-9 * Dense::Identity(n, n);
  const Dense P = Dense(A + B - G).inverse();
  const Eigen::VectorXd mean =
      Dense(A + B - 2.0 * G + 2.0 * eta).inverse() * ((B - G + eta) * a.x + (A - G + eta) * b.x);
  return {P * (A * a.x + B * b.x - G * mean), P};
}

void expect_moments(const DirectionalFusion& fusion, const Moments& expected, double within) {
  EXPECT_EQ(fusion.skipped, nullptr);
  const Moments m = moments(fusion.belief);
  EXPECT_LE(relative(m.P, expected.P), within);
  EXPECT_LE((m.x - expected.x).norm(), within * (1.0 + expected.x.norm()));
}

TEST(InverseIntersection, IsItsFormulaAtTheBestWeight) {
  Stream random = stream("inverse");
  for (int trial = 0; trial < 100; ++trial) {
    const int n = 1 + trial % dimension_max;
    const Belief a = random_belief(random, n), b = random_belief(random, n);
    const Moments ma = moments(a), mb = moments(b);
    const auto determinant = [&](double omega) {
      return -inverse_intersection(ma, mb, omega).P.determinant();
    };
    // Golden section on the determinant of the covariance, which has one minimum.
    double low = 0.0, high = 1.0;
    for (int i = 0; i < 100; ++i) {
      const double left = high - 0.6180339887498949 * (high - low);
      const double right = low + 0.6180339887498949 * (high - low);
      (determinant(left) < determinant(right) ? low : high) =
          determinant(left) < determinant(right) ? left : right;
    }
    const DirectionalFusion fusion = fuse_by_inverse_intersection(a, b);
    expect_moments(fusion, inverse_intersection(ma, mb, 0.5 * (low + high)), 1e-5);
    EXPECT_LE(-determinant(0.5 * (low + high)) * (1.0 - 1e-9),
              moments(fusion.belief).P.determinant());
  }
}

TEST(EllipsoidalIntersection, IsItsFormulaForASmallEta) {
  Stream random = stream("ellipsoids");
  for (int trial = 0; trial < 100; ++trial) {
    const int n = 1 + trial % dimension_max;
    const Belief a = random_belief(random, n), b = random_belief(random, n);
    expect_moments(fuse_by_ellipsoids(a, b), ellipsoids(moments(a), moments(b)), 1e-5);
  }
}

TEST(DirectionalFusion, IsUnbiased) {
  Stream random = stream("unbiased");
  for (int trial = 0; trial < 100; ++trial) {
    const int n = 1 + trial % dimension_max;
    const Belief a = random_belief(random, n), b = random_belief(random, n);
    for (const auto& fusion : {fuse_by_inverse_intersection(a, b), fuse_by_ellipsoids(a, b)}) {
      const Dense sum = fusion.own * a.omega + fusion.received * b.omega;
      EXPECT_LE(relative(sum, fusion.belief.omega), 1e-10);
    }
  }
}

TEST(DirectionalFusion, OfOneThatKnowsNothingTakesTheOther) {
  Stream random = stream("nothing");
  const Belief known = random_belief(random, 3), nothing = Belief::unknown(3);
  for (const auto way : {fuse_by_inverse_intersection, fuse_by_ellipsoids}) {
    EXPECT_EQ(way(known, nothing).belief.omega, known.omega);
    EXPECT_EQ(way(nothing, known).belief.xi, known.xi);
    EXPECT_EQ(way(nothing, known).received, Matrix(Matrix::Identity(3, 3)));
    Belief singular = known;
    singular.omega.row(0).setZero();
    singular.omega.col(0).setZero();
    EXPECT_STREQ(way(known, singular).skipped, "a belief is singular");
    EXPECT_EQ(way(singular, known).belief.omega, singular.omega);
    Belief indefinite = known;
    indefinite.omega(1, 1) = -1.0;
    EXPECT_STREQ(way(known, indefinite).skipped, "received belief is indefinite");
  }
}

TEST(DirectionalFusion, ItsLedgerKnowsTheTrueCovariance) {
  // Two agents that share one measurement; the joint covariance worked out by hand.
  Stream random = stream("ledger");
  for (const auto way : {fuse_by_inverse_intersection, fuse_by_ellipsoids}) {
    MeasurementBook book(2);
    const Belief only_a = random_belief(random, 2), shared = random_belief(random, 2),
                 only_b = random_belief(random, 2);
    Belief a = only_a, b = only_b;
    a += shared;
    b += shared;
    Ledger of_a, of_b;
    of_a.measured(book.add(only_a));
    const std::size_t common = book.add(shared);
    of_a.measured(common);
    of_b.measured(common);
    of_b.measured(book.add(only_b));
    const DirectionalFusion fusion = way(a, b);
    of_a.combine(fusion.own, fusion.received, of_b);
    // cov(ξ_a) = Ω_a, cov(ξ_b) = Ω_b, cov(ξ_a, ξ_b) = Ω_shared.
    const Dense cross = fusion.own * shared.omega * fusion.received.transpose();
    const Dense noise = fusion.own * a.omega * fusion.own.transpose() + cross + cross.transpose() +
                        fusion.received * b.omega * fusion.received.transpose();
    const Dense P = Dense(fusion.belief.omega).inverse();
    EXPECT_LE(relative(*true_covariance(fusion.belief.omega, of_a, book), P * noise * P), 1e-10);
    ASSERT_EQ(of_a.weights().size(), 3u);
    EXPECT_NEAR(of_a.weights()[0], fusion.own.trace() / 2.0, 1e-14);
    EXPECT_NEAR(of_a.weights()[1], (fusion.own + fusion.received).trace() / 2.0, 1e-14);

    // A measurement later, and a copy, go on as before.
    Ledger copy;
    copy = of_a;
    const Belief more = random_belief(random, 2);
    copy.measured(book.add(more));
    Belief later = fusion.belief;
    later += more;
    EXPECT_LE(relative(book.weighted_sum_of(copy.matrices()).omega, later.omega), 1e-10);
    EXPECT_LE(relative(*true_covariance(later.omega, copy, book), Dense(later.omega).inverse() *
                                                                      (noise + Dense(more.omega)) *
                                                                      Dense(later.omega).inverse()),
              1e-10);
  }
}

TEST(DirectionalFusion, DoesNotDependOnUnits) {
  Stream random = stream("units");
  for (const auto way : {fuse_by_inverse_intersection, fuse_by_ellipsoids}) {
    const Belief a = random_belief(random, 4), b = random_belief(random, 4);
    const Matrix D = diagonal({1.0, 1e6, 1e-6, 1e3});
    const auto scaled = [&](const Belief& belief) {
      return Belief{Matrix(D * belief.omega * D), Vector(D * belief.xi)};
    };
    const DirectionalFusion plain = way(a, b);
    const DirectionalFusion other = way(scaled(a), scaled(b));
    const Matrix back = D.inverse() * other.belief.omega * D.inverse();
    EXPECT_LE(relative(back, plain.belief.omega), 1e-9);
  }
}

}  // namespace
}  // namespace hearsay::gaussian
