// A Gaussian belief about a moving state at several instants at once: its trajectory over stamps
// t₀ < t₁ < … in information form. Merino 2007, section 3.1.2, Algorithm 3.3.
//
// As the state is Markov, Ω is block tridiagonal. Only these blocks are kept: for each step k the
// n×n block Ω_k,k, the n×n block Ω_k,k+1 and the n-vector ξ_k. Prediction and update touch one or
// two of them; a measurement may come late, at any stamp that is still there. Means and marginal
// covariances cost a block Cholesky factorisation, linear in the number of steps
// (trajectory_factor.hpp).
//
// Ω need not be regular: a trajectory about which nothing is known but how it moves is legal.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "filters/gaussian/belief.hpp"
#include "filters/gaussian/transition.hpp"

namespace hearsay::gaussian {

/// The instant of a step, in whatever unit the user counts: nanoseconds, say.
using Stamp = std::int64_t;

class Trajectory {
 public:
  using Block = Eigen::Map<Matrix>;
  using ConstBlock = Eigen::Map<const Matrix>;
  using Part = Eigen::Map<Vector>;
  using ConstPart = Eigen::Map<const Vector>;

  /// Knows nothing about a state of dimension n, 1 ≤ n ≤ dimension_max, at one stamp.
  Trajectory(int n, Stamp first);

  int dimension() const { return n_; }
  int steps() const { return static_cast<int>(stamps_.size()); }
  std::span<const Stamp> stamps() const { return stamps_; }
  /// The step with this stamp.
  std::optional<int> find(Stamp stamp) const;

  /// Ω_k,k (n×n, symmetric), 0 ≤ k < steps().
  ConstBlock omega(int k) const { return {at(k), n_, n_}; }
  /// Ω_k,k+1 (n×n), 0 ≤ k < steps() − 1.
  ConstBlock omega_next(int k) const { return {at(k) + n_ * n_, n_, n_}; }
  /// ξ_k (n).
  ConstPart xi(int k) const { return {at(k) + 2 * n_ * n_, n_}; }

  /// Prediction: adds a step behind the last one, (−A, I)ᵀR⁻¹(−A, I) on both (eq. 3.27–3.28).
  /// @throws BrokenInvariant unless `stamp` is later than the last, or if dimensions differ or R is
  /// not positive definite.
  void augment(Stamp stamp, const Transition& transition);

  /// Adds a step behind the last one with blocks that are known, as those of a message: `before` is
  /// Ω_k−1,k (n×n), `own` are Ω_k,k and ξ_k. @throws BrokenInvariant as above.
  void append(Stamp stamp, const Matrix& before, const Belief& own);

  /// Adds independent information about the state at step k: a measurement (eq. 3.29–3.30), or what
  /// somebody else measured.
  void update(int k, const Belief& information);
  /// Takes information out again.
  void take_out(int k, const Belief& information);

  /// Takes step k out of the trajectory; what it tells about its neighbours stays (eq. 3.31–3.33).
  /// False, and nothing changes, if Ω_k,k is singular or not finite, or it is the only step: then
  /// nothing can be concluded from it. (Of a trajectory of several steps no block is singular, for
  /// the motion alone makes it regular.)
  bool marginalise(int k);

  /// This and independent information over the same stamps: Ω += other.Ω, ξ += other.ξ.
  /// @throws BrokenInvariant unless both have the same stamps and dimension.
  Trajectory& operator+=(const Trajectory& other);
  Trajectory& operator-=(const Trajectory& other);
  Trajectory& operator*=(double factor);
  /// ω·this + (1−ω)·other: covariance intersection (eq. 3.45–3.46), block by block, so that the
  /// result is tridiagonal again.
  void intersect(double omega, const Trajectory& other);

 private:
  std::size_t stride() const { return static_cast<std::size_t>(n_ * (2 * n_ + 1)); }
  double* at(int k) { return numbers_.data() + static_cast<std::size_t>(k) * stride(); }
  const double* at(int k) const { return numbers_.data() + static_cast<std::size_t>(k) * stride(); }
  Block block(int k) { return {at(k), n_, n_}; }
  Block block_next(int k) { return {at(k) + n_ * n_, n_, n_}; }
  Part part(int k) { return {at(k) + 2 * n_ * n_, n_}; }
  void require_like(const Trajectory& other) const;
  void remove(int k);

  int n_;
  std::vector<Stamp> stamps_;
  // A row a step: Ω_k,k and Ω_k,k+1 by columns, ξ_k. What follows the last step is zero.
  std::vector<double> numbers_;
};

/// The belief about the state at the last stamp: all others marginalised. What is left of a
/// direction below 1e-11 of what the last block says of it is rounding, and counts as unknown; so
/// does everything where nothing can be concluded (marginalise() is false).
Belief present(const Trajectory& trajectory);

}  // namespace hearsay::gaussian
