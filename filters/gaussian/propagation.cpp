#include "filters/gaussian/propagation.hpp"

#include <cmath>

#include "sim/kernel/error.hpp"

namespace hearsay::gaussian {
namespace {

Matrix symmetrised(const Matrix& m) { return 0.5 * (m + m.transpose()); }

}  // namespace

std::optional<Moments> moments(const Belief& belief) {
  const auto mean = state(belief);
  const auto sigma = covariance(belief);
  if (!mean || !sigma) return std::nullopt;
  return Moments{*mean, *sigma};
}

Moments linearised(const Moments& x, const Vector& f_of_mean, const Matrix& jacobian) {
  const Eigen::Index n = x.mean.size();
  require(x.covariance.rows() == n && x.covariance.cols() == n && jacobian.cols() == n &&
              jacobian.rows() == f_of_mean.size(),
          "linearised: the shapes of Σ (n×n), J (m×n) and f(μ) (m) disagree");
  const Matrix spread = jacobian.lazyProduct(x.covariance);
  return {f_of_mean, symmetrised(spread.lazyProduct(jacobian.transpose()))};
}

std::optional<SigmaPoints> sigma_points(const Moments& x, double kappa) {
  const auto n = static_cast<int>(x.mean.size());
  require(n >= 1 && n <= dimension_max && x.covariance.rows() == n && x.covariance.cols() == n,
          "sigma points: the shapes of μ (n) and Σ (n×n) disagree");
  require(std::isfinite(kappa) && n + kappa > 0.0, "sigma points: n + κ must be positive");
  const auto root = square_root(x.covariance);
  if (!root || !all_finite(x.mean)) return std::nullopt;
  SigmaPoints at;
  at.count = 2 * n + 1;
  at.points[0] = x.mean;
  at.weights[0] = kappa / (n + kappa);
  const double reach = std::sqrt(n + kappa);
  for (int i = 0; i < n; ++i) {
    const auto up = static_cast<std::size_t>(1 + i), down = static_cast<std::size_t>(1 + n + i);
    at.points[up] = x.mean + reach * root->col(i);
    at.points[down] = x.mean - reach * root->col(i);
    at.weights[up] = at.weights[down] = 0.5 / (n + kappa);
  }
  return at;
}

Propagated propagated(const SigmaPoints& x, const Vector& f_of_mean,
                      const std::array<Vector, 2 * dimension_max + 1>& differences) {
  const Eigen::Index m = f_of_mean.size(), n = x.points[0].size();
  const auto count = static_cast<std::size_t>(x.count);
  Vector shift = Vector::Zero(m);
  for (std::size_t i = 0; i < count; ++i) shift += x.weights[i] * differences[i];
  Propagated out{{f_of_mean + shift, Matrix::Zero(m, m)}, Matrix::Zero(n, m)};
  for (std::size_t i = 0; i < count; ++i) {
    const Vector dy = differences[i] - shift;
    const Vector dx = x.points[i] - x.points[0];
    for (Eigen::Index column = 0; column < m; ++column) {
      const double weighted = x.weights[i] * dy(column);
      out.y.covariance.col(column) += weighted * dy;
      out.cross.col(column) += weighted * dx;
    }
  }
  out.y.covariance = symmetrised(out.y.covariance);
  return out;
}

void RunningMoments::add(const Vector& y) {
  if (count_ == 0) {
    mean_ = Vector::Zero(y.size());
    sum_ = Matrix::Zero(y.size(), y.size());
  }
  require(y.size() == mean_.size(), "moments: values differ in dimension");
  ++count_;
  const Vector before = y - mean_;
  mean_ += before / static_cast<double>(count_);
  const double share = static_cast<double>(count_ - 1) / static_cast<double>(count_);
  for (Eigen::Index j = 0; j < y.size(); ++j) sum_.col(j) += share * before(j) * before;
}

std::optional<Moments> RunningMoments::moments() const {
  if (count_ < 2) return std::nullopt;
  return Moments{mean_, symmetrised(sum_ / static_cast<double>(count_ - 1))};
}

}  // namespace hearsay::gaussian
