// Rules and talk that lack something, or have something without effect, are refused with file,
// line, key and what is allowed.
#include <gtest/gtest.h>

#include <string>

#include "tests/scenarios/rule_names.hpp"
#include "tests/scenarios/temp_files.hpp"

namespace hearsay {
namespace {

class EstimatorChecks : public InTempDirectory {
 protected:
  // The line with the estimator is 6.
  static std::string error(const std::string& estimator, const std::string& talk = "") {
    write("s.toml",
          "duration_s = 10\nworld = { targets = [{ position_m = [0, 50] }] }\n"
          "[[agents]]\ncount = 4\nsensor = { kind = \"position\", sigma_m = 5 }\n" +
              estimator + "\n" + talk + "\n");
    return error_of([] { load_scenario("s.toml", {}, {}); });
  }
};

TEST_F(EstimatorChecks, AFixedWeightIsGivenWithItsRuleAlone) {
  EXPECT_EQ(error("estimator = { fusion = \"ci-fixed\", omega = 0.7 }"), "no error");
  EXPECT_EQ(error("estimator = { fusion = \"ci-fixed\", omega = 1 }"), "no error");
  EXPECT_EQ(error("estimator = { fusion = \"ci-fixed\" }"),
            "s.toml:6: agents[0].estimator.omega: missing; fusion \"ci-fixed\" needs the weight of "
            "the own belief");
  EXPECT_EQ(
      error("estimator = { fusion = \"ci-det\", omega = 0.7 }"),
      "s.toml:6: agents[0].estimator.omega: without effect under fusion \"ci-det\"; only with "
      "\"ci-fixed\"");
  EXPECT_EQ(error("estimator = { fusion = \"ci-fixed\", omega = 0.0 }"),
            "s.toml:6: agents[0].estimator.omega = 0.0: must be greater than 0");
  EXPECT_EQ(error("estimator = { fusion = \"ci-fixed\", omega = 1.5 }"),
            "s.toml:6: agents[0].estimator.omega = 1.5: must be at most 1");
}

TEST_F(EstimatorChecks, ACorrectionIsOfHybridConsensusAlone) {
  EXPECT_EQ(error("estimator = { fusion = \"hybrid-consensus\", correction = \"one\" }"),
            "no error");
  EXPECT_EQ(error("estimator = { fusion = \"hybrid-consensus\" }"), "no error");
  EXPECT_EQ(error("estimator = { fusion = \"naive\", correction = \"one\" }"),
            "s.toml:6: agents[0].estimator.correction: without effect under fusion \"naive\"; only "
            "with \"hybrid-consensus\"");
  EXPECT_EQ(error("estimator = { fusion = \"hybrid-consensus\", correction = \"two\" }"),
            "s.toml:6: agents[0].estimator.correction = \"two\": unknown; allowed: nodes, one");
}

TEST_F(EstimatorChecks, AThresholdIsGivenWithItsPolicyAlone) {
  const std::string ci = "estimator = { fusion = \"ci-det\" }";
  EXPECT_EQ(error(ci, "talk = { policy = \"event-triggered\", divergence_nats = 0.1 }"),
            "no error");
  EXPECT_EQ(
      error(ci, "talk = { policy = \"event-triggered\" }"),
      "s.toml:7: agents[0].talk.divergence_nats: missing; policy \"event-triggered\" needs to "
      "know how much news is worth a message");
  EXPECT_EQ(error(ci, "talk = { policy = \"on-update\", divergence_nats = 0.1 }"),
            "s.toml:7: agents[0].talk.divergence_nats: without effect under policy \"on-update\"; "
            "only with \"event-triggered\"");
  EXPECT_EQ(error(ci, "talk = { policy = \"event-triggered\", divergence_nats = 0 }"),
            "s.toml:7: agents[0].talk.divergence_nats = 0: must be greater than 0");
}

TEST_F(EstimatorChecks, AContentGoesWithRulesThatDoNotBookWhatWasSaid) {
  const std::string ci = "estimator = { fusion = \"ci-det\" }";
  EXPECT_EQ(error(ci, "talk = { content = \"diagonal\" }"), "no error");
  EXPECT_EQ(error(ci, "talk = { content = \"quantised\", bits = 6 }"), "no error");
  EXPECT_EQ(error("estimator = { fusion = \"none\" }", "talk = { content = \"diagonal\" }"),
            "no error");
  EXPECT_EQ(error(ci, "talk = { content = \"diagonal\", bits = 6 }"),
            "s.toml:7: agents[0].talk.bits: without effect with content \"diagonal\"; only with "
            "\"quantised\"");
  EXPECT_EQ(error(ci, "talk = { content = \"quantised\", bits = 3 }"),
            "s.toml:7: agents[0].talk.bits = 3: must be between 4 and 16");
  EXPECT_EQ(error("estimator = { fusion = \"channel\" }", "talk = { content = \"diagonal\" }"),
            "s.toml:7: agents[0].talk.content: \"diagonal\" does not go with fusion \"channel\", "
            "which counts on what exactly was said; allowed: " +
                rules_but({"none", "local-update", "channel", "channel-robust", "split-ci",
                           "consensus-information", "hybrid-consensus"}));
}

TEST_F(EstimatorChecks, AgentsUnderstandOneAnother) {
  const std::string ci = "estimator = { fusion = \"ci-det\" }";
  const std::string other = "[[agents]]\nestimator = { fusion = ";
  EXPECT_EQ(error(ci, other + "\"naive\" }"), "no error");
  EXPECT_EQ(error(ci, other + "\"none\" }"), "no error");
  EXPECT_EQ(error(ci, other + "\"split-ci\" }"),
            "s.toml:8: agents[1].estimator.fusion: \"split-ci\" and \"ci-det\" of agents[0] do not "
            "understand each other: one of them sends more than beliefs");
  EXPECT_EQ(error(ci, other + "\"ci-det\" }\ntalk = { content = \"diagonal\" }"),
            "s.toml:9: agents[1].talk.content: \"diagonal\" and \"belief\" of agents[0] do not "
            "understand each other: give all agents the same content");
}

}  // namespace
}  // namespace hearsay
