// Intersection of many beliefs at once: against its own optimality conditions, the intersection of
// two, a dense search, and random admissible correlations of all with all.
#include "filters/gaussian/batch.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "sim/kernel/error.hpp"
#include "tests/filters/gaussian/samples.hpp"

namespace hearsay::gaussian {
namespace {

std::vector<double> weights(const std::vector<Matrix>& omegas) {
  std::vector<const Matrix*> pointers;
  for (const Matrix& omega : omegas) pointers.push_back(&omega);
  BatchIntersection batch;
  const auto found = batch.weights(pointers);
  return {found.begin(), found.end()};
}

Eigen::MatrixXd mixed(const std::vector<Matrix>& omegas, const std::vector<double>& weights) {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(omegas[0].rows(), omegas[0].cols());
  for (std::size_t i = 0; i < omegas.size(); ++i) sum += weights[i] * omegas[i];
  return sum;
}

/// How far log |Ω| can be below its maximum: max tr(Ω⁻¹Ωᵢ) − n, as log |Ω| is concave.
double gap(const std::vector<Matrix>& omegas, const std::vector<double>& weights) {
  const Eigen::MatrixXd inverse = mixed(omegas, weights).inverse();
  double most = 0.0;
  for (const Matrix& omega : omegas) most = std::max(most, (inverse * omega).trace());
  return most - static_cast<double>(omegas[0].rows());
}

std::vector<Matrix> random_informations(Stream& random, int n, int k, double decades) {
  std::vector<Matrix> omegas;
  for (int i = 0; i < k; ++i) omegas.push_back(random_information(random, n, decades));
  return omegas;
}

TEST(BatchIntersection, ReachesTheMaximumOfTheDeterminant) {
  Stream random = stream("optimality");
  for (int trial = 0; trial < 800; ++trial) {
    const int n = 1 + trial % dimension_max;
    const int k = 2 + trial % 11;
    const auto omegas = random_informations(random, n, k, trial % 3 == 0 ? 6.0 : 2.0);
    const auto found = weights(omegas);
    EXPECT_NEAR(std::accumulate(found.begin(), found.end(), 0.0), 1.0, 1e-12);
    for (const double omega : found) EXPECT_GE(omega, 0.0);
    EXPECT_LT(gap(omegas, found), 1e-8) << "n " << n << " k " << k;
  }
}

TEST(BatchIntersection, OfThreeIsWhatADenseSearchFinds) {
  Stream random = stream("search");
  for (int trial = 0; trial < 20; ++trial) {
    const auto omegas = random_informations(random, 2, 3, 1.0);
    double best = 0.0;
    constexpr int cells = 200;
    for (int i = 0; i <= cells; ++i) {
      for (int j = 0; i + j <= cells; ++j) {
        const double x = i, y = j, z = cells - i - j;
        best = std::max(best, mixed(omegas, {x / cells, y / cells, z / cells}).determinant());
      }
    }
    const double found = mixed(omegas, weights(omegas)).determinant();
    EXPECT_GE(found, best * (1.0 - 1e-12));
    EXPECT_LT(found, best * 1.001);
  }
}

TEST(BatchIntersection, OfTwoIsThePairwiseOne) {
  Stream random = stream("pairs");
  for (int trial = 0; trial < 300; ++trial) {
    const int n = 1 + trial % dimension_max;
    const Matrix a = random_information(random, n), b = random_information(random, n);
    EXPECT_NEAR(weights({a, b})[0], intersect_det(a, b).omega, 1e-7) << n;
  }
  const Matrix published = matrix({{2, -0.8}, {-0.8, 1}}).inverse();
  EXPECT_NEAR(weights({diagonal({1.0 / 3.0, 2.5}), published})[0], 0.564516, 5e-7);
}

TEST(BatchIntersection, DoesNotDependOnTheOrder) {
  Stream random = stream("order");
  for (int trial = 0; trial < 200; ++trial) {
    const int n = 1 + trial % 4;
    auto omegas = random_informations(random, n, 5, 2.0);
    omegas.push_back(omegas[trial % 5]);  // a tie
    const auto found = weights(omegas);
    std::vector<Matrix> turned(omegas.rbegin(), omegas.rend());
    const auto other = weights(turned);
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_NEAR(found[i], other[found.size() - 1 - i], 1e-7);
    }
  }
}

TEST(BatchIntersection, EqualBeliefsGetEqualWeights) {
  Stream random = stream("ties");
  const Matrix a = random_information(random, 3);
  for (const double weight : weights({a, a, a, a})) EXPECT_NEAR(weight, 0.25, 1e-9);
  const Matrix better = 4.0 * a;
  const auto found = weights({a, better, better});
  EXPECT_EQ(found[0], 0.0);
  EXPECT_NEAR(found[1], 0.5, 1e-9);
}

TEST(BatchIntersection, UnitsDoNotMatter) {
  Stream random = stream("units");
  for (int trial = 0; trial < 100; ++trial) {
    const auto omegas = random_informations(random, 3, 4, 2.0);
    const Eigen::Vector3d units(1e-6, 1.0, 1e4);
    std::vector<Matrix> scaled;
    for (const Matrix& omega : omegas) {
      scaled.push_back(Matrix(1e100 * (units.asDiagonal() * omega * units.asDiagonal())));
    }
    const auto found = weights(omegas), other = weights(scaled);
    for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], other[i], 1e-6);
  }
}

TEST(BatchIntersection, SingularBeliefsCompleteOneAnother) {
  // Each knows one axis of three, and nobody the third: two directions, a half for each.
  const auto found = weights({diagonal({2, 0, 0}), diagonal({0, 5, 0}), diagonal({0, 0, 0})});
  EXPECT_NEAR(found[0], 0.5, 1e-9);
  EXPECT_NEAR(found[1], 0.5, 1e-9);
  EXPECT_EQ(found[2], 0.0);
  EXPECT_EQ(weights({diagonal({0, 0}), diagonal({0, 0})}), (std::vector<double>{0.5, 0.5}));
  EXPECT_EQ(weights({diagonal({3, 4})}), (std::vector<double>{1.0}));
  EXPECT_THROW(weights({}), BrokenInvariant);
  EXPECT_THROW(weights({diagonal({1}), diagonal({1, 2})}), BrokenInvariant);
}

TEST(BatchIntersection, IsConservativeUnderAnyCorrelationOfAllWithAll) {
  // Joint errors L_i u_i with (u_1 … u_k) = C w, each row block of C with C_iC_iᵀ = I: every pair
  // is correlated as far as can be.
  Stream random = stream("conservative");
  double least = 1.0, least_of_the_sum = 1.0;
  for (int trial = 0; trial < 300; ++trial) {
    const int n = 1 + trial % 3, k = 2 + trial % 4;
    const auto omegas = random_informations(random, n, k, 2.0);
    const auto found = weights(omegas);
    const Eigen::MatrixXd P = mixed(omegas, found).inverse();
    const Eigen::MatrixXd naive = mixed(omegas, std::vector<double>(found.size(), 1.0)).inverse();
    for (int draw = 0; draw < 20; ++draw) {
      Eigen::MatrixXd error = Eigen::MatrixXd::Zero(n, n), sum = error;
      for (int i = 0; i < k; ++i) {
        const Eigen::MatrixXd g = random_matrix(random, n, n);
        const Eigen::MatrixXd rotation = Eigen::HouseholderQR<Eigen::MatrixXd>(g).householderQ();
        const auto at = static_cast<std::size_t>(i);
        const Eigen::MatrixXd root = Eigen::MatrixXd(omegas[at]).llt().matrixL();
        error += found[at] * root * rotation;  // of ξᵢ: covariance Ωᵢ
        sum += root * rotation;
      }
      const auto margin = [](const Eigen::MatrixXd& claim, const Eigen::MatrixXd& e) {
        const Eigen::MatrixXd truth = claim * e * e.transpose() * claim;
        return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(claim - truth).eigenvalues()(0) /
               claim.norm();
      };
      least = std::min(least, margin(P, error));
      least_of_the_sum = std::min(least_of_the_sum, margin(naive, sum));
    }
  }
  EXPECT_GT(least, -1e-9);
  EXPECT_LT(least_of_the_sum, -0.5);  // the draws are hard enough for a rule that is not
}

TEST(MetropolisWeight, IsThatOfTheBusierOne) {
  EXPECT_EQ(metropolis_weight(1, 3), 0.25);
  EXPECT_EQ(metropolis_weight(3, 1), 0.25);
  EXPECT_EQ(metropolis_weight(0, 0), 1.0);
}

}  // namespace
}  // namespace hearsay::gaussian
