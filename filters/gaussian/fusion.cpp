#include "filters/gaussian/fusion.hpp"

#include "filters/gaussian/symmetric.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay::gaussian {
namespace {

bool finite(const Belief& belief) { return all_finite(belief.omega) && all_finite(belief.xi); }

Coefficients weighted(const Intersection& intersection) {
  if (intersection.skipped != nullptr) return {1.0, 0.0, 0.0, intersection.skipped};
  return {intersection.omega, 1.0 - intersection.omega, 0.0, nullptr};
}

}  // namespace

Coefficients coefficients(Rule rule, const Belief& own, const Belief& received,
                          double fixed_omega) {
  require(own.dimension() == received.dimension(), "coefficients: dimensions differ");
  if (rule == Rule::none) return {1.0, 0.0, 0.0, nullptr};
  if (!finite(own) || !finite(received)) return {1.0, 0.0, 0.0, "overflow"};
  switch (rule) {
    case Rule::naive:
    case Rule::local_update:
      return {1.0, 1.0, 0.0, nullptr};
    case Rule::channel:
    case Rule::channel_robust:
      return {1.0, 1.0, 1.0, nullptr};
    case Rule::ci_det:
      return weighted(intersect_det(own.omega, received.omega));
    case Rule::ci_trace:
      return weighted(intersect_trace(own.omega, received.omega));
    case Rule::ci_half:
      return weighted(intersect_fixed(own.omega, received.omega, 0.5));
    case Rule::ci_fixed:
      return weighted(intersect_fixed(own.omega, received.omega, fixed_omega));
    case Rule::ci_niehsen:
      return weighted(intersect_niehsen(own.omega, received.omega));
    case Rule::ci_franken_huepper:
      return weighted(intersect_franken_huepper(own.omega, received.omega));
    case Rule::most_certain:
      return weighted(most_certain(own.omega, received.omega));
    case Rule::none:
    case Rule::inverse_ci:
    case Rule::ellipsoidal:
    case Rule::ci_batch:
    case Rule::split_ci:
    case Rule::consensus_information:
    case Rule::hybrid_consensus:
      break;
  }
  throw BrokenInvariant("coefficients: a fusion rule without coefficients");
}

DirectionalFusion fuse_by_direction(Rule rule, const Belief& own, const Belief& received) {
  require(own.dimension() == received.dimension(), "fuse_by_direction: dimensions differ");
  if (!finite(own) || !finite(received)) {
    const int n = own.dimension();
    return {own, Matrix::Identity(n, n), Matrix::Zero(n, n), "overflow"};
  }
  if (rule == Rule::inverse_ci) return fuse_by_inverse_intersection(own, received);
  if (rule == Rule::ellipsoidal) return fuse_by_ellipsoids(own, received);
  throw BrokenInvariant("fuse_by_direction: a rule that does not");
}

}  // namespace hearsay::gaussian
