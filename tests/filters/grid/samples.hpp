// Areas, evidence and noise for the tests of this family.
#pragma once

#include <string_view>
#include <vector>

#include "filters/grid/bernoulli.hpp"
#include "filters/grid/beta.hpp"
#include "sim/kernel/random.hpp"

namespace hearsay::grid {

inline Stream stream(std::string_view purpose) {
  return Stream(1, Purpose(purpose), Entity::agent(0));
}

inline Area square(int side) { return Area({.columns = side, .rows = side}); }

/// Normal evidence, with zeros (never looked at) among it.
inline std::vector<float> random_evidence(Stream& random, std::size_t numbers, double sigma = 3.0) {
  std::vector<float> evidence(numbers);
  for (float& e : evidence) {
    e = random.bernoulli(0.2) ? 0.0F : static_cast<float>(random.normal(0.0, sigma));
  }
  return evidence;
}

/// Counts of looks: not negative.
inline std::vector<float> random_counts(Stream& random, std::size_t numbers) {
  std::vector<float> counts(numbers);
  for (float& c : counts) {
    c = random.bernoulli(0.2) ? 0.0F : static_cast<float>(random.exponential(0.2));
  }
  return counts;
}

template <typename Grid>
void set(Grid& grid, const std::vector<float>& evidence) {
  std::copy(evidence.begin(), evidence.end(), grid.evidence_mutable().begin());
}
template <typename Grid>
std::vector<float> copy_of(const Grid& grid) {
  return {grid.evidence().begin(), grid.evidence().end()};
}

}  // namespace hearsay::grid
