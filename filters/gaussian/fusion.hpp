// Fusion rules for Gaussian beliefs in information form, as data.
//
// Most rules are a linear combination of beliefs:
//     fused = a·own + b·received − c·common,
// with coefficients that depend on the matrices alone; some weigh direction by direction
// (filters/gaussian/directional.hpp). Whatever rides along with a belief (the
// rumour ledger) is combined with the same coefficients, so it cannot disagree with the rule.
//
//   rule                sends             a, b, c                 remembers for each neighbour
//   none                nothing           1, 0, 0                 nothing
//   naive               own               1, 1, 0                 nothing
//   local-update        own measurements  1, 1, 0                 nothing
//                       since it last sent
//   channel             own               1, 1, 1                 what was last exchanged
//   channel-robust      own − heard       1, 1, 1                 what was last heard from it
//   ci-det              own               ω, 1−ω, 0 by max |Ω|    nothing
//   ci-trace            own               ω, 1−ω, 0 by min tr Σ   nothing
//   ci-half             own               ½, ½, 0                 nothing
//   ci-niehsen          own               ω ∝ 1/tr Σ              nothing
//   ci-franken-huepper  own               ω from determinants     nothing
//   most-certain        own               1, 0, 0 or 0, 1, 0      nothing
//   inverse-ci          own               by direction            nothing
//   ellipsoidal         own               by direction            nothing
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string_view>

#include "filters/gaussian/belief.hpp"
#include "filters/gaussian/directional.hpp"

namespace hearsay::gaussian {

enum class Rule {
  none,
  naive,
  local_update,
  channel,
  channel_robust,
  ci_det,
  ci_trace,
  ci_half,
  ci_niehsen,
  ci_franken_huepper,
  most_certain,
  inverse_ci,
  ellipsoidal,
};

/// What a rule sends and to whom.
enum class Sends {
  nothing,
  belief,            ///< the whole belief, one broadcast
  local_update,      ///< the information of its own measurements since it last sent, one broadcast
  belief_less_heard  ///< a frame for each neighbour: the belief less what that neighbour said last
};

/// What a rule keeps for each neighbour.
enum class Memory {
  nothing,
  last_exchanged,  ///< overwritten by what is sent to and by what is heard from the neighbour
  last_heard,      ///< replaced by each newer message of the neighbour
};

/// What `hearsay list rules` says.
struct RuleInfo {
  Rule rule;
  std::string_view name;  ///< as in scenario files
  Sends sends;
  Memory memory;
  std::string_view assumes;
  std::string_view conservative;  ///< when it is conservative
  std::string_view ledger;        ///< where the ledger's true covariance is exact
  std::string_view source;
  bool directional = false;  ///< fuse_by_direction() instead of coefficients()
};
std::span<const RuleInfo> rules();
const RuleInfo& info(Rule rule);
/// Nothing for an unknown name.
std::optional<Rule> rule_by_name(std::string_view name);

/// fused = own·a + received·b − common·c.
struct Coefficients {
  double own = 1.0;
  double received = 0.0;
  double common = 0.0;
  /// Why the rule kept its own belief, if it did for want of a usable pair; else nullptr.
  const char* skipped = nullptr;
};

/// The coefficients of `rule` for these two beliefs of equal dimension. Every rule but `none` keeps
/// its own belief, `skipped` = "overflow", if either belief is not finite.
/// @throws BrokenInvariant if the dimensions differ, or for a directional rule.
Coefficients coefficients(Rule rule, const Belief& own, const Belief& received);

/// What a directional rule makes of these two beliefs of equal dimension; `skipped` as above.
/// @throws BrokenInvariant if the dimensions differ, or for another rule.
DirectionalFusion fuse_by_direction(Rule rule, const Belief& own, const Belief& received);

/// ω in [0, 1] of covariance intersection Ω = ωΩ_a + (1−ω)Ω_b, ξ likewise.
/// Equal matrices, all generalised eigenvalues one (1e-12): ω = ½.
/// If one side knows nothing (Ω = 0, or below 1e-15 of a singular other side) the other is taken.
/// Where both know some direction, and one or both are singular, the criterion is that of the
/// fused matrix on its own range, range(Ω_a) + range(Ω_b): its determinant there, or the trace of
/// its pseudo-inverse. So equal ranges give the criterion on the common range, and what only one
/// side knows is never dropped (0 < ω < 1 where each has such a direction). Where no direction is
/// known to both `skipped` says "no common range", and own is kept. So it is for indefinite
/// ("own belief is indefinite", "received belief is indefinite") and non-finite ("overflow") input.
/// ω is accurate to about 1e-12 unless the matrices determine it worse.
/// @throws BrokenInvariant if the dimensions differ.
/// Julier & Uhlmann 1997; Merino 2007, eq. 3.43–3.46.
struct Intersection {
  double omega = 1.0;
  const char* skipped = nullptr;
};
Intersection intersect_det(const Matrix& omega_a, const Matrix& omega_b);
Intersection intersect_trace(const Matrix& omega_a, const Matrix& omega_b);

// Weights without a search. Where one side is no belief or knows nothing the answer is that of the
// two above; any ω keeps the result conservative.

/// ω = ½.
Intersection intersect_half(const Matrix& omega_a, const Matrix& omega_b);
/// ω ∝ 1/tr Σ: by trace as above where one of them has none. Niehsen 2002.
Intersection intersect_niehsen(const Matrix& omega_a, const Matrix& omega_b);
/// ω = (|I| − |I−Ω_a| + |Ω_a|)/(2|I| + …) with I = Ω_a + Ω_b; by determinant as above where I is
/// singular. Fränken & Hüpper 2005.
Intersection intersect_franken_huepper(const Matrix& omega_a, const Matrix& omega_b);
/// ω = 1 or 0: the belief of less entropy, own if equal. Both singular: own, `skipped` = "both
/// beliefs are singular".
Intersection most_certain(const Matrix& omega_a, const Matrix& omega_b);

}  // namespace hearsay::gaussian
