// Covariance intersection of trajectories: the zero of the slope of f(ω) = log |ωΩ_a + (1−ω)Ω_b|,
// which is concave, by Newton's method within a bracket. A step costs one sweep over both
// trajectories (trajectory_slope.hpp); how many are needed depends on where the zero lies, not on
// how long they are.
//
// With the eigenvalues μ of Ω⁻¹(Ω_a − Ω_b), f'' is −Σμ² and the m-th derivative (m−1)!·Σ±μᵐ, hence
// at most (m−1)!·sᵐ with s = √−f'' (self-concordance). In units of 1/s let λ and λ' be the
// distances of the last two points from the zero. To first order in them, the error is then at most
//     λ²         after a step of Newton,
//     11 λ²λ'²   at the zero of the cubic ω(f') through both points and their slopes: its remainder
//                is ω''''·(f'₁f'₂)²/4!, with |ω''''| ≤ (15·2³ + 10·2·6 + 24)/s⁵ and f' = sλ.
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "filters/gaussian/trajectory_factor.hpp"
#include "filters/gaussian/trajectory_slope.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay::gaussian {
namespace {

// Of ω, and in units of 1/s: so ½·1e-20 nats of the maximum are lost, far less than the rounding of
// f itself.
constexpr double error_max = 1e-10;

struct Point {
  double omega;
  TrajectorySlope slope;
};

/// Where the cubic ω(f') through two points, with its slopes 1/f'' there, is zero.
double cubic_zero(const Point& before, const Point& now) {
  const double g = now.slope.first, g_before = before.slope.first;
  const double span = g_before - g;
  const double chord = (before.omega - now.omega) / span;
  const double bend = (chord - 1.0 / now.slope.second) / span;
  const double bend_before = (1.0 / before.slope.second - chord) / span;
  const double twist = (bend_before - bend) / span;
  return now.omega - g / now.slope.second + g * g * (bend - twist * g_before);
}

struct Step {
  double omega;
  bool last;  ///< its error is below error_max
};

/// From the last point and the one before it, if any, towards the zero.
Step step_from(const Point& now, const std::optional<Point>& before) {
  const double s = std::sqrt(-now.slope.second);
  const double lambda = std::fabs(now.slope.first) / s;
  double omega = now.omega - now.slope.first / now.slope.second;
  double error = lambda * lambda;
  if (before) {
    const double lambda_before = s * std::fabs(omega - before->omega);
    const double gain = 11.0 * lambda_before * lambda_before;
    if (gain < 1.0 && before->slope.first != now.slope.first) {
      omega = cubic_zero(*before, now);
      error *= gain;
    }
  }
  return {omega, lambda <= 0.1 && error <= error_max * std::min(1.0, s)};
}

template <int N>
std::optional<double> best_weight(const Trajectory& a, const Trajectory& b) {
  SlopeSweep<N> sweep(a, b);
  // Where the slope at an end still points outwards, the end is best.
  const auto best_at = [&](double end) {
    const auto slope = sweep.at(end);
    return slope && (end > 0.5 ? slope->first >= 0.0 : slope->first <= 0.0);
  };
  double omega = 0.5, low = 0.0, high = 1.0;
  bool asked[2] = {false, false};  // about either end
  std::optional<Point> before;
  for (int iteration = 0; iteration < 100 && high - low > 1e-15; ++iteration) {
    const auto slope = sweep.at(omega);
    if (!slope) return std::nullopt;
    if (!(slope->second < -1e-20) || slope->first == 0.0) return omega;  // the two are equal
    (slope->first > 0.0 ? low : high) = omega;
    const Point now{omega, *slope};
    Step step = step_from(now, before);
    if (step.last && step.omega >= low && step.omega <= high) return step.omega;
    if (!(step.omega > low && step.omega < high)) {
      const int end = slope->first > 0.0 ? 1 : 0;
      if (!std::exchange(asked[end], true) && best_at(end)) return end;
      step.omega = 0.5 * (low + high);
    }
    before = now;
    omega = step.omega;
  }
  return omega;
}

}  // namespace

std::optional<double> intersect_det(const Trajectory& a, const Trajectory& b) {
  require(a.dimension() == b.dimension() && std::ranges::equal(a.stamps(), b.stamps()),
          "intersect_det: trajectories must have the same stamps and dimension");
  switch (a.dimension()) {  // those of one, two and three axes at a known size
    case 2:
      return best_weight<2>(a, b);
    case 4:
      return best_weight<4>(a, b);
    case 6:
      return best_weight<6>(a, b);
    default:
      return best_weight<0>(a, b);
  }
}

}  // namespace hearsay::gaussian
