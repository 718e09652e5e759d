// Weights without a search: the published pair, formulas with plain inverses, and what happens at
// the edges.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <limits>

#include "filters/gaussian/fusion.hpp"
#include "tests/filters/gaussian/samples.hpp"

namespace hearsay::gaussian {
namespace {

using Way = Intersection (*)(const Matrix&, const Matrix&);
constexpr Way half = [](const Matrix& a, const Matrix& b) { return intersect_fixed(a, b, 0.5); };
constexpr Way ways[] = {half, intersect_niehsen, intersect_franken_huepper, most_certain};

const Matrix published_a = diagonal({1.0 / 3.0, 2.5});
const Matrix published_b = matrix({{2, -0.8}, {-0.8, 1}}).inverse();

TEST(FastIntersection, OfThePublishedPair) {
  EXPECT_NEAR(intersect_niehsen(published_a, published_b).omega, 0.468750, 5e-7);
  EXPECT_NEAR(intersect_franken_huepper(published_a, published_b).omega, 0.512579, 5e-7);
  EXPECT_EQ(half(published_a, published_b).omega, 0.5);
}

TEST(FastIntersection, IsItsFormulaWithPlainInverses) {
  Stream random = stream("formula");
  for (int trial = 0; trial < 200; ++trial) {
    const int n = 1 + trial % dimension_max;
    const Eigen::MatrixXd A = random_information(random, n), B = random_information(random, n);
    const Eigen::MatrixXd I = A + B;
    const double a = 1.0 / A.inverse().trace(), b = 1.0 / B.inverse().trace();
    EXPECT_NEAR(intersect_niehsen(A, B).omega, a / (a + b), 1e-9);
    const double numerator = I.determinant() - (I - A).determinant() + A.determinant();
    const double denominator = 2.0 * I.determinant() + A.determinant() - (I - A).determinant() +
                               B.determinant() - (I - B).determinant();
    EXPECT_NEAR(intersect_franken_huepper(A, B).omega, numerator / denominator, 1e-9);
    EXPECT_EQ(most_certain(A, B).omega, A.determinant() >= B.determinant() ? 1.0 : 0.0);
  }
}

TEST(FastIntersection, IsNeverBetterThanTheOptimumItStandsFor) {
  Stream random = stream("optimum");
  for (int trial = 0; trial < 200; ++trial) {
    const int n = 1 + trial % dimension_max;
    const Matrix A = random_information(random, n), B = random_information(random, n);
    const auto fused_by = [&](const Intersection& i) {
      return Matrix(i.omega * A + (1.0 - i.omega) * B);
    };
    const auto determinant = [&](Way way) { return *log_determinant(fused_by(way(A, B))); };
    const auto trace = [&](Way way) {
      return *claimed_sigma({fused_by(way(A, B)), Vector::Zero(n)});
    };
    for (const Way way : ways) {
      EXPECT_LE(determinant(way), determinant(intersect_det) + 1e-9);
      EXPECT_GE(trace(way), trace(intersect_trace) * (1.0 - 1e-9));
    }
  }
}

TEST(FastIntersection, TakesTheOtherWhereOneKnowsNothing) {
  Stream random = stream("nothing");
  const Matrix known = random_information(random, 3), nothing = Matrix::Zero(3, 3);
  for (const Way way : ways) {
    EXPECT_EQ(way(known, nothing).omega, 1.0);
    EXPECT_EQ(way(nothing, known).omega, 0.0);
    EXPECT_EQ(way(nothing, known).skipped, nullptr);
  }
}

TEST(FastIntersection, KeepsItsOwnBesideWhatIsNoBelief) {
  const Matrix good = diagonal({1.0, 2.0});
  const Matrix indefinite = diagonal({1.0, -2.0});
  const Matrix infinite = diagonal({1.0, std::numeric_limits<double>::infinity()});
  for (const Way way : ways) {
    EXPECT_STREQ(way(good, indefinite).skipped, "received belief is indefinite");
    EXPECT_STREQ(way(good, infinite).skipped, "overflow");
    EXPECT_EQ(way(good, indefinite).omega, 1.0);
  }
}

TEST(FastIntersection, OfSingularBeliefs) {
  const Matrix along_x = diagonal({2.0, 0.0}), along_y = diagonal({0.0, 3.0});
  const Matrix both = diagonal({1.0, 1.0});
  EXPECT_EQ(most_certain(along_x, both).omega, 0.0);
  EXPECT_EQ(most_certain(both, along_x).omega, 1.0);
  EXPECT_STREQ(most_certain(along_x, along_y).skipped, "both beliefs are singular");
  EXPECT_STREQ(intersect_niehsen(along_x, along_y).skipped, "no common range");
  EXPECT_EQ(half(along_x, along_y).omega, 0.5);
  // |I| = 6 and neither has a determinant of its own.
  EXPECT_EQ(intersect_franken_huepper(along_x, along_y).omega, 0.5);
  EXPECT_EQ(intersect_franken_huepper(along_x, diagonal({2.0, 0.0})).omega, 0.5);
}

TEST(FastIntersection, DoesNotOverflow) {
  Stream random = stream("huge");
  for (const double size : {1e-200, 1e200}) {
    const Matrix A = random_information(random, 4), B = random_information(random, 4);
    for (const Way way : ways) {
      EXPECT_NEAR(way(size * A, size * B).omega, way(A, B).omega, 1e-12);
    }
  }
}

}  // namespace
}  // namespace hearsay::gaussian
