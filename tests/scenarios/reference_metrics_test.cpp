// What a run says of itself against its references: the central filter, the agent alone, and the
// next measurement. Each against values that are worked out from other recorded ones, or from χ².
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "scenarios/run.hpp"
#include "tests/scenarios/temp_files.hpp"

namespace hearsay {
namespace {

using Values = std::map<std::string, std::vector<double>>;  // a scalar has one value

constexpr double sigma_m = 3.0;  // of the position sensors

// Two agents look at two targets at 0, 2 … 40 s, when the run is sampled, and speak every 4 s.
const std::string still = R"(duration_s = 40
[world]
targets = [{ name = "a", position_m = [5, -3] }, { name = "b", position_m = [-20, 8] }]
[radio]
topology = "full"
[record]
series = ["x_m", "y_m", "nees", "claimed_sigma_m", "hellinger_to_central"]
series_period_s = 2
[[agents]]
count = 2
position_m = [0, 0]
sensor = { kind = "position", period_s = 2, sigma_m = 3 }
estimator = { fusion = "RULE" }
talk = { period_s = 4 }
)";
const std::string moving = R"(duration_s = 40
[world]
step_s = 1
[[world.targets]]
name = "a"
position_m = [5, -3]
[world.targets.motion]
kind = "white-noise-acceleration"
velocity_m_per_s = [2, 1]
acceleration_psd_m2_per_s3 = 0.4
[radio]
topology = "full"
[record]
series = ["x_m", "y_m", "nees"]
series_period_s = 4
[[agents]]
count = 2
position_m = [0, 0]
sensor = { kind = "position", period_s = 2, sigma_m = 3 }
estimator = { kind = "KIND", fusion = "RULE", acceleration_psd_m2_per_s3 = 0.4 }
talk = { period_s = 4 }
)";

std::string with(std::string text, const std::string& what, const std::string& value) {
  return text.replace(text.find(what), what.size(), value);
}

class ReferenceMetrics : public InTempDirectory {
 protected:
  std::shared_ptr<const PreparedScenario> prepared(const std::string& text) {
    write("s.toml", text);
    return prepare(load_scenario("s.toml", {}, known_names(catalog_)), catalog_, logs_);
  }
  /// Scalars by name, series by "name of subject", of an agent.
  Values run(const std::shared_ptr<const PreparedScenario>& what, std::uint64_t seed,
             AgentId agent) {
    hearsay::Run one(what, catalog_, {.seed = seed});
    const RunEnd end = one.run();
    EXPECT_TRUE(end.ok()) << end.message;
    Values values;
    const Record& record = one.record();
    for (const ScalarRow& row : record.scalars()) {
      if (row.agent == agent) values[std::string(record.text(row.name))].push_back(row.value);
    }
    for (const SeriesRow& row : record.series()) {
      if (row.agent != agent) continue;
      const std::string of = std::string(record.text(row.subject));
      values[std::string(record.text(row.name)) + " of " + of].push_back(row.value);
    }
    return values;
  }
  Values run(const std::string& text, std::uint64_t seed, AgentId agent) {
    return run(prepared(text), seed, agent);
  }

 private:
  Catalog catalog_;
  LogCache logs_;
};

std::string still_with(const std::string& rule) { return with(still, "RULE", rule); }

// After k looks of one who hears nobody the estimate is their mean, so the k-th was
// z = k·x_k − (k − 1)·x_{k−1}, expected with variance σ²(1 + 1/(k − 1)) an axis.
TEST_F(ReferenceMetrics, NisOfWhoHearsNobodyFollowsFromItsEstimates) {
  const Values values = run(still_with("none"), 3, 1);
  double sum = 0.0;
  int count = 0;
  for (const char* target : {" of a", " of b"}) {
    for (const char* axis : {"x_m", "y_m"}) {
      const std::vector<double>& x = values.at(axis + std::string(target));
      ASSERT_EQ(x.size(), 21u);
      for (std::size_t i = 1; i < x.size(); ++i) {
        const double before = static_cast<double>(i), v = (before + 1.0) * (x[i] - x[i - 1]);
        sum += v * v / (sigma_m * sigma_m * (1.0 + 1.0 / before));
        ++count;
      }
    }
  }
  EXPECT_NEAR(values.at("nis_mean")[0], sum / count, 1e-9);
}

// Mean of N values of χ² with n degrees of freedom each, over n: outside 1 ± 3.3 √(2/(nN)) once in
// a thousand times, somewhat more often above (n N ≥ 400 here).
void expect_consistent(double mean_over_n, double degrees) {
  EXPECT_NEAR(mean_over_n, 1.0, 3.4 * std::sqrt(2.0 / degrees));
}

TEST_F(ReferenceMetrics, TheCentralFilterIsConsistentAndSoAreAgentsAloneAtAllTimes) {
  constexpr int runs = 200;
  const std::string moves = with(with(moving, "KIND", "moving-gaussian"), "RULE", "none");
  for (const auto& [text, n] : {std::pair{still_with("none"), 2}, std::pair{moves, 4}}) {
    const auto what = prepared(text);
    for (const AgentId agent : {central_agent, AgentId(1)}) {
      std::vector<double> sums;
      double nis = 0.0;
      for (int r = 0; r < runs; ++r) {
        const Values values = run(what, 1000 + static_cast<std::uint64_t>(r), agent);
        const std::vector<double>& nees = values.at("nees of a");
        sums.resize(nees.size());
        for (std::size_t i = 0; i < nees.size(); ++i) sums[i] += nees[i];
        if (agent >= 0) nis += values.at("nis_mean")[0];
      }
      for (std::size_t i = 1; i < sums.size(); ++i) {  // after one look velocity is not known
        SCOPED_TRACE(i);
        expect_consistent(sums[i] / (n * runs), n * runs);
      }
      // Of innovations, which are independent: 20 or 40 of 2 numbers a run, the first left out.
      if (agent >= 0) expect_consistent(nis / runs, 2 * 18 * runs);
    }
  }
}

// Both know the position to Σ = s²I: ∫√(pq) = Π (2 s_p s_q/(s_p² + s_q²))^½ · exp(−|d|²/(4(s_p² +
// s_q²))) over two axes.
TEST_F(ReferenceMetrics, HellingerDistanceIsThatOfTheRecordedMeansAndSigmas) {
  for (const char* rule : {"none", "naive", "ci-half"}) {
    const Values local = run(still_with(rule), 3, 0);
    const Values central = run(still_with(rule), 3, central_agent);
    for (const std::string target : {" of a", " of b"}) {
      for (std::size_t i = 0; i < 21; ++i) {
        const double dx = local.at("x_m" + target)[i] - central.at("x_m" + target)[i];
        const double dy = local.at("y_m" + target)[i] - central.at("y_m" + target)[i];
        const double p = central.at("claimed_sigma_m" + target)[i];
        const double q = local.at("claimed_sigma_m" + target)[i];
        const double sum = p * p + q * q;
        const double overlap = 2.0 * p * q / sum * std::exp(-(dx * dx + dy * dy) / (4.0 * sum));
        EXPECT_NEAR(local.at("hellinger_to_central" + target)[i], std::sqrt(1.0 - overlap), 1e-7);
        EXPECT_NEAR(central.at("hellinger_to_central" + target)[i], 0.0, 1e-12);
      }
    }
  }
}

// Measurements are the same under every rule: what an agent would believe that heard nobody is what
// it believes in the run in which nobody speaks.
TEST_F(ReferenceMetrics, WhatHearsaySavesIsTheDifferenceFromTheRunWithoutAny) {
  const auto of_kind = [](const std::string& kind, const std::string& rule) {
    return with(with(moving, "KIND", kind), "RULE", rule);
  };
  const std::string forgets =
      "[[dropouts]]\nagents = [1]\nkind = \"reboot\"\nfrom_s = 13\nuntil_s = 17\n";
  const std::vector<std::pair<std::string, std::string>> pairs = {
      {still_with("none"), still_with("naive")},
      {still_with("none"), still_with("ci-det")},
      {still_with("none") + forgets, still_with("ci-det") + forgets},
      {of_kind("moving-gaussian", "none"), of_kind("moving-gaussian", "ci-det")},
      {of_kind("moving-gaussian", "none"), of_kind("trajectory-gaussian", "naive")},
  };
  for (const auto& [without, rule] : pairs) {
    const Values alone = run(without, 3, 1), heard = run(rule, 3, 1);
    const double saved = alone.at("distance_error_m")[0] - heard.at("distance_error_m")[0];
    EXPECT_NE(saved, 0.0);
    EXPECT_NEAR(heard.at("distance_saved_m")[0], saved, 1e-8);
    EXPECT_NEAR(alone.at("distance_saved_m")[0], 0.0, 1e-9);
  }
}

TEST_F(ReferenceMetrics, WhoNeverLooksHasNothingToCompareWith) {
  std::string text = still_with("naive");
  text +=
      "[[agents]]\nposition_m = [1, 1]\nestimator = { fusion = \"naive\" }\n"
      "sensor = { kind = \"position\", period_s = 2, sigma_m = 3, start_s = 100 }\n"
      "talk = { period_s = 4 }\n";
  const Values values = run(text, 3, 2);
  EXPECT_TRUE(std::isfinite(values.at("distance_error_m")[0]));
  EXPECT_TRUE(std::isnan(values.at("distance_saved_m")[0]));
  EXPECT_TRUE(std::isnan(values.at("nis_mean")[0]));
}

}  // namespace
}  // namespace hearsay
