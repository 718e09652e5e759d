// Split covariance intersection: beliefs of which a part is known to be independent.
//
// Julier & Uhlmann 2001; Li, Nashashibi & Yang 2013. They write the covariance as P = P_d + P_i,
// P_i of errors that are independent of everybody else's, and widen P_d alone:
//     P₁ = P₁d/ω + P₁i,   P₂ = P₂d/(1−ω) + P₂i,   P⁻¹ = P₁⁻¹ + P₂⁻¹,   ω by minimum |P|.
//
// Here in information form. The error of ξ has the covariance Ω = Ω_d + Ω_i with Ω_i = ΩP_iΩ, and a
// measurement of one's own adds its information to Ω_i and leaves Ω_d as it is. In directions along
// which a share s of Ω is independent, widening multiplies information by ω/((1−s) + ωs).
#pragma once

#include "filters/gaussian/belief.hpp"

namespace hearsay::gaussian {

struct SplitFusion {
  Belief belief;
  Matrix independent;  ///< Ω_i of the fused belief: what is left of one's own
  Matrix own;          ///< G_a (n×n): ξ = G_aξ_a + G_bξ_b, as for rules by direction
  Matrix received;     ///< G_b
  double omega = 1.0;
  /// Why own was kept: as for Intersection, and "a part is more than the whole".
  const char* skipped = nullptr;
};

/// Fuses beliefs of equal dimension n whose independent parts (n×n) satisfy 0 ≤ Ω_i ≤ Ω. What the
/// other side knew independently was told to others, too: it is not independent any more.
/// Neither part independent: intersect_det(). Both wholly independent: the sum.
/// Singular beliefs: on their ranges; the determinant is that on the range of the sum.
/// @throws BrokenInvariant if dimensions differ.
SplitFusion fuse_split(const Belief& own, const Matrix& own_independent, const Belief& received,
                       const Matrix& received_independent);

}  // namespace hearsay::gaussian
