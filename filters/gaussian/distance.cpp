#include "filters/gaussian/distance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <vector>

#include "filters/gaussian/symmetric.hpp"
#include "filters/gaussian/trajectory_factor.hpp"
#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"

namespace hearsay::gaussian {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

bool positive(const Scaled& scaled) {
  return scaled.definiteness == Definiteness::positive && scaled.cholesky.size() > 0;
}

/// A symmetric 2×2 matrix (a b; b c) = (1 0; l 1) diag(a, d) (1 l; 0 1). Its units do not matter.
struct Plane {
  double a, b, c, l, d;
  explicit Plane(const Matrix& m) : Plane(m(0, 0), m(0, 1), m(1, 1)) {}
  Plane(double a11, double a12, double a22) : a(a11), b(a12), c(a22), l(b / a), d(c - l * b) {}
  /// False also for NaN and infinity.
  bool positive() const {
    constexpr double singular_below = 2e-13;  // as for beliefs of any dimension
    return a > 0.0 && c > 0.0 && d > singular_below * c && a + c < infinity;
  }
  std::array<double, 2> solve(const std::array<double, 2>& y) const {
    const double second = (y[1] - l * y[0]) / d;
    return {y[0] / a - l * second, second};
  }
  std::array<double, 2> times(const std::array<double, 2>& x) const {
    return {a * x[0] + b * x[1], b * x[0] + c * x[1]};
  }
};

/// With v = z − μ, r = Ω_z v and F = Ω + Ω_z: (Σ + Ω_z⁻¹)⁻¹ v = Ω F⁻¹ r. In the plane, as nearly
/// all measurements are, without a matrix: it is asked for at every measurement of a run.
std::optional<double> nis_in_plane(const Belief& belief, const Belief& information) {
  const Plane omega(belief.omega), seen(information.omega);
  const Plane sum(omega.a + seen.a, omega.b + seen.b, omega.c + seen.c);
  if (!omega.positive() || !seen.positive() || !sum.positive()) return std::nullopt;
  const auto mean = omega.solve({belief.xi(0), belief.xi(1)});
  const auto z = seen.solve({information.xi(0), information.xi(1)});
  const std::array<double, 2> v = {z[0] - mean[0], z[1] - mean[1]};
  const auto weighted = omega.times(sum.solve(seen.times(v)));
  const double squared = v[0] * weighted[0] + v[1] * weighted[1];
  return std::isfinite(squared) ? std::optional(squared) : std::nullopt;
}

/// `t` without the stamps that are not among `kept`, of which there are some; nothing if a step
/// cannot be marginalised. Every step is taken out as soon as the next is there, so that none is
/// moved more than once.
std::optional<Trajectory> restricted(const Trajectory& t, const std::vector<Stamp>& kept) {
  const auto wanted = [&](Stamp stamp) { return std::ranges::binary_search(kept, stamp); };
  const auto said = [&](int k) { return Belief{t.omega(k), t.xi(k)}; };
  Trajectory out(t.dimension(), t.stamps()[0]);
  out.update(0, said(0));
  for (int k = 1; k < t.steps(); ++k) {
    const bool keep_before = wanted(out.stamps().back());
    out.append(t.stamps()[static_cast<std::size_t>(k)], t.omega_next(k - 1), said(k));
    if (!keep_before && !out.marginalise(out.steps() - 2)) return std::nullopt;
  }
  if (!wanted(out.stamps().back()) && !out.marginalise(out.steps() - 1)) return std::nullopt;
  return out;
}

}  // namespace

// With Ω = D⁻¹LLᵀD⁻¹ and W = L⁻¹DMᵀ: MΣMᵀ = WᵀW.
std::optional<Expected> expected(const Belief& belief, const Matrix& M) {
  require(M.cols() == belief.dimension(), "expected: M has another number of columns");
  if (!all_finite(belief.xi)) return std::nullopt;
  const Scaled omega = scale(belief.omega);
  if (!positive(omega)) return std::nullopt;
  Matrix w = M.transpose();
  scale_rows(w, omega.factor);
  solve_lower(omega.cholesky, w);
  Matrix y = belief.xi;
  scale_rows(y, omega.factor);
  solve_lower(omega.cholesky, y);
  Expected out{Vector(w.transpose().lazyProduct(y)), gram(w)};
  if (!all_finite(out.z) || !all_finite(out.covariance)) return std::nullopt;
  return out;
}

std::optional<double> nis(const Expected& expected, const Matrix& S, const Vector& z) {
  require(z.size() == expected.z.size() && S.rows() == z.size() && S.cols() == z.size(),
          "nis: dimensions differ");
  return mahalanobis_squared(Vector(z - expected.z), Matrix(expected.covariance + S));
}

std::optional<double> nis(const Belief& belief, const Matrix& M, const Matrix& S, const Vector& z) {
  const auto e = expected(belief, M);
  if (!e) return std::nullopt;
  return nis(*e, S, z);
}

std::optional<double> nis(const Belief& belief, const Belief& information) {
  const int n = belief.dimension(), m = information.dimension();
  require(m <= n, "nis: the measurement has more dimensions than the belief");
  if (n == 2 && m == 2) return nis_in_plane(belief, information);
  const auto z = state(information);
  const auto S = covariance(information);
  if (!z || !S) return std::nullopt;
  return nis(belief, Matrix::Identity(m, n), *S, *z);
}

// (Σ_a + Σ_b)⁻¹ = Ω_a(Ω_a + Ω_b)⁻¹Ω_b, and with the mean x of the fused belief
//     d² = (x − μ_a)ᵀΩ_a(x − μ_a) + (x − μ_b)ᵀΩ_b(x − μ_b):
// a solve with the sum, and nothing is subtracted from anything but means.
std::optional<double> mahalanobis_squared(const Belief& a, const Belief& b) {
  require(a.dimension() == b.dimension(), "mahalanobis_squared: dimensions differ");
  if (definiteness(a) != Definiteness::positive) return std::nullopt;
  if (definiteness(b) != Definiteness::positive) return std::nullopt;
  Belief both = a;
  both += b;
  const auto x = state(both);
  if (!x) return std::nullopt;
  const auto from_a = nees(a, *x);
  const auto from_b = nees(b, *x);
  if (!from_a || !from_b) return std::nullopt;
  return *from_a + *from_b;
}

std::optional<TrajectoryDistance> mahalanobis_squared(const Trajectory& a, const Trajectory& b) {
  require(a.dimension() == b.dimension(), "mahalanobis_squared: dimensions differ");
  std::vector<Stamp> common;
  std::ranges::set_intersection(a.stamps(), b.stamps(), std::back_inserter(common));
  if (common.empty()) return std::nullopt;
  const auto on_a = restricted(a, common);
  const auto on_b = restricted(b, common);
  if (!on_a || !on_b) return std::nullopt;
  Trajectory both = *on_a;
  both += *on_b;
  TrajectoryFactor factor;
  if (factor.factor(both) != Definiteness::positive) return std::nullopt;
  const std::vector<Vector> x = factor.means();
  const auto from_a = nees(*on_a, x, factor);
  const auto from_b = nees(*on_b, x, factor);
  if (!from_a || !from_b) return std::nullopt;
  return TrajectoryDistance{*from_a + *from_b, static_cast<int>(common.size())};
}

// ∫√(pq) = (|Ω_p||Ω_q|)^¼ |½(Ω_p + Ω_q)|^-½ exp(−¼d²). With Ω_p + Ω_q = LLᵀ and the eigenvalues k
// of K = L⁻¹(Ω_p − Ω_q)L⁻ᵀ the determinants make Π(1 − k²)^¼; so nearly equal beliefs lose nothing.
std::optional<double> hellinger(const Belief& p, const Belief& q) {
  const auto distance = mahalanobis_squared(p, q);
  if (!distance) return std::nullopt;
  const Scaled sum = scale(p.omega + q.omega);
  if (!positive(sum)) return std::nullopt;
  Matrix k = p.omega - q.omega;
  for (int side = 0; side < 2; ++side) {
    scale_rows(k, sum.factor);
    solve_lower(sum.cholesky, k);
    k.transposeInPlace();
  }
  double logarithm = -0.25 * *distance;
  for (const double value : eigenvalues(0.5 * (k + k.transpose()))) {
    logarithm += 0.25 * math::log1p(-std::min(value * value, 1.0));
  }
  return std::sqrt(-math::expm1(std::min(logarithm, 0.0)));
}

}  // namespace hearsay::gaussian
