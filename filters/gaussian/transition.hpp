// How a state moves from one instant to a later one: x' = Ax + w, w ~ N(0, R).
#pragma once

#include "filters/gaussian/belief.hpp"

namespace hearsay::gaussian {

/// Over some span of time. A (n×n) is invertible, R (n×n) positive definite.
struct Transition {
  Matrix A;
  Matrix R;
};

/// White-noise acceleration along each of `axes` axes (1 … 4), over dt > 0 s: the state is
/// (positions, velocities), n = 2·axes, in m and m/s; q > 0 is the power spectral density of the
/// acceleration, the same on every axis, in m²/s³. Merino 2007, eq. 3.58–3.59.
/// @throws BrokenInvariant outside these ranges.
Transition white_noise_acceleration(int axes, double dt_s, double q);

/// The belief about x' that follows from `belief` about x, which it need not determine:
/// Ψ = A⁻ᵀΩA⁻¹, Ω' = (I + ΨR)⁻¹Ψ, ξ' = (I + ΨR)⁻¹A⁻ᵀξ. Merino 2007, eq. 3.12–3.13 in a form that
/// is legal for a singular Ω. @throws BrokenInvariant if dimensions differ or A is not invertible.
Belief predict(const Belief& belief, const Transition& transition);

/// The same, and the F (n×n) of ξ' = Fξ.
struct Prediction {
  Belief belief;
  Matrix F;
};
Prediction predict_with_gain(const Belief& belief, const Transition& transition);

}  // namespace hearsay::gaussian
