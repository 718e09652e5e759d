// Covariance intersection with a weight that needs no search.
#include "filters/gaussian/belief.hpp"
#include "filters/gaussian/intersection.hpp"
#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"

namespace hearsay::gaussian {
namespace {

/// |Ω_part|/|Ω_whole|, 0 for a singular part.
double share(const Matrix& omega_part, double log_determinant_of_whole) {
  const auto part = log_determinant(omega_part);
  return part ? math::exp(*part - log_determinant_of_whole) : 0.0;
}

}  // namespace

Intersection intersect_fixed(const Matrix& omega_a, const Matrix& omega_b, double omega) {
  require_equal_dimensions(omega_a, omega_b);
  require(omega > 0.0 && omega <= 1.0, "intersect: a fixed weight must be in (0, 1]");
  const auto answer = decided(scale(omega_a), scale(omega_b), omega_a, omega_b);
  return answer.value_or(Intersection{omega, nullptr});
}

// ω = (1/tr P_a)/(1/tr P_a + 1/tr P_b).
Intersection intersect_niehsen(const Matrix& omega_a, const Matrix& omega_b) {
  require_equal_dimensions(omega_a, omega_b);
  const Vector origin = Vector::Zero(omega_a.rows());
  const auto a = claimed_sigma({omega_a, origin});  // √(tr P/n)
  const auto b = claimed_sigma({omega_b, origin});
  if (!a || !b) return intersect_trace(omega_a, omega_b);
  const double ratio = *a / *b;
  return {1.0 / (1.0 + ratio * ratio), nullptr};
}

// For two beliefs |I − I_a| = |I_b|, and their formula is ω = ½ + ½(|I_a| − |I_b|)/|I|.
Intersection intersect_franken_huepper(const Matrix& omega_a, const Matrix& omega_b) {
  require_equal_dimensions(omega_a, omega_b);
  if (const auto answer = decided(scale(omega_a), scale(omega_b), omega_a, omega_b)) return *answer;
  const auto whole = log_determinant(omega_a + omega_b);
  if (!whole) return intersect_det(omega_a, omega_b);
  return {0.5 + 0.5 * (share(omega_a, *whole) - share(omega_b, *whole)), nullptr};
}

Intersection most_certain(const Matrix& omega_a, const Matrix& omega_b) {
  require_equal_dimensions(omega_a, omega_b);
  if (const auto answer = decided(scale(omega_a), scale(omega_b), omega_a, omega_b)) {
    return *answer;
  }
  const auto a = log_determinant(omega_a);
  const auto b = log_determinant(omega_b);
  if (!a && !b) return {1.0, "both beliefs are singular"};
  return {!b || (a && *a >= *b) ? 1.0 : 0.0, nullptr};
}

}  // namespace hearsay::gaussian
