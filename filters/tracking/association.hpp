// Which of these belongs to which of those, decided by gated distances. Merino 2007, section 3.8.
#pragma once

#include <vector>

#include "filters/tracking/assignment.hpp"

namespace hearsay::tracking {

/// Gate for squared Mahalanobis distances, Merino 2007, eq. 3.64–3.65: a right pair lies beyond it
/// with probability 0.011 for two dimensions, 0.061 for four.
inline constexpr double gate_of_merino = 9.0;

enum class Pairing {
  nearest,  ///< the nearest pair of all first, then the nearest of what is left
  optimal,  ///< the pairs that make Σ(gate − d²) largest
};

/// The column of each row, or `unassigned`. Only pairs with d² ≤ gate are made; no column is used
/// twice. An infinite d² marks a pair that cannot be. Ties go to the lowest row, then the lowest
/// column (`nearest`), or are always broken the same way (`optimal`).
/// @throws BrokenInvariant unless the gate is positive and finite and no d² is negative or NaN.
std::vector<int> pair_within(const Table& d2, double gate, Pairing pairing);

}  // namespace hearsay::tracking
