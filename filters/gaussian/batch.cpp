#include "filters/gaussian/batch.hpp"

#include <algorithm>
#include <cmath>

#include "filters/gaussian/symmetric.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay::gaussian {
namespace {

constexpr int iterations_max = 100;
constexpr double gap = 1e-12;      // complementarity ωᵢzᵢ, beside r
constexpr double reduction = 0.1;  // of it, by one step
constexpr double to_boundary = 0.95;
constexpr double trusted = 0.8;      // length of a step in the metric of −log |Ω|
constexpr double negligible = 1e-8;  // a weight that its slack holds down

/// Wᵀ m W, symmetric to the last bit.
Matrix congruence(const Matrix& m, const Matrix& w) {
  const Matrix half = m.lazyProduct(w);
  const Matrix full = w.transpose().lazyProduct(half);
  return 0.5 * (full + full.transpose());
}

/// L⁻¹ m L⁻ᵀ.
Matrix whitened(const Matrix& m, const Matrix& l) {
  Matrix x = m;
  solve_lower(l, x);
  x.transposeInPlace();
  solve_lower(l, x);
  return x;
}

/// Solves A x = b in place of b by A = LLᵀ (k×k, by rows), in place of A; false unless all pivots
/// are positive.
bool solve_in_place(std::vector<double>& a, std::vector<double>& b) {
  const std::size_t k = b.size();
  for (std::size_t i = 0; i < k; ++i) {
    double* const row = a.data() + i * k;
    for (std::size_t j = 0; j <= i; ++j) {
      const double* const other = a.data() + j * k;
      double sum = row[j];
      for (std::size_t m = 0; m < j; ++m) sum -= row[m] * other[m];
      if (i > j) {
        row[j] = sum / other[j];
      } else if (sum > 0.0) {
        row[i] = std::sqrt(sum);
      } else {
        return false;
      }
    }
  }
  for (std::size_t i = 0; i < k; ++i) {
    for (std::size_t m = 0; m < i; ++m) b[i] -= a[i * k + m] * b[m];
    b[i] /= a[i * k + i];
  }
  for (std::size_t i = k; i-- > 0;) {
    for (std::size_t m = i + 1; m < k; ++m) b[i] -= a[m * k + i] * b[m];
    b[i] /= a[i * k + i];
  }
  return true;
}

}  // namespace

// The constraint Σω = 1 needs no multiplier of its own: log |tΩ| = r log t + log |Ω|, so the
// maximum of log |Ω| − r Σω over ω ≥ 0 lies on the simplex by itself.
std::span<const double> BatchIntersection::weights(std::span<const Matrix* const> omegas) {
  prepare(omegas);
  if (rank_ == 0 || size() == 1) return omega_;
  for (int iteration = 0; iteration < iterations_max; ++iteration) {
    if (!evaluate()) break;
    double complementarity = 0.0, residual = 0.0;
    for (std::size_t i = 0; i < size(); ++i) {
      complementarity += omega_[i] * slack_[i] / static_cast<double>(size());
      residual = std::max(residual, std::fabs(rank_ - slope_[i] - slack_[i]));
    }
    if (complementarity <= gap * rank_ && residual <= 100.0 * gap * rank_) break;
    if (!find_step(reduction * complementarity)) break;
    const double length = step_length();
    for (std::size_t i = 0; i < size(); ++i) {
      omega_[i] += length * step_[i];
      slack_[i] += length * slack_step_[i];
    }
  }
  settle();
  return omega_;
}

void BatchIntersection::prepare(std::span<const Matrix* const> omegas) {
  require(!omegas.empty(), "BatchIntersection: nothing to intersect");
  const std::size_t k = omegas.size();
  const Eigen::Index n = omegas.front()->rows();
  int exponent = exponent_of(*omegas.front());
  for (const Matrix* omega : omegas) {
    require(omega->rows() == n && n >= 1, "BatchIntersection: dimensions differ");
    exponent = std::max(exponent, exponent_of(*omega));
  }
  Matrix sum = Matrix::Zero(n, n);
  for (const Matrix* omega : omegas) sum += times_power_of_two(*omega, -exponent);
  const Scaled scaled = scale(sum);
  rank_ = scaled.rank;
  omega_.assign(k, 1.0 / static_cast<double>(k));
  if (rank_ == 0) return;

  const Eigenpairs range = eigenpairs(scaled.matrix);
  Matrix whitener = range.vectors.rightCols(rank_);
  scale_rows(whitener, scaled.factor);
  for (Eigen::Index i = 0; i < rank_; ++i) {
    whitener.col(i) /= std::sqrt(range.values(n - rank_ + i));
  }
  parts_.resize(k);
  shares_.resize(k);
  for (std::size_t i = 0; i < k; ++i) {
    parts_[i] = congruence(times_power_of_two(*omegas[i], -exponent), whitener);
  }
  slack_.assign(k, static_cast<double>(rank_));
  slope_.assign(k, 0.0);
  step_.assign(k, 0.0);
  slack_step_.assign(k, 0.0);
  curvature_.assign(k * k, 0.0);
}

/// Slope and curvature of −log |Ω| where we stand; false if Ω has no Cholesky factor there.
bool BatchIntersection::evaluate() {
  Matrix sum = omega_[0] * parts_[0];
  for (std::size_t i = 1; i < size(); ++i) sum += omega_[i] * parts_[i];
  const Scaled scaled = scale(sum);
  if (scaled.cholesky.size() == 0) return false;
  Matrix l = scaled.cholesky;
  scale_rows(l, scaled.factor.cwiseInverse());
  for (std::size_t i = 0; i < size(); ++i) {
    shares_[i] = whitened(parts_[i], l);
    slope_[i] = shares_[i].trace();
  }
  for (std::size_t i = 0; i < size(); ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      curvature(i, j) = curvature(j, i) = shares_[i].cwiseProduct(shares_[j]).sum();
    }
  }
  return true;
}

/// Newton's step towards ωᵢzᵢ = target and zᵢ = r − slopeᵢ; false if it is not determined.
bool BatchIntersection::find_step(double target) {
  factor_ = curvature_;
  for (std::size_t i = 0; i < size(); ++i) {
    factor_[i * size() + i] += slack_[i] / omega_[i];
    step_[i] = slope_[i] - rank_ + target / omega_[i];
  }
  if (!solve_in_place(factor_, step_)) return false;
  for (std::size_t i = 0; i < size(); ++i) {
    slack_step_[i] = (target - slack_[i] * step_[i]) / omega_[i] - slack_[i];
  }
  return true;
}

double BatchIntersection::step_length() const {
  double length = 1.0, squared = 0.0;
  for (std::size_t i = 0; i < size(); ++i) {
    if (step_[i] < 0.0) length = std::min(length, -to_boundary * omega_[i] / step_[i]);
    if (slack_step_[i] < 0.0) length = std::min(length, -to_boundary * slack_[i] / slack_step_[i]);
    for (std::size_t j = 0; j < size(); ++j) squared += step_[i] * curvature(i, j) * step_[j];
  }
  const double local = std::sqrt(std::max(squared, 0.0));
  return local > trusted ? std::min(length, trusted / local) : length;
}

/// Weights that only the barrier keeps above zero become zero; the rest add up to one.
void BatchIntersection::settle() {
  double sum = 0.0;
  for (std::size_t i = 0; i < size(); ++i) {
    if (omega_[i] < negligible && slack_[i] > omega_[i]) omega_[i] = 0.0;
    sum += omega_[i];
  }
  for (double& omega : omega_) omega /= sum;
}

double metropolis_weight(int degree_a, int degree_b) {
  return 1.0 / (1.0 + static_cast<double>(std::max(degree_a, degree_b)));
}

}  // namespace hearsay::gaussian
