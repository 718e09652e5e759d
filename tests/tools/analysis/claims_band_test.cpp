// The χ² band, and agreement with a prediction.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/tools/analysis/bed.hpp"

namespace hearsay::analysis {
namespace {

using Kind = Expectation::Kind;
using testing::HasSubstr;

/// Two agents, 100 repetitions, three instants: NEES of a two-dimensional error whose covariance is
/// `excess` times what is claimed, and a prediction of it.
struct Consistency : Bed {
  explicit Consistency(double excess) : Bed(100, 2) {
    fill([excess](const Asked& asked, Rows& rows) {
      for (AgentId agent = 0; agent < 2; ++agent) {
        Stream stream = draws(asked.repetition, agent);
        rows.series(0.0, agent, "nees", null);
        for (const double t_s : {10.0, 20.0, 30.0}) {
          const double x = stream.normal();
          const double y = stream.normal();
          rows.series(t_s, agent, "nees", excess * (x * x + y * y));
          rows.series(t_s, agent, "ledger_nees", x * x + y * y);
          rows.series(t_s, agent, "ledger_anees", excess);
          rows.series(t_s, agent, "too_low", 0.7 * excess);
          rows.series(t_s, agent, "rms_error_m", std::sqrt(excess * (x * x + y * y) / 2.0));
          rows.series(t_s, agent, "true_sigma_m", std::sqrt(excess));
          rows.series(t_s, agent, "claimed_sigma_m", 1.0);
        }
      }
      return Outcome::finished;
    });
  }
};

Expectation everywhere(Expectation expect) {
  expect.at = "all";
  return expect;
}

TEST(ChiSquaredBand, AConsistentBeliefLiesInsideAtAllInstants) {
  Consistency bed(1.0);
  const ClaimResult result = bed.judge(everywhere(banded("anees", Kind::within)));
  EXPECT_EQ(result.verdict, Verdict::reproduced);
  EXPECT_EQ(result.comparisons, 6u);  // not those at 0 s, where there is no NEES yet
  EXPECT_THAT(result.note, HasSubstr("instants left out before the first value: 2"));
  EXPECT_EQ(result.missing_values, 0u);
  EXPECT_EQ(result.repetitions, 100);
  EXPECT_EQ(result.bound_high, anees_band(2, 100, 0.05, 6).high);
  EXPECT_EQ(bed.verdict(banded("anees", Kind::at_most)), Verdict::reproduced);
  EXPECT_EQ(bed.verdict(banded("anees", Kind::at_least)), Verdict::not_reproduced);
}

TEST(ChiSquaredBand, AnOverconfidentBeliefLiesAbove) {
  Consistency bed(3.0);
  const ClaimResult result = bed.judge(banded("anees", Kind::at_least));
  EXPECT_EQ(result.verdict, Verdict::reproduced);
  EXPECT_NEAR(result.worst.estimate, 3.0, 0.9);
  EXPECT_EQ(bed.verdict(banded("anees", Kind::within)), Verdict::not_reproduced);
  EXPECT_EQ(bed.verdict(banded("anees", Kind::at_most)), Verdict::not_reproduced);
}

TEST(ChiSquaredBand, ATimidBeliefIsNotAboveTheBandButNotWithinItEither) {
  Consistency bed(0.4);
  EXPECT_EQ(bed.verdict(banded("anees", Kind::at_most)), Verdict::reproduced);
  EXPECT_EQ(bed.verdict(banded("anees", Kind::within)), Verdict::not_reproduced);
  EXPECT_EQ(bed.verdict(banded("anees", Kind::at_least)), Verdict::not_reproduced);
}

TEST(ChiSquaredBand, ASlightExcessLeavesOverconfidenceUndecided) {
  Consistency bed(1.2);
  const ClaimResult result = bed.judge(banded("anees", Kind::at_least));
  EXPECT_EQ(result.verdict, Verdict::undecided);
  EXPECT_GT(result.open, 0u);
}

TEST(ChiSquaredBand, NeesIsDividedByTheDimensionAndPlainNeesIsNot) {
  Consistency bed(1.0);
  EXPECT_EQ(bed.verdict(banded("nees", Kind::within)), Verdict::reproduced);
  EXPECT_EQ(bed.verdict(banded("ledger_nees", Kind::within)), Verdict::reproduced);
  EXPECT_EQ(bed.verdict(within("anees", 0.7, 1.4)), Verdict::reproduced);
  EXPECT_EQ(bed.verdict(within("nees", 1.4, 2.8)), Verdict::reproduced);
}

TEST(ChiSquaredBand, EachSubjectIsAComparisonOfItsOwn) {
  Bed bed(20, 1);
  bed.fill([](const Asked& asked, Rows& rows) {
    Stream stream = draws(asked.repetition, 0);
    rows.series(1.0, 0, "nees", 2.0 * stream.exponential(1.0), "near");
    rows.series(1.0, 0, "nees", 20.0 * stream.exponential(1.0), "far");
    return Outcome::finished;
  });
  const ClaimResult result = bed.judge(banded("anees", Kind::within));
  EXPECT_EQ(result.comparisons, 2u);
  EXPECT_EQ(result.failing, 1u);
  EXPECT_EQ(result.worst_where, "agent=0 far t=1 s");
}

TEST(Agreement, APredictionOfTheAneesIsConfirmedOrRefuted) {
  Consistency bed(5.0);
  Expectation expect = everywhere(expects("anees", Kind::agrees_with));
  expect.than_metric = "ledger_anees";
  const ClaimResult result = bed.judge(expect);
  EXPECT_EQ(result.verdict, Verdict::reproduced);
  EXPECT_EQ(result.quantity, "relative difference of anees from ledger_anees");
  EXPECT_THAT(result.note, HasSubstr("intervals are ±"));
  expect.than_metric = "too_low";
  const ClaimResult refuted = bed.judge(expect);
  EXPECT_EQ(refuted.verdict, Verdict::not_reproduced);
  EXPECT_NEAR(refuted.worst.estimate, 1.0 / 0.7 - 1.0, 0.5);
}

TEST(Agreement, RootMeanSquaresAreHeldAgainstTheirPrediction) {
  Consistency bed(5.0);
  Expectation expect = expects("rms_error_m", Kind::agrees_with);
  expect.than_metric = "true_sigma_m";
  EXPECT_EQ(bed.verdict(expect), Verdict::reproduced);
  expect.than_metric = "claimed_sigma_m";
  EXPECT_EQ(bed.verdict(expect), Verdict::not_reproduced);
  EXPECT_NEAR(bed.judge(expect).worst.estimate, std::sqrt(5.0) - 1.0, 0.4);
}

TEST(Agreement, RepetitionsWithoutAPredictionAreLeftOutAndCounted) {
  Bed bed(20, 1);
  bed.fill([](const Asked& asked, Rows& rows) {
    rows.series(1.0, 0, "nees", asked.repetition % 2 == 0 ? 2.2 : 1.8);
    rows.series(1.0, 0, "ledger_anees", asked.repetition <= 4 ? 0.0 : 1.0);
    return Outcome::finished;
  });
  Expectation expect = expects("anees", Kind::agrees_with);
  expect.than_metric = "ledger_anees";
  EXPECT_EQ(bed.verdict(expect), Verdict::reproduced);
  EXPECT_EQ(bed.judge(expect).missing_values, 4u);
}

TEST(Agreement, OtherMetricsAreComparedByTheirDifference) {
  Bed bed(20, 1);
  bed.fill([](const Asked& asked, Rows& rows) {
    const double x = asked.repetition;
    rows.scalar(0, "sent", x);
    rows.scalar(0, "received", x * (1.0 + 1e-12));
    rows.scalar(0, "shifted", x + 0.5);
    return Outcome::finished;
  });
  Expectation expect = expects("sent", Kind::agrees_with);
  expect.than_metric = "received";  // rounding is forgiven
  EXPECT_EQ(bed.verdict(expect), Verdict::reproduced);
  expect.than_metric = "shifted";
  EXPECT_EQ(bed.verdict(expect), Verdict::not_reproduced);
  EXPECT_NEAR(bed.judge(expect).worst.estimate, -0.5, 1e-12);
}

}  // namespace
}  // namespace hearsay::analysis
