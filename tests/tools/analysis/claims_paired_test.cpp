// Comparisons with another cell, agent or metric, paired by repetition.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/tools/analysis/bed.hpp"

namespace hearsay::analysis {
namespace {

using Kind = Expectation::Kind;
using testing::HasSubstr;

Value text(const char* label) { return std::string(label); }

/// Rules "none", "ci" (5 % better than none in every repetition, at any loss) and "same" (equal to
/// none on average), each with loss 0 and 0.3; errors vary by far more than 5 % over repetitions.
struct Rules : Bed {
  Rules() : Bed(40, 1) {
    axis("rule", {text("none"), text("ci"), text("same")});
    axis("loss", {Value(0.0), Value(0.3)});
    fill([](const Asked& asked, Rows& rows) {
      Stream stream = draws(asked.repetition, 0);
      const double shared = 2.0 + std::abs(stream.normal());
      const double wobble = asked.repetition % 2 == 0 ? 0.01 : -0.01;
      const std::string& rule = asked.labels.at("rule");
      const double factor = rule == "ci" ? 0.95 + wobble : rule == "same" ? 1.0 + wobble : 1.0;
      rows.series(60.0, 0, "rms_error_m", factor * shared);
      rows.series(60.0, central_agent, "rms_error_m", 0.5 * shared);
      rows.series(60.0, 0, "claimed_sigma_m", 0.25 * factor * shared);
      rows.series(60.0, 0, "kl_to_central_nats", factor * shared);
      return Outcome::finished;
    });
  }
};

Expectation compared(const std::string& metric, const char* rule, Kind kind, const char* with) {
  Expectation expect = expects(metric, kind);
  expect.where["rule"] = {text(rule)};
  expect.than["rule"] = {text(with)};
  return expect;
}

TEST(PairedClaims, ASmallDifferenceShowsThroughALargeScatter) {
  Rules bed;
  const ClaimResult result = bed.judge(compared("rms_error_m", "ci", Kind::less_than, "none"));
  EXPECT_EQ(result.verdict, Verdict::reproduced);
  EXPECT_EQ(result.comparisons, 2u);  // at each loss
  EXPECT_EQ(result.quantity, "ratio of rms_error_m, paired");
  EXPECT_NEAR(result.worst.estimate, 0.95, 0.01);
  EXPECT_EQ(result.bound_high, 1.0);
  EXPECT_THAT(result.worst_where, HasSubstr("rule=ci"));
}

TEST(PairedClaims, LessAndGreaterAreKeptBrokenOrOpen) {
  Rules bed;
  for (const char* metric : {"rms_error_m", "kl_to_central_nats"}) {
    EXPECT_EQ(bed.verdict(compared(metric, "ci", Kind::less_than, "none")), Verdict::reproduced);
    EXPECT_EQ(bed.verdict(compared(metric, "none", Kind::less_than, "ci")),
              Verdict::not_reproduced);
    EXPECT_EQ(bed.verdict(compared(metric, "same", Kind::less_than, "none")), Verdict::undecided);
    EXPECT_EQ(bed.verdict(compared(metric, "none", Kind::greater_than, "ci")), Verdict::reproduced);
    EXPECT_EQ(bed.verdict(compared(metric, "ci", Kind::greater_than, "none")),
              Verdict::not_reproduced);
    EXPECT_EQ(bed.verdict(compared(metric, "same", Kind::greater_than, "none")),
              Verdict::undecided);
  }
}

TEST(PairedClaims, MeansAreComparedByTheirDifference) {
  Rules bed;
  const ClaimResult result =
      bed.judge(compared("kl_to_central_nats", "ci", Kind::less_than, "none"));
  EXPECT_EQ(result.quantity, "mean difference of kl_to_central_nats");
  EXPECT_EQ(result.bound_high, 0.0);
  EXPECT_LT(result.worst.estimate, -0.1);
}

TEST(PairedClaims, EqualIsNeitherLessNorGreater) {
  Rules bed;
  Expectation expect = compared("rms_error_m", "ci", Kind::less_than, "ci");
  expect.than["loss"] = {Value(0.0)};
  // With loss 0 the cell would be compared with itself; with loss 0.3 it is the same by pairing.
  const ClaimResult result = bed.judge(expect);
  EXPECT_EQ(result.comparisons, 1u);
  EXPECT_EQ(result.verdict, Verdict::not_reproduced);
  EXPECT_EQ(result.worst.estimate, 1.0);
}

TEST(PairedClaims, WhatIsEqualButForRoundingIsEqual) {
  Bed bed(3, 1);
  bed.axis("rule", {text("a"), text("b")});
  bed.fill([](const Asked& asked, Rows& rows) {
    const double x = 1.0 + asked.repetition;
    const double less = asked.labels.at("rule") == "b" ? std::nextafter(x, 0.0) : x;
    rows.scalar(0, "cost", less);
    rows.series(1.0, 0, "rms_error_m", less);
    rows.series(1.0, 0, "claimed_sigma_m", x);
    return Outcome::finished;
  });
  for (const char* metric : {"cost", "rms_error_m"}) {
    EXPECT_EQ(bed.verdict(compared(metric, "b", Kind::less_than, "a")), Verdict::not_reproduced);
    EXPECT_EQ(bed.verdict(compared(metric, "a", Kind::greater_than, "b")), Verdict::not_reproduced);
    const auto rows = compare(bed.file(), {.metric = metric, .by = "rule"});
    EXPECT_EQ(rows.at(1).verdict, "no difference seen");
  }
  Expectation ratio = at_least("rms_error_m", 1.0);
  ratio.over = "claimed_sigma_m";
  EXPECT_EQ(bed.verdict(ratio), Verdict::reproduced);
}

TEST(PairedClaims, AnotherAgentOrMetricOfTheSameRunCanBeMeant) {
  Rules bed;
  Expectation expect = expects("rms_error_m", Kind::greater_than);
  expect.than_agent = "central";
  EXPECT_EQ(bed.judge(expect).comparisons, 6u);
  EXPECT_EQ(bed.verdict(expect), Verdict::reproduced);
  Expectation metric = expects("claimed_sigma_m", Kind::less_than);
  metric.than_metric = "rms_error_m";
  const ClaimResult result = bed.judge(metric);
  EXPECT_EQ(result.verdict, Verdict::reproduced);
  EXPECT_NEAR(result.worst.estimate, 0.25, 1e-9);
}

TEST(PairedClaims, AnotherCellsOtherAgentIsNotTheCellItself) {
  Rules bed;
  Expectation expect = compared("rms_error_m", "none", Kind::greater_than, "none");
  expect.than_agent = "central";
  EXPECT_EQ(bed.judge(expect).comparisons, 2u);
  EXPECT_EQ(bed.verdict(expect), Verdict::reproduced);
}

TEST(PairedClaims, RatiosOfAggregatesCanBeComparedToo) {
  Rules bed;
  Expectation expect = compared("claimed_sigma_m", "ci", Kind::less_than, "none");
  expect.over = "kl_to_central_nats";
  const ClaimResult result = bed.judge(expect);  // rms/mean on both sides
  EXPECT_NEAR(result.worst.estimate, 1.0, 0.01);
  EXPECT_EQ(result.bound_high, 1.0);
}

TEST(PairedClaims, BytesPerMetreSavedIsAQuotientOfMeans) {
  Bed bed(40, 1);
  bed.axis("rule", {text("a"), text("b"), text("worse")});
  double bytes = 0.0, saved = 0.0;
  bed.fill([&](const Asked& asked, Rows& rows) {
    Stream stream = draws(asked.repetition, 0);
    const bool is_a = asked.labels.at("rule") == "a";
    const double sent = (is_a ? 100.0 : 300.0) + asked.repetition;
    const double metres = (asked.labels.at("rule") == "worse" ? -1.0 : 1.0) + 0.1 * stream.normal();
    rows.scalar(0, "bytes_sent", sent);
    rows.scalar(0, "distance_saved_m", metres);
    bytes += is_a ? sent : 0.0;
    saved += is_a ? metres : 0.0;
    return Outcome::finished;
  });
  Expectation expect = at_least("bytes_per_m_saved", 110.0);
  expect.where["rule"] = {text("a")};
  const ClaimResult result = bed.judge(expect);
  EXPECT_NEAR(result.worst.estimate, bytes / saved, 1e-9);
  EXPECT_EQ(result.quantity, "bytes_per_m_saved");
  EXPECT_EQ(result.verdict, Verdict::reproduced);
  EXPECT_EQ(bed.verdict(compared("bytes_per_m_saved", "a", Kind::less_than, "b")),
            Verdict::reproduced);
  EXPECT_EQ(bed.verdict(compared("bytes_per_m_saved", "b", Kind::less_than, "a")),
            Verdict::not_reproduced);
  // Where nothing is saved there is no such number.
  EXPECT_EQ(bed.verdict(compared("bytes_per_m_saved", "worse", Kind::less_than, "a")),
            Verdict::undecided);
  expect.over = "bytes_sent";
  EXPECT_THROW(bed.judge(expect), InputError);
  expect = at_least("bytes_sent", 0.0);
  expect.over = "bytes_per_m_saved";
  EXPECT_THROW(bed.judge(expect), InputError);
  EXPECT_THROW(compare(bed.file(), {.metric = "bytes_per_m_saved", .by = "rule"}), InputError);
}

TEST(PairedClaims, ExtremesHoldInEveryRepetition) {
  Rules bed;
  Expectation expect = compared("rms_error_m", "ci", Kind::less_than, "none");
  expect.statistic = "max";
  const ClaimResult result = bed.judge(expect);
  EXPECT_EQ(result.verdict, Verdict::reproduced);
  EXPECT_EQ(result.worst.low, result.worst.high);
  expect.where["rule"] = {text("same")};
  EXPECT_EQ(bed.verdict(expect), Verdict::not_reproduced);
}

TEST(PairedClaims, CellsThatTheStudySkipsAreNoted) {
  Rules bed;
  bed.study.skips.push_back({{{"rule", {text("none")}}, {"loss", {Value(0.3)}}}, 1});
  const ClaimResult result = bed.judge(compared("rms_error_m", "ci", Kind::less_than, "none"));
  EXPECT_EQ(result.comparisons, 1u);
  EXPECT_THAT(result.note, HasSubstr("the study skips the other cell: 1"));
}

}  // namespace
}  // namespace hearsay::analysis
