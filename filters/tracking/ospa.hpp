// How far a set of estimates is from a set of truths, one number for place and number alike.
//
// OSPA is a mean an object: with m ≤ n objects on the two sides,
//     d = ((min Σ min(dᵢ, c)^p + (n − m)c^p)/n)^(1/p),
// the minimum over all assignments of the m to m of the n. Schuhmacher, Vo & Vo, IEEE Trans. Signal
// Processing 56(8), 2008. For p = ∞ it is the least possible largest distance, or c where m ≠ n.
//
// GOSPA is a sum, and says what it is made of: with α = 2,
//     d = (min Σ dᵢ^p + ½c^p·(missed + false))^(1/p),
// the minimum over all assignments of any number of pairs. Rahmathullah, García-Fernández &
// Svensson, FUSION 2017.
#pragma once

#include <span>
#include <vector>

#include "filters/gaussian/belief.hpp"
#include "filters/tracking/assignment.hpp"

namespace hearsay::tracking {

/// Euclidean distances: a row an estimate, a column a truth, in their unit.
/// @throws BrokenInvariant if dimensions differ.
Table distances(std::span<const gaussian::Vector> estimates,
                std::span<const gaussian::Vector> truths);

/// In the unit of the distances; 0 … c. Two empty sets are at 0.
struct Ospa {
  double distance = 0.0;
  double localisation = 0.0;  ///< the part of place: localisation^p + cardinality^p = distance^p
  double cardinality = 0.0;  ///< the part of number; for p = ∞ the larger of both is the distance
};
/// `distances` ≥ 0, order 1 ≤ p ≤ ∞, cut-off c > 0. @throws BrokenInvariant outside these.
Ospa ospa(const Table& distances, double p, double c);

struct Gospa {
  double distance = 0.0;      ///< in the unit of the distances
  double localisation = 0.0;  ///< Σ dᵢ^p over the pairs; the three add up to distance^p
  double missed = 0.0;        ///< ½c^p for each truth without an estimate
  double false_ones = 0.0;    ///< ½c^p for each estimate without a truth
  int missed_count = 0;
  int false_count = 0;
  /// The truth of each estimate, or `unassigned`; a pair is nearer than c.
  std::vector<int> truth_of;
};
/// `distances` ≥ 0, order 1 ≤ p < ∞, cut-off c > 0. @throws BrokenInvariant outside these.
Gospa gospa(const Table& distances, double p, double c);

}  // namespace hearsay::tracking
