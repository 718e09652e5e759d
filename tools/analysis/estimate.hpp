// One comparison's interval, and on which side of the claim it lies.
#pragma once

#include <cstddef>
#include <string>

#include "tools/analysis/comparison.hpp"
#include "tools/analysis/statistics.hpp"

namespace hearsay::analysis {

inline constexpr double family_alpha = 0.05;

enum class Side { claimed, other, open };

struct Finding {
  Interval interval;
  Side side = Side::open;
  double bound_low = 0.0, bound_high = 0.0;
  double margin = 0.0;       ///< how far inside the claim; negative beyond the bound
  double half_width = 0.0;   ///< agrees_with: of the interval, relative to the prediction
  std::size_t left_out = 0;  ///< agrees_with: values that cannot be divided by their prediction
};

/// `family`: number of comparisons in the claim.
Finding examine(const ClaimRules& rules, const Comparison& comparison, std::size_t family);

/// What examine() estimates, in words.
std::string quantity(const ClaimRules& rules);

}  // namespace hearsay::analysis
