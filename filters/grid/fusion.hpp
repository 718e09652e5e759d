// Fusion rules for grids, as data. Each works cell by cell on evidence (what was added to the
// prior; filters/grid/bernoulli.hpp, beta.hpp), so priors are never counted twice.
//
//   rule                 of        own evidence becomes                             remembers
//   none                 both      own                                              nothing
//   naive                both      own + received                                   nothing
//   channel              both      own + received − last exchanged                  last_exchanged
//   channel-robust       both      own + received − last heard                      last_heard
//   maximum              Bernoulli the larger probability                           nothing
//   strongest            Bernoulli the larger |e|, with its sign                    nothing
//   dictatorship         both      that of the belief of less entropy               nothing
//   geometric-mean       Bernoulli ω·own + (1−ω)·received                           nothing
//   linear-pool          Bernoulli that of p = ω·p_own + (1−ω)·p_received           nothing
//   elementwise-maximum  Beta      (max m, max n)                                   nothing
//   averaged-parameters  Beta      ω·own + (1−ω)·received                           nothing
//
// Results are brought within the limits of the grid. Cells that were not heard are not touched:
// what arrives in packets is fused range by range.
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "filters/grid/bernoulli.hpp"
#include "filters/grid/beta.hpp"

namespace hearsay::grid {

enum class Rule {
  none,
  naive,
  channel,
  channel_robust,
  maximum,
  strongest,
  dictatorship,
  geometric_mean,
  linear_pool,
  elementwise_maximum,
  averaged_parameters,
};

/// What a rule sends and to whom.
enum class Sends {
  nothing,
  evidence,             ///< the whole evidence, one broadcast
  evidence_less_heard,  ///< for each neighbour: the evidence less what that neighbour said last
};

/// What a rule keeps for each neighbour.
enum class Memory {
  nothing,
  last_exchanged,  ///< overwritten by what is sent to and by what is heard from the neighbour
  last_heard,      ///< each cell replaced by what the neighbour said of it last
};

struct RuleInfo {
  Rule rule;
  std::string_view name;  ///< as in scenario files
  bool bernoulli, beta;   ///< which grids it is for
  Sends sends;
  Memory memory;
  bool idempotent;   ///< fusing a belief with itself changes nothing
  bool commutative;  ///< sender and receiver end with the same evidence; weighted rules at ω = ½
  std::string_view assumes;
  std::string_view conservative;  ///< when it is
  std::string_view cost;          ///< of one fusion
  std::string_view source;
  /// What the rumour ledger (filters/grid/ledger.hpp) knows under it, as long as no evidence stands
  /// at its limit.
  std::string_view ledger;
};
std::span<const RuleInfo> rules();
const RuleInfo& info(Rule rule);
/// Nothing for an unknown name.
std::optional<Rule> rule_by_name(std::string_view name);

/// What is heard of a range of cells.
struct Heard {
  int first_cell = 0;
  /// Evidence of the cells from the first on, `layers` finite numbers a cell.
  std::span<const float> received;
  /// Of the same cells, for rules with a memory: what to take off, 0 as long as nothing was
  /// exchanged. Else not looked at.
  std::span<const float> common = {};
};

/// Weighted rules: the weight of one's own belief.
inline constexpr double usual_omega = 0.5;

/// Fuses a range of cells into `own`. `omega`, in [0, 1], is looked at by
/// the three weighted rules alone. Nothing is allocated.
/// @throws BrokenInvariant for a rule that is not for such a grid, a range that is not in it,
/// `common` of another length where the rule needs it, a weight outside [0, 1].
void fuse(Rule rule, BernoulliGrid& own, const Heard& heard, double omega = usual_omega);
void fuse(Rule rule, BetaGrid& own, const Heard& heard, double omega = usual_omega);

/// What a number becomes: own·number + heard·received − common·(what is common), before the limit.
struct Shares {
  double own = 1.0, heard = 0.0, common = 0.0;
};

/// With which shares fuse() of the same arguments makes each number of the range: to be asked
/// before, since the rules that choose look at `own`. linear-pool is not linear in log-odds, but
/// its result lies between both, e = λ·own + (1−λ)·received: λ is the share (ω where both are
/// equal). `out` has as many as there are numbers in `heard.received`; nothing is allocated.
/// @throws BrokenInvariant as fuse(), or for another length.
void shares(Rule rule, const BernoulliGrid& own, const Heard& heard, double omega,
            std::span<Shares> out);
void shares(Rule rule, const BetaGrid& own, const Heard& heard, double omega,
            std::span<Shares> out);

/// own − heard into `out`, number by number: what channel-robust sends. @throws BrokenInvariant
/// unless all three are of one length.
void less_heard(std::span<const float> own, std::span<const float> heard, std::span<float> out);

}  // namespace hearsay::grid
