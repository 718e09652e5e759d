// What of a claim has a meaning, and how its repetitions are brought together.
#include <fmt/format.h>

#include "sim/kernel/error.hpp"
#include "tools/analysis/comparison.hpp"

namespace hearsay::analysis {
namespace {

using Kind = Expectation::Kind;

class Checker {
 public:
  Checker(const Study& study, const Claim& claim) : study_(study), claim_(claim) {}

  void require_that(bool holds, const std::string& message) const {
    if (!holds) throw InputError(study_.file, claim_.line, message);
  }

  std::optional<Statistic> statistic() const {
    const std::string& name = claim_.expect.statistic;
    if (name == "auto") return std::nullopt;
    if (name == "mean") return Statistic::mean;
    if (name == "rms") return Statistic::rms;
    if (name == "median") return Statistic::median;
    if (name == "max") return Statistic::largest;
    if (name == "min") return Statistic::smallest;
    require_that(
        name == "any",
        fmt::format("statistic = '{}'; allowed: auto, mean, rms, median, max, min, any", name));
    return Statistic::any;
  }

  void check(const ClaimRules& rules) const {
    const Expectation& expect = claim_.expect;
    require_that(expect.scale == "linear" || expect.scale == "log10",
                 fmt::format("scale = '{}'; allowed: linear, log10", expect.scale));
    if (rules.paired) {
      require_that(!expect.than.empty() || expect.than_agent || expect.than_metric,
                   "compared with nothing: neither another cell, agent nor metric is named");
      for (const auto& [axis, labels] : expect.than) {
        require_that(!labels.empty(), fmt::format("no label of '{}' to compare with", axis));
      }
      require_that(!expect.than_agent || *expect.than_agent != "each",
                   "an agent is compared with one other, not with \"each\"");
    }
    const std::optional<Statistic>& statistic = rules.statistic;
    const bool averages =
        !statistic || *statistic == Statistic::mean || *statistic == Statistic::rms;
    require_that(!rules.metric.median || !averages,
                 fmt::format("{} is infinite where it never comes, and has no mean; statistic is "
                             "median, max or min",
                             expect.metric));
    if (rules.trend) {
      require_that(!statistic || *statistic == Statistic::mean,
                   "a trend is the mean of its repetitions' slopes; leave statistic out");
    }
    if (expect.kind == Kind::agrees_with) {
      require_that(averages && !rules.over, "agreement is of means or root mean squares");
    }
    require_that(!rules.paired || statistic != Statistic::any,
                 "statistic \"any\" goes with at_most, at_least, within");
    require_that(expect.scale != "log10" || statistic != Statistic::rms,
                 "a root mean square of logarithms has no meaning");
    if (expect.chi2_band) check_band(rules);
    check_quotients(expect);
  }

 private:
  void check_quotients(const Expectation& expect) const {
    const auto quotient = [](const std::string& name) { return !metric_rule(name).over.empty(); };
    require_that(
        !quotient(expect.metric) || (!expect.over && !expect.than_metric),
        fmt::format("{} is a quotient by itself; leave over and than_metric out", expect.metric));
    for (const auto& other : {expect.over, expect.than_metric}) {
      require_that(!other || !quotient(*other),
                   fmt::format("{} is a quotient; it can only be the metric", other.value_or("")));
    }
  }

  void check_band(const ClaimRules& rules) const {
    const Expectation& expect = claim_.expect;
    require_that(expect.kind == Kind::at_most || expect.kind == Kind::at_least ||
                     expect.kind == Kind::within,
                 "\"chi2-band\" goes with at_most, at_least, within");
    require_that(rules.metric.per_dimension,
                 fmt::format("\"chi2-band\" is a band of anees, nees or ledger_nees, not of {}",
                             expect.metric));
    require_that(!expect.over && expect.scale == "linear" &&
                     (!rules.statistic || *rules.statistic == Statistic::mean),
                 "\"chi2-band\" is a band of the mean, without over or scale");
    require_that(expect.agents != "mean" && expect.agents != "max",
                 "agents of one run are not independent: \"chi2-band\" takes each by itself");
  }

  const Study& study_;
  const Claim& claim_;
};

}  // namespace

bool ClaimRules::keeps_infinite() const {
  return !trend && statistic && *statistic != Statistic::mean && *statistic != Statistic::rms;
}

bool ClaimRules::is_rms(const MetricRule& rule) const {
  if (log10 || trend) return false;
  return statistic ? *statistic == Statistic::rms : rule.rms;
}

bool ClaimRules::ratio_within_repetition() const {
  const bool averages = !statistic || *statistic == Statistic::mean || *statistic == Statistic::rms;
  return log10 || trend || !averages;
}

ClaimRules rules_of(const Study& study, const Claim& claim) {
  const Expectation& expect = claim.expect;
  const Checker checker(study, claim);
  ClaimRules rules;
  rules.study = &study;
  rules.claim = &claim;
  rules.metric = metric_rule(expect.metric, expect.chi2_band);
  if (expect.over) rules.over = metric_rule(*expect.over);
  if (!rules.metric.over.empty()) rules.over = metric_rule(rules.metric.over);
  rules.other = metric_rule(expect.than_metric.value_or(expect.metric));
  rules.paired = expect.kind == Kind::less_than || expect.kind == Kind::greater_than ||
                 expect.kind == Kind::agrees_with;
  rules.trend = expect.kind == Kind::grows || expect.kind == Kind::falls_as;
  // An exponent is the slope of logarithms.
  rules.log10 = expect.scale == "log10" || expect.kind == Kind::falls_as;
  rules.statistic = checker.statistic();
  if (!rules.statistic && rules.metric.median && !rules.trend) rules.statistic = Statistic::median;
  checker.check(rules);
  return rules;
}

}  // namespace hearsay::analysis
