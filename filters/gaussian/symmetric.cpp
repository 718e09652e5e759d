#include "filters/gaussian/symmetric.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "sim/kernel/error.hpp"

namespace hearsay::gaussian {
namespace {

constexpr double singular_below = 1e-13;  // times n, of the largest eigenvalue

/// e such that value lies in [½, 1)·2^e.
int binary_exponent(double value) {
  const int biased = static_cast<int>(std::bit_cast<std::uint64_t>(value) >> 52) & 0x7ff;
  if (biased != 0 && biased != 0x7ff) return biased - 1022;  // a normal number, as nearly all are
  int e = 0;
  std::frexp(value, &e);
  return e;
}

/// 2^e, |e| ≤ 1022.
double power_of_two(int e) { return std::bit_cast<double>(std::uint64_t(1023 + e) << 52); }

/// Half of it, rounded so that value·2^(−2·half) lies in [½, 2).
int half_exponent(double value) {
  const int e = binary_exponent(value);
  return (e >= 0 ? e : e - 1) / 2;
}

/// Applies the rotation of the plane (p, q) that annihilates a(p, q).
void rotate(Matrix& a, Matrix* vectors, Eigen::Index p, Eigen::Index q) {
  const double theta = (a(q, q) - a(p, p)) / (2.0 * a(p, q));
  const double t = (theta >= 0 ? 1.0 : -1.0) / (std::fabs(theta) + std::sqrt(theta * theta + 1.0));
  const double c = 1.0 / std::sqrt(t * t + 1.0);
  const double s = t * c;
  a(p, p) -= t * a(p, q);
  a(q, q) += t * a(p, q);
  a(p, q) = a(q, p) = 0.0;
  for (Eigen::Index k = 0; k < a.rows(); ++k) {
    if (k != p && k != q) {
      const double kp = a(k, p);
      const double kq = a(k, q);
      a(k, p) = a(p, k) = c * kp - s * kq;
      a(k, q) = a(q, k) = s * kp + c * kq;
    }
    if (vectors != nullptr) {
      const double vp = (*vectors)(k, p);
      const double vq = (*vectors)(k, q);
      (*vectors)(k, p) = c * vp - s * vq;
      (*vectors)(k, q) = s * vp + c * vq;
    }
  }
}

/// Brings a to diagonal form. It converges quadratically: about six sweeps for n = 8.
void diagonalise(Matrix& a, Matrix* vectors) {
  constexpr int sweeps_max = 60;
  const double negligible = std::ldexp(a.size() > 0 ? a.cwiseAbs().maxCoeff() : 0.0, -60);
  for (int sweep = 0; sweep < sweeps_max; ++sweep) {
    bool rotated = false;
    for (Eigen::Index p = 0; p < a.rows(); ++p) {
      for (Eigen::Index q = p + 1; q < a.cols(); ++q) {
        if (!(std::fabs(a(p, q)) > negligible)) continue;
        rotate(a, vectors, p, q);
        rotated = true;
      }
    }
    if (!rotated) return;
  }
  throw BrokenInvariant("eigenvalues: the Jacobi iteration did not converge");
}

/// Factors that bring the diagonal to [½, 2); false where that cannot be a fair scale.
bool diagonal_factors(const Matrix& omega, Vector& factor) {
  for (Eigen::Index i = 0; i < omega.rows(); ++i) {
    const double d = omega(i, i);
    if (d > 0) {
      factor(i) = power_of_two(-half_exponent(d));
    } else {
      if (d < 0 || (omega.row(i).array() != 0.0).any()) return false;
      factor(i) = 1.0;
    }
  }
  return true;
}

/// Puts DΩD into `out`. @return whether all entries are below 2 in size (no NaN either).
bool equilibrate(const Matrix& omega, const Vector& factor, Matrix& out) {
  const Eigen::Index n = omega.rows();
  out.resize(n, n);
  bool small = true;
  for (Eigen::Index j = 0; j < n; ++j) {
    for (Eigen::Index i = 0; i < n; ++i) {
      const double entry = omega(i, j) * factor(i) * factor(j);
      out(i, j) = entry;
      small = small && std::fabs(entry) < 2.0;
    }
  }
  return small;
}

/// Puts the lower factor into `l`; false, `l` empty, unless all pivots are positive.
bool factor_cholesky(const Matrix& matrix, Matrix& l) {
  const Eigen::Index n = matrix.rows();
  l = matrix;
  for (Eigen::Index j = 0; j < n; ++j) {
    for (Eigen::Index k = 0; k < j; ++k) {
      for (Eigen::Index i = j; i < n; ++i) l(i, j) -= l(i, k) * l(j, k);
    }
    if (!(l(j, j) > 0.0)) {
      l.resize(0, 0);
      return false;
    }
    l(j, j) = std::sqrt(l(j, j));
    for (Eigen::Index i = j + 1; i < n; ++i) l(i, j) /= l(j, j);
    for (Eigen::Index i = 0; i < j; ++i) l(i, j) = 0.0;
  }
  return true;
}

/// True if the matrix LLᵀ is positive definite by so much that no eigenvalue need be computed. With
/// its trace t the largest is at most t; by the inequality of the means the product of all but the
/// least is at most (t/(n−1))ⁿ⁻¹, so the least is at least |LLᵀ|((n−1)/t)ⁿ⁻¹.
bool clearly_positive(const Matrix& l, double trace) {
  constexpr double margin = 10.0;  // for the rounding of L
  const auto n = static_cast<double>(l.rows());
  double least = l(0, 0) * l(0, 0);
  for (Eigen::Index i = 1; i < l.rows(); ++i) least *= l(i, i) * l(i, i) * ((n - 1.0) / trace);
  return least > margin * n * singular_below * trace;
}

void judge(Scaled& scaled) {
  const bool factored = factor_cholesky(scaled.matrix, scaled.cholesky);
  if (factored && clearly_positive(scaled.cholesky, scaled.matrix.trace())) {
    scaled.rank = static_cast<int>(scaled.matrix.rows());
    scaled.definiteness = Definiteness::positive;
    return;
  }
  const Vector values = eigenvalues(scaled.matrix);
  const Eigen::Index n = values.size();
  const double largest = std::max(std::fabs(values(0)), std::fabs(values(n - 1)));
  const double threshold = static_cast<double>(n) * singular_below * largest;
  for (Eigen::Index i = 0; i < n; ++i) scaled.rank += std::fabs(values(i)) > threshold ? 1 : 0;
  scaled.definiteness = values(0) < -threshold ? Definiteness::indefinite
                        : scaled.rank == n     ? Definiteness::positive
                                               : Definiteness::singular;
  if (scaled.definiteness != Definiteness::positive) scaled.cholesky.resize(0, 0);
}

}  // namespace

Scaled scale(const Matrix& omega) {
  Scaled scaled;
  if (omega.size() == 0) return scaled;
  scaled.factor.resize(omega.rows());
  // |Ω(i, j)| ≤ √(Ω(i, i)·Ω(j, j)) < 2 in any semi-definite matrix.
  const bool fair =
      diagonal_factors(omega, scaled.factor) && equilibrate(omega, scaled.factor, scaled.matrix);
  if (!fair) {
    if (!all_finite(omega)) {
      scaled.matrix = omega;
      scaled.factor.resize(0);
      scaled.definiteness = Definiteness::overflow;
      return scaled;
    }
    scaled.factor.setConstant(std::ldexp(1.0, -(exponent_of(omega) / 2)));
    equilibrate(omega, scaled.factor, scaled.matrix);
  }
  judge(scaled);
  return scaled;
}

void solve_lower(const Matrix& l, Matrix& x) {
  for (Eigen::Index column = 0; column < x.cols(); ++column) {
    for (Eigen::Index i = 0; i < x.rows(); ++i) {
      for (Eigen::Index k = 0; k < i; ++k) x(i, column) -= l(i, k) * x(k, column);
      x(i, column) /= l(i, i);
    }
  }
}

void solve_lower_transposed(const Matrix& l, Matrix& x) {
  for (Eigen::Index column = 0; column < x.cols(); ++column) {
    for (Eigen::Index i = x.rows() - 1; i >= 0; --i) {
      for (Eigen::Index k = i + 1; k < x.rows(); ++k) x(i, column) -= l(k, i) * x(k, column);
      x(i, column) /= l(i, i);
    }
  }
}

Matrix solve(const Scaled& scaled, const Matrix& rhs) {
  require(scaled.invertible(), "solve: the matrix is singular");
  Matrix x = rhs;
  if (scaled.cholesky.size() > 0) {
    solve_lower(scaled.cholesky, x);
    solve_lower_transposed(scaled.cholesky, x);
    return x;
  }
  const Eigenpairs e = eigenpairs(scaled.matrix);
  Matrix y = e.vectors.transpose().lazyProduct(x);
  for (Eigen::Index i = 0; i < y.rows(); ++i) y.row(i) /= e.values(i);
  x = e.vectors.lazyProduct(y);
  return x;
}

void scale_rows(Matrix& m, const Vector& factor) {
  for (Eigen::Index j = 0; j < m.cols(); ++j) {
    for (Eigen::Index i = 0; i < m.rows(); ++i) m(i, j) *= factor(i);
  }
}

Matrix times_power_of_two(const Matrix& m, int exponent) {
  // In two factors: 2^±1074 itself is out of range.
  const double half = std::ldexp(1.0, exponent / 2);
  const double rest = std::ldexp(1.0, exponent - exponent / 2);
  return (m * half) * rest;
}

int exponent_of(const Matrix& matrix) {
  return matrix.size() == 0 ? 0 : binary_exponent(matrix.cwiseAbs().maxCoeff());
}

std::optional<Matrix> square_root(const Matrix& omega) {
  const Scaled scaled = scale(omega);
  Matrix g;
  if (scaled.definiteness == Definiteness::positive && scaled.cholesky.size() > 0) {
    g = scaled.cholesky;
  } else if (scaled.definiteness == Definiteness::indefinite ||
             scaled.definiteness == Definiteness::overflow) {
    return std::nullopt;
  } else {
    const Eigenpairs pairs = eigenpairs(scaled.matrix);
    g = pairs.vectors;
    for (Eigen::Index j = 0; j < g.cols(); ++j)
      g.col(j) *= std::sqrt(std::max(pairs.values(j), 0.0));
  }
  scale_rows(g, scaled.factor.cwiseInverse());
  return g;
}

Matrix gram(const Matrix& w) {
  const Eigen::Index n = w.cols();
  Matrix out(n, n);
  for (Eigen::Index j = 0; j < n; ++j) {
    for (Eigen::Index i = 0; i <= j; ++i) {
      double sum = 0.0;
      for (Eigen::Index k = 0; k < w.rows(); ++k) sum += w(k, i) * w(k, j);
      out(i, j) = out(j, i) = sum;
    }
  }
  return out;
}

Eigenpairs eigenpairs(const Matrix& symmetric) {
  Matrix a = symmetric;
  Eigenpairs out;
  out.vectors = Matrix::Identity(a.rows(), a.cols());
  diagonalise(a, &out.vectors);
  out.values = a.diagonal();
  for (Eigen::Index i = 1; i < out.values.size(); ++i) {
    for (Eigen::Index k = i; k > 0 && out.values(k) < out.values(k - 1); --k) {
      std::swap(out.values(k), out.values(k - 1));
      out.vectors.col(k).swap(out.vectors.col(k - 1));
    }
  }
  return out;
}

Vector eigenvalues(const Matrix& symmetric) {
  Matrix a = symmetric;
  diagonalise(a, nullptr);
  Vector values = a.diagonal();
  std::sort(values.data(), values.data() + values.size());
  return values;
}

}  // namespace hearsay::gaussian
