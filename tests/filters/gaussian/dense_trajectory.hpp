// A trajectory's information as one dense matrix and one vector, for tests.
#pragma once

#include <Eigen/Core>

#include "filters/gaussian/trajectory.hpp"

namespace hearsay::gaussian {

inline Eigen::MatrixXd dense(const Trajectory& t) {
  const int n = t.dimension();
  Eigen::MatrixXd m = Eigen::MatrixXd::Zero(n * t.steps(), n * t.steps());
  for (int k = 0; k < t.steps(); ++k) {
    m.block(n * k, n * k, n, n) = t.omega(k);
    if (k + 1 == t.steps()) break;
    m.block(n * k, n * (k + 1), n, n) = t.omega_next(k);
    m.block(n * (k + 1), n * k, n, n) = t.omega_next(k).transpose();
  }
  return m;
}

inline Eigen::VectorXd dense_vector(const Trajectory& t) {
  Eigen::VectorXd v(t.dimension() * t.steps());
  for (int k = 0; k < t.steps(); ++k) v.segment(t.dimension() * k, t.dimension()) = t.xi(k);
  return v;
}

}  // namespace hearsay::gaussian
