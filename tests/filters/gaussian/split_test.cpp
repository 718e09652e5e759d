// Split covariance intersection: its two limits, the published covariance form, random admissible
// correlations of the parts that may be correlated, and a gossiping network with its ledger.
#include "filters/gaussian/split.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "filters/gaussian/fusion.hpp"
#include "filters/ledger/ledger.hpp"
#include "sim/kernel/error.hpp"
#include "tests/filters/gaussian/samples.hpp"

namespace hearsay::gaussian {
namespace {

using Dense = Eigen::MatrixXd;

struct Split {
  Belief belief;
  Matrix independent;
};

/// Ω = Ω_d + Ω_i of two random parts.
Split random_split(Stream& random, int n) {
  const Matrix independent = random_information(random, n, 1.0);
  Split split{{random_information(random, n) + independent, Vector(n)}, independent};
  split.belief.xi = split.belief.omega * random_vector(random, n);
  return split;
}

SplitFusion fuse(const Split& a, const Split& b) {
  return fuse_split(a.belief, a.independent, b.belief, b.independent);
}

double least_eigenvalue(const Dense& m) {
  return Eigen::SelfAdjointEigenSolver<Dense>(0.5 * (m + m.transpose())).eigenvalues()(0);
}

TEST(SplitIntersection, WithoutIndependentPartsIsCovarianceIntersection) {
  Stream random = stream("dependent");
  for (int trial = 0; trial < 200; ++trial) {
    const int n = 1 + trial % dimension_max;
    Split a = random_split(random, n), b = random_split(random, n);
    a.independent.setZero();
    b.independent.setZero();
    const SplitFusion fusion = fuse(a, b);
    const Belief expected =
        fused(coefficients(Rule::ci_det, a.belief, b.belief), a.belief, b.belief, {});
    EXPECT_LT(relative(fusion.belief.omega, expected.omega), 1e-9);
    EXPECT_LT(relative(fusion.belief.xi, expected.xi), 1e-7);
    EXPECT_EQ(fusion.independent.norm(), 0.0);
  }
}

TEST(SplitIntersection, WhollyIndependentBeliefsAreAdded) {
  Stream random = stream("independent");
  for (int trial = 0; trial < 100; ++trial) {
    const int n = 1 + trial % dimension_max;
    Split a = random_split(random, n), b = random_split(random, n);
    a.independent = a.belief.omega;
    b.independent = b.belief.omega;
    const SplitFusion fusion = fuse(a, b);
    EXPECT_LT(relative(fusion.belief.omega, a.belief.omega + b.belief.omega), 1e-12);
    EXPECT_LT(relative(fusion.belief.xi, a.belief.xi + b.belief.xi), 1e-11);
    EXPECT_LT(relative(fusion.independent, a.independent), 1e-12);  // only one's own
  }
}

TEST(SplitIntersection, IsTheCovarianceFormOfItsAuthors) {
  Stream random = stream("published form");
  for (int trial = 0; trial < 60; ++trial) {
    const int n = 1 + trial % 4;
    const Split a = random_split(random, n), b = random_split(random, n);
    const Dense Pa = Dense(a.belief.omega).inverse(), Pb = Dense(b.belief.omega).inverse();
    const Dense Pai = Pa * a.independent * Pa, Pbi = Pb * b.independent * Pb;
    const Dense Pad = Pa - Pai, Pbd = Pb - Pbi;
    const auto information = [&](double omega) -> Dense {
      return (Pad / omega + Pai).inverse() + (Pbd / (1.0 - omega) + Pbi).inverse();
    };
    const SplitFusion fusion = fuse(a, b);
    double best = 0.0;
    for (int i = 1; i < 2000; ++i) best = std::max(best, information(i / 2000.0).determinant());
    EXPECT_GE(fusion.belief.omega.determinant(), best * (1.0 - 1e-9));
    if (fusion.omega < 1e-6 || fusion.omega > 1.0 - 1e-6) continue;

    const Dense P1 = Pad / fusion.omega + Pai, P2 = Pbd / (1.0 - fusion.omega) + Pbi;
    const Dense K = P1 * (P1 + P2).inverse(), rest = Dense::Identity(n, n) - K;
    const Dense P = rest * P1;
    EXPECT_LT(relative(Dense(fusion.belief.omega).inverse(), P), 1e-9);
    const Dense x = rest * Pa * a.belief.xi + K * Pb * b.belief.xi;
    EXPECT_LT((P * fusion.belief.xi - x).norm(), 1e-9 * (1.0 + x.norm()));
    // One's own share of the independent part, in Joseph form.
    EXPECT_LT(relative(P * fusion.independent * P, rest * Pai * rest.transpose()), 1e-8);
  }
}

TEST(SplitIntersection, IsConservativeHoweverTheDependentPartsAreCorrelated) {
  Stream random = stream("admissible");
  double least = 1.0, least_dependent = 1.0, least_if_correlated = 1.0;
  for (int trial = 0; trial < 200; ++trial) {
    const int n = 1 + trial % 4;
    const Split a = random_split(random, n), b = random_split(random, n);
    const SplitFusion fusion = fuse(a, b);
    const Dense Ga = fusion.own, Gb = fusion.received;
    const Dense La = Dense(a.belief.omega - a.independent).llt().matrixL();
    const Dense Lb = Dense(b.belief.omega - b.independent).llt().matrixL();
    const Dense mine = Ga * Dense(a.independent) * Ga.transpose();
    const Dense theirs = Gb * Dense(b.independent) * Gb.transpose();
    const Dense la = Dense(a.independent).llt().matrixL(),
                lb = Dense(b.independent).llt().matrixL();
    EXPECT_LT((fusion.independent - mine).norm(), 1e-9 * fusion.belief.omega.norm());
    EXPECT_LT(relative(Ga * a.belief.omega + Gb * b.belief.omega, fusion.belief.omega), 1e-10);
    for (int draw = 0; draw < 30; ++draw) {
      const Dense g = random_matrix(random, n, n);
      const Dense rotation = Eigen::HouseholderQR<Dense>(g).householderQ();
      // The error of ξ from the dependent parts, wholly correlated: covariance eeᵀ.
      const Dense e = Ga * La + Gb * Lb * rotation;
      const Dense dependent = e * e.transpose() + theirs;
      const double size = Dense(fusion.belief.omega).norm();
      least_dependent = std::min(
          least_dependent,
          least_eigenvalue(Dense(fusion.belief.omega - fusion.independent) - dependent) / size);
      least = std::min(least, least_eigenvalue(fusion.belief.omega - dependent - mine) / size);
      const Dense f = Ga * la + Gb * lb * rotation;
      least_if_correlated = std::min(
          least_if_correlated,
          least_eigenvalue(fusion.belief.omega - e * e.transpose() - f * f.transpose()) / size);
    }
  }
  EXPECT_GT(least, -1e-9);
  EXPECT_GT(least_dependent, -1e-9);
  EXPECT_LT(least_if_correlated, -0.05);  // what the rule assumes does matter
}

TEST(SplitIntersection, ANetworkThatSpeaksInBroadcastsStaysConservative) {
  // Agents measure, speak to whoever happens to hear, and fuse. The ledger knows the true
  // covariance of each: none may claim more than that.
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Stream random(seed, Purpose("split network"), Entity::agent(0));
    constexpr std::size_t agents = 4;
    MeasurementBook book(2);
    std::vector<Split> splits(agents, {Belief::unknown(2), Matrix::Zero(2, 2)});
    std::vector<Ledger> ledgers(agents);
    double most = 0.0;
    for (int step = 0; step < 120; ++step) {
      const auto i = static_cast<std::size_t>(random.below(agents));
      if (random.bernoulli(0.5)) {
        const Belief z = measurement_information(random_matrix(random, 2, 2), diagonal({1, 0.2}),
                                                 random_vector(random, 2));
        ledgers[i].measured(book.add(z));
        splits[i].belief += z;
        splits[i].independent += z.omega;
        continue;
      }
      const Split said = splits[i];
      const Ledger ledger = ledgers[i];
      splits[i].independent.setZero();
      for (std::size_t j = 0; j < agents; ++j) {
        if (j == i || random.bernoulli(0.4)) continue;
        const SplitFusion fusion = fuse(splits[j], said);
        ASSERT_EQ(fusion.skipped, nullptr);
        splits[j] = {fusion.belief, fusion.independent};
        ledgers[j].combine(fusion.own, fusion.received, ledger);
        const auto P = true_covariance(splits[j].belief.omega, ledgers[j], book);
        if (!P) continue;
        const Dense L = Dense(splits[j].belief.omega).llt().matrixL();
        most = std::max(most, -least_eigenvalue(-(L.transpose() * Dense(*P) * L)));
        EXPECT_EQ(definiteness({splits[j].belief.omega - splits[j].independent, Vector(2)}) ==
                      Definiteness::indefinite,
                  false);
      }
    }
    EXPECT_LT(most, 1.0 + 1e-9) << seed;
    EXPECT_GT(most, 0.5) << seed;
  }
}

TEST(SplitIntersection, UnitsDoNotMatter) {
  Stream random = stream("units");
  const Eigen::Vector3d units(1e-5, 1.0, 1e4);
  for (int trial = 0; trial < 50; ++trial) {
    const Split a = random_split(random, 3), b = random_split(random, 3);
    const auto scaled = [&](const Split& s) {
      return Split{{Matrix(units.asDiagonal() * s.belief.omega * units.asDiagonal()),
                    Vector(units.asDiagonal() * s.belief.xi)},
                   Matrix(units.asDiagonal() * s.independent * units.asDiagonal())};
    };
    EXPECT_NEAR(fuse(a, b).omega, fuse(scaled(a), scaled(b)).omega, 1e-8);
  }
}

TEST(SplitIntersection, WhatCannotBeUsedIsSkipped) {
  Stream random = stream("edges");
  const Split a = random_split(random, 2), b = random_split(random, 2);
  const Split nothing{Belief::unknown(2), Matrix::Zero(2, 2)};
  EXPECT_EQ(fuse(a, nothing).belief.omega, a.belief.omega);
  EXPECT_EQ(fuse(a, nothing).independent, a.independent);
  EXPECT_EQ(fuse(nothing, b).belief.omega, b.belief.omega);
  EXPECT_EQ(fuse(nothing, b).independent.norm(), 0.0);
  EXPECT_STREQ(fuse(a, {b.belief, Matrix(2.0 * b.belief.omega)}).skipped,
               "a part is more than the whole");
  EXPECT_STREQ(fuse(a, {b.belief, Matrix(-b.belief.omega)}).skipped,
               "a part is more than the whole");
  EXPECT_STREQ(fuse(a, {{-b.belief.omega, b.belief.xi}, b.independent}).skipped,
               "received belief is indefinite");
  EXPECT_THROW(fuse_split(a.belief, a.independent, Belief::unknown(3), Matrix::Zero(3, 3)),
               BrokenInvariant);
  // Each knows one axis: nothing to weigh, and nothing is lost but half of what may be shared.
  const Split x{{diagonal({2, 0}), vector({2, 0})}, diagonal({0, 0})};
  const Split y{{diagonal({0, 3}), vector({0, 3})}, diagonal({0, 3})};
  EXPECT_LT(relative(fuse(x, y).belief.omega, diagonal({2, 3})), 1e-12);
}

}  // namespace
}  // namespace hearsay::gaussian
