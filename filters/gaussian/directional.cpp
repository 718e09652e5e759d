#include "filters/gaussian/directional.hpp"

#include <algorithm>
#include <cmath>

#include "filters/gaussian/intersection.hpp"
#include "filters/gaussian/symmetric.hpp"

namespace hearsay::gaussian {
namespace {

constexpr double equal_within = 1e-12;

DirectionalFusion kept(const Belief& belief, double own, const char* skipped) {
  const Eigen::Index n = belief.dimension();
  return {belief, own * Matrix::Identity(n, n), (1.0 - own) * Matrix::Identity(n, n), skipped};
}

/// What the rule does along a direction in which own information is 1 and received information d.
struct Along {
  double c, own, received;
};

/// `rule(d)` gives an Along for each of the directions `d`, after `prepare(d)`.
template <class Prepare, class Rule>
DirectionalFusion fuse(const Belief& own, const Belief& received, const Prepare& prepare,
                       const Rule& rule) {
  require_equal_dimensions(own.omega, received.omega);
  const Scaled a = scale(own.omega);
  const Scaled b = scale(received.omega);
  if (const auto answer = decided(a, b, own.omega, received.omega)) {
    return kept(answer->omega > 0.0 ? own : received, answer->omega > 0.0 ? 1.0 : 0.0,
                answer->skipped);
  }
  if (a.cholesky.size() == 0 || b.cholesky.size() == 0) {
    return kept(own, 1.0, "a belief is singular");
  }
  // With Ω_a = D⁻¹LLᵀD⁻¹ and L⁻¹DΩ_bDL⁻ᵀ = Q diag(d) Qᵀ: U = D⁻¹LQ.
  Matrix c = received.omega;
  for (int side = 0; side < 2; ++side) {
    scale_rows(c, a.factor);
    solve_lower(a.cholesky, c);
    c.transposeInPlace();
  }
  const Eigenpairs pairs = eigenpairs(0.5 * (c + c.transpose()));
  Matrix U = a.cholesky.lazyProduct(pairs.vectors);
  scale_rows(U, a.factor.cwiseInverse());
  Matrix V = Matrix::Identity(U.rows(), U.cols());  // U⁻¹ = QᵀL⁻¹D
  solve_lower(a.cholesky, V);
  V = Matrix(pairs.vectors.transpose().lazyProduct(V));
  for (Eigen::Index j = 0; j < V.cols(); ++j) V.col(j) *= a.factor(j);

  prepare(pairs.values);
  Matrix half = U, ga = V, gb = V;  // U√c, and diag(g)U⁻¹
  for (Eigen::Index i = 0; i < U.cols(); ++i) {
    const Along along = rule(pairs.values(i));
    half.col(i) *= std::sqrt(along.c);
    ga.row(i) *= along.own;
    gb.row(i) *= along.received;
  }
  DirectionalFusion out;
  out.own = U.lazyProduct(ga);
  out.received = U.lazyProduct(gb);
  out.belief.omega = gram(half.transpose());
  out.belief.xi = out.own.lazyProduct(own.xi) + out.received.lazyProduct(received.xi);
  return out;
}

/// ω that maximises Σ log c over directions d, where with q = 1 + ω(d − 1)
///     c = 1 + d − d/q,   c' = d(d − 1)/q²,   c'' = −2d(d − 1)²/q³.
double best_omega(const Vector& d) {
  const auto slope = [&](double omega) {
    Slope sum{0.0, 0.0};
    for (const double x : d) {
      const double q = 1.0 + omega * (x - 1.0);
      const double c = 1.0 + x - x / q;
      const double first = x * (x - 1.0) / (q * q);
      const double second = -2.0 * first * (x - 1.0) / q;
      sum.value += first / c;
      sum.derivative += second / c - first * first / (c * c);
    }
    return sum;
  };
  const auto one = [](double x) { return std::fabs(x - 1.0) <= equal_within; };
  if (std::all_of(d.begin(), d.end(), one)) return 0.5;
  if (slope(0.0).value <= 0.0) return 0.0;
  if (slope(1.0).value >= 0.0) return 1.0;
  return zero_of(slope);
}

}  // namespace

DirectionalFusion fuse_by_inverse_intersection(const Belief& own, const Belief& received) {
  double omega = 0.5;
  return fuse(
      own, received, [&](const Vector& d) { omega = best_omega(d); },
      [&](double d) {
        const double m = d / (1.0 + omega * (d - 1.0));
        return Along{1.0 + d - m, 1.0 - omega * m, 1.0 - (1.0 - omega) * m / d};
      });
}

DirectionalFusion fuse_by_ellipsoids(const Belief& own, const Belief& received) {
  return fuse(
      own, received, [](const Vector&) {},
      [](double d) {
        const double share = std::fabs(d - 1.0) <= equal_within ? 0.5 : d < 1.0 ? 1.0 : 0.0;
        return Along{std::max(1.0, d), share, 1.0 - share};
      });
}

}  // namespace hearsay::gaussian
