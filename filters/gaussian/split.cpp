#include "filters/gaussian/split.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "filters/gaussian/intersection.hpp"
#include "filters/gaussian/symmetric.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay::gaussian {
namespace {

constexpr double tied = 1e-12;
constexpr double tolerated = 1e-6;  // of a share below 0 or above 1
constexpr double snapped = 1e-12;

/// One belief in directions along which its independent part is a share s of the whole:
/// Ω = EEᵀ, Ω_i = E diag(s) Eᵀ.
struct Side {
  Matrix e;        ///< n×r
  Matrix inverse;  ///< r×n, inverse·e = I
  Vector s;        ///< in [0, 1]
};

std::optional<Side> side_of(const Scaled& scaled, const Matrix& independent) {
  const Eigenpairs whole = eigenpairs(scaled.matrix);
  const Eigen::Index n = independent.rows(), r = scaled.rank;
  Matrix f = whole.vectors.rightCols(r);
  Matrix g = f.transpose();
  for (Eigen::Index i = 0; i < r; ++i) {
    const double root = std::sqrt(whole.values(n - r + i));
    f.col(i) *= root;
    g.row(i) /= root;
  }
  scale_rows(f, scaled.factor.cwiseInverse());
  for (Eigen::Index j = 0; j < n; ++j) g.col(j) *= scaled.factor(j);
  const Matrix share = g.lazyProduct(Matrix(independent.lazyProduct(g.transpose())));
  if (!all_finite(share)) return std::nullopt;
  const Eigenpairs parts = eigenpairs(0.5 * (share + share.transpose()));
  Side side{f.lazyProduct(parts.vectors), parts.vectors.transpose().lazyProduct(g), parts.values};
  for (double& s : side.s) {
    if (s < -tolerated || s > 1.0 + tolerated) return std::nullopt;
    s = s < snapped ? 0.0 : s > 1.0 - snapped ? 1.0 : s;
  }
  return side;
}

/// What is left of the information along each direction, and its first two derivatives by ω.
struct Left {
  Vector value, first, second;
};
Left left(const Vector& s, double omega) {
  Left out{Vector::Ones(s.size()), Vector::Zero(s.size()), Vector::Zero(s.size())};
  for (Eigen::Index i = 0; i < s.size(); ++i) {
    if (s(i) == 1.0) continue;
    const double denominator = (1.0 - s(i)) + omega * s(i);
    out.value(i) = omega / denominator;
    out.first(i) = (1.0 - s(i)) / (denominator * denominator);
    out.second(i) = -2.0 * s(i) * out.first(i) / denominator;
  }
  return out;
}

/// y diag(weights) yᵀ.
Matrix weighted(const Matrix& y, const Vector& weights) {
  const Matrix scaled = y * weights.asDiagonal();
  const Matrix out = scaled.lazyProduct(y.transpose());
  return 0.5 * (out + out.transpose());
}

/// d/dω of log |Ω(ω)|; `a` and `b` are the directions of both in coordinates in which the sum of
/// both is I. Infinite where Ω(ω) is singular.
Slope slope_at(const Matrix& a, const Vector& s_a, const Matrix& b, const Vector& s_b,
               double omega) {
  const Left la = left(s_a, omega), lb = left(s_b, 1.0 - omega);
  const Scaled sum = scale(weighted(a, la.value) + weighted(b, lb.value));
  if (!sum.invertible()) {
    const double infinite = std::numeric_limits<double>::infinity();
    return {omega < 0.5 ? infinite : -infinite, -1.0};
  }
  const auto solved = [&](Matrix m) {  // Ω⁻¹m, up to a similarity
    scale_rows(m, sum.factor);
    m = solve(sum, m);
    scale_rows(m, sum.factor);
    return m;
  };
  const Matrix first = solved(weighted(a, la.first) - weighted(b, lb.first));
  const Matrix second = solved(weighted(a, la.second) + weighted(b, lb.second));
  return {first.trace(), second.trace() - first.lazyProduct(first).trace()};
}

/// ω of the greatest determinant.
double best_omega(const Side& own, const Side& received, const Matrix& omega_a,
                  const Matrix& omega_b) {
  const Scaled sum = scale(omega_a + omega_b);
  const Eigenpairs range = eigenpairs(sum.matrix);
  Matrix whitener = range.vectors.rightCols(sum.rank);
  scale_rows(whitener, sum.factor);
  for (Eigen::Index i = 0; i < sum.rank; ++i) {
    whitener.col(i) /= std::sqrt(range.values(range.values.size() - sum.rank + i));
  }
  const Matrix a = whitener.transpose().lazyProduct(own.e);
  const Matrix b = whitener.transpose().lazyProduct(received.e);
  const auto slope = [&](double omega) { return slope_at(a, own.s, b, received.s, omega); };
  const double at_zero = slope(0.0).value, at_one = slope(1.0).value;
  if (std::fabs(at_zero) <= tied && std::fabs(at_one) <= tied) return 0.5;
  if (at_zero <= 0.0) return 0.0;
  if (at_one >= 0.0) return 1.0;
  return zero_of(slope);
}

SplitFusion kept(const Belief& own, const Matrix& independent, const char* skipped) {
  const Eigen::Index n = own.dimension();
  return {own, independent, Matrix::Identity(n, n), Matrix::Zero(n, n), 1.0, skipped};
}

}  // namespace

SplitFusion fuse_split(const Belief& own, const Matrix& own_independent, const Belief& received,
                       const Matrix& received_independent) {
  require_equal_dimensions(own.omega, received.omega);
  const Eigen::Index n = own.dimension();
  require(own_independent.rows() == n && received_independent.rows() == n,
          "fuse_split: dimensions differ");
  if (!all_finite(own.xi) || !all_finite(received.xi)) {
    return kept(own, own_independent, "overflow");
  }
  const Scaled a = scale(own.omega), b = scale(received.omega);
  const auto answer = decided(a, b, own.omega, received.omega);
  if (answer && answer->omega == 0.0) {
    return {received, Matrix::Zero(n, n), Matrix::Zero(n, n), Matrix::Identity(n, n), 0.0, nullptr};
  }
  if (answer) return kept(own, own_independent, answer->skipped);
  const auto mine = side_of(a, own_independent);
  const auto theirs = side_of(b, received_independent);
  if (!mine || !theirs) return kept(own, own_independent, "a part is more than the whole");

  const double omega = best_omega(*mine, *theirs, own.omega, received.omega);
  const Vector keep_a = left(mine->s, omega).value, keep_b = left(theirs->s, 1.0 - omega).value;
  SplitFusion fusion;
  fusion.omega = omega;
  fusion.own = Matrix(mine->e * keep_a.asDiagonal()).lazyProduct(mine->inverse);
  fusion.received = Matrix(theirs->e * keep_b.asDiagonal()).lazyProduct(theirs->inverse);
  fusion.belief.omega = weighted(mine->e, keep_a) + weighted(theirs->e, keep_b);
  fusion.belief.xi = fusion.own.lazyProduct(own.xi);
  fusion.belief.xi += fusion.received.lazyProduct(received.xi);
  fusion.independent = weighted(mine->e, Vector(keep_a.cwiseProduct(keep_a).cwiseProduct(mine->s)));
  return fusion;
}

}  // namespace hearsay::gaussian
