// What becomes of a Gaussian under a function y = f(x): by linearisation, by the unscented
// transform and by Monte Carlo. Merino 2007, section 3.3 and Algorithm 3.5 (Julier and Uhlmann
// 1997).
//
// f takes a Vector (n) and returns std::optional<Vector> (m): nothing where it has no value, as for
// a ray that misses the ground. Functions with angles among their values give `difference(a, b)`,
// too: a − b (m) with angles wrapped.
#pragma once

#include <array>
#include <optional>

#include "filters/gaussian/belief.hpp"
#include "filters/gaussian/symmetric.hpp"

namespace hearsay::gaussian {

/// Mean μ (n) and covariance Σ (n×n, positive semi-definite).
struct Moments {
  Vector mean;
  Matrix covariance;
};
/// Those of a belief; nothing unless it is positive definite.
std::optional<Moments> moments(const Belief& belief);

/// y ≈ f(μ) + J(x − μ), given f(μ) (m) and J = ∂f/∂x at μ (m×n): mean f(μ), covariance JΣJᵀ.
Moments linearised(const Moments& x, const Vector& f_of_mean, const Matrix& jacobian);

/// κ with n + κ = 3, which for a Gaussian also matches fourth moments along each axis. Beyond n = 3
/// it is negative: the middle point weighs less than nothing, and the covariance of a strongly
/// curved f may come out indefinite.
inline double usual_kappa(int n) { return 3.0 - n; }

/// The points of Algorithm 3.5: μ, and μ ± the columns of √((n + κ)Σ).
struct SigmaPoints {
  std::array<Vector, 2 * dimension_max + 1> points;
  std::array<double, 2 * dimension_max + 1> weights;  ///< they add up to 1
  int count;                                          ///< 2n + 1
};
/// Nothing if Σ is indefinite or not finite; a singular Σ is legal. @throws BrokenInvariant unless
/// n + κ > 0 and shapes agree.
std::optional<SigmaPoints> sigma_points(const Moments& x, double kappa);

/// Moments of y, and Cov(x, y) (n×m).
struct Propagated {
  Moments y;
  Matrix cross;
};
/// From the values of f at the points, as f(μ) and the differences to it.
Propagated propagated(const SigmaPoints& x, const Vector& f_of_mean,
                      const std::array<Vector, 2 * dimension_max + 1>& differences);

/// Algorithm 3.5. Nothing if f has no value at one of the points, or Σ no square root.
template <typename Function, typename Difference>
std::optional<Propagated> unscented(const Moments& x, double kappa, const Function& f,
                                    const Difference& difference) {
  const std::optional<SigmaPoints> at = sigma_points(x, kappa);
  if (!at) return std::nullopt;
  std::array<Vector, 2 * dimension_max + 1> differences;
  std::optional<Vector> middle;
  for (int i = 0; i < at->count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const std::optional<Vector> y = f(at->points[k]);
    if (!y) return std::nullopt;
    if (i == 0) middle = y;
    differences[k] = difference(*y, *middle);
  }
  return propagated(*at, *middle, differences);
}
template <typename Function>
std::optional<Propagated> unscented(const Moments& x, double kappa, const Function& f) {
  return unscented(x, kappa, f, [](const Vector& a, const Vector& b) { return Vector(a - b); });
}

/// Mean and covariance of values that come one by one (Welford 1962).
class RunningMoments {
 public:
  void add(const Vector& y);
  int count() const { return count_; }
  /// With n − 1 in the denominator; nothing for fewer than two values.
  std::optional<Moments> moments() const;

 private:
  int count_ = 0;
  Vector mean_;
  Matrix sum_;
};

struct Sampled {
  std::optional<Moments> y;  ///< of the draws where f has a value; nothing for fewer than two
  int misses = 0;            ///< draws where it has none
};
/// f at `draws` points of N(μ, Σ). `normal()` gives standard normal numbers, n a draw. Where some
/// draws miss, the rest speaks for the part that hits alone. All miss if Σ has no square root.
template <typename Function, typename Normal>
Sampled sampled(const Moments& x, int draws, const Function& f, Normal&& normal) {
  const std::optional<Matrix> root = square_root(x.covariance);
  if (!root) return {.y = std::nullopt, .misses = draws};
  RunningMoments values;
  Sampled result;
  Vector u(x.mean.size());
  for (int i = 0; i < draws; ++i) {
    for (Eigen::Index k = 0; k < u.size(); ++k) u(k) = normal();
    const std::optional<Vector> y = f(Vector(x.mean + root->lazyProduct(u)));
    if (y) {
      values.add(*y);
    } else {
      ++result.misses;
    }
  }
  result.y = values.moments();
  return result;
}

}  // namespace hearsay::gaussian
