// What all ways to choose ω have in common. Internal to filters/.
#pragma once

#include <cmath>
#include <optional>

#include "filters/gaussian/fusion.hpp"
#include "filters/gaussian/symmetric.hpp"

namespace hearsay::gaussian {

/// @throws BrokenInvariant unless both have the same dimension, at least 1.
void require_equal_dimensions(const Matrix& omega_a, const Matrix& omega_b);

/// The answer where there is nothing to choose: one side is no belief, or knows nothing. `a` and
/// `b` are the matrices scaled.
std::optional<Intersection> decided(const Scaled& a, const Scaled& b, const Matrix& omega_a,
                                    const Matrix& omega_b);

/// A decreasing function of ω on [0, 1], infinite only at the ends, and its derivative.
struct Slope {
  double value;
  double derivative;
};

/// The zero of a decreasing slope: Newton, with bisection where it leaves the bracket.
template <typename SlopeAt>
double zero_of(const SlopeAt& slope_at) {
  double low = 0.0;
  double high = 1.0;
  double omega = 0.5;
  for (int iteration = 0; iteration < 200; ++iteration) {
    const Slope slope = slope_at(omega);
    if (slope.value == 0.0) return omega;
    (slope.value > 0.0 ? low : high) = omega;
    double next = omega - slope.value / slope.derivative;
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    const double step = std::fabs(next - omega);
    omega = next;
    if (step <= 1e-16 || high - low <= 1e-16) break;
  }
  return omega;
}

}  // namespace hearsay::gaussian
