// Bounds, trends and statistics: each in all verdicts.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "sim/kernel/error.hpp"
#include "tests/tools/analysis/bed.hpp"

namespace hearsay::analysis {
namespace {

using Kind = Expectation::Kind;
using testing::HasSubstr;

/// Twenty repetitions whose "length" is 9 and 11 by turns: mean 10, t interval [9.520, 10.480].
struct Lengths : Bed {
  Lengths() : Bed(20, 1) {
    fill([](const Asked& asked, Rows& rows) {
      const double length = asked.repetition % 2 == 0 ? 11.0 : 9.0;
      rows.scalar(0, "length", length);
      rows.scalar(0, "signed", length - 10.0);
      for (const double t_s : {0.0, 10.0, 20.0}) rows.series(t_s, 0, "longer", length + t_s);
      return Outcome::finished;
    });
  }
};

TEST(Claims, ABoundFromAboveIsKeptBrokenOrOpen) {
  Lengths bed;
  EXPECT_EQ(bed.verdict(at_most("length", 11.0)), Verdict::reproduced);
  EXPECT_EQ(bed.verdict(at_most("length", 9.0)), Verdict::not_reproduced);
  EXPECT_EQ(bed.verdict(at_most("length", 10.2)), Verdict::undecided);
}

TEST(Claims, ABoundFromBelowIsKeptBrokenOrOpen) {
  Lengths bed;
  EXPECT_EQ(bed.verdict(at_least("length", 9.0)), Verdict::reproduced);
  EXPECT_EQ(bed.verdict(at_least("length", 11.0)), Verdict::not_reproduced);
  EXPECT_EQ(bed.verdict(at_least("length", 9.8)), Verdict::undecided);
}

TEST(Claims, ARangeHoldsBreaksOrStaysOpen) {
  Lengths bed;
  EXPECT_EQ(bed.verdict(within("length", 9.0, 11.0)), Verdict::reproduced);
  EXPECT_EQ(bed.verdict(within("length", 11.0, 12.0)), Verdict::not_reproduced);
  EXPECT_EQ(bed.verdict(within("length", 9.8, 12.0)), Verdict::undecided);
}

TEST(Claims, TheResultCarriesWhatDecidedIt) {
  Lengths bed;
  const ClaimResult result = bed.judge(at_most("signed", 1.0));
  EXPECT_EQ(result.claim.text, "a made-up claim");
  EXPECT_EQ(result.quantity, "mean of signed");
  EXPECT_EQ(result.comparisons, 1u);
  EXPECT_EQ(result.repetitions, 20);
  EXPECT_EQ(result.bound_high, 1.0);
  EXPECT_EQ(result.worst_where, "agent=0");
  // Standard error √(20/19)/√20, t(19, 97.5 %) = 2.093024.
  EXPECT_NEAR(result.worst.estimate, 0.0, 1e-12);
  EXPECT_NEAR(result.worst.high, 2.093024 / std::sqrt(19.0), 1e-6);
  EXPECT_EQ(result.note, "");
}

TEST(Claims, TheExtremesAreExactStatements) {
  Lengths bed;
  Expectation expect = at_most("length", 11.0);
  expect.statistic = "max";
  EXPECT_EQ(bed.verdict(expect), Verdict::reproduced);
  EXPECT_EQ(bed.judge(expect).worst.low, 11.0);
  expect.high = 10.999;
  EXPECT_EQ(bed.verdict(expect), Verdict::not_reproduced);
  expect.statistic = "min";
  EXPECT_EQ(bed.verdict(expect), Verdict::reproduced);
}

TEST(Claims, AnyCountsRepetitionsWithAValueAboveZero) {
  Lengths bed;
  Expectation expect = at_least("signed", 0.25);
  expect.statistic = "any";
  const ClaimResult result = bed.judge(expect);
  EXPECT_EQ(result.verdict, Verdict::reproduced);
  EXPECT_EQ(result.worst.estimate, 0.5);
  EXPECT_NEAR(result.worst.low, 0.299298, 1e-6);  // Wilson for 10 of 20
  expect.low = 0.4;
  EXPECT_EQ(bed.verdict(expect), Verdict::undecided);
  expect.low = 0.8;
  EXPECT_EQ(bed.verdict(expect), Verdict::not_reproduced);
}

TEST(Claims, LogarithmsAreTakenOfEachRepetition) {
  Lengths bed;
  Expectation expect = within("length", 0.9, 1.1);
  expect.scale = "log10";
  const ClaimResult result = bed.judge(expect);
  EXPECT_EQ(result.verdict, Verdict::reproduced);
  EXPECT_NEAR(result.worst.estimate, 0.5 * std::log10(99.0), 1e-12);
  expect.metric = "signed";  // −1 has no logarithm
  EXPECT_EQ(bed.judge(expect).missing_values, 10u);
}

TEST(Claims, LogarithmsOfRootMeanSquaresAreAveraged) {
  Bed bed(4, 1);
  bed.fill([](const Asked& asked, Rows& rows) {
    rows.series(1.0, 0, "rms_error_m", asked.repetition % 2 == 0 ? 0.1 : 10.0);
    return Outcome::finished;
  });
  Expectation expect = within("rms_error_m", -5.0, 5.0);
  expect.scale = "log10";
  EXPECT_NEAR(bed.judge(expect).worst.estimate, 0.0, 1e-12);
  EXPECT_EQ(bed.judge(expect).quantity, "mean of log10 rms_error_m");
}

TEST(Claims, InstantsComeInOrderOfTimeWhateverRunHasThemFirst) {
  Bed bed(2, 1);
  bed.axis("period_s", {Value(4.0), Value(3.0)});
  bed.fill([](const Asked& asked, Rows& rows) {
    const double period_s = asked.labels.at("period_s") == "4" ? 4.0 : 3.0;
    for (double t_s = period_s; t_s <= 12.0; t_s += period_s) rows.series(t_s, 0, "age", t_s);
    return Outcome::finished;
  });
  Expectation expect = within("age", 12.0, 12.0);
  EXPECT_EQ(bed.verdict(expect), Verdict::reproduced);  // the last instant of each
  EXPECT_EQ(bed.judge(expect).comparisons, 2u);
  expect.at = "all";
  expect.low = 3.0;
  EXPECT_EQ(bed.judge(expect).comparisons, 7u);
  EXPECT_NEAR(bed.judge(within("age", 0.9, 1.1, Kind::falls_as)).worst.estimate, 1.0, 1e-9);
  expect.where["period_s"] = {Value(std::int64_t{3})};
  expect.at = "9";
  EXPECT_EQ(bed.judge(expect).worst.estimate, 9.0);
}

TEST(Claims, OneOfSeveralInstantsCanBeMeant) {
  Lengths bed;
  EXPECT_EQ(bed.judge(at_most("longer", 40.0)).worst.estimate, 30.0);
  EXPECT_EQ(bed.judge(at_most("longer", 40.0)).worst_where, "agent=0 t=20 s");
  Expectation expect = at_most("longer", 40.0);
  expect.at = "10";
  EXPECT_EQ(bed.judge(expect).worst.estimate, 20.0);
  expect.at = "all";
  EXPECT_EQ(bed.judge(expect).comparisons, 3u);
  EXPECT_EQ(bed.judge(expect).worst_where, "agent=0 t=20 s");
  expect.at = "15";
  EXPECT_THROW(bed.judge(expect), InputError);
}

TEST(Claims, MoreComparisonsWidenEachInterval) {
  Lengths bed;
  Expectation expect = at_most("longer", 30.6);
  EXPECT_EQ(bed.verdict(expect), Verdict::reproduced);  // t(19) = 2.09: 30.48
  expect.at = "all";
  EXPECT_EQ(bed.verdict(expect), Verdict::undecided);  // t(19) = 2.63: 30.604
}

/// A quantity that follows c·t^p with a factor of its own in each repetition.
struct Power : Bed {
  explicit Power(double p) : Bed(30, 1) {
    fill([p](const Asked& asked, Rows& rows) {
      Stream stream = draws(asked.repetition, 0);
      for (const double t_s : {0.0, 1.0, 2.0, 4.0, 8.0}) {
        const double noise = 1.0 + 0.02 * stream.normal();
        rows.series(t_s, 0, "size", t_s == 0.0 ? null : 3.0 * std::pow(t_s, p) * noise);
      }
      return Outcome::finished;
    });
  }
};

TEST(Claims, AnExponentIsTheSlopeOfLogarithms) {
  Power bed(-0.5);
  const ClaimResult result = bed.judge(within("size", -0.55, -0.45, Kind::falls_as));
  EXPECT_EQ(result.verdict, Verdict::reproduced);
  EXPECT_NEAR(result.worst.estimate, -0.5, 0.01);
  EXPECT_EQ(bed.verdict(within("size", -1.1, -0.9, Kind::falls_as)), Verdict::not_reproduced);
  EXPECT_EQ(bed.verdict(within("size", -0.5, -0.4, Kind::falls_as)), Verdict::undecided);
}

TEST(Claims, GrowthIsASlopeAboveZero) {
  EXPECT_EQ(Power(0.5).verdict(expects("size", Kind::grows)), Verdict::reproduced);
  EXPECT_EQ(Power(-0.5).verdict(expects("size", Kind::grows)), Verdict::not_reproduced);
  EXPECT_EQ(Power(0.0).verdict(expects("size", Kind::grows)), Verdict::undecided);
  Expectation expect = expects("size", Kind::grows);
  expect.scale = "log10";
  EXPECT_EQ(Power(1.0).verdict(expect), Verdict::reproduced);
}

/// Agents 0 and 1 with values 3 and 4, the central one with 1, in two subjects.
struct Agents : Bed {
  Agents() : Bed(5, 2) {
    fill([](const Asked&, Rows& rows) {
      const double value[] = {1.0, 3.0, 4.0};
      for (AgentId agent = -1; agent < 2; ++agent) {
        rows.scalar(agent, "weight", value[agent + 1]);
        for (const char* subject : {"near", "far"}) {
          const double factor = std::string(subject) == "far" ? 7.0 : 1.0;
          rows.series(5.0, agent, "rms_error_m", factor * value[agent + 1], subject);
          rows.series(5.0, agent, "reach_gap", factor * value[agent + 1], subject);
        }
      }
      return Outcome::finished;
    });
  }
  double estimate(const std::string& metric, const std::string& agents) {
    Expectation expect = at_most(metric, 1e6);
    expect.agents = agents;
    return judge(expect).worst.estimate;
  }
};

TEST(Claims, AgentsAreMeantOneByOneTogetherOrByName) {
  Agents bed;
  Expectation each = at_most("weight", 5.0);
  EXPECT_EQ(bed.judge(each).comparisons, 2u);
  EXPECT_EQ(bed.judge(each).worst_where, "agent=1");
  EXPECT_NEAR(bed.estimate("weight", "mean"), 3.5, 1e-12);
  EXPECT_NEAR(bed.estimate("weight", "max"), 4.0, 1e-12);
  EXPECT_NEAR(bed.estimate("weight", "central"), 1.0, 1e-12);
  EXPECT_NEAR(bed.estimate("weight", "1"), 4.0, 1e-12);
  EXPECT_NEAR(bed.estimate("weight", "a0"), 3.0, 1e-12);
  EXPECT_THROW(bed.estimate("weight", "a7"), InputError);
}

TEST(Claims, RootMeanSquaresStaySoOverAgentsAndSubjects) {
  Agents bed;
  EXPECT_NEAR(bed.estimate("rms_error_m", "a0"), 3.0 * 5.0, 1e-12);  // √((1 + 49)/2) = 5
  EXPECT_NEAR(bed.estimate("rms_error_m", "mean"), 5.0 * std::sqrt(12.5), 1e-12);
  EXPECT_NEAR(bed.estimate("reach_gap", "mean"), 4.0 * 3.5, 1e-12);
  EXPECT_THAT(bed.judge(at_most("reach_gap", 1e6)).note, HasSubstr("subjects averaged"));
}

TEST(Claims, NamedSubjectsAreComparedEachForItself) {
  Agents bed;
  Expectation far = at_most("reach_gap", 30.0);
  far.subjects = {"far"};
  EXPECT_EQ(bed.judge(far).comparisons, 2u) << "two agents";
  EXPECT_NEAR(bed.judge(far).worst.estimate, 7.0 * 4.0, 1e-12);
  EXPECT_THAT(bed.judge(far).worst_where, HasSubstr("far"));
  far.subjects = {"near", "far"};
  EXPECT_EQ(bed.judge(far).comparisons, 4u);
  EXPECT_NEAR(bed.judge(far).worst.estimate, 7.0 * 4.0, 1e-12);
  far.subjects = {"fare"};
  EXPECT_THROW(bed.judge(far), InputError);
}

TEST(Claims, OverDividesTheAggregates) {
  Lengths bed;
  Expectation expect = within("longer", 2.9, 3.1);
  expect.over = "length";
  const ClaimResult result = bed.judge(expect);
  EXPECT_EQ(result.verdict, Verdict::reproduced);
  EXPECT_NEAR(result.worst.estimate, 3.0, 1e-12);
  expect.statistic = "max";  // of each repetition's ratio: 29/9
  EXPECT_NEAR(bed.judge(expect).worst.estimate, 29.0 / 9.0, 1e-12);
}

TEST(Claims, WhatHasNoMeaningIsRefusedWithItsLine) {
  Lengths bed;
  bed.study.file = "a.study.toml";
  const auto refused = [&](const Expectation& expect, const std::string& part) {
    try {
      bed.judge(expect);
      ADD_FAILURE() << "not refused: " << part;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("a.study.toml:7: "));
      EXPECT_THAT(error.what(), HasSubstr(part));
    }
  };
  Expectation expect = at_most("length", 1.0);
  expect.where["rul"] = {Value(std::string("naive"))};
  refused(expect, "no axis 'rul'");
  expect = at_most("length", 1.0);
  expect.statistic = "mode";
  refused(expect, "mode");
  expect = at_most("agree_again_s", 1.0);
  expect.statistic = "mean";
  refused(expect, "agree_again_s is infinite where it never comes");
  refused(expects("length", Kind::less_than), "compared with nothing");
  refused(banded("length", Kind::within), "not of length");
  expect = banded("anees", Kind::within);
  expect.agents = "mean";
  refused(expect, "not independent");
}

}  // namespace
}  // namespace hearsay::analysis
