#include "filters/gaussian/trajectory.hpp"

#include <algorithm>
#include <cmath>

#include "filters/gaussian/symmetric.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay::gaussian {

Trajectory::Trajectory(int n, Stamp first) : n_(n), stamps_{first} {
  require(n >= 1 && n <= dimension_max, "Trajectory: the dimension must be 1 to 8");
  numbers_.assign(stride(), 0.0);
}

std::optional<int> Trajectory::find(Stamp stamp) const {
  const auto found = std::lower_bound(stamps_.begin(), stamps_.end(), stamp);
  if (found == stamps_.end() || *found != stamp) return std::nullopt;
  return static_cast<int>(found - stamps_.begin());
}

void Trajectory::augment(Stamp stamp, const Transition& transition) {
  require(stamp > stamps_.back(), "Trajectory: a stamp must be later than those before");
  require(transition.A.rows() == n_ && transition.A.cols() == n_ && transition.R.rows() == n_,
          "Trajectory: dimensions differ");
  const Scaled R = scale(transition.R);
  require(R.definiteness == Definiteness::positive && R.cholesky.size() > 0,
          "Trajectory: the covariance of the motion's noise must be positive definite");
  // With R = D⁻¹LLᵀD⁻¹ and W = L⁻¹D(−A, I) all blocks are products of W.
  Matrix past = -transition.A;
  Matrix now = Matrix::Identity(n_, n_);
  for (Matrix* w : {&past, &now}) {
    scale_rows(*w, R.factor);
    solve_lower(R.cholesky, *w);
  }
  const int k = steps() - 1;
  stamps_.push_back(stamp);
  numbers_.resize(numbers_.size() + stride(), 0.0);
  block(k) += gram(past);
  block_next(k) += past.transpose().lazyProduct(now);
  block(k + 1) += gram(now);
}

void Trajectory::append(Stamp stamp, const Matrix& before, const Belief& own) {
  require(stamp > stamps_.back(), "Trajectory: a stamp must be later than those before");
  require(own.dimension() == n_ && before.rows() == n_ && before.cols() == n_,
          "Trajectory: dimensions differ");
  const int k = steps();
  stamps_.push_back(stamp);
  numbers_.resize(numbers_.size() + stride(), 0.0);
  block_next(k - 1) = before;
  block(k) = own.omega;
  part(k) = own.xi;
}

void Trajectory::update(int k, const Belief& information) {
  require(k >= 0 && k < steps() && information.dimension() == n_, "Trajectory: no such step");
  block(k) += information.omega;
  part(k) += information.xi;
}

void Trajectory::take_out(int k, const Belief& information) {
  require(k >= 0 && k < steps() && information.dimension() == n_, "Trajectory: no such step");
  block(k) -= information.omega;
  part(k) -= information.xi;
}

bool Trajectory::marginalise(int k) {
  require(k >= 0 && k < steps(), "Trajectory: no such step");
  if (steps() == 1) return false;
  const Scaled own = scale(omega(k));
  if (!own.invertible()) return false;
  const bool before = k > 0, after = k + 1 < steps();
  // X = D·(Ω_k,k−1, Ω_k,k+1, ξ_k) and Y = (DΩ_k,kD)⁻¹X; what is taken away are products of both.
  const auto scaled = [&](Matrix x) {
    scale_rows(x, own.factor);
    return x;
  };
  const Matrix x_xi = scaled(xi(k));
  const Matrix y_xi = solve(own, x_xi);
  Matrix x_before, x_after, y_after;
  if (before) {
    x_before = scaled(omega_next(k - 1).transpose());
    const Matrix y = solve(own, x_before);
    const Matrix less = x_before.transpose().lazyProduct(y);
    block(k - 1) -= 0.5 * (less + less.transpose());
    part(k - 1) -= x_before.transpose().lazyProduct(y_xi);
  }
  if (after) {
    x_after = scaled(omega_next(k));
    y_after = solve(own, x_after);
    const Matrix less = x_after.transpose().lazyProduct(y_after);
    block(k + 1) -= 0.5 * (less + less.transpose());
    part(k + 1) -= x_after.transpose().lazyProduct(y_xi);
  }
  if (before) {
    block_next(k - 1).setZero();
    if (after) block_next(k - 1) -= x_before.transpose().lazyProduct(y_after);
  }
  remove(k);
  return true;
}

void Trajectory::remove(int k) {
  stamps_.erase(stamps_.begin() + k);
  const auto row = static_cast<std::ptrdiff_t>(stride());
  const auto from = numbers_.begin() + k * row;
  numbers_.erase(from, from + row);
}

void Trajectory::require_like(const Trajectory& other) const {
  require(n_ == other.n_ && stamps_ == other.stamps_,
          "trajectories must have the same stamps and dimension to be fused");
}

Trajectory& Trajectory::operator+=(const Trajectory& other) {
  require_like(other);
  for (std::size_t i = 0; i < numbers_.size(); ++i) numbers_[i] += other.numbers_[i];
  return *this;
}

Trajectory& Trajectory::operator-=(const Trajectory& other) {
  require_like(other);
  for (std::size_t i = 0; i < numbers_.size(); ++i) numbers_[i] -= other.numbers_[i];
  return *this;
}

Trajectory& Trajectory::operator*=(double factor) {
  for (double& number : numbers_) number *= factor;
  return *this;
}

void Trajectory::intersect(double omega, const Trajectory& other) {
  require_like(other);
  const double rest = 1.0 - omega;
  for (std::size_t i = 0; i < numbers_.size(); ++i) {
    numbers_[i] = omega * numbers_[i] + rest * other.numbers_[i];
  }
}

Belief present(const Trajectory& trajectory) {
  const auto said = [&](int k) { return Belief{trajectory.omega(k), trajectory.xi(k)}; };
  const std::span<const Stamp> stamps = trajectory.stamps();
  Trajectory left(trajectory.dimension(), stamps[0]);
  left.update(0, said(0));
  for (int k = 1; k < trajectory.steps(); ++k) {
    left.append(stamps[static_cast<std::size_t>(k)], trajectory.omega_next(k - 1), said(k));
    if (!left.marginalise(0)) return Belief::unknown(trajectory.dimension());
  }
  const Scaled before = scale(trajectory.omega(trajectory.steps() - 1));
  Matrix omega = left.omega(0), xi = left.xi(0);
  if (before.definiteness == Definiteness::overflow || !omega.allFinite()) return {omega, xi};
  // In the scale of the block before, directions that are known are far from zero.
  scale_rows(omega, before.factor);
  omega.transposeInPlace();
  scale_rows(omega, before.factor);
  scale_rows(xi, before.factor);
  const Eigenpairs pairs = eigenpairs(omega);
  Matrix known = Matrix::Zero(omega.rows(), omega.cols());
  for (Eigen::Index j = 0; j < omega.cols(); ++j) {
    if (std::fabs(pairs.values(j)) < 1e-11) continue;
    known += pairs.vectors.col(j) * pairs.vectors.col(j).transpose();
  }
  if (known.isIdentity(1e-14)) return {left.omega(0), left.xi(0)};
  const Matrix half = known.lazyProduct(omega);
  omega = half.lazyProduct(known);
  xi = known.lazyProduct(xi).eval();
  const Vector back = before.factor.cwiseInverse();
  scale_rows(omega, back);
  omega.transposeInPlace();
  scale_rows(omega, back);
  scale_rows(xi, back);
  return {0.5 * (omega + omega.transpose()), Vector(xi)};
}

}  // namespace hearsay::gaussian
