// Ledgers with a matrix for each measurement: of rules that weigh direction by direction, and of
// states that move.
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

/// x ← Gx for all matrices of a list.
void multiply(const Matrix& G, std::vector<double>& matrices) {
  const auto n = static_cast<int>(G.rows());
  for (std::size_t at = 0; at < matrices.size(); at += squared(n)) {
    Eigen::Map<Matrix> x(matrices.data() + at, n, n);
    const Matrix product = G.lazyProduct(x);
    x = product;
  }
}

/// x ← ax + by − cz; lists are as long as the longest.
void add(double a, std::vector<double>& x, double b, std::span<const double> y, double c,
         std::span<const double> z) {
  x.resize(std::max({x.size(), y.size(), z.size()}), 0.0);
  for (std::size_t i = 0; i < x.size(); ++i) {
    double sum = a * x[i];
    if (i < y.size()) sum += b * y[i];
    if (i < z.size()) sum -= c * z[i];
    x[i] = sum;
  }
}

/// x ← Gx + Hy for all matrices of two lists.
void add(const Matrix& G, std::vector<double>& x, const Matrix& H, std::span<const double> y) {
  const auto n = static_cast<int>(G.rows());
  x.resize(std::max(x.size(), y.size()), 0.0);
  multiply(G, x);
  for (std::size_t at = 0; at < y.size(); at += squared(n)) {
    Eigen::Map<Matrix>(x.data() + at, n, n) +=
        H.lazyProduct(Eigen::Map<const Matrix>(y.data() + at, n, n));
  }
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

Matrix MeasurementBook::motion_square_of(std::span<const double> drift) const {
  Matrix sum = Matrix::Zero(dimension_, dimension_);
  for (std::size_t s = 0; s < drift.size() / squared(dimension_); ++s) {
    const Weight H = weight(drift, s, dimension_);
    const Matrix left = H.lazyProduct(motion_);
    sum += left.lazyProduct(H.transpose());
  }
  return 0.5 * (sum + sum.transpose());
}

Ledger Ledger::moving(int n) {
  Ledger ledger;
  ledger.dimension_ = n;
  ledger.moves_ = true;
  return ledger;
}

void Ledger::predict(const Matrix& F, const Matrix& omega, std::size_t step) {
  require(moves_ && F.rows() == dimension_ && omega.rows() == dimension_,
          "Ledger::predict: the state stands still, or dimensions differ");
  multiply(F, matrices_);
  multiply(F, drift_);
  const std::size_t size = squared(dimension_);
  if (drift_.size() < (step + 1) * size) drift_.resize((step + 1) * size, 0.0);
  Eigen::Map<Matrix>(drift_.data() + step * size, dimension_, dimension_) -= omega;
}

void Ledger::combine_moving(double a, double b, const Ledger& received, double c,
                            const Ledger* common) {
  require(received.dimension_ == dimension_ && received.moves_,
          "Ledger::combine: a state that moves and one that does not");
  const Ledger nothing;
  const Ledger& known = common != nullptr ? *common : nothing;
  add(a, matrices_, b, received.matrices_, c, known.matrices_);
  add(a, drift_, b, received.drift_, c, known.drift_);
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
  exact_ = exact_ && received.exact_;
  if (moves_) {
    const std::size_t size = std::max(weights_.size(), received.weights_.size());
    add(trace(own) / n, weights_, trace(heard) / n, received.weights_, 0.0, {});
    add(own, matrices_, heard, received.matrices_);
    add(own, drift_, heard, received.drift_);
    reach_.resize(size, 0);
    for (std::size_t k = 0; k < received.reach_.size(); ++k) reach_[k] |= received.reach_[k];
    return;
  }
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
