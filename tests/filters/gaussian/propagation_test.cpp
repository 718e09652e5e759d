#include "filters/gaussian/propagation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "sim/kernel/error.hpp"
#include "tests/filters/gaussian/samples.hpp"

namespace hearsay::gaussian {
namespace {

TEST(UnscentedTransform, ItsPointsAreThoseOfTheAlgorithm) {
  const auto at = sigma_points({vector({1.0, 2.0}), diagonal({4.0, 9.0})}, 1.0);
  ASSERT_TRUE(at);
  ASSERT_EQ(at->count, 5);
  const double reach = std::sqrt(3.0);
  EXPECT_EQ(at->points[0], vector({1.0, 2.0}));
  EXPECT_LT(relative(at->points[1], vector({1.0 + 2.0 * reach, 2.0})), 1e-15);
  EXPECT_LT(relative(at->points[2], vector({1.0, 2.0 + 3.0 * reach})), 1e-15);
  EXPECT_LT(relative(at->points[3], vector({1.0 - 2.0 * reach, 2.0})), 1e-15);
  EXPECT_LT(relative(at->points[4], vector({1.0, 2.0 - 3.0 * reach})), 1e-15);
  EXPECT_DOUBLE_EQ(at->weights[0], 1.0 / 3.0);
  for (std::size_t i = 1; i < 5; ++i) EXPECT_DOUBLE_EQ(at->weights[i], 1.0 / 6.0);
}

TEST(UnscentedTransform, IsExactForLinearMapsWhateverKappaAndRank) {
  Stream random = stream("unscented linear");
  for (int n = 1; n <= dimension_max; ++n) {
    for (const double kappa : {usual_kappa(n), 0.0, 2.5}) {
      const int m = 1 + n / 2;
      const Matrix A = random_matrix(random, m, n);
      const Vector b = random_vector(random, m);
      Moments x{random_vector(random, n), random_information(random, n)};
      if (n > 2) {  // a direction without any spread
        const Matrix flat = random_matrix(random, n, n - 2);
        x.covariance = flat * flat.transpose();
      }
      const auto out =
          unscented(x, kappa, [&](const Vector& p) { return std::optional<Vector>(A * p + b); });
      ASSERT_TRUE(out) << n;
      EXPECT_LT(relative(out->y.mean, A * x.mean + b), 1e-12);
      EXPECT_LT(relative(out->y.covariance, A * x.covariance * A.transpose()), 1e-11);
      EXPECT_LT(relative(out->cross, x.covariance * A.transpose()), 1e-11);
      const Moments first = linearised(x, A * x.mean + b, A);
      EXPECT_LT(relative(first.covariance, A * x.covariance * A.transpose()), 1e-12);
    }
  }
}

TEST(UnscentedTransform, HasTheMeanOfEveryQuadraticMap) {
  // E xᵀQx = μᵀQμ + tr QΣ.
  Stream random = stream("unscented quadratic");
  for (int n = 1; n <= dimension_max; ++n) {
    const Matrix Q = random_information(random, n);
    const Moments x{random_vector(random, n), random_information(random, n)};
    const double exact = x.mean.dot(Q * x.mean) + (Q * x.covariance).trace();
    for (const double kappa : {usual_kappa(n), 0.0, 4.0}) {
      const auto out = unscented(
          x, kappa, [&](const Vector& p) { return std::optional<Vector>(vector({p.dot(Q * p)})); });
      ASSERT_TRUE(out);
      EXPECT_NEAR(out->y.mean(0), exact, 1e-12 * exact) << n << " " << kappa;
    }
  }
}

TEST(UnscentedTransform, WithTheUsualKappaHasTheVarianceOfASquare) {
  // Var x² = 4μ²σ² + 2σ⁴; to first order it is 4μ²σ² alone.
  const double mu = 0.7, variance = 0.3;
  const Moments x{vector({mu}), matrix({{variance}})};
  const auto square = [](const Vector& p) { return std::optional<Vector>(vector({p(0) * p(0)})); };
  const auto out = unscented(x, usual_kappa(1), square);
  ASSERT_TRUE(out);
  EXPECT_NEAR(out->y.covariance(0, 0), 4 * mu * mu * variance + 2 * variance * variance, 1e-14);
  const Moments first = linearised(x, *square(x.mean), matrix({{2 * mu}}));
  EXPECT_NEAR(first.covariance(0, 0), 4 * mu * mu * variance, 1e-14);
}

/// A range and a bearing as a place. E = r·e^(−σ²/2) on the axis for a certain range.
std::optional<Vector> place(const Vector& polar) {
  return vector({polar(0) * std::cos(polar(1)), polar(0) * std::sin(polar(1))});
}

TEST(Sampled, GivesTheClosedFormOfPolarCoordinatesWithinItsOwnError) {
  const double r = 10.0, sigma = 0.3;
  const Moments x{vector({r, 0.0}), diagonal({0.0, sigma * sigma})};
  Stream random = stream("polar");
  constexpr int draws = 20000;
  const Sampled out = sampled(x, draws, place, [&] { return random.normal(); });
  ASSERT_TRUE(out.y);
  EXPECT_EQ(out.misses, 0);
  const double damped = std::exp(-sigma * sigma), mean = r * std::sqrt(damped);
  const double xx = r * r * (1 + damped * damped) / 2 - mean * mean;
  const double yy = r * r * (1 - damped * damped) / 2;
  EXPECT_NEAR(out.y->mean(0), mean, 4 * std::sqrt(xx / draws));
  EXPECT_NEAR(out.y->mean(1), 0.0, 4 * std::sqrt(yy / draws));
  EXPECT_NEAR(out.y->covariance(1, 1), yy, 4 * yy * std::sqrt(2.0 / draws));
  EXPECT_NEAR(out.y->covariance(0, 0), xx,
              4 * xx * std::sqrt(14.0 / draws));  // like χ², kurtosis 15
}

TEST(UnscentedTransform, IsWithinTheErrorOfMonteCarloWhereLinearisationIsNot) {
  const Moments x{vector({10.0, 0.9}), diagonal({0.04, 0.01})};
  Stream random = stream("unscented against sampled");
  constexpr int draws = 40000;
  const Sampled reference = sampled(x, draws, place, [&] { return random.normal(); });
  const auto out = unscented(x, usual_kappa(2), place);
  ASSERT_TRUE(reference.y && out);
  const Matrix J =
      matrix({{std::cos(0.9), -10 * std::sin(0.9)}, {std::sin(0.9), 10 * std::cos(0.9)}});
  const Moments first = linearised(x, *place(x.mean), J);
  const Matrix& S = reference.y->covariance;
  int first_outside = 0;
  for (int i = 0; i < 2; ++i) {
    const double of_mean = 4 * std::sqrt(S(i, i) / draws);
    EXPECT_NEAR(out->y.mean(i), reference.y->mean(i), of_mean);
    if (std::fabs(first.mean(i) - reference.y->mean(i)) > of_mean) ++first_outside;
    for (int j = 0; j < 2; ++j) {
      const double of_entry = 4 * std::sqrt((S(i, i) * S(j, j) + S(i, j) * S(i, j)) / draws);
      EXPECT_NEAR(out->y.covariance(i, j), S(i, j), of_entry);
      EXPECT_NEAR(first.covariance(i, j), S(i, j), of_entry);  // a tenth of a radian is little
    }
  }
  EXPECT_EQ(first_outside, 2);
}

TEST(UnscentedTransform, MeansOfAnglesDoNotBreakAtTheCut) {
  const Moments x{vector({3.1}), matrix({{0.04}})};  // points on either side of π
  const auto wrapped = [](double a) { return std::remainder(a, 2 * 3.14159265358979323846); };
  const auto out = unscented(
      x, 2.0, [&](const Vector& p) { return std::optional<Vector>(vector({wrapped(p(0))})); },
      [&](const Vector& a, const Vector& b) { return vector({wrapped(a(0) - b(0))}); });
  ASSERT_TRUE(out);
  EXPECT_NEAR(out->y.mean(0), 3.1, 1e-14);
  EXPECT_NEAR(out->y.covariance(0, 0), 0.04, 1e-14);
}

TEST(Propagation, WhereTheFunctionHasNoValueThereIsNone) {
  const Moments x{vector({1.0}), matrix({{1.0}})};
  const auto root = [](const Vector& p) -> std::optional<Vector> {
    if (p(0) < 0) return std::nullopt;
    return vector({std::sqrt(p(0))});
  };
  EXPECT_FALSE(unscented(x, 2.0, root));   // a point at 1 − √3
  EXPECT_TRUE(unscented(x, -0.25, root));  // points at 1 ± √0.75
  Stream random = stream("missing");
  constexpr int draws = 4000;
  const Sampled out = sampled(x, draws, root, [&] { return random.normal(); });
  const double below = 0.158655;  // Φ(−1)
  EXPECT_NEAR(out.misses, draws * below, 4 * std::sqrt(draws * below * (1 - below)));
  EXPECT_FALSE(sampled(x, 1, root, [] { return 0.0; }).y);
}

TEST(Propagation, ACovarianceThatIsNoneGivesNothing) {
  const auto same = [](const Vector& p) { return std::optional<Vector>(p); };
  for (const double bad : {-1.0, std::nan(""), HUGE_VAL}) {
    const Moments x{vector({0.0, 0.0}), diagonal({1.0, bad})};
    EXPECT_FALSE(unscented(x, 1.0, same)) << bad;
    EXPECT_EQ(sampled(x, 10, same, [] { return 0.0; }).misses, 10) << bad;
  }
  EXPECT_FALSE(unscented({vector({std::nan("")}), matrix({{1.0}})}, 1.0, same));
  const auto certain = unscented({vector({3.0}), matrix({{0.0}})}, 1.0, same);
  ASSERT_TRUE(certain);
  EXPECT_EQ(certain->y.mean(0), 3.0);
  EXPECT_EQ(certain->y.covariance(0, 0), 0.0);
}

TEST(Propagation, WrongShapesAndKappasAreRefused) {
  const Moments x{vector({0.0, 0.0}), Matrix::Identity(2, 2)};
  EXPECT_THROW(sigma_points(x, -2.0), BrokenInvariant);
  EXPECT_THROW(sigma_points(x, std::nan("")), BrokenInvariant);
  EXPECT_THROW(sigma_points({vector({0.0}), x.covariance}, 1.0), BrokenInvariant);
  EXPECT_THROW(linearised(x, vector({0.0}), Matrix::Identity(2, 2)), BrokenInvariant);
  RunningMoments values;
  values.add(vector({1.0}));
  EXPECT_THROW(values.add(vector({1.0, 2.0})), BrokenInvariant);
}

TEST(RunningMoments, EqualTheSumsAlsoFarFromZero) {
  Stream random = stream("running");
  std::vector<Vector> all;
  RunningMoments values;
  EXPECT_FALSE(values.moments());
  for (int i = 0; i < 200; ++i) {
    all.push_back(random_vector(random, 3) + vector({1e8, -1e8, 5.0}));
    values.add(all.back());
  }
  Vector mean = Vector::Zero(3);
  for (const Vector& y : all) mean += (y - all.front()) / 200.0;
  mean += all.front();
  Matrix covariance = Matrix::Zero(3, 3);
  for (const Vector& y : all) covariance += (y - mean) * (y - mean).transpose() / 199.0;
  ASSERT_TRUE(values.moments());
  EXPECT_LT(relative(values.moments()->mean, mean), 1e-15);
  EXPECT_LT(relative(values.moments()->covariance, covariance), 1e-6);
}

TEST(Moments, OfABeliefAreThoseItWasMadeFrom) {
  const Vector mean = vector({3.0, -1.0});
  const Matrix covariance = matrix({{2.0, 0.5}, {0.5, 1.0}});
  const auto back = moments(Belief::from_moments(mean, covariance));
  ASSERT_TRUE(back);
  EXPECT_LT(relative(back->mean, mean), 1e-14);
  EXPECT_LT(relative(back->covariance, covariance), 1e-14);
  EXPECT_FALSE(moments(Belief::unknown(2)));
}

}  // namespace
}  // namespace hearsay::gaussian
