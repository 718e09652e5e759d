// Covariance intersection: where on the segment between two information matrices to stand.
//
// Both criteria become sums over the directions that diagonalise Ω_a and Ω_b at once. With
// information aᵢ and bᵢ along direction i the fused information is fᵢ(ω) = ωaᵢ + (1−ω)bᵢ, and
//     log |Ω| = Σ log fᵢ + const   (concave),      tr Σ = Σ gᵢ/fᵢ   (convex).
#include <algorithm>
#include <cmath>

#include "filters/gaussian/intersection.hpp"
#include "filters/gaussian/regular_pair.hpp"
#include "filters/gaussian/symmetric.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay::gaussian {
namespace {

constexpr double equal_within = 1e-12;
constexpr double negligible = 1e-15;  // beside a singular matrix: below the rounding of its entries
constexpr int ratio_exponent_max = 200;  // a ratio beyond 2^200 moves no ω by 1e-12

/// The pair in its common directions.
struct Directions {
  Vector a;  ///< information of either side along each direction, up to a common factor
  Vector b;
  Vector g;  ///< what a unit of variance along it adds to the trace, up to a common factor
};

/// Either a finished answer or the directions to optimise over.
struct Pair {
  std::optional<Intersection> answer;
  Directions directions;
};

double largest(const Matrix& m) { return m.size() == 0 ? 0.0 : m.cwiseAbs().maxCoeff(); }

/// Wᵀ m W.
Matrix congruence(const Matrix& m, const Matrix& w) {
  const Eigen::Index n = w.rows();
  const Eigen::Index r = w.cols();
  Matrix mw(n, r);
  for (Eigen::Index j = 0; j < r; ++j) {
    for (Eigen::Index i = 0; i < n; ++i) {
      mw(i, j) = m(i, 0) * w(0, j);
      for (Eigen::Index k = 1; k < n; ++k) mw(i, j) += m(i, k) * w(k, j);
    }
  }
  const auto entry = [&](Eigen::Index i, Eigen::Index j) {
    double sum = w(0, i) * mw(0, j);
    for (Eigen::Index k = 1; k < n; ++k) sum += w(k, i) * mw(k, j);
    return sum;
  };
  Matrix out(r, r);
  for (Eigen::Index j = 0; j < r; ++j) {
    for (Eigen::Index i = 0; i <= j; ++i) out(i, j) = out(j, i) = 0.5 * (entry(i, j) + entry(j, i));
  }
  return out;
}

/// Squared length, in the state's own coordinates, of the covariance along each column of `t`.
/// `q` (n×r) spans the range of the sum in coordinates equilibrated by the powers of two `d`.
Vector trace_weights(const Matrix& q, const Matrix& t, const Vector& d) {
  const Eigen::Index r = q.cols();
  Vector g = Vector::Zero(r);
  double top = 0.0;
  if (r == q.rows()) {
    Matrix columns = q.lazyProduct(t);
    scale_rows(columns, d / d.maxCoeff());
    for (Eigen::Index j = 0; j < r; ++j) g(j) = columns.col(j).squaredNorm();
  } else {
    // Trace of the pseudo-inverse: the range has the basis D⁻¹q, which is not orthonormal.
    Matrix basis = q;
    scale_rows(basis, d.minCoeff() * d.cwiseInverse());
    const Scaled metric = scale(gram(basis));
    if (!metric.invertible()) return Vector::Ones(r);  // axes of wholly different units: no trace
    Matrix rhs = t;
    scale_rows(rhs, metric.factor);
    const Matrix solved = solve(metric, rhs);
    for (Eigen::Index j = 0; j < r; ++j) g(j) = rhs.col(j).dot(solved.col(j));
  }
  for (const double weight : g) top = std::max(top, weight);
  if (!(top > 0.0)) return Vector::Ones(r);
  return g / top;
}

/// Both matrices are semi-definite and neither is zero.
Pair simultaneous(const Matrix& omega_a, const Matrix& omega_b, int rank_a, int rank_b) {
  // Each on its own scale, so that a belief 1e90 times stronger does not drown the other's range.
  const int exponent_a = exponent_of(omega_a);
  const int exponent_b = exponent_of(omega_b);
  const Matrix a = times_power_of_two(omega_a, -exponent_a);
  const Matrix b = times_power_of_two(omega_b, -exponent_b);
  const Scaled sum = scale(a + b);
  const Eigenpairs range = eigenpairs(sum.matrix);
  const Eigen::Index n = a.rows();
  Eigen::Index r = std::max({sum.rank, rank_a, rank_b});
  while (r > 0 && !(range.values(n - r) > 0.0)) --r;
  const Eigen::Index only_b = std::max<Eigen::Index>(0, r - rank_a);
  const Eigen::Index only_a = std::max<Eigen::Index>(0, r - rank_b);

  Pair pair;
  if (r - only_a - only_b <= 0) {
    pair.answer = Intersection{1.0, "no common range"};
    return pair;
  }
  const Matrix q = range.vectors.rightCols(r);
  Matrix whitener = q;
  scale_rows(whitener, sum.factor);
  for (Eigen::Index i = 0; i < r; ++i) whitener.col(i) /= std::sqrt(range.values(n - r + i));
  const Matrix share_b = congruence(b, whitener);
  const Eigenpairs shares = eigenpairs(congruence(a, whitener));

  Directions& d = pair.directions;
  d.a = shares.values;
  d.b = congruence(share_b, shares.vectors).diagonal();
  for (Eigen::Index i = 0; i < r; ++i) {
    d.a(i) = i < only_b ? 0.0 : i >= r - only_a ? 1.0 : std::max(d.a(i), 0.0);
    d.b(i) = i < only_b ? 1.0 : i >= r - only_a ? 0.0 : std::max(d.b(i), 0.0);
  }
  const int ratio = std::clamp(exponent_a - exponent_b, -ratio_exponent_max, ratio_exponent_max);
  (ratio > 0 ? d.b : d.a) *= std::ldexp(1.0, -std::abs(ratio));
  Matrix t = shares.vectors;  // whitener = D·q·diag(λ^-½)
  for (Eigen::Index i = 0; i < r; ++i) t.row(i) /= std::sqrt(range.values(n - r + i));
  d.g = trace_weights(q, t, sum.factor);
  return pair;
}

bool all_equal(const Directions& d) {
  for (Eigen::Index i = 0; i < d.a.size(); ++i) {
    if (std::fabs(d.a(i) - d.b(i)) > equal_within * std::max(d.a(i), d.b(i))) return false;
  }
  return true;
}

/// d/dω of log |Ω|.
Slope determinant_slope(const Directions& d, double omega) {
  Slope slope{0.0, 0.0};
  for (Eigen::Index i = 0; i < d.a.size(); ++i) {
    const double u = (d.a(i) - d.b(i)) / (omega * d.a(i) + (1.0 - omega) * d.b(i));
    slope.value += u;
    slope.derivative -= u * u;
  }
  return slope;
}

/// d/dω of −tr Σ.
Slope trace_slope(const Directions& d, double omega) {
  Slope slope{0.0, 0.0};
  for (Eigen::Index i = 0; i < d.a.size(); ++i) {
    const double f = omega * d.a(i) + (1.0 - omega) * d.b(i);
    const double u = (d.a(i) - d.b(i)) / f;
    slope.value += d.g(i) * u / f;
    slope.derivative -= 2.0 * d.g(i) * u * u / f;
  }
  return slope;
}

template <typename SlopeAt>
Pair prepared(const Matrix& omega_a, const Matrix& omega_b, const SlopeAt& slope_at) {
  const Scaled a = scale(omega_a);
  const Scaled b = scale(omega_b);
  if (const auto answer = decided(a, b, omega_a, omega_b)) return {answer, {}};
  Pair pair = simultaneous(omega_a, omega_b, a.rank, b.rank);
  if (pair.answer) return pair;
  if (all_equal(pair.directions)) {
    pair.answer = Intersection{0.5, nullptr};
  } else if (slope_at(pair.directions, 0.0).value <= 0.0) {
    pair.answer = Intersection{0.0, nullptr};
  } else if (slope_at(pair.directions, 1.0).value >= 0.0) {
    pair.answer = Intersection{1.0, nullptr};
  }
  return pair;
}

}  // namespace

void require_equal_dimensions(const Matrix& a, const Matrix& b) {
  require(a.rows() == b.rows() && a.rows() >= 1, "intersect: dimensions differ");
}

std::optional<Intersection> decided(const Scaled& a, const Scaled& b, const Matrix& omega_a,
                                    const Matrix& omega_b) {
  if (a.definiteness == Definiteness::overflow || b.definiteness == Definiteness::overflow) {
    return Intersection{1.0, "overflow"};
  }
  if (a.definiteness == Definiteness::indefinite) {
    return Intersection{1.0, "own belief is indefinite"};
  }
  if (b.definiteness == Definiteness::indefinite) {
    return Intersection{1.0, "received belief is indefinite"};
  }
  if (a.rank == 0 && b.rank == 0) return Intersection{0.5, nullptr};
  const double size_a = largest(omega_a);
  const double size_b = largest(omega_b);
  if (b.rank == 0 || (!a.invertible() && size_b <= negligible * size_a)) {
    return Intersection{1.0, nullptr};
  }
  if (a.rank == 0 || (!b.invertible() && size_a <= negligible * size_b)) {
    return Intersection{0.0, nullptr};
  }
  return std::nullopt;
}

Intersection intersect_det(const Matrix& omega_a, const Matrix& omega_b) {
  require_equal_dimensions(omega_a, omega_b);
  if (const auto omega = omega_of_regular_pair(omega_a, omega_b)) return {*omega, nullptr};
  const Pair pair = prepared(omega_a, omega_b, determinant_slope);
  if (pair.answer) return *pair.answer;
  const Directions& d = pair.directions;
  if (d.a.size() == 2) {
    // Σ (aᵢ−bᵢ)/fᵢ = 0 is linear in ω for two directions, one of them with a < b.
    const double u0 = d.b(0) / (d.a(0) - d.b(0));
    const double u1 = d.b(1) / (d.a(1) - d.b(1));
    return {std::clamp(-0.5 * (u0 + u1), 0.0, 1.0), nullptr};
  }
  return {zero_of([&](double omega) { return determinant_slope(d, omega); }), nullptr};
}

Intersection intersect_trace(const Matrix& omega_a, const Matrix& omega_b) {
  require_equal_dimensions(omega_a, omega_b);
  const Pair pair = prepared(omega_a, omega_b, trace_slope);
  if (pair.answer) return *pair.answer;
  const Directions& d = pair.directions;
  return {zero_of([&](double omega) { return trace_slope(d, omega); }), nullptr};
}

}  // namespace hearsay::gaussian
