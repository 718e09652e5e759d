#include "filters/gaussian/fusion.hpp"

#include "filters/gaussian/symmetric.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay::gaussian {
namespace {

constexpr std::string_view exact_ledger =
    "exact for linear-Gaussian problems, static or moving by a known model, while sending does not "
    "depend on measured values; of trajectories multiplicity alone";

constexpr std::array<RuleInfo, 13> table = {{
    {Rule::none, "none", Sends::nothing, Memory::nothing,
     "nothing: an agent believes only what it measured itself",
     "always, as far as its own measurements are", exact_ledger,
     "the reference without communication"},
    {Rule::naive, "naive", Sends::belief, Memory::nothing,
     "whatever is heard is news: sender and receiver share no measurement",
     "only as long as no measurement reaches an agent twice, so not beyond a first exchange",
     exact_ledger, "Merino 2007, eq. 3.36 without its common term"},
    {Rule::local_update, "local-update", Sends::local_update, Memory::nothing,
     "everybody hears everybody's messages, each exactly once",
     "always: no measurement is counted twice; what was lost is missing for ever, and nothing "
     "travels beyond the first hearer, unless messages are stored and forwarded",
     exact_ledger, "Merino 2007, section 3.2.3"},
    {Rule::channel, "channel", Sends::belief, Memory::last_exchanged,
     "a tree of reliable, ordered links on which beliefs never cross",
     "exact there; loops count twice; lost or crossing beliefs lose information, up to an "
     "indefinite belief",
     exact_ledger, "Merino 2007, Alg. 3.4, eq. 3.36-3.40"},
    {Rule::channel_robust, "channel-robust", Sends::belief_less_heard, Memory::last_heard,
     "a tree; messages may be lost, doubled, reordered or cross",
     "exact there, up to messages under way; loops count twice and more; what a neighbour said "
     "before it lost its memory is given back, not counted twice; filters of moving states lose "
     "information, up to an indefinite belief, trajectories do not",
     exact_ledger, "cumulative form of Merino 2007, Alg. 3.4"},
    {Rule::ci_det, "ci-det", Sends::belief, Memory::nothing,
     "both beliefs are conservative; nothing about what they share",
     "always, for any correlation; price: independent information is not added", exact_ledger,
     "Julier & Uhlmann 1997; Merino 2007, eq. 3.43-3.46"},
    {Rule::ci_trace, "ci-trace", Sends::belief, Memory::nothing,
     "both beliefs are conservative; nothing about what they share; one unit on all axes",
     "always, for any correlation; price: independent information is not added", exact_ledger,
     "Julier & Uhlmann 1997; Merino 2007, eq. 3.43-3.46"},
    {Rule::ci_half, "ci-half", Sends::belief, Memory::nothing,
     "both beliefs are conservative; nothing about what they share",
     "always, for any correlation; a poor belief that is heard makes a good one worse",
     exact_ledger, "Merino 2007, eq. 3.45-3.46 with a fixed weight"},
    {Rule::ci_niehsen, "ci-niehsen", Sends::belief, Memory::nothing,
     "both beliefs are conservative; nothing about what they share; one unit on all axes",
     "always, for any correlation; looser than ci-trace, and costs two factorisations",
     exact_ledger, "W. Niehsen, FUSION 2002"},
    {Rule::ci_franken_huepper, "ci-franken-huepper", Sends::belief, Memory::nothing,
     "both beliefs are conservative; nothing about what they share",
     "always, for any correlation; looser than ci-det, and costs three factorisations",
     exact_ledger, "D. Franken, A. Hupper, FUSION 2005"},
    {Rule::most_certain, "most-certain", Sends::belief, Memory::nothing,
     "both beliefs are conservative; the one of less entropy is taken whole",
     "always, for any correlation; price: nothing is ever combined", exact_ledger,
     "dictatorship by least entropy: Merino 2007, section 4.3"},
    {Rule::inverse_ci, "inverse-ci", Sends::belief, Memory::nothing,
     "what both have in common is information of either, independent of the rest of both",
     "where that is so; not for any correlation", exact_ledger,
     "B. Noack, J. Sijs, M. Reinhardt, U. D. Hanebeck, Automatica 79, 2017", true},
    {Rule::ellipsoidal, "ellipsoidal", Sends::belief, Memory::nothing,
     "along each direction the better belief contains the other",
     "not in general: it claims the better of both in every direction", exact_ledger,
     "J. Sijs, M. Lazar, P. P. J. van den Bosch, ACC 2010", true},
}};

bool finite(const Belief& belief) { return all_finite(belief.omega) && all_finite(belief.xi); }

Coefficients weighted(const Intersection& intersection) {
  if (intersection.skipped != nullptr) return {1.0, 0.0, 0.0, intersection.skipped};
  return {intersection.omega, 1.0 - intersection.omega, 0.0, nullptr};
}

}  // namespace

std::span<const RuleInfo> rules() { return table; }

const RuleInfo& info(Rule rule) {
  for (const RuleInfo& row : table) {
    if (row.rule == rule) return row;
  }
  throw BrokenInvariant("info: a fusion rule that is not in the table");
}

std::optional<Rule> rule_by_name(std::string_view name) {
  for (const RuleInfo& row : table) {
    if (row.name == name) return row.rule;
  }
  return std::nullopt;
}

Coefficients coefficients(Rule rule, const Belief& own, const Belief& received) {
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
      return weighted(intersect_half(own.omega, received.omega));
    case Rule::ci_niehsen:
      return weighted(intersect_niehsen(own.omega, received.omega));
    case Rule::ci_franken_huepper:
      return weighted(intersect_franken_huepper(own.omega, received.omega));
    case Rule::most_certain:
      return weighted(most_certain(own.omega, received.omega));
    case Rule::none:
    case Rule::inverse_ci:
    case Rule::ellipsoidal:
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
