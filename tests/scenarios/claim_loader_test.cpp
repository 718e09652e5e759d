#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scenarios/study.hpp"
#include "temp_files.hpp"

namespace hearsay {
namespace {

using ::testing::ElementsAre;
using Kind = Expectation::Kind;

class ClaimLoader : public InTempDirectory {
 protected:
  void SetUp() override {
    InTempDirectory::SetUp();
    write("ring.toml", ring);
  }
  static Study load(const std::string& expect) {
    write(
        "s.toml",
        "scenario = \"ring.toml\"\n[axes]\n"
        "rule = { key = \"agents.estimator.fusion\", values = [\"none\", \"naive\", \"ci-det\"] }\n"
        "loss = { key = \"radio.loss.probability\", values = [0, 0.1] }\n"
        "[[skip]]\nwhen = { rule = \"none\", loss = 0.1 }\n"
        "[[claims]]\ntext = \"t\"\nsource = \"s\"\nexpect = { " +
            expect + " }\n");
    KnownNames names;
    names.metrics = {"nees", "anees", "rms_error_m", "true_sigma_m"};
    return load_study("s.toml", names);
  }
  static Expectation expectation(const std::string& expect) {
    return load(expect).claims.at(0).expect;
  }
  static std::string error(const std::string& expect) {
    return error_of([&] { load(expect); });
  }
};

TEST_F(ClaimLoader, EveryPartOfAnExpectationArrives) {
  const Study study = load(
      "metric = \"rms_error_m\", where = { rule = [\"naive\", \"ci-det\"], loss = 0 }, agents = "
      "\"mean\", at = 20, over = \"true_sigma_m\", statistic = \"rms\", scale = \"log10\", within "
      "= "
      "[-1, 2.5]");
  const Claim& claim = study.claims.at(0);
  EXPECT_EQ(claim.text, "t");
  EXPECT_EQ(claim.source, "s");
  EXPECT_EQ(claim.line, 7);
  const Expectation& e = claim.expect;
  EXPECT_EQ(e.metric, "rms_error_m");
  EXPECT_THAT(e.where.at("rule"), ElementsAre(Value("naive"), Value("ci-det")));
  EXPECT_THAT(e.where.at("loss"), ElementsAre(Value(0.0))) << "as the axis has it";
  EXPECT_EQ(e.agents, "mean");
  EXPECT_EQ(e.at, "20.0");
  EXPECT_EQ(e.over, "true_sigma_m");
  EXPECT_EQ(e.statistic, "rms");
  EXPECT_EQ(e.scale, "log10");
  EXPECT_EQ(e.kind, Kind::within);
  EXPECT_EQ(e.low, -1.0);
  EXPECT_EQ(e.high, 2.5);
  EXPECT_FALSE(e.chi2_band);
}

TEST_F(ClaimLoader, WhatIsLeftOutHasDefaults) {
  const Expectation e = expectation("metric = \"nees\", grows = true");
  EXPECT_EQ(e.kind, Kind::grows);
  EXPECT_TRUE(e.where.empty());
  EXPECT_EQ(e.agents, "each");
  EXPECT_EQ(e.at, "end");
  EXPECT_EQ(e.over, std::nullopt);
  EXPECT_EQ(e.statistic, "auto");
  EXPECT_EQ(e.scale, "linear");
}

TEST_F(ClaimLoader, EachKindHasItsBound) {
  EXPECT_EQ(expectation("metric = \"nees\", at_most = 3").high, 3.0);
  EXPECT_EQ(expectation("metric = \"nees\", at_least = 2").low, 2.0);
  EXPECT_EQ(expectation("metric = \"nees\", at_least = 2").kind, Kind::at_least);
  EXPECT_TRUE(expectation("metric = \"anees\", at_most = \"chi2-band\"").chi2_band);
  EXPECT_TRUE(expectation("metric = \"anees\", within = \"chi2-band\"").chi2_band);
  const Expectation falls = expectation("metric = \"nees\", falls_as = [-0.6, -0.4]");
  EXPECT_EQ(falls.kind, Kind::falls_as);
  EXPECT_EQ(falls.low, -0.6);
  const Expectation less =
      expectation("metric = \"nees\", less_than = { rule = \"none\", agent = \"central\" }");
  EXPECT_EQ(less.kind, Kind::less_than);
  EXPECT_THAT(less.than.at("rule"), ElementsAre(Value("none")));
  EXPECT_EQ(less.than_agent, "central");
  EXPECT_EQ(expectation("metric = \"nees\", greater_than = { metric = \"anees\" }").than_metric,
            "anees");
  const Expectation agrees = expectation("metric = \"anees\", agrees_with = \"nees\"");
  EXPECT_EQ(agrees.kind, Kind::agrees_with);
  EXPECT_EQ(agrees.than_metric, "nees");
}

TEST_F(ClaimLoader, AgentsAreNamedOrNumbered) {
  EXPECT_EQ(expectation("metric = \"nees\", agents = \"estimator2\", at_most = 1").agents,
            "estimator2");
  EXPECT_EQ(expectation("metric = \"nees\", agents = 3, at_most = 1").agents, "estimator3");
  EXPECT_EQ(error("metric = \"nees\", agents = 4, at_most = 1"),
            "s.toml:10: claims[0].expect.agents = 4: there is no such agent");
  EXPECT_EQ(error("metric = \"nees\", agents = \"cenral\", at_most = 1"),
            "s.toml:10: claims[0].expect.agents = \"cenral\": unknown; allowed: each, mean, "
            "central, max, estimator0, estimator1, estimator2, estimator3; did you mean "
            "'central'?");
}

TEST_F(ClaimLoader, SubjectsAreNamed) {
  EXPECT_THAT(expectation("metric = \"nees\", at_most = 1, subjects = [\"0.8\", \"0.9\"]").subjects,
              ElementsAre("0.8", "0.9"));
  EXPECT_EQ(error("metric = \"nees\", at_most = 1, subjects = []"),
            "s.toml:10: claims[0].expect.subjects = []: must have at least one name");
  EXPECT_THAT(error("metric = \"nees\", at_most = 1, subjects = [\"a\", \"a\"]"),
              ::testing::HasSubstr("stands there twice"));
}

TEST_F(ClaimLoader, AnUnknownMetricIsRefused) {
  EXPECT_EQ(
      error("metric = \"aneess\", at_most = 1"),
      "s.toml:10: claims[0].expect.metric = \"aneess\": unknown metric; allowed: nees, anees, "
      "rms_error_m, true_sigma_m; did you mean 'anees'?");
  EXPECT_EQ(error("metric = \"nees\", over = \"x\", at_most = 1"),
            "s.toml:10: claims[0].expect.over = \"x\": unknown metric; allowed: nees, anees, "
            "rms_error_m, true_sigma_m");
  EXPECT_EQ(error("at_most = 1"), "s.toml:10: claims[0].expect.metric: missing");
}

TEST_F(ClaimLoader, CellsAreThoseOfTheStudy) {
  EXPECT_EQ(error("metric = \"nees\", where = { los = 0 }, at_most = 1"),
            "s.toml:10: claims[0].expect.where.los = 0: there is no axis 'los'; did you mean "
            "'loss'?");
  EXPECT_EQ(error("metric = \"nees\", where = { rule = \"ci-dett\" }, at_most = 1"),
            "s.toml:10: claims[0].expect.where.rule = \"ci-dett\": not on axis 'rule'; allowed: "
            "none, naive, ci-det; did you mean 'ci-det'?");
  EXPECT_EQ(error("metric = \"nees\", where = { rule = \"none\", loss = 0.1 }, at_most = 1"),
            "s.toml:10: claims[0].expect.where = { rule = \"none\", loss = 0.1 }: all of these "
            "cells are skipped");
  EXPECT_EQ(
      error("metric = \"nees\", less_than = { rule = [\"none\", \"naive\"] }"),
      "s.toml:10: claims[0].expect.less_than.rule = [\"none\", \"naive\"]: must be one value");
  EXPECT_EQ(
      error("metric = \"nees\", less_than = {}"),
      "s.toml:10: claims[0].expect.less_than = {}: names nothing; give axis = value, agent or "
      "metric");
  EXPECT_EQ(error("metric = \"nees\", less_than = 3"),
            "s.toml:10: claims[0].expect.less_than = 3: expected a table that names the other "
            "cell, agent or metric, found an integer");
}

TEST_F(ClaimLoader, AClaimExpectsExactlyOneThing) {
  EXPECT_EQ(error("metric = \"nees\""),
            "s.toml:10: claims[0].expect: expects nothing; give one of at_most, at_least, within, "
            "less_than, greater_than, grows, falls_as, agrees_with");
  EXPECT_EQ(error("metric = \"nees\", at_most = 1, grows = true"),
            "s.toml:10: claims[0].expect: has both at_most and grows; a claim expects one thing");
}

TEST_F(ClaimLoader, BoundsHaveTheirForm) {
  EXPECT_EQ(error("metric = \"nees\", within = [2, 1]"),
            "s.toml:10: claims[0].expect.within = [2, 1]: low must not be above high");
  EXPECT_EQ(error("metric = \"nees\", within = [2]"),
            "s.toml:10: claims[0].expect.within = [2]: must be [low, high]");
  EXPECT_EQ(error("metric = \"nees\", within = 2"),
            "s.toml:10: claims[0].expect.within = 2: expected [low, high], found an integer");
  EXPECT_EQ(error("metric = \"nees\", at_most = \"chi2\""),
            "s.toml:10: claims[0].expect.at_most = \"chi2\": expected a number or \"chi2-band\"");
  EXPECT_EQ(error("metric = \"nees\", grows = false"),
            "s.toml:10: claims[0].expect.grows = false: must be true");
  EXPECT_EQ(error("metric = \"nees\", at = \"start\", at_most = 1"),
            "s.toml:10: claims[0].expect.at = \"start\": unknown; allowed: end, all");
  EXPECT_EQ(error("metric = \"nees\", at = true, at_most = 1"),
            "s.toml:10: claims[0].expect.at = true: expected \"end\", \"all\" or seconds, found a "
            "boolean");
  EXPECT_EQ(error("metric = \"nees\", statistic = \"meen\", at_most = 1"),
            "s.toml:10: claims[0].expect.statistic = \"meen\": unknown; allowed: auto, mean, rms, "
            "median, max, min, any; did you mean 'mean'?");
  EXPECT_EQ(error("metric = \"nees\", at_mst = 1"),
            "s.toml:10: unknown key 'at_mst' in [claims[0].expect]; did you mean 'at_most'?");
}

}  // namespace
}  // namespace hearsay
