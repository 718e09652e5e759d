// What is missing: runs, values, whole cells.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sim/kernel/error.hpp"
#include "tests/tools/analysis/bed.hpp"

namespace hearsay::analysis {
namespace {

using Kind = Expectation::Kind;
using testing::HasSubstr;

constexpr double infinity = std::numeric_limits<double>::infinity();

Value text(const char* label) { return std::string(label); }

TEST(WhatIsLeftOut, FailedAndAbsentRunsAreNotedAndPairsStillMatch) {
  Bed bed(10, 1);
  bed.axis("rule", {text("none"), text("ci")});
  bed.fill([](const Asked& asked, Rows& rows) {
    const bool ci = asked.labels.at("rule") == "ci";
    // Paired wrongly (by place, not by repetition) the differences would be far from −1.
    rows.scalar(0, "cost", 100.0 * asked.repetition - (ci ? 1.0 : 0.0));
    if (ci && asked.repetition == 2) return Outcome::failed;
    if (!ci && asked.repetition == 5) return Outcome::absent;
    return Outcome::finished;
  });
  Expectation expect = expects("cost", Kind::less_than);
  expect.where["rule"] = {text("ci")};
  expect.than["rule"] = {text("none")};
  const ClaimResult result = bed.judge(expect);
  EXPECT_EQ(result.verdict, Verdict::reproduced);
  EXPECT_EQ(result.repetitions, 8);
  EXPECT_NEAR(result.worst.estimate, -1.0, 1e-9);
  EXPECT_THAT(result.note, HasSubstr("missing runs: 1 of 10 (failed: 1)"));
  EXPECT_THAT(result.note, HasSubstr("repetitions without a finished run to pair them with: 1"));
}

TEST(WhatIsLeftOut, ACellWithoutRunsKeepsAClaimFromBeingReproduced) {
  Bed bed(3, 1);
  bed.axis("rule", {text("none"), text("ci")});
  bed.fill([](const Asked& asked, Rows& rows) {
    rows.scalar(0, "cost", asked.repetition);
    return asked.labels.at("rule") == "ci" ? Outcome::absent : Outcome::finished;
  });
  const ClaimResult result = bed.judge(at_most("cost", 100.0));
  EXPECT_EQ(result.verdict, Verdict::undecided);
  EXPECT_EQ(result.open, 1u);
  EXPECT_EQ(result.worst_where, "rule=ci");
  EXPECT_THAT(result.note, HasSubstr("cells without a finished run: 1, the first rule=ci"));
}

TEST(WhatIsLeftOut, MissingValuesAreCounted) {
  Bed bed(10, 1);
  bed.fill([](const Asked& asked, Rows& rows) {
    rows.series(5.0, 0, "entropy_nats", asked.repetition <= 3 ? null : -1.0 * asked.repetition);
    return Outcome::finished;
  });
  const ClaimResult result = bed.judge(at_most("entropy_nats", 0.0));
  EXPECT_EQ(result.verdict, Verdict::reproduced);
  EXPECT_EQ(result.missing_values, 3u);
  EXPECT_EQ(result.repetitions, 7);
}

TEST(WhatIsLeftOut, ASubjectThatTheFirstRunsHaveNotIsThereAllTheSame) {
  Bed bed(10, 1);
  bed.fill([](const Asked& asked, Rows& rows) {
    for (int trip = 1; trip <= asked.repetition; ++trip) {
      rows.series(5.0, 0, "trip_length_m", 10.0 * trip, std::to_string(trip));
    }
    return Outcome::finished;
  });
  Expectation fourth = at_most("trip_length_m", 40.5);
  fourth.subjects = {"4"};
  const ClaimResult result = bed.judge(fourth);
  EXPECT_EQ(result.verdict, Verdict::reproduced);
  EXPECT_NEAR(result.worst.estimate, 40.0, 1e-12);
  EXPECT_EQ(result.repetitions, 7);
  EXPECT_EQ(result.missing_values, 3u);
  fourth.subjects = {"11"};
  EXPECT_THROW(bed.judge(fourth), InputError);
}

/// Of ten repetitions three never agree: without them the times would be 1 … 7 s.
struct Times : Bed {
  Times() : Bed(10, 1) {
    axis("rule", {text("slow"), text("quick")});
    fill([](const Asked& asked, Rows& rows) {
      const bool slow = asked.labels.at("rule") == "slow";
      const double time_s = slow && asked.repetition > 7 ? infinity : asked.repetition;
      rows.scalar(central_agent, "agree_again_s", slow ? time_s : 0.5);
      rows.scalar(0, "reach_gap_max", slow && asked.repetition == 9 ? infinity : 0.0);
      return Outcome::finished;
    });
  }
  ClaimResult judge_slow(Expectation expect) {
    expect.agents = "central";
    expect.where["rule"] = {text("slow")};
    return judge(expect);
  }
};

TEST(WhatIsLeftOut, TimesThatNeverComeAreNot) {
  Times bed;
  const ClaimResult within = bed.judge_slow(at_most("agree_again_s", 7.0));
  EXPECT_EQ(within.verdict, Verdict::undecided);
  EXPECT_EQ(within.quantity, "median of agree_again_s");
  EXPECT_EQ(within.worst.estimate, 5.5);
  EXPECT_EQ(within.worst.low, 2.0);
  EXPECT_EQ(within.worst.high, infinity);
  EXPECT_EQ(within.missing_values, 0u);
  EXPECT_EQ(within.repetitions, 10);
  EXPECT_THAT(within.note, HasSubstr("infinite values, which count: 3"));
  Expectation worst = at_most("agree_again_s", 1e9);
  worst.statistic = "max";
  EXPECT_EQ(bed.judge_slow(worst).verdict, Verdict::not_reproduced);
  EXPECT_EQ(bed.judge_slow(at_most("agree_again_s", 1.5)).verdict, Verdict::not_reproduced);
  EXPECT_EQ(bed.judge_slow(at_least("agree_again_s", 2.0)).verdict, Verdict::reproduced);
}

TEST(WhatIsLeftOut, TimesThatNeverComeAreLaterThanAllOthers) {
  Times bed;
  Expectation later = expects("agree_again_s", Kind::greater_than);
  later.than["rule"] = {text("quick")};
  const ClaimResult result = bed.judge_slow(later);
  EXPECT_EQ(result.verdict, Verdict::reproduced);
  EXPECT_EQ(result.quantity, "median difference of agree_again_s");
  EXPECT_EQ(result.worst.estimate, 5.0);
  EXPECT_EQ(result.repetitions, 10);
  Expectation itself = expects("agree_again_s", Kind::greater_than);
  itself.than_agent = "central";
  EXPECT_EQ(bed.judge_slow(itself).worst.estimate, 0.0);
  const auto rows =
      compare(bed.file(),
              {.metric = "agree_again_s", .by = "rule", .baseline = "quick", .agents = "central"});
  EXPECT_EQ(rows.at(0).verdict, "higher");
  EXPECT_EQ(rows.at(0).pairs, 10);
  EXPECT_EQ(rows.at(0).difference.estimate, 5.0);
}

TEST(WhatIsLeftOut, AnInfiniteGapIsTheLargest) {
  Times bed;
  Expectation exact = at_most("reach_gap_max", 1e-9);
  exact.statistic = "max";
  const ClaimResult result = bed.judge(exact);
  EXPECT_EQ(result.verdict, Verdict::not_reproduced);
  EXPECT_EQ(result.missing_values, 0u);
  EXPECT_EQ(result.worst.estimate, infinity);
  Expectation mean = at_most("reach_gap_max", 1e-9);
  EXPECT_EQ(bed.judge(mean).missing_values, 1u);
}

TEST(WhatIsLeftOut, WithoutAnyValueNothingIsDecided) {
  Bed bed(4, 1);
  bed.fill([](const Asked&, Rows& rows) {
    rows.series(5.0, 0, "entropy_nats", null);
    return Outcome::finished;
  });
  const ClaimResult result = bed.judge(at_most("entropy_nats", 0.0));
  EXPECT_EQ(result.verdict, Verdict::undecided);
  EXPECT_TRUE(std::isnan(result.worst.estimate));
  EXPECT_THAT(result.note, HasSubstr("comparisons with fewer than two values: 1"));
  const ClaimResult unknown = bed.judge(at_most("never_recorded", 0.0));
  EXPECT_EQ(unknown.verdict, Verdict::undecided);
  EXPECT_THAT(unknown.note, HasSubstr("the database has no values of never_recorded"));
}

TEST(WhatIsLeftOut, AnInstantThatLosesAllValuesStaysOpen) {
  Bed bed(4, 1);
  bed.fill([](const Asked&, Rows& rows) {
    for (const double t_s : {0.0, 5.0, 7.0, 9.0}) {
      rows.series(t_s, 0, "nees", t_s == 5.0 || t_s == 9.0 ? 2.0 : null);
    }
    return Outcome::finished;
  });
  Expectation expect = banded("anees", Kind::within);
  expect.at = "all";
  const ClaimResult result = bed.judge(expect);
  EXPECT_EQ(result.verdict, Verdict::undecided);
  EXPECT_EQ(result.comparisons, 3u);
  EXPECT_EQ(result.open, 1u);
  EXPECT_EQ(result.worst_where, "agent=0 t=7 s");
}

TEST(WhatIsLeftOut, OneValueOfSeveralRepetitionsIsNotEnough) {
  Bed bed(2, 1);
  bed.fill([](const Asked& asked, Rows& rows) {
    rows.scalar(0, "cost", asked.repetition == 1 ? 1.0 : null);
    return Outcome::finished;
  });
  EXPECT_EQ(bed.verdict(at_most("cost", 100.0)), Verdict::undecided);
}

TEST(WhatIsLeftOut, AStudyOfOneRunSpeaksOfThatRun) {
  Bed bed(1, 1);
  bed.fill([](const Asked&, Rows& rows) {
    rows.scalar(0, "cost", 3.0);
    return Outcome::finished;
  });
  const ClaimResult result = bed.judge(at_most("cost", 3.0));
  EXPECT_EQ(result.verdict, Verdict::reproduced);
  EXPECT_EQ(result.worst.low, 3.0);
  EXPECT_EQ(result.worst.high, 3.0);
  EXPECT_EQ(result.note, "one run, no interval");
  EXPECT_EQ(bed.verdict(at_most("cost", 2.9)), Verdict::not_reproduced);
}

TEST(WhatIsLeftOut, RunsOfCellsThatTheStudyNoLongerHasAreNoted) {
  Bed bed(2, 1);
  bed.axis("rule", {text("none"), text("ci")});
  bed.fill([](const Asked&, Rows& rows) {
    rows.scalar(0, "cost", 3.0);
    return Outcome::finished;
  });
  bed.study.axes[0].points.pop_back();
  EXPECT_THAT(bed.judge(at_most("cost", 3.0)).note,
              HasSubstr("runs of cells that the study does not have: 2"));
}

TEST(WhatIsLeftOut, ADatabaseWithoutTheStudyIsRefused) {
  Bed bed(1, 1);
  bed.fill([](const Asked&, Rows&) { return Outcome::finished; });
  bed.study.name = "made up too";
  try {
    bed.judge(at_most("cost", 3.0));
    FAIL() << "judged";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("no run of study 'made up too'"));
    EXPECT_THAT(error.what(), HasSubstr(bed.file()));
  }
}

}  // namespace
}  // namespace hearsay::analysis
