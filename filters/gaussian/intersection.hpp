// What all ways to choose ω have in common. Internal to filters/.
#pragma once

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

}  // namespace hearsay::gaussian
