// Whole runs under each policy and content: who speaks when, and how many bytes it takes.
#include <gtest/gtest.h>

#include <map>
#include <string>

#include "scenarios/run.hpp"
#include "tests/scenarios/temp_files.hpp"

namespace hearsay {
namespace {

class TalkPolicies : public InTempDirectory {
 protected:
  struct Ended {
    std::map<std::string, double> sums;     // of scalars over agents
    std::map<std::string, double> lasting;  // series of agent 0 at the end
  };

  // Five agents on a ring look every 2 s until 20 s, and may talk every second.
  static Ended run(const std::string& estimator, const std::string& talk,
                   const std::string& radio = "") {
    write("s.toml",
          "duration_s = 60\n[world]\ntargets = [{ position_m = [0, 50] }]\n[radio]\n"
          "topology = \"ring\"\n" +
              radio + R"(
[record]
messages = "all"
series = ["rms_error_m", "claimed_sigma_m", "true_sigma_m", "multiplicity_mean"]
[[agents]]
count = 5
circle = { radius_m = 10 }
sensor = { kind = "position", sigma_along_m = 5, sigma_across_m = 1, period_s = 2, end_s = 20 }
)" + "estimator = { " +
              estimator + " }\ntalk = { period_s = 1, phase = \"staggered\", " + talk + " }\n");
    LogCache logs;
    const Catalog catalog;
    hearsay::Run one(prepare(load_scenario("s.toml", {}, known_names(catalog)), catalog, logs),
                     catalog, {.seed = 3});
    const RunEnd end = one.run();
    EXPECT_TRUE(end.ok()) << end.message;
    Ended ended;
    const Record& record = one.record();
    for (const ScalarRow& row : record.scalars()) {
      if (row.agent >= 0) ended.sums[record.text(row.name)] += row.value;
    }
    for (const SeriesRow& row : record.series()) {
      if (row.agent == 0) ended.lasting[record.text(row.name)] = row.value;
    }
    return ended;
  }
  static inline const std::string ci = "fusion = \"ci-det\"";
};

TEST_F(TalkPolicies, OnUpdateAnAgentSpeaksOnceForEachLook) {
  // Looks at 0, 2, … 20 s: eleven sendings each, of 61 periods.
  EXPECT_EQ(run(ci, "policy = \"on-update\"").sums.at("packets"), 5 * 11);
  EXPECT_EQ(run(ci, "policy = \"periodic\"").sums.at("packets"), 5 * 60 + 1);
  EXPECT_EQ(run(ci, "policy = \"never\"").sums.at("packets"), 0);
}

TEST_F(TalkPolicies, EventTriggeredAgentsFallSilentWhenNothingIsNew) {
  const Ended often = run(ci, "policy = \"event-triggered\", divergence_nats = 0.001");
  const Ended seldom = run(ci, "policy = \"event-triggered\", divergence_nats = 1.0");
  EXPECT_LT(seldom.sums.at("packets"), often.sums.at("packets"));
  EXPECT_LT(often.sums.at("packets"), 5 * 40);
  EXPECT_GE(seldom.sums.at("packets"), 5);
  // Who speaks because of what it measured leaves no exact ledger, but counts.
  EXPECT_NE(often.lasting.at("true_sigma_m"), often.lasting.at("true_sigma_m"));
  EXPECT_GT(often.lasting.at("multiplicity_mean"), 0.0);
  const Ended periodic = run(ci, "policy = \"periodic\"");
  EXPECT_GT(periodic.lasting.at("true_sigma_m"), 0.0);
}

TEST_F(TalkPolicies, AdaptiveAgentsDoNotFloodASlowRadio) {
  // A packet takes 7.6 s of air time: at most eight fit into the run.
  const std::string slow = "rate_bps = 80\nqueue_bytes_max = 1000";
  const Ended periodic = run(ci, "policy = \"periodic\"", slow);
  const Ended adaptive = run(ci, "policy = \"adaptive\"", slow);
  EXPECT_GT(periodic.sums.at("packets_queue_full"), 100);
  EXPECT_EQ(adaptive.sums.at("packets_queue_full"), 0);
  EXPECT_LE(adaptive.sums.at("packets"), 5 * 10);
  EXPECT_GE(adaptive.sums.at("packets"), 5 * 4);
  // On a fast one nothing is different.
  EXPECT_EQ(run(ci, "policy = \"adaptive\"").sums.at("packets"), 5 * 60 + 1);
}

TEST_F(TalkPolicies, SmallerContentsCostLessAndClaimLess) {
  const std::string header = "header_bytes = 0";
  const Ended whole = run(ci, "content = \"belief\"", header);
  const Ended diagonal = run(ci, "content = \"diagonal\"", header);
  const Ended quantised = run(ci, "content = \"quantised\", bits = 8", header);
  const double packets = 5 * 60 + 1;
  EXPECT_EQ(whole.sums.at("bytes_sent"), packets * 76);
  EXPECT_EQ(diagonal.sums.at("bytes_sent"), packets * 68);
  EXPECT_EQ(quantised.sums.at("bytes_sent"), packets * 41);
  EXPECT_GT(diagonal.lasting.at("claimed_sigma_m"), whole.lasting.at("claimed_sigma_m"));
  EXPECT_GT(diagonal.lasting.at("true_sigma_m"), 0.0);
  EXPECT_NE(quantised.lasting.at("true_sigma_m"), quantised.lasting.at("true_sigma_m"));
}

TEST_F(TalkPolicies, AllNewRulesRunAndSayTheirSizes) {
  const std::string header = "header_bytes = 0";
  const double packets = 5 * 60 + 1;
  const std::map<std::string, double> bytes = {{"fusion = \"ci-fixed\", omega = 0.7", 76},
                                               {"fusion = \"ci-batch\"", 76},
                                               {"fusion = \"split-ci\"", 108},
                                               {"fusion = \"consensus-information\"", 76},
                                               {"fusion = \"hybrid-consensus\"", 132}};
  for (const auto& [rule, size] : bytes) {
    const Ended ended = run(rule, "policy = \"periodic\"", header);
    EXPECT_EQ(ended.sums.at("bytes_sent"), packets * size) << rule;
    EXPECT_GT(ended.sums.at("fusions"), 200) << rule;
    EXPECT_EQ(ended.sums.at("messages_refused"), 0) << rule;
    EXPECT_LT(ended.lasting.at("rms_error_m"), 3.0) << rule;
  }
}

TEST_F(TalkPolicies, WhoOnlyListensFusesWhatItHolds) {
  const Ended ended = run("fusion = \"ci-batch\"", "policy = \"never\"");
  EXPECT_EQ(ended.sums.at("packets"), 0);
  EXPECT_EQ(ended.sums.at("fusions"), 0);
}

}  // namespace
}  // namespace hearsay
