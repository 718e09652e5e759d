#include "filters/ledger/ledger.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "filters/gaussian/symmetric.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

using gaussian::Belief;
using gaussian::dimension_max;
using gaussian::Matrix;

constexpr std::size_t entries_max = dimension_max * (dimension_max + 1) / 2 + dimension_max;
using Sums = std::array<double, entries_max>;

std::size_t triangle(int n) { return static_cast<std::size_t>(n * (n + 1) / 2); }

/// sums[j] += weight·row[j], unrolled so that the sums stay in registers.
template <std::size_t... J>
void add_row(double (&sums)[sizeof...(J)], double weight, const double* row,
             std::index_sequence<J...>) {
  ((sums[J] += weight * row[J]), ...);
}

/// Σ over k of weight(k) · rows[k·stride + j] for j < Width, in four interleaved partial sums: a
/// single one would wait for its own last addition.
template <std::size_t Width, typename WeightAt>
Sums accumulated(std::span<const double> rows, std::size_t count, std::size_t stride,
                 const WeightAt& weight_at) {
  constexpr auto columns = std::make_index_sequence<Width>();
  double s0[Width] = {};
  double s1[Width] = {};
  double s2[Width] = {};
  double s3[Width] = {};
  const double* row = rows.data();
  std::size_t k = 0;
  for (; k + 4 <= count; k += 4, row += 4 * stride) {
    add_row(s0, weight_at(k), row, columns);
    add_row(s1, weight_at(k + 1), row + stride, columns);
    add_row(s2, weight_at(k + 2), row + 2 * stride, columns);
    add_row(s3, weight_at(k + 3), row + 3 * stride, columns);
  }
  for (; k < count; ++k, row += stride) add_row(s0, weight_at(k), row, columns);
  Sums sums{};
  for (std::size_t j = 0; j < Width; ++j) sums[j] = (s0[j] + s1[j]) + (s2[j] + s3[j]);
  return sums;
}

template <typename WeightAt>
Sums accumulated(std::span<const double> rows, std::size_t count, std::size_t stride,
                 std::size_t width, const WeightAt& weight_at) {
  if (width == 5) return accumulated<5>(rows, count, stride, weight_at);  // Ω and ξ for n = 2
  if (width == 3) return accumulated<3>(rows, count, stride, weight_at);  // Ω alone
  Sums sums{};
  for (std::size_t k = 0; k < count; ++k) {
    for (std::size_t j = 0; j < width; ++j) sums[j] += weight_at(k) * rows[k * stride + j];
  }
  return sums;
}

Matrix unpacked(const Sums& sums, int n) {
  Matrix m(n, n);
  std::size_t at = 0;
  for (int i = 0; i < n; ++i) {
    for (int j = i; j < n; ++j) m(i, j) = m(j, i) = sums[at++];
  }
  return m;
}

Belief unpacked_belief(const Sums& sums, int n) {
  Belief belief{unpacked(sums, n), gaussian::Vector(n)};
  for (int i = 0; i < n; ++i) belief.xi(i) = sums[triangle(n) + static_cast<std::size_t>(i)];
  return belief;
}

/// Frobenius, free of overflow.
double norm(const Matrix& m) {
  const int exponent = gaussian::exponent_of(m);
  double sum = 0.0;
  for (Eigen::Index j = 0; j < m.cols(); ++j) {
    for (Eigen::Index i = 0; i < m.rows(); ++i) {
      const double x = std::ldexp(m(i, j), -exponent);
      sum += x * x;
    }
  }
  return std::ldexp(std::sqrt(sum), exponent);
}

/// ‖value − reference‖/‖reference‖; 0 if both are zero, infinite if only the reference is.
double relative_distance(const Matrix& value, const Matrix& reference) {
  if (!value.allFinite()) return std::numeric_limits<double>::infinity();
  const double distance = norm(value - reference);
  return distance == 0.0 ? 0.0 : distance / norm(reference);
}

/// into[k] |= from[k], eight at a time.
void unite(std::uint8_t* into, const std::uint8_t* from, std::size_t count) {
  std::size_t k = 0;
  for (; k + 8 <= count; k += 8) {
    std::uint64_t x = 0;
    std::uint64_t y = 0;
    std::memcpy(&x, into + k, 8);
    std::memcpy(&y, from + k, 8);
    x |= y;
    std::memcpy(into + k, &x, 8);
  }
  for (; k < count; ++k) into[k] |= from[k];
}

template <typename T>
void copy_with_room(const std::vector<T>& from, std::vector<T>& to) {
  if (to.capacity() < from.size()) {
    to.clear();
    to.reserve(2 * from.size());
  }
  to.assign(from.begin(), from.end());
}

/// D·m·D·2^exponent for a diagonal D of powers of two.
Matrix both_sides(const gaussian::Vector& d, const Matrix& m, int exponent) {
  Matrix out(m.rows(), m.cols());
  for (Eigen::Index j = 0; j < m.cols(); ++j) {
    for (Eigen::Index i = 0; i < m.rows(); ++i) {
      // In one step: D alone may take m out of range before 2^exponent brings it back.
      out(i, j) = std::ldexp(m(i, j), std::ilogb(d(i)) + std::ilogb(d(j)) + exponent);
    }
  }
  return out;
}

}  // namespace

std::size_t MeasurementBook::add(const Belief& information) {
  require(information.dimension() == dimension_,
          "MeasurementBook: a measurement of another dimension");
  for (int i = 0; i < dimension_; ++i) {
    for (int j = i; j < dimension_; ++j) information_.push_back(information.omega(i, j));
  }
  for (int i = 0; i < dimension_; ++i) information_.push_back(information.xi(i));
  return count_++;
}

Belief MeasurementBook::information(std::size_t k) const {
  const std::size_t stride = triangle(dimension_) + static_cast<std::size_t>(dimension_);
  Sums row{};
  std::copy_n(information_.data() + k * stride, stride, row.begin());
  return unpacked_belief(row, dimension_);
}

Belief MeasurementBook::weighted_sum(std::span<const double> weights) const {
  const std::size_t stride = triangle(dimension_) + static_cast<std::size_t>(dimension_);
  const Sums sums = accumulated(information_, std::min(count_, weights.size()), stride, stride,
                                [&](std::size_t k) { return weights[k]; });
  return unpacked_belief(sums, dimension_);
}

Belief MeasurementBook::sum_over(std::span<const std::uint8_t> chosen) const {
  const std::size_t stride = triangle(dimension_) + static_cast<std::size_t>(dimension_);
  const Sums sums = accumulated(information_, std::min(count_, chosen.size()), stride, stride,
                                [&](std::size_t k) { return chosen[k] != 0 ? 1.0 : 0.0; });
  return unpacked_belief(sums, dimension_);
}

Matrix MeasurementBook::weighted_square(std::span<const double> weights, double scale) const {
  const std::size_t stride = triangle(dimension_) + static_cast<std::size_t>(dimension_);
  const Sums sums = accumulated(information_, std::min(count_, weights.size()), stride,
                                triangle(dimension_), [&](std::size_t k) {
                                  const double w = scale * weights[k];
                                  return w * w;
                                });
  return unpacked(sums, dimension_);
}

Ledger::Parts Ledger::parts() const {
  return {.weights = weights_,
          .matrices = matrices_,
          .drift = drift_,
          .reach = reach_,
          .dimension = dimension_,
          .moves = moves_,
          .exact = exact_};
}

Ledger Ledger::from(Parts parts) {
  const int n = parts.dimension;
  require(n >= 0 && n <= gaussian::dimension_max && (n > 0 || !parts.moves),
          "a ledger of another dimension");
  const std::size_t square = static_cast<std::size_t>(n) * static_cast<std::size_t>(n);
  const auto whole = [&](const std::vector<double>& numbers) {
    return square == 0 ? numbers.empty() : numbers.size() % square == 0;
  };
  require(whole(parts.matrices) && whole(parts.drift), "a ledger with half a matrix");
  require(parts.matrices.size() <= square * parts.weights.size(),
          "a ledger with more matrices than weights");
  require(parts.reach.size() == parts.weights.size(),
          "a ledger with more or less reach than weights");
  Ledger ledger;
  ledger.weights_ = std::move(parts.weights);
  ledger.matrices_ = std::move(parts.matrices);
  ledger.drift_ = std::move(parts.drift);
  ledger.reach_ = std::move(parts.reach);
  ledger.dimension_ = n;
  ledger.moves_ = parts.moves;
  ledger.exact_ = parts.exact;
  return ledger;
}

Ledger& Ledger::operator=(const Ledger& other) {
  if (this != &other) {
    copy_with_room(other.weights_, weights_);
    copy_with_room(other.matrices_, matrices_);
    copy_with_room(other.drift_, drift_);
    dimension_ = other.dimension_;
    moves_ = other.moves_;
    exact_ = other.exact_;
    copy_with_room(other.reach_, reach_);
  }
  return *this;
}

void Ledger::measured(std::size_t index) {
  if (index >= weights_.size()) {
    weights_.resize(index + 1, 0.0);
    reach_.resize(index + 1, 0);
  }
  weights_[index] += 1.0;
  reach_[index] = 1;
  if (dimension_ == 0) return;
  const auto n = static_cast<std::size_t>(dimension_);
  matrices_.resize(weights_.size() * n * n, 0.0);
  for (std::size_t i = 0; i < n; ++i) matrices_[(index * n + i) * n + i] += 1.0;
}

void Ledger::combine(double a, double b, const Ledger& received, double c, const Ledger* common) {
  require(common != this, "Ledger::combine: a ledger cannot be its own common memory");
  if (!moves_ && (dimension_ != 0 || received.dimension_ != 0)) {
    require(c == 0.0 || common == nullptr,
            "Ledger::combine: a rule by direction takes nothing away");
    const int n = std::max(dimension_, received.dimension_);
    const Matrix identity = Matrix::Identity(n, n);
    return combine(Matrix(a * identity), Matrix(b * identity), received);
  }
  exact_ = exact_ && received.exact_;
  const std::size_t common_size = common != nullptr && c != 0.0 ? common->weights_.size() : 0;
  const std::size_t size = std::max({weights_.size(), received.weights_.size(), common_size});
  weights_.resize(size, 0.0);
  reach_.resize(size, 0);

  // In the order of the rule itself: (a·own + b·received) − c·common.
  const std::size_t heard_size = received.weights_.size();
  const std::size_t three = std::min(heard_size, common_size);
  double* const own = weights_.data();
  const double* const heard = received.weights_.data();
  const double* const known = common_size > 0 ? common->weights_.data() : nullptr;
  for (std::size_t k = 0; k < three; ++k) own[k] = (a * own[k] + b * heard[k]) - c * known[k];
  for (std::size_t k = three; k < heard_size; ++k) own[k] = a * own[k] + b * heard[k];
  for (std::size_t k = three; k < common_size; ++k) own[k] = a * own[k] - c * known[k];
  for (std::size_t k = std::max(heard_size, common_size); k < size; ++k) own[k] = a * own[k];
  unite(reach_.data(), received.reach_.data(), received.reach_.size());
  if (moves_) combine_moving(a, b, received, c, common_size > 0 ? common : nullptr);
}

void Ledger::replace(const Ledger& other, std::span<const std::uint8_t> where) {
  require(dimension_ == 0 && other.dimension_ == 0, "Ledger::replace: not with matrices");
  const std::size_t size = std::max(weights_.size(), other.weights_.size());
  weights_.resize(size, 0.0);
  reach_.resize(size, 0);
  for (std::size_t k = 0; k < std::min(size, where.size()); ++k) {
    if (where[k] != 0) weights_[k] = k < other.weights_.size() ? other.weights_[k] : 0.0;
  }
  unite(reach_.data(), other.reach_.data(), other.reach_.size());
}

void Ledger::clear() {
  weights_.clear();
  matrices_.clear();
  drift_.clear();
  reach_.clear();
  if (!moves_) dimension_ = 0;
  exact_ = true;
}

Multiplicity multiplicity(const Ledger& ledger) {
  Multiplicity out;
  double sum = 0.0;
  double max = -std::numeric_limits<double>::infinity();
  std::size_t above_one = 0;
  for (const double w : ledger.weights()) {
    if (!(std::fabs(w) > 1e-12)) continue;
    ++out.measurements;
    sum += w;
    max = std::max(max, w);
    above_one += w > 1.0 + 1e-9 ? 1 : 0;
  }
  if (out.measurements == 0) {
    out.mean = std::numeric_limits<double>::quiet_NaN();
    return out;
  }
  out.mean = sum / static_cast<double>(out.measurements);
  out.max = max;
  out.share_above_one = static_cast<double>(above_one) / static_cast<double>(out.measurements);
  return out;
}

std::optional<Matrix> true_covariance(const Matrix& omega, const Ledger& ledger,
                                      const MeasurementBook& book) {
  require(omega.rows() == book.dimension(), "true_covariance: dimensions differ");
  const gaussian::Scaled scaled = gaussian::scale(omega);
  if (!ledger.exact() || !scaled.invertible()) return std::nullopt;
  double largest = 0.0;
  for (const double w : ledger.weights()) {
    if (!std::isfinite(w)) return std::nullopt;
    largest = std::max(largest, std::fabs(w));
  }
  // Weights grow like Ω (1e85 and beyond) and enter as squares: both are brought to about one.
  // (Those by direction stay moderate: no belief grows that does not grow in any direction.)
  int exponent = 0;
  std::frexp(largest, &exponent);
  if (!ledger.matrices().empty()) exponent = 0;
  Matrix square = ledger.matrices().empty()
                      ? book.weighted_square(ledger.weights(), std::ldexp(1.0, -exponent))
                      : book.weighted_square_of(ledger.matrices());
  if (ledger.moves()) square += book.motion_square_of(ledger.drift());
  const Matrix middle = both_sides(scaled.factor, square, exponent);
  const Matrix half = gaussian::solve(scaled, middle).transpose();
  Matrix p = gaussian::solve(scaled, half);
  p = 0.5 * (p + Matrix(p.transpose()));
  p = both_sides(scaled.factor, p, exponent);
  if (!p.allFinite()) return std::nullopt;
  return p;
}

double reach_gap(const Belief& belief, const Ledger& ledger, const MeasurementBook& book) {
  const Belief central = book.sum_over(ledger.reach());
  return std::max(relative_distance(belief.omega, central.omega),
                  relative_distance(belief.xi, central.xi));
}

}  // namespace hearsay
