#include "filters/gaussian/regular_pair.hpp"

#include <algorithm>
#include <cmath>

namespace hearsay::gaussian {
namespace {

constexpr double diagonal_min = 1e-30;  // so that products of eight are in range
constexpr double diagonal_max = 1e30;
// Below this product of |S|, S scaled to unit diagonal, and |I ± K| the pair goes the general way.
// By the inequality of the means an n×n matrix of trace t has no eigenvalue below |M|((n−1)/t)ⁿ⁻¹:
// above it both beliefs' smallest eigenvalues are beyond 1e-11, so neither counts as singular.
constexpr double determinant_min = 1e-7;
constexpr double equal_within = 1e-11;
constexpr double negligible = 1e-40;  // beside 1, as a square

// The dimension n is a template argument, so that the compiler unrolls the loops.

/// Lower triangle of a symmetric matrix, or a lower triangular one.
template <int n>
using Lower = double[n][n];

/// S = U·diag(p)·Uᵀ, U with unit diagonal: Cholesky without its square roots.
template <int n>
struct Factors {
  Lower<n> u;
  double inverse[n];   ///< 1/p
  double determinant;  ///< of S scaled to unit diagonal
};

template <int n>
bool factor_sum(const Matrix& a, const Matrix& b, Factors<n>& out) {
  double pivots = 1.0;
  double diagonals = 1.0;
  Lower<n> s;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j <= i; ++j) s[i][j] = a(i, j) + b(i, j);
    if (!(s[i][i] >= diagonal_min && s[i][i] <= diagonal_max)) return false;
    diagonals *= s[i][i];
  }
  for (int j = 0; j < n; ++j) {
    if (!(s[j][j] > 0.0)) return false;
    pivots *= s[j][j];
    out.inverse[j] = 1.0 / s[j][j];
    for (int i = j + 1; i < n; ++i) out.u[i][j] = s[i][j] * out.inverse[j];
    for (int i = j + 1; i < n; ++i) {
      for (int k = j + 1; k <= i; ++k) s[i][k] -= out.u[i][j] * s[k][j];
    }
  }
  out.determinant = pivots / diagonals;
  return true;
}

/// K = L⁻¹(Ω_a − Ω_b)L⁻ᵀ, L = U·diag(√p): U's columns are eliminated from both sides at once.
template <int n>
void whiten_difference(const Matrix& a, const Matrix& b, const Factors<n>& sum, Lower<n>& k) {
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j <= i; ++j) k[i][j] = a(i, j) - b(i, j);
  }
  for (int j = 0; j < n; ++j) {
    double half[n];
    for (int i = j + 1; i < n; ++i) {
      const double u = sum.u[i][j];
      for (int m = 0; m < j; ++m) k[i][m] -= u * k[j][m];
      half[i] = k[i][j] - 0.5 * u * k[j][j];
      k[i][j] -= u * k[j][j];
      for (int m = j + 1; m <= i; ++m) k[i][m] -= u * half[m] + half[i] * sum.u[m][j];
    }
  }
  double root[n];
  for (int i = 0; i < n; ++i) root[i] = std::sqrt(sum.inverse[i]);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j <= i; ++j) k[i][j] *= root[i] * root[j];
  }
}

/// A symmetric tridiagonal matrix with the same eigenvalues as K.
template <int n>
struct Tridiagonal {
  double diagonal[n];
  double squared[n];  ///< squares of the entries beside it; squared[0] = 0
};

/// Householder's reflections, column by column.
template <int n>
void tridiagonalise(Lower<n>& k, Tridiagonal<n>& t) {
  t.squared[0] = 0.0;
  for (int c = 0; c + 1 < n; ++c) {
    double tail = 0.0;
    for (int i = c + 2; i < n; ++i) tail += k[i][c] * k[i][c];
    const double first = k[c + 1][c];
    t.squared[c + 1] = first * first + tail;
    if (!(tail > negligible * negligible)) continue;
    const double length = std::sqrt(t.squared[c + 1]);
    double v[n];
    v[c + 1] = first + std::copysign(length, first);
    for (int i = c + 2; i < n; ++i) v[i] = k[i][c];
    const double beta = 1.0 / (length * std::fabs(v[c + 1]));  // 2/vᵀv
    double w[n];
    double vw = 0.0;
    for (int i = c + 1; i < n; ++i) {
      double sum = 0.0;
      for (int j = c + 1; j <= i; ++j) sum += k[i][j] * v[j];
      for (int j = i + 1; j < n; ++j) sum += k[j][i] * v[j];
      w[i] = beta * sum;
      vw += v[i] * w[i];
    }
    for (int i = c + 1; i < n; ++i) w[i] -= 0.5 * beta * vw * v[i];
    for (int i = c + 1; i < n; ++i) {
      for (int j = c + 1; j <= i; ++j) k[i][j] -= v[i] * w[j] + w[i] * v[j];
    }
  }
  for (int i = 0; i < n; ++i) t.diagonal[i] = k[i][i];
}

/// |I + τT| with its derivatives after τ; positive: the least leading minor.
struct Determinant {
  double value;
  double first;
  double second;
  double least_minor;
};

/// By the three-term recurrence of the leading minors, Dₖ = (1 + τtₖ)Dₖ₋₁ − τ²eₖ²Dₖ₋₂: for a
/// positive definite matrix as accurate as elimination, and without its chain of divisions.
template <int n>
Determinant determinant(const Tridiagonal<n>& t, double tau) {
  Determinant d{1.0 + tau * t.diagonal[0], t.diagonal[0], 0.0, 0.0};
  Determinant before{1.0, 0.0, 0.0, 0.0};
  d.least_minor = d.value;
  for (int k = 1; k < n; ++k) {
    const double g = 1.0 + tau * t.diagonal[k];
    const double e = t.squared[k];
    const double te = tau * e;
    const double tte = tau * te;
    const Determinant next{
        g * d.value - tte * before.value,
        (g * d.first - tte * before.first) + (t.diagonal[k] * d.value - 2.0 * te * before.value),
        (g * d.second - tte * before.second) +
            2.0 * (t.diagonal[k] * d.first - 2.0 * te * before.first - e * before.value),
        0.0};
    before = d;
    const double least = std::min(d.least_minor, next.value);
    d = next;
    d.least_minor = least;
  }
  return d;
}

/// The zero of d/dτ log |I + τT| between low and high: Newton, from 0 on, with bisection where it
/// leaves the bracket.
template <int n>
double best_tau(const Tridiagonal<n>& t, double slope, double curvature) {
  double low = -1.0;
  double high = 1.0;
  double tau = 0.0;
  for (int iteration = 0; iteration < 100; ++iteration) {
    (slope > 0.0 ? low : high) = tau;
    double next = tau - slope / curvature;
    if (!(next >= low && next <= high)) next = 0.5 * (low + high);
    const double step = next - tau;
    tau = next;
    // The error after a step is below step²·√|curvature|.
    const double squared = step * step;
    if (squared * squared * -curvature <= 1e-32 || high - low <= 1e-16) break;
    const Determinant d = determinant(t, tau);
    slope = d.first / d.value;
    curvature = d.second / d.value - slope * slope;
  }
  return tau;
}

template <int n>
std::optional<double> omega_of(const Matrix& omega_a, const Matrix& omega_b) {
  Factors<n> sum;
  if (!factor_sum(omega_a, omega_b, sum)) return std::nullopt;
  Lower<n> k;
  whiten_difference(omega_a, omega_b, sum, k);
  double trace = 0.0;
  double squares = 0.0;
  for (int i = 0; i < n; ++i) {
    trace += k[i][i];
    squares += k[i][i] * k[i][i];
    for (int j = 0; j < i; ++j) squares += 2.0 * k[i][j] * k[i][j];
  }
  if (!(squares > equal_within * equal_within)) return std::nullopt;
  Tridiagonal<n> t;
  tridiagonalise(k, t);
  // Only if all leading minors are positive at both ends lie K's eigenvalues in (−1, 1).
  const Determinant at_a = determinant(t, 1.0);
  const Determinant at_b = determinant(t, -1.0);
  const double least = std::min(at_a.least_minor, at_b.least_minor);
  if (!(sum.determinant * least >= determinant_min)) return std::nullopt;
  if (at_a.first >= 0.0) return 1.0;
  if (at_b.first <= 0.0) return 0.0;
  // tr K and −tr K² are slope and curvature at 0.
  return 0.5 * (1.0 + best_tau(t, trace, -squares));
}

}  // namespace

std::optional<double> omega_of_regular_pair(const Matrix& omega_a, const Matrix& omega_b) {
  static_assert(dimension_max == 8);
  switch (omega_a.rows()) {
    case 3:
      return omega_of<3>(omega_a, omega_b);
    case 4:
      return omega_of<4>(omega_a, omega_b);
    case 5:
      return omega_of<5>(omega_a, omega_b);
    case 6:
      return omega_of<6>(omega_a, omega_b);
    case 7:
      return omega_of<7>(omega_a, omega_b);
    case 8:
      return omega_of<8>(omega_a, omega_b);
    default:
      return std::nullopt;
  }
}

}  // namespace hearsay::gaussian
