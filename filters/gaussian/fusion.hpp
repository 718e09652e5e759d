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
//   ci-fixed            own               ω, 1−ω, 0 as given      nothing
//   ci-niehsen          own               ω ∝ 1/tr Σ              nothing
//   ci-franken-huepper  own               ω from determinants     nothing
//   most-certain        own               1, 0, 0 or 0, 1, 0      nothing
//   inverse-ci          own               by direction            nothing
//   ellipsoidal         own               by direction            nothing
//
// Some take in all that was heard since they last spoke at once (filters/gaussian/batch.hpp), and
// one knows which part of a belief is independent (filters/gaussian/split.hpp):
//
//   ci-batch               own                     ω on the simplex by max |Ω|
//   split-ci               own, its fresh part     by direction: only the rest is weighed by ω
//   consensus-information  own, its degree         Metropolis weights
//   hybrid-consensus       own, fresh, its degree  Metropolis weights, γ times those for the fresh
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
  ci_fixed,
  ci_niehsen,
  ci_franken_huepper,
  most_certain,
  inverse_ci,
  ellipsoidal,
  ci_batch,
  split_ci,
  consensus_information,
  hybrid_consensus,
};

/// What a rule sends and to whom.
enum class Sends {
  nothing,
  belief,             ///< the whole belief, one broadcast
  local_update,       ///< the information of its own measurements since it last sent, one broadcast
  belief_less_heard,  ///< a frame for each neighbour: the belief less what that neighbour said last
  belief_and_fresh,   ///< the belief, and how much of it was measured since the last sending
  belief_and_degree,  ///< the belief, and how many neighbours the sender has
  hybrid,             ///< the belief, what was measured since the last sending, and the degree
};

/// What a rule keeps for each neighbour.
enum class Memory {
  nothing,
  last_exchanged,  ///< overwritten by what is sent to and by what is heard from the neighbour
  last_heard,      ///< replaced by each newer message of the neighbour
  held,            ///< the newest message of the neighbour, until it is fused with all others
};

/// How a rule takes in what is heard.
enum class Fuses {
  by_weight,     ///< each message with coefficients()
  by_direction,  ///< each message with fuse_by_direction()
  by_parts,      ///< each message with fuse_split()
  at_once,       ///< all that is held with weights of their own, when the agent is about to talk
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
  std::string_view cost;          ///< of one fusion of beliefs of dimension n
  std::string_view source;
  Fuses fuses = Fuses::by_weight;
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
/// its own belief, `skipped` = "overflow", if either belief is not finite. `fixed_omega`, in (0,
/// 1], is the weight of the own belief under ci-fixed; no other rule looks at it.
/// @throws BrokenInvariant if the dimensions differ, or for a rule that does not fuse by weight.
Coefficients coefficients(Rule rule, const Belief& own, const Belief& received,
                          double fixed_omega = 0.5);

/// What a rule by direction makes of these two beliefs of equal dimension; `skipped` as above.
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

/// `omega`, in (0, 1], as it is.
Intersection intersect_fixed(const Matrix& omega_a, const Matrix& omega_b, double omega);
/// ω ∝ 1/tr Σ: by trace as above where one of them has none. Niehsen 2002.
Intersection intersect_niehsen(const Matrix& omega_a, const Matrix& omega_b);
/// ω = (|I| − |I−Ω_a| + |Ω_a|)/(2|I| + …) with I = Ω_a + Ω_b; by determinant as above where I is
/// singular. Fränken & Hüpper 2005.
Intersection intersect_franken_huepper(const Matrix& omega_a, const Matrix& omega_b);
/// ω = 1 or 0: the belief of less entropy, own if equal. Both singular: own, `skipped` = "both
/// beliefs are singular".
Intersection most_certain(const Matrix& omega_a, const Matrix& omega_b);

}  // namespace hearsay::gaussian
