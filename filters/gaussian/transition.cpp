#include "filters/gaussian/transition.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "filters/gaussian/symmetric.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay::gaussian {
namespace {

using Decomposition = Eigen::PartialPivLU<Matrix>;

Matrix product(const Matrix& a, const Matrix& b) { return a.lazyProduct(b); }

}  // namespace

Transition white_noise_acceleration(int axes, double dt_s, double q) {
  require(axes >= 1 && 2 * axes <= dimension_max, "white-noise acceleration: 1 to 4 axes");
  require(dt_s > 0.0 && q > 0.0 && std::isfinite(dt_s) && std::isfinite(q),
          "white-noise acceleration: dt and q must be positive");
  const int n = 2 * axes;
  Transition t{Matrix::Identity(n, n), Matrix::Zero(n, n)};
  for (int p = 0; p < axes; ++p) {
    const int v = p + axes;
    t.A(p, v) = dt_s;
    t.R(p, p) = q * dt_s * dt_s * dt_s / 3.0;
    t.R(p, v) = t.R(v, p) = q * dt_s * dt_s / 2.0;
    t.R(v, v) = q * dt_s;
  }
  return t;
}

// With Ψ = GGᵀ, (I + ΨR)⁻¹Ψ = G(I + GᵀRG)⁻¹Gᵀ: what is inverted is never worse than the identity,
// and nothing is subtracted.
Prediction predict_with_gain(const Belief& belief, const Transition& transition) {
  const Eigen::Index n = belief.dimension();
  const Matrix& R = transition.R;
  require(transition.A.rows() == n && transition.A.cols() == n && R.rows() == n && R.cols() == n,
          "predict: dimensions differ");
  const Matrix At = transition.A.transpose();
  const Decomposition lu(At);
  require(std::fabs(lu.determinant()) > 0.0, "predict: A is not invertible");
  const Matrix identity = Matrix::Identity(n, n);
  const Matrix back = lu.solve(identity);  // A⁻ᵀ
  if (const auto omega_root = square_root(belief.omega)) {
    const Matrix G = product(back, *omega_root);  // A⁻ᵀG_Ω
    const Matrix RG = product(R, G);
    const Scaled middle = scale(identity + product(G.transpose(), RG));
    if (middle.cholesky.size() > 0) {
      // W = L⁻¹D Gᵀ, so that WᵀW = G(I + GᵀRG)⁻¹Gᵀ.
      Matrix W = G.transpose();
      scale_rows(W, middle.factor);
      solve_lower(middle.cholesky, W);
      Matrix w = product(RG.transpose(), back);
      scale_rows(w, middle.factor);
      solve_lower(middle.cholesky, w);
      const Matrix F = back - product(W.transpose(), w);
      return {{gram(W), F.lazyProduct(belief.xi)}, F};
    }
  }
  // A belief that a faulty rule made indefinite: what its user would compute.
  const Matrix half = product(back, belief.omega);             // A⁻ᵀΩ
  const Matrix psi = product(half, Matrix(back.transpose()));  // A⁻ᵀΩA⁻¹
  const Decomposition general(identity + product(psi, R));
  const Matrix omega = general.solve(psi);
  const Matrix F = general.solve(back);
  return {{0.5 * (omega + omega.transpose()), F.lazyProduct(belief.xi)}, F};
}

Belief predict(const Belief& belief, const Transition& transition) {
  return predict_with_gain(belief, transition).belief;
}

}  // namespace hearsay::gaussian
