// hearsay compare: paired differences along one axis of a study.
#include <fmt/core.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tools/analysis/claims.hpp"
#include "tools/hearsay/verbs.hpp"

namespace hearsay::program {
namespace {

nlohmann::ordered_json to_json(const analysis::Interval& interval) {
  // As in the reports of claims: a time that never comes is not one that is unknown.
  const auto number = [](double value) {
    if (std::isinf(value)) return nlohmann::ordered_json(value > 0.0 ? "inf" : "-inf");
    return std::isnan(value) ? nlohmann::ordered_json() : nlohmann::ordered_json(value);
  };
  return {{"estimate", number(interval.estimate)},
          {"low", number(interval.low)},
          {"high", number(interval.high)}};
}

}  // namespace

int compare(const CompareVerb& verb) {
  const std::vector<analysis::CompareRow> rows =
      analysis::compare(verb.database, {.metric = verb.metric,
                                        .by = verb.by,
                                        .baseline = verb.baseline,
                                        .agents = verb.agents,
                                        .at = verb.at,
                                        .study = verb.study});
  if (verb.json) {
    nlohmann::ordered_json out = nlohmann::ordered_json::array();
    for (const analysis::CompareRow& row : rows) {
      out.push_back({{"cell", row.cell},
                     {verb.by, row.label},
                     {"pairs", row.pairs},
                     {"value", to_json(row.value)},
                     {"difference", to_json(row.difference)},
                     {"verdict", row.verdict}});
    }
    fmt::print("{}\n", out.dump(2));
    return exit_done;
  }
  std::size_t cell_width = 4, label_width = verb.by.size();
  for (const analysis::CompareRow& row : rows) {
    cell_width = std::max(cell_width, row.cell.size());
    label_width = std::max(label_width, row.label.size());
  }
  fmt::print("{:<{}}  {:<{}}  {:>5}  {:>11}  {:>11}  {:>26}  {}\n", "cell", cell_width, verb.by,
             label_width, "pairs", verb.metric.substr(0, 11), "difference", "interval", "verdict");
  for (const analysis::CompareRow& row : rows) {
    const bool baseline = row.verdict == "baseline";
    fmt::print(
        "{:<{}}  {:<{}}  {:>5}  {:>11.4g}  {:>11}  {:>26}  {}\n", row.cell, cell_width, row.label,
        label_width, row.pairs, row.value.estimate,
        baseline ? "" : fmt::format("{:.4g}", row.difference.estimate),
        baseline ? "" : fmt::format("[{:.4g}, {:.4g}]", row.difference.low, row.difference.high),
        row.verdict);
  }
  fmt::print("\nIntervals hold together at 95 % (Bonferroni over all rows).\n");
  return exit_done;
}

}  // namespace hearsay::program
