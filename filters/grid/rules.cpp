// The table of fusion rules for grids.
#include <array>

#include "filters/grid/fusion.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay::grid {
namespace {

constexpr std::array<RuleInfo, 11> table = {{
    {Rule::none, "none", true, true, Sends::nothing, Memory::nothing, true, false,
     "nothing: an agent believes only what it saw itself", "always, as far as its own looks are",
     "nothing", "the reference without communication", "weights are exact: 1 for its own looks"},
    {Rule::naive, "naive", true, true, Sends::evidence, Memory::nothing, false, true,
     "whatever is heard is news: sender and receiver share no look",
     "only as long as no look reaches an agent twice, so not beyond a first exchange",
     "one addition a number", "Merino 2007, eq. 4.4; Beta eq. 4.35",
     "weights are exact, whole numbers"},
    {Rule::channel, "channel", true, true, Sends::evidence, Memory::last_exchanged, false, true,
     "a tree of reliable, ordered links on which beliefs never cross, and evidence within limits",
     "exact there; loops count twice; lost or crossing beliefs lose looks, of Beta down to "
     "negative counts",
     "one addition and one subtraction a number", "Merino 2007, Alg. 4.3; Beta Alg. 4.5",
     "weights are exact, whole numbers; below 1 where looks were lost"},
    {Rule::channel_robust, "channel-robust", true, true, Sends::evidence_less_heard,
     Memory::last_heard, false, true,
     "a tree; messages may be lost, doubled, reordered or cross; evidence within limits",
     "exact there, up to messages under way; loops count twice and more",
     "one addition and two subtractions a number",
     "as the Gaussian rule of this name: cumulative evidence that replaces its predecessor",
     "weights are exact, whole numbers"},
    {Rule::maximum, "maximum", true, false, Sends::evidence, Memory::nothing, true, true,
     "nothing about what is shared; one prior",
     "no look counts twice; but looks that saw nothing count only where nobody holds more: the "
     "most alarmed agent is believed",
     "one comparison a cell", "Merino 2007, eq. 4.5",
     "weights are exact, 0 or 1: a cell is all of one side"},
    {Rule::strongest, "strongest", true, false, Sends::evidence, Memory::nothing, true, true,
     "nothing about what is shared",
     "no look counts twice: a cell has the looks of one of both, those that moved it farthest from "
     "the prior; of equal ones the alarm",
     "two comparisons a cell",
     "dictatorship (Merino 2007, section 4.1.3), told by evidence; with prior ½ the same",
     "weights are exact, 0 or 1: a cell is all of one side"},
    {Rule::dictatorship, "dictatorship", true, true, Sends::evidence, Memory::nothing, true, true,
     "nothing about what is shared; one prior",
     "no look counts twice: a cell has the looks of one of both, those that leave the least "
     "entropy; of equal ones the alarm",
     "Bernoulli: two comparisons a cell; Beta: two entropies a cell (six lgamma, six digamma) "
     "where both differ",
     "Merino 2007, section 4.1.3", "weights are exact, 0 or 1: a cell is all of one side"},
    {Rule::geometric_mean, "geometric-mean", true, false, Sends::evidence, Memory::nothing, true,
     true, "nothing about what is shared",
     "always, if both are: no look gains weight; a look known to one side alone loses some",
     "two multiplications and an addition a cell",
     "logarithmic opinion pool: Genest & Zidek, Statistical Science 1(1), 1986",
     "weights are exact: shares ω and 1−ω"},
    {Rule::linear_pool, "linear-pool", true, false, Sends::evidence, Memory::nothing, true, true,
     "nothing about what is shared; one prior",
     "the probability is never outside of those of both; what agrees does not grow",
     "four exponentials and two logarithms a cell where both differ",
     "linear opinion pool: Stone, Annals of Mathematical Statistics 32, 1961",
     "shares λ and 1−λ, cell by cell those that make up the result: weights add up exactly, but "
     "depend on the evidence"},
    {Rule::elementwise_maximum, "elementwise-maximum", false, true, Sends::evidence,
     Memory::nothing, true, true, "counts only grow",
     "no look counts twice: m and n are each as one of both counted them, and never more than all "
     "looks give",
     "one comparison a number", "Merino 2007, eq. 4.38-4.39",
     "weights are exact, 0 or 1: m and n are each all of one side, so that a look may count in one "
     "alone"},
    {Rule::averaged_parameters, "averaged-parameters", false, true, Sends::evidence,
     Memory::nothing, true, true, "nothing about what is shared",
     "always, if both are: no look gains weight; a look known to one side alone loses some",
     "two multiplications and an addition a number", "geometric mean of Beta densities",
     "weights are exact: shares ω and 1−ω"},
}};

}  // namespace

std::span<const RuleInfo> rules() { return table; }

const RuleInfo& info(Rule rule) {
  for (const RuleInfo& row : table) {
    if (row.rule == rule) return row;
  }
  throw BrokenInvariant("info: a fusion rule of grids that is not in the table");
}

std::optional<Rule> rule_by_name(std::string_view name) {
  for (const RuleInfo& row : table) {
    if (row.name == name) return row.rule;
  }
  return std::nullopt;
}

}  // namespace hearsay::grid
