#include "filters/tracking/trail.hpp"

#include <cmath>

#include "filters/gaussian/distance.hpp"
#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"

namespace hearsay::tracking {

// (χ²_k/k)^⅓ is nearly normal, with mean 1 − 2/(9k) and variance 2/(9k).
double equivalent_gate(double gate, int n, int degrees) {
  require(gate > 0.0 && n > 0 && degrees > 0, "equivalent_gate: everything must be positive");
  const double variance = 2.0 / (9.0 * n), wanted = 2.0 / (9.0 * degrees);
  const double root = math::pow(gate / n, 1.0 / 3.0);
  const double sigmas = (root - (1.0 - variance)) / std::sqrt(variance);
  const double wanted_root = 1.0 - wanted + sigmas * std::sqrt(wanted);
  return degrees * wanted_root * wanted_root * wanted_root;
}

std::optional<double> trail_separation(const gaussian::Trajectory& a, const gaussian::Trajectory& b,
                                       double gate) {
  const auto distance = gaussian::mahalanobis_squared(a, b);
  if (!distance) return std::nullopt;
  const int n = a.dimension();
  return distance->squared * (gate / equivalent_gate(gate, n, n * distance->steps));
}

void extend(gaussian::Trajectory& trail, gaussian::Stamp stamp, const gaussian::Belief& seen,
            const std::optional<gaussian::Transition>& motion, gaussian::Stamp oldest) {
  if (stamp != trail.stamps().back()) {
    require(motion.has_value(), "extend: a later stamp needs a motion that leads there");
    trail.augment(stamp, *motion);
  }
  trail.update(trail.steps() - 1, seen);
  while (trail.stamps().front() < oldest && trail.marginalise(0)) continue;
}

}  // namespace hearsay::tracking
