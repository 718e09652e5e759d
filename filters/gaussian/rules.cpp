// The table of fusion rules: `hearsay list rules`.
#include "filters/gaussian/fusion.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay::gaussian {
namespace {

constexpr std::string_view exact_ledger =
    "exact for linear-Gaussian problems, static or moving by a known model, while sending does not "
    "depend on measured values; of trajectories multiplicity alone";

constexpr std::array<RuleInfo, 18> table = {{
    {Rule::none, "none", Sends::nothing, Memory::nothing,
     "nothing: an agent believes only what it measured itself",
     "always, as far as its own measurements are", exact_ledger, "nothing",
     "the reference without communication"},
    {Rule::naive, "naive", Sends::belief, Memory::nothing,
     "whatever is heard is news: sender and receiver share no measurement",
     "only as long as no measurement reaches an agent twice, so not beyond a first exchange",
     exact_ledger, "one addition, ~n² operations", "Merino 2007, eq. 3.36 without its common term"},
    {Rule::local_update, "local-update", Sends::local_update, Memory::nothing,
     "everybody hears everybody's messages, each exactly once",
     "always: no measurement is counted twice; what was lost is missing for ever, and nothing "
     "travels beyond the first hearer, unless messages are stored and forwarded",
     exact_ledger, "one addition, ~n² operations", "Merino 2007, section 3.2.3"},
    {Rule::channel, "channel", Sends::belief, Memory::last_exchanged,
     "a tree of reliable, ordered links on which beliefs never cross",
     "exact there; loops count twice; lost or crossing beliefs lose information, up to an "
     "indefinite belief",
     exact_ledger, "one addition and one subtraction, ~n² operations",
     "Merino 2007, Alg. 3.4, eq. 3.36-3.40"},
    {Rule::channel_robust, "channel-robust", Sends::belief_less_heard, Memory::last_heard,
     "a tree; messages may be lost, doubled, reordered or cross",
     "exact there, up to messages under way; loops count twice and more; what a neighbour said "
     "before it lost its memory is given back, not counted twice; filters of moving states lose "
     "information, up to an indefinite belief, trajectories do not",
     exact_ledger, "one addition and two subtractions, ~n² operations",
     "cumulative form of Merino 2007, Alg. 3.4"},
    {Rule::ci_det, "ci-det", Sends::belief, Memory::nothing,
     "both beliefs are conservative; nothing about what they share",
     "always, for any correlation; price: independent information is not added", exact_ledger,
     "two factorisations, an eigenvalue problem and a search over one number (none for n ≤ 2), ~10 "
     "n³ operations",
     "Julier & Uhlmann 1997; Merino 2007, eq. 3.43-3.46"},
    {Rule::ci_trace, "ci-trace", Sends::belief, Memory::nothing,
     "both beliefs are conservative; nothing about what they share; one unit on all axes",
     "always, for any correlation; price: independent information is not added", exact_ledger,
     "two factorisations, two eigenvalue problems and a search over one number, ~20 n³ operations",
     "Julier & Uhlmann 1997; Merino 2007, eq. 3.43-3.46"},
    {Rule::ci_half, "ci-half", Sends::belief, Memory::nothing,
     "both beliefs are conservative; nothing about what they share",
     "always, for any correlation; a poor belief that is heard makes a good one worse",
     exact_ledger, "two factorisations to see what there is to weigh, ~n³ operations",
     "Merino 2007, eq. 3.45-3.46 with a fixed weight"},
    {Rule::ci_fixed, "ci-fixed", Sends::belief, Memory::nothing,
     "both beliefs are conservative; nothing about what they share",
     "always, for any correlation and any weight; it does not ask which of both knows more",
     exact_ledger, "two factorisations to see what there is to weigh, ~n³ operations",
     "Julier & Uhlmann 1997 with the scenario's weight estimator.omega of one's own belief"},
    {Rule::ci_niehsen, "ci-niehsen", Sends::belief, Memory::nothing,
     "both beliefs are conservative; nothing about what they share; one unit on all axes",
     "always, for any correlation; looser than ci-trace, and costs two factorisations",
     exact_ledger, "two factorisations and two traces of inverses, ~2 n³ operations",
     "W. Niehsen, FUSION 2002"},
    {Rule::ci_franken_huepper, "ci-franken-huepper", Sends::belief, Memory::nothing,
     "both beliefs are conservative; nothing about what they share",
     "always, for any correlation; looser than ci-det, and costs three factorisations",
     exact_ledger, "three factorisations for three determinants, ~n³ operations",
     "D. Franken, A. Hupper, FUSION 2005"},
    {Rule::most_certain, "most-certain", Sends::belief, Memory::nothing,
     "both beliefs are conservative; the one of less entropy is taken whole",
     "always, for any correlation; price: nothing is ever combined", exact_ledger,
     "two factorisations for two determinants, ~n³ operations",
     "dictatorship by least entropy: Merino 2007, section 4.3"},
    {Rule::inverse_ci, "inverse-ci", Sends::belief, Memory::nothing,
     "what both have in common is information of either, independent of the rest of both",
     "where that is so; not for any correlation", exact_ledger,
     "two factorisations, an eigenvalue problem and a search over one number, ~20 n³ operations",
     "B. Noack, J. Sijs, M. Reinhardt, U. D. Hanebeck, Automatica 79, 2017", Fuses::by_direction},
    {Rule::ellipsoidal, "ellipsoidal", Sends::belief, Memory::nothing,
     "along each direction the better belief contains the other",
     "not in general: it claims the better of both in every direction", exact_ledger,
     "two factorisations and an eigenvalue problem, ~20 n³ operations",
     "J. Sijs, M. Lazar, P. P. J. van den Bosch, ACC 2010", Fuses::by_direction},
    {Rule::ci_batch, "ci-batch", Sends::belief, Memory::held,
     "all beliefs are conservative; nothing about what they share",
     "always, for any correlation; the newest belief of each neighbour, in any order", exact_ledger,
     "for k beliefs about 20 steps of k³/3 + k²n² + kn³ operations, once a talk",
     "S. J. Julier, J. K. Uhlmann, in: Handbook of Multisensor Data Fusion, 2001, ch. 12 (any "
     "number of beliefs)",
     Fuses::at_once},
    {Rule::split_ci, "split-ci", Sends::belief_and_fresh, Memory::nothing,
     "what an agent measured since it last sent is independent of all that others know",
     "while a broadcast reaches its hearers before any belief that has it: not with jitter or "
     "acknowledgements",
     exact_ledger, "five eigenvalue problems and a search over one number, ~60 n³ operations",
     "Julier & Uhlmann 2001; H. Li, F. Nashashibi, M. Yang, IEEE Trans. ITS 14(4), 2013",
     Fuses::by_parts},
    {Rule::consensus_information, "consensus-information", Sends::belief_and_degree, Memory::held,
     "all beliefs are conservative; nothing about what they share; the graph is undirected",
     "always, for any correlation: weights of Metropolis, and one's own for whom was not heard",
     exact_ledger, "for k beliefs k additions, ~kn² operations, once a talk",
     "G. Battistelli, L. Chisci, Automatica 50(3), 2014; weights: L. Xiao, S. Boyd, S. Lall, IPSN "
     "2005",
     Fuses::at_once},
    {Rule::hybrid_consensus, "hybrid-consensus", Sends::hybrid, Memory::held,
     "as consensus-information, and that what an agent measured since it last sent is independent "
     "of all that others know; with correction \"nodes\" also that it spreads evenly over all "
     "agents",
     "with correction \"one\" where that is so; with \"nodes\" not while news spreads: a fresh "
     "measurement counts more than once",
     exact_ledger, "for k beliefs 2k additions, ~2kn² operations, once a talk",
     "G. Battistelli, L. Chisci, G. Mugnai, A. Farina, A. Graziano, IEEE Trans. AC 60(5), 2015, "
     "with one step of consensus a talk",
     Fuses::at_once},
}};

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

}  // namespace hearsay::gaussian
