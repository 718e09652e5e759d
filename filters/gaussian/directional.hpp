// Fusion rules that weigh beliefs direction by direction.
//
// In the coordinates that diagonalise both information matrices, Ω_a = U diag(a) Uᵀ and
// Ω_b = U diag(b) Uᵀ, each direction has weights of its own:
//     Ω = U diag(c) Uᵀ,   ξ = G_aξ_a + G_bξ_b,   G_a = U diag(g_a) U⁻¹,   G_b likewise.
//
//   inverse-ci    c = a + b − m with m = 1/(ω/a + (1−ω)/b), g_a = 1 − ωm/a, g_b = 1 − (1−ω)m/b
//   ellipsoidal   c = max(a, b): the belief that knows more of a direction is believed there
//
// In both G_aΩ_a + G_bΩ_b = Ω, so the mean is unbiased.
#pragma once

#include "filters/gaussian/belief.hpp"

namespace hearsay::gaussian {

struct DirectionalFusion {
  Belief belief;
  Matrix own;       ///< G_a (n×n)
  Matrix received;  ///< G_b
  /// Why own was kept: as for Intersection, and "a belief is singular" where one of them does not
  /// determine the state and the other knows something.
  const char* skipped = nullptr;
};

/// Inverse covariance intersection, ω by maximum |Ω|. Noack, Sijs, Reinhardt & Hanebeck,
/// Automatica 79, 2017. @throws BrokenInvariant if the dimensions differ.
DirectionalFusion fuse_by_inverse_intersection(const Belief& own, const Belief& received);

/// Ellipsoidal intersection in the limit η → 0; where both know the same of a direction (to 1e-12)
/// the two means are averaged. Sijs, Lazar & van den Bosch, ACC 2010.
/// @throws BrokenInvariant if the dimensions differ.
DirectionalFusion fuse_by_ellipsoids(const Belief& own, const Belief& received);

}  // namespace hearsay::gaussian
