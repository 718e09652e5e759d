// Beliefs, matrices and noise for the tests of this family.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <initializer_list>

#include "filters/gaussian/batch.hpp"
#include "filters/gaussian/belief.hpp"
#include "filters/gaussian/fusion.hpp"
#include "filters/gaussian/split.hpp"
#include "sim/kernel/random.hpp"

namespace hearsay::gaussian {

inline Matrix matrix(std::initializer_list<std::initializer_list<double>> rows) {
  Matrix m(rows.size(), rows.begin()->size());
  Eigen::Index i = 0;
  for (const auto& row : rows) {
    Eigen::Index j = 0;
    for (const double value : row) m(i, j++) = value;
    ++i;
  }
  return m;
}

inline Vector vector(std::initializer_list<double> values) {
  Vector v(values.size());
  Eigen::Index i = 0;
  for (const double value : values) v(i++) = value;
  return v;
}

/// Where a slope that falls with ω crosses zero on [0, 1], to the last digits; the nearer end if it
/// does not.
template <typename Slope>
double zero_of_falling(const Slope& slope) {
  if (slope(0.0) <= 0) return 0;
  if (slope(1.0) >= 0) return 1;
  double low = 0;
  double high = 1;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (slope(middle) > 0 ? low : high) = middle;
  }
  return low;
}

inline Matrix diagonal(std::initializer_list<double> values) { return vector(values).asDiagonal(); }

inline Stream stream(std::string_view purpose) {
  return Stream(1, Purpose(purpose), Entity::agent(0));
}

inline Matrix random_matrix(Stream& random, int rows, int columns) {
  Matrix m(rows, columns);
  for (Eigen::Index j = 0; j < columns; ++j) {
    for (Eigen::Index i = 0; i < rows; ++i) m(i, j) = random.normal();
  }
  return m;
}

inline Vector random_vector(Stream& random, int n) { return random_matrix(random, n, 1); }

/// Symmetric positive definite with eigenvalues spread over about `decades` decades.
inline Matrix random_information(Stream& random, int n, double decades = 2.0) {
  const Eigen::MatrixXd g = random_matrix(random, n, n);
  const Eigen::MatrixXd q = Eigen::HouseholderQR<Eigen::MatrixXd>(g).householderQ();
  Eigen::VectorXd d(n);
  for (int i = 0; i < n; ++i) d(i) = std::pow(10.0, random.uniform(-decades / 2, decades / 2));
  const Eigen::MatrixXd m = q * d.asDiagonal() * q.transpose();
  return 0.5 * (m + m.transpose());
}

inline Belief random_belief(Stream& random, int n) {
  Belief belief{random_information(random, n), Vector(n)};
  belief.xi = belief.omega * random_vector(random, n);
  return belief;
}

inline constexpr double weight_of_own = 0.3;  ///< ω of ci-fixed

/// What an agent makes of a rule's coefficients.
inline Belief fused(const Coefficients& c, const Belief& own, const Belief& received,
                    const Belief& common) {
  Belief sum = own;
  sum *= c.own;
  Belief heard = received;
  heard *= c.received;
  sum += heard;
  if (c.common != 0.0) {
    Belief known = common;
    known *= c.common;
    sum -= known;
  }
  return sum;
}

/// Weight of the own belief for a rule that fuses all at once; consensus with two neighbours each.
inline double weight_at_once(Rule rule, const Belief& own, const Belief& received) {
  if (rule != Rule::ci_batch) return 1.0 - metropolis_weight(2, 2);
  const Matrix* const both[] = {&own.omega, &received.omega};
  return BatchIntersection().weights(both)[0];
}

/// What multiplies the two information vectors. Nothing fresh for the rules that care.
struct Gains {
  Eigen::MatrixXd own, received;
};
inline Gains gains(Rule rule, const Belief& own, const Belief& received) {
  const int n = own.dimension();
  const Matrix identity = Matrix::Identity(n, n), nothing = Matrix::Zero(n, n);
  switch (info(rule).fuses) {
    case Fuses::by_direction: {
      const DirectionalFusion fusion = fuse_by_direction(rule, own, received);
      return {fusion.own, fusion.received};
    }
    case Fuses::by_parts: {
      const SplitFusion fusion = fuse_split(own, nothing, received, nothing);
      return {fusion.own, fusion.received};
    }
    case Fuses::at_once: {
      const double weight = weight_at_once(rule, own, received);
      return {weight * identity, (1.0 - weight) * identity};
    }
    case Fuses::by_weight:
      break;
  }
  const Coefficients c = coefficients(rule, own, received, weight_of_own);
  return {c.own * identity, c.received * identity};
}

/// The fused belief of any rule.
inline Belief fused(Rule rule, const Belief& own, const Belief& received, const Belief& common) {
  if (info(rule).fuses == Fuses::by_direction) return fuse_by_direction(rule, own, received).belief;
  if (info(rule).fuses == Fuses::by_parts) {
    const Matrix nothing = Matrix::Zero(own.dimension(), own.dimension());
    return fuse_split(own, nothing, received, nothing).belief;
  }
  if (info(rule).fuses == Fuses::at_once) {
    const double weight = weight_at_once(rule, own, received);
    return fused({weight, 1.0 - weight, 0.0, nullptr}, own, received, common);
  }
  return fused(coefficients(rule, own, received, weight_of_own), own, received, common);
}

inline double relative(const Eigen::MatrixXd& value, const Eigen::MatrixXd& reference) {
  return (value - reference).norm() / reference.norm();
}

}  // namespace hearsay::gaussian
