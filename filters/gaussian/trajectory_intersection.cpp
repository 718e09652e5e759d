// Covariance intersection of trajectories: the zero of the slope of
//     f(ω) = log |Ω_b + ω(Ω_a − Ω_b)|,
// which is concave. With the block Cholesky factorisation at ω, dP_k and d²P_k the derivatives of
// its P_k, X = L⁻¹dPL⁻ᵀ, Y = L⁻¹d²PL⁻ᵀ, V = L⁻¹d(Ω_k,k+1) and Z = V − XW:
//     dP_k+1  = d(Ω_k+1,k+1) − VᵀW − WᵀZ,      f'  = Σ tr X,
//     d²P_k+1 = WᵀYW − 2ZᵀZ,                   f'' = Σ (tr Y − ‖X‖²).
#include <algorithm>
#include <cmath>
#include <utility>

#include "filters/gaussian/block_cholesky.hpp"
#include "filters/gaussian/symmetric.hpp"
#include "filters/gaussian/trajectory_factor.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay::gaussian {
namespace {

struct Slope {
  double first;
  double second;
};

/// aᵀb.
Matrix product(const Matrix& a, const Matrix& b) { return a.transpose().lazyProduct(b); }

/// x ← L⁻¹x column by column, with the reciprocals of L's diagonal.
void whiten(const Matrix& l, const Vector& reciprocal, Matrix& x) {
  const Eigen::Index n = x.rows();
  for (Eigen::Index c = 0; c < x.cols(); ++c) {
    double* const v = x.data() + c * n;
    for (Eigen::Index k = 0; k < n; ++k) {
      v[k] *= reciprocal(k);
      const double* const below = l.data() + k * n;
      for (Eigen::Index i = k + 1; i < n; ++i) v[i] -= below[i] * v[k];
    }
  }
}

/// a ← L⁻¹aL⁻ᵀ of a symmetric a.
void whiten_both(const Matrix& l, const Vector& reciprocal, Matrix& a) {
  whiten(l, reciprocal, a);
  a.transposeInPlace();
  whiten(l, reciprocal, a);
}

/// ωa + (1−ω)b and a − b.
void mix(const Trajectory::ConstBlock& a, const Trajectory::ConstBlock& b, double omega,
         Matrix& mixed, Matrix& change) {
  mixed = omega * a + (1.0 - omega) * b;
  change = a - b;
}

/// At Ω = ωΩ_a + (1−ω)Ω_b; nothing unless it is positive definite.
std::optional<Slope> slope(const Trajectory& a, const Trajectory& b, double omega) {
  Slope sum{0.0, 0.0};
  Vector scales, next_scales, reciprocal;
  Matrix P, dP, W, V, YW;
  Matrix less_P, less_dP, ddP;  // what the steps before take off, and leave
  for (int k = 0; k < a.steps(); ++k) {
    mix(a.omega(k), b.omega(k), omega, P, dP);
    if (k == 0) {
      diagonal_factors(P, scales);
    } else {
      scales = next_scales;
    }
    scale_both(P, scales, scales);
    scale_both(dP, scales, scales);
    if (k > 0) {
      P -= less_P;
      dP -= less_dP;
    }
    if (cholesky(P) != Definiteness::positive) return std::nullopt;
    const Matrix& L = P;
    reciprocal = L.diagonal().cwiseInverse();
    Matrix& X = dP;
    whiten_both(L, reciprocal, X);
    sum.first += X.trace();
    sum.second -= X.cwiseProduct(X).sum();
    Matrix& Y = ddP;
    if (k > 0) {
      whiten_both(L, reciprocal, Y);
      sum.second += Y.trace();
    }
    if (k + 1 == a.steps()) break;
    const Matrix next = omega * a.omega(k + 1) + (1.0 - omega) * b.omega(k + 1);
    diagonal_factors(next, next_scales);
    mix(a.omega_next(k), b.omega_next(k), omega, W, V);
    for (Matrix* w : {&W, &V}) {
      scale_both(*w, scales, next_scales);
      whiten(L, reciprocal, *w);
    }
    const Matrix Z = V - X.lazyProduct(W);
    less_P = gram(W);
    less_dP = product(V, W) + product(W, Z);
    if (k > 0) YW = Y.lazyProduct(W);
    ddP = -2.0 * gram(Z);
    if (k > 0) ddP += product(W, YW);
  }
  return sum;
}

}  // namespace

std::optional<double> intersect_det(const Trajectory& a, const Trajectory& b) {
  require(a.dimension() == b.dimension() && std::ranges::equal(a.stamps(), b.stamps()),
          "intersect_det: trajectories must have the same stamps and dimension");
  // Where the slope at an end still points outwards, the end is best.
  const auto best_at = [&](double end) {
    const auto at_end = slope(a, b, end);
    return at_end && (end > 0.5 ? at_end->first >= 0.0 : at_end->first <= 0.0);
  };
  double omega = 0.5, low = 0.0, high = 1.0;
  bool asked[2] = {false, false};  // about either end
  for (int iteration = 0; iteration < 100; ++iteration) {
    const auto at = slope(a, b, omega);
    if (!at) return std::nullopt;
    if (!(at->second < -1e-20)) return omega;  // the two are equal
    (at->first > 0.0 ? low : high) = omega;
    double next = omega - at->first / at->second;
    if (!(next > low && next < high)) {
      const int end = at->first > 0.0 ? 1 : 0;
      if (!std::exchange(asked[end], true) && best_at(end)) return end;
      next = 0.5 * (low + high);
    }
    const double step = next - omega;
    omega = next;
    // The error after a step of Newton is about step²·√|f''|.
    if (step * step * std::sqrt(-at->second) <= 1e-12 || high - low <= 1e-15) break;
  }
  return omega;
}

}  // namespace hearsay::gaussian
