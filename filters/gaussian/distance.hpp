// How far two beliefs are from each other, and a measurement from a belief.
#pragma once

#include <optional>

#include "filters/gaussian/belief.hpp"
#include "filters/gaussian/trajectory.hpp"

namespace hearsay::gaussian {

/// What a belief expects of z = Mx: Mμ (m) and MΣMᵀ (m×m), the noise of z not yet in it.
struct Expected {
  Vector z;
  Matrix covariance;
};
/// M is m×n. Nothing unless the belief is positive definite.
std::optional<Expected> expected(const Belief& belief, const Matrix& M);

/// Normalised innovation squared, vᵀ(MΣMᵀ + S)⁻¹v with v = z − Mμ, of a measurement z = Mx + e,
/// e ~ N(0, S): its mean is m for a consistent belief. Merino 2007, eq. 3.64. M is m×n, S m×m, z m.
/// Nothing unless the belief and MΣMᵀ + S are positive definite.
std::optional<double> nis(const Expected& expected, const Matrix& S, const Vector& z);
std::optional<double> nis(const Belief& belief, const Matrix& M, const Matrix& S, const Vector& z);

/// The same of a measurement of the first m of the n numbers, as information about them: M = (I 0),
/// S = Ω⁻¹ and z = Ω⁻¹ξ of `information` (m×m). Nothing unless both are positive definite.
/// @throws BrokenInvariant if m > n.
std::optional<double> nis(const Belief& belief, const Belief& information);

/// d² = (μ_a − μ_b)ᵀ(Σ_a + Σ_b)⁻¹(μ_a − μ_b), Merino 2007, eq. 3.65: χ² with n degrees of freedom
/// if both mean the same x and their errors are independent. Nothing unless both are positive
/// definite.
/// @throws BrokenInvariant if dimensions differ.
std::optional<double> mahalanobis_squared(const Belief& a, const Belief& b);

/// The same of two trajectories over the stamps that both have; all others are marginalised.
/// Linear in the number of steps: nothing dense is formed.
///
/// Two trackers of the same object assume the same random accelerations. That share of their errors
/// is common to both, and so d² is on average below its degrees of freedom.
struct TrajectoryDistance {
  double squared = 0.0;
  int steps = 0;  ///< common stamps; n·steps degrees of freedom
};
/// Nothing without common stamps or unless both are positive definite.
/// @throws BrokenInvariant if dimensions differ.
std::optional<TrajectoryDistance> mahalanobis_squared(const Trajectory& a, const Trajectory& b);

/// Hellinger distance √(1 − ∫√(pq)), 0 … 1; 0 for equal beliefs. Nothing unless both are positive
/// definite. @throws BrokenInvariant if dimensions differ.
std::optional<double> hellinger(const Belief& p, const Belief& q);

}  // namespace hearsay::gaussian
