// Covariance intersection by determinant for the common case: two positive definite matrices, well
// conditioned on the scale of their own diagonals. Internal to filters/.
//
// With S = Ω_a + Ω_b = LLᵀ and K = L⁻¹(Ω_a − Ω_b)L⁻ᵀ the fused matrix is
//     ωΩ_a + (1−ω)Ω_b = ½ L (I + τK) Lᵀ,   τ = 2ω − 1,
// and K's eigenvalues lie in (−1, 1). So log |I + τK| is what to maximise over −1 ≤ τ ≤ 1: K is
// brought to tridiagonal form, and Newton's method runs on the recurrence of its leading minors. No
// eigenvalue is computed. The difference is formed first, so nearly equal matrices lose nothing.
#pragma once

#include <optional>

#include "filters/gaussian/belief.hpp"

namespace hearsay::gaussian {

/// ω that maximises |ωΩ_a + (1−ω)Ω_b|, both n×n symmetric. Nothing, and the general way is to be
/// gone, if the matrices are not certainly positive definite (by the measure of `definiteness`), if
/// they differ widely, are equal to about 1e-11, or have diagonal entries beyond 1e±30; nothing for
/// n ≤ 2 either, where the general way ends in closed form.
std::optional<double> omega_of_regular_pair(const Matrix& omega_a, const Matrix& omega_b);

}  // namespace hearsay::gaussian
