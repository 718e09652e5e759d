// Ledgers of rules that weigh direction by direction: a matrix for each measurement.
#include <algorithm>

#include "filters/ledger/ledger.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay {

using gaussian::Belief;
using gaussian::Matrix;

namespace {

using Weight = Eigen::Map<const Matrix>;

std::size_t squared(int n) { return static_cast<std::size_t>(n) * static_cast<std::size_t>(n); }

Weight weight(std::span<const double> matrices, std::size_t k, int n) {
  return {matrices.data() + k * squared(n), n, n};
}

double trace(const Matrix& m) {
  double sum = 0.0;
  for (Eigen::Index i = 0; i < m.rows(); ++i) sum += m(i, i);
  return sum;
}

}  // namespace

Belief MeasurementBook::weighted_sum_of(std::span<const double> matrices) const {
  Belief sum = Belief::unknown(dimension_);
  const std::size_t known = std::min(count_, matrices.size() / squared(dimension_));
  for (std::size_t k = 0; k < known; ++k) {
    const Belief measured = information(k);
    const Weight W = weight(matrices, k, dimension_);
    sum.omega += W.lazyProduct(measured.omega);
    sum.xi += W.lazyProduct(measured.xi);
  }
  return sum;
}

Matrix MeasurementBook::weighted_square_of(std::span<const double> matrices) const {
  Matrix sum = Matrix::Zero(dimension_, dimension_);
  const std::size_t known = std::min(count_, matrices.size() / squared(dimension_));
  for (std::size_t k = 0; k < known; ++k) {
    const Weight W = weight(matrices, k, dimension_);
    const Matrix left = W.lazyProduct(information(k).omega);
    sum += left.lazyProduct(W.transpose());
  }
  return 0.5 * (sum + sum.transpose());
}

// From here on with matrices: so far W_k = w_k·I.
void Ledger::spread(int dimension) {
  const std::size_t known = dimension_ == 0 ? 0 : matrices_.size() / squared(dimension);
  dimension_ = dimension;
  matrices_.resize(weights_.size() * squared(dimension), 0.0);
  for (std::size_t k = known; k < weights_.size(); ++k) {
    Eigen::Map<Matrix> W(matrices_.data() + k * squared(dimension), dimension, dimension);
    for (Eigen::Index i = 0; i < dimension; ++i) W(i, i) = weights_[k];
  }
}

void Ledger::combine(const Matrix& own, const Matrix& heard, const Ledger& received) {
  const auto n = static_cast<int>(own.rows());
  require(dimension_ == 0 || dimension_ == n, "Ledger::combine: dimensions differ");
  spread(n);
  if (received.weights_.size() > weights_.size()) {
    weights_.resize(received.weights_.size(), 0.0);
    reach_.resize(received.weights_.size(), 0);
    spread(n);
  }
  for (std::size_t k = 0; k < weights_.size(); ++k) {
    Eigen::Map<Matrix> W(matrices_.data() + k * squared(n), n, n);
    Matrix sum = own.lazyProduct(W);
    if (k < received.weights_.size()) {
      if (received.dimension_ == 0) {
        sum += received.weights_[k] * heard;
      } else {
        sum += heard.lazyProduct(weight(received.matrices_, k, n));
      }
    }
    W = sum;
    weights_[k] = trace(sum) / n;
  }
  for (std::size_t k = 0; k < received.reach_.size(); ++k) reach_[k] |= received.reach_[k];
}

}  // namespace hearsay
