#include "filters/gaussian/trajectory_factor.hpp"

#include <algorithm>
#include <cmath>

#include "filters/gaussian/block_cholesky.hpp"
#include "filters/gaussian/symmetric.hpp"
#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"

namespace hearsay::gaussian {
namespace {

constexpr double log_2 = 0.69314718055994530942;
/// c −= aᵀb.
void subtract_product(Matrix& c, const Matrix& a, const Matrix& b) {
  for (Eigen::Index j = 0; j < c.cols(); ++j) {
    for (Eigen::Index i = 0; i < c.rows(); ++i) {
      double sum = 0.0;
      for (Eigen::Index k = 0; k < a.rows(); ++k) sum += a(k, i) * b(k, j);
      c(i, j) -= sum;
    }
  }
}

}  // namespace

Definiteness TrajectoryFactor::factor(const Trajectory& trajectory) {
  const int n = trajectory.dimension();
  size_ = static_cast<std::size_t>(trajectory.steps());
  if (steps_.size() < size_) steps_.resize(size_);
  double logs = 0.0;
  int exponents = 0;
  for (std::size_t k = 0; k < size_; ++k) {
    const int i = static_cast<int>(k);
    Step& step = steps_[k];
    if (k == 0) diagonal_factors(trajectory.omega(i), step.factor);
    step.l = trajectory.omega(i);
    scale_both(step.l, step.factor, step.factor);
    step.y = trajectory.xi(i).cwiseProduct(step.factor);
    if (k > 0) {
      const Step& before = steps_[k - 1];
      subtract_product(step.l, before.w, before.w);
      step.y -= before.w.transpose().lazyProduct(before.y);
    }
    const Definiteness definiteness = cholesky(step.l);
    if (definiteness != Definiteness::positive) return definiteness;
    Matrix y = step.y;
    solve_lower(step.l, y);
    if (!all_finite(y)) return Definiteness::overflow;
    step.y = y;
    for (int d = 0; d < n; ++d) {
      int e = 0;
      std::frexp(step.factor(d), &e);
      exponents += e - 1;
      logs += math::log(step.l(d, d));
    }
    if (k + 1 == size_) break;
    Step& next = steps_[k + 1];
    diagonal_factors(trajectory.omega(i + 1), next.factor);
    step.w = trajectory.omega_next(i);
    scale_both(step.w, step.factor, next.factor);
    solve_lower(step.l, step.w);
  }
  log_determinant_ = 2.0 * (logs - log_2 * exponents);
  return Definiteness::positive;
}

// x_k = D L⁻ᵀ(y_k − W_k D⁻¹x_k+1); scaled means are unscaled only at the end.
const std::vector<Vector>& TrajectoryFactor::means() {
  means_.resize(size_);
  Matrix later;
  for (std::size_t k = size_; k-- > 0;) {
    const Step& step = steps_[k];
    Matrix x = step.y;
    if (k + 1 < size_) x -= step.w.lazyProduct(later);
    solve_lower_transposed(step.l, x);
    later = x;
    means_[k] = x.col(0).cwiseProduct(step.factor);
  }
  return means_;
}

// Σ_k,k = P_k⁻¹ + GΣ_k+1,k+1Gᵀ with G = P_k⁻¹Ω_k,k+1 = L_k⁻ᵀW_k.
const std::vector<Matrix>& TrajectoryFactor::covariances() {
  covariances_.resize(size_);
  Matrix later;
  for (std::size_t k = size_; k-- > 0;) {
    const Step& step = steps_[k];
    Matrix inverse = Matrix::Identity(step.l.rows(), step.l.cols());
    solve_lower(step.l, inverse);
    Matrix sigma = gram(inverse);
    if (k + 1 < size_) {
      Matrix g = step.w;
      solve_lower_transposed(step.l, g);
      const Matrix gs = g.lazyProduct(later);
      const Matrix more = gs.lazyProduct(g.transpose());
      sigma += 0.5 * (more + more.transpose());
    }
    later = sigma;
    scale_both(sigma, step.factor, step.factor);
    covariances_[k] = sigma;
  }
  return covariances_;
}

// Σ_k,k+1 = −GΣ_k+1,k+1: all other blocks of Θ are zero.
double TrajectoryFactor::trace_with(const Trajectory& other) {
  const std::vector<Matrix>& sigma = covariances();
  double trace = 0.0;
  for (std::size_t k = 0; k < size_; ++k) {
    const int i = static_cast<int>(k);
    trace += sigma[k].cwiseProduct(other.omega(i)).sum();
    if (k + 1 == size_) break;
    const Step& step = steps_[k];
    Matrix g = step.w;
    solve_lower_transposed(step.l, g);
    scale_both(g, step.factor, steps_[k + 1].factor.cwiseInverse());
    const Matrix beside = g.lazyProduct(sigma[k + 1]);
    trace -= 2.0 * beside.cwiseProduct(other.omega_next(i)).sum();
  }
  return trace;
}

std::optional<double> nees(const Trajectory& trajectory, std::span<const Vector> truth) {
  TrajectoryFactor factor;
  return nees(trajectory, truth, factor);
}

std::optional<double> nees(const Trajectory& trajectory, std::span<const Vector> truth,
                           TrajectoryFactor& room) {
  require(truth.size() == static_cast<std::size_t>(trajectory.steps()),
          "nees: a true state for each step");
  if (room.factor(trajectory) != Definiteness::positive) return std::nullopt;
  const std::vector<Vector>& means = room.means();
  double sum = 0.0;
  Vector later;
  for (int k = trajectory.steps() - 1; k >= 0; --k) {
    const auto i = static_cast<std::size_t>(k);
    const Vector e = means[i] - truth[i];
    sum += e.cwiseProduct(trajectory.omega(k).lazyProduct(e)).sum();
    if (later.size() > 0) {
      sum += 2.0 * e.cwiseProduct(trajectory.omega_next(k).lazyProduct(later)).sum();
    }
    later = e;
  }
  if (!std::isfinite(sum)) return std::nullopt;
  return sum;
}

std::optional<double> kl_divergence_nats(const Trajectory& p, const Trajectory& q) {
  require(p.dimension() == q.dimension() && std::ranges::equal(p.stamps(), q.stamps()),
          "kl_divergence_nats: trajectories must have the same stamps and dimension");
  TrajectoryFactor fp, fq;
  if (fp.factor(p) != Definiteness::positive) return std::nullopt;
  if (fq.factor(q) != Definiteness::positive) return std::nullopt;
  const auto distance = nees(q, fp.means());
  if (!distance) return std::nullopt;
  const double trace = fp.trace_with(q);
  const double kl = 0.5 * (trace - p.dimension() * p.steps() + *distance + fp.log_determinant() -
                           fq.log_determinant());
  if (!std::isfinite(kl)) return std::nullopt;
  return kl < 0.0 ? 0.0 : kl;  // below zero by rounding only
}

}  // namespace hearsay::gaussian
