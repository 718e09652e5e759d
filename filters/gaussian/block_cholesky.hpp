// The steps of a block Cholesky factorisation of a trajectory. Internal to filters/.
//
// What is left of a block when earlier steps are eliminated may be rounding alone. So a block is
// scaled by its own diagonal before anything is taken off it, and a pivot counts as none if it is
// negligible beside that.
#pragma once

#include <cmath>

#include "filters/gaussian/belief.hpp"

namespace hearsay::gaussian {

inline constexpr double singular_below = 1e-13;  // times n, of a diagonal in [½, 2)

/// Powers of two that bring a diagonal to [½, 2); 1 where it is not positive.
template <class Block>
void diagonal_factors(const Block& omega, Vector& factor) {
  factor.resize(omega.rows());
  for (Eigen::Index i = 0; i < omega.rows(); ++i) {
    factor(i) = 1.0;
    if (!(omega(i, i) > 0.0) || !std::isfinite(omega(i, i))) continue;
    int e = 0;
    std::frexp(omega(i, i), &e);
    factor(i) = std::ldexp(1.0, -((e >= 0 ? e : e - 1) / 2));
  }
}

/// a ← DₐaD_b.
inline void scale_both(Matrix& a, const Vector& rows, const Vector& columns) {
  for (Eigen::Index j = 0; j < a.cols(); ++j) {
    for (Eigen::Index i = 0; i < a.rows(); ++i) a(i, j) *= rows(i) * columns(j);
  }
}

/// The lower factor in place, zero above the diagonal.
inline Definiteness cholesky(Matrix& a) {
  const Eigen::Index n = a.rows();
  const double threshold = static_cast<double>(n) * singular_below;
  for (Eigen::Index j = 0; j < n; ++j) {
    for (Eigen::Index k = 0; k < j; ++k) {
      for (Eigen::Index i = j; i < n; ++i) a(i, j) -= a(i, k) * a(j, k);
    }
    const double pivot = a(j, j);
    if (!std::isfinite(pivot)) return Definiteness::overflow;
    if (pivot <= threshold) {
      return pivot < -threshold ? Definiteness::indefinite : Definiteness::singular;
    }
    const double root = std::sqrt(pivot);
    a(j, j) = root;
    for (Eigen::Index i = j + 1; i < n; ++i) a(i, j) /= root;
    for (Eigen::Index i = 0; i < j; ++i) a(i, j) = 0.0;
  }
  return Definiteness::positive;
}

}  // namespace hearsay::gaussian
