#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "sim/kernel/error.hpp"
#include "tests/tools/analysis/bed.hpp"

namespace hearsay::analysis {
namespace {

using testing::HasSubstr;

Value text(const char* label) { return std::string(label); }

/// Costs of three rules at two losses: ci 1 below none, naive 1 above but for loss 0.3, where only
/// chance divides them.
struct Costs : Bed {
  Costs() : Bed(12, 2) {
    axis("rule", {text("none"), text("ci"), text("naive")});
    axis("loss", {Value(0.0), Value(0.3)});
    fill([](const Asked& asked, Rows& rows) {
      const std::string& rule = asked.labels.at("rule");
      const double wobble = asked.repetition % 2 == 0 ? 0.2 : -0.2;
      const bool open = asked.labels.at("loss") == "0.3";
      const double shift = rule == "ci"      ? -1.0 + wobble
                           : rule != "naive" ? 0.0
                           : open            ? wobble
                                             : 1.0;
      for (AgentId agent = 0; agent < 2; ++agent) {
        const double cost = 10.0 * asked.repetition + agent + shift;
        rows.scalar(agent, "cost", cost);
        rows.series(10.0, agent, "rms_error_m", cost);
        rows.series(20.0, agent, "rms_error_m", 2.0 * cost);
        rows.series(20.0, agent, "nees", cost);
      }
      return Outcome::finished;
    });
  }
  std::string refusal(const CompareOptions& options) const {
    try {
      compare(file(), options);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
};

TEST(Compare, EveryCellAndLabelHasARow) {
  const Costs bed;
  const auto rows = compare(bed.file(), {.metric = "cost", .by = "rule"});
  ASSERT_EQ(rows.size(), 6u);
  EXPECT_EQ(rows[0].cell, "loss=0");
  EXPECT_EQ(rows[0].label, "none");
  EXPECT_EQ(rows[0].verdict, "baseline");
  EXPECT_NEAR(rows[0].value.estimate, 65.5, 1e-9);
  EXPECT_EQ(rows[1].label, "ci");
  EXPECT_EQ(rows[1].verdict, "lower");
  EXPECT_EQ(rows[1].pairs, 12);
  EXPECT_NEAR(rows[1].difference.estimate, -1.0, 1e-9);
  EXPECT_EQ(rows[2].verdict, "higher");
  EXPECT_EQ(rows[5].cell, "loss=0.3");
  EXPECT_EQ(rows[5].verdict, "no difference seen");
}

TEST(Compare, DifferencesAreCorrectedForTheNumberOfRows) {
  const Costs bed;
  const auto rows = compare(bed.file(), {.metric = "cost", .by = "rule"});
  // Deviation 0.2·√(12/11), four rows: t(11, 1 − 0.05/8) = 2.980.
  const double half = 2.9804 * 0.2 / std::sqrt(11.0);
  EXPECT_NEAR(rows[1].difference.high, -1.0 + half, 1e-4);
}

TEST(Compare, AnyLabelCanBeTheBaseline) {
  const Costs bed;
  const auto rows = compare(bed.file(), {.metric = "cost", .by = "rule", .baseline = "ci"});
  EXPECT_EQ(rows[0].verdict, "higher");
  EXPECT_EQ(rows[1].verdict, "baseline");
  const auto by_loss = compare(bed.file(), {.metric = "cost", .by = "loss", .baseline = "0.30"});
  EXPECT_EQ(by_loss[0].cell, "rule=none");
  EXPECT_EQ(by_loss[0].label, "0");
  EXPECT_EQ(by_loss[1].verdict, "baseline");
}

TEST(Compare, SeriesAreComparedAtTheEndOrAtAnInstant) {
  const Costs bed;
  CompareOptions options{.metric = "rms_error_m", .by = "rule"};
  options.agents = "a0";
  const double end = compare(bed.file(), options)[0].value.estimate;
  options.at = "10";
  const double before = compare(bed.file(), options)[0].value.estimate;
  EXPECT_NEAR(before, 10.0 * std::sqrt(650.0 / 12.0), 1e-9);
  EXPECT_NEAR(end, 2.0 * before, 1e-9);
  options.at = "11";
  EXPECT_THAT(bed.refusal(options), HasSubstr("no sample at 11 s"));
  options.at = "never";
  EXPECT_THAT(bed.refusal(options), HasSubstr("'never'"));
}

TEST(Compare, AgentsCanBeComparedEach) {
  const Costs bed;
  CompareOptions options{.metric = "anees", .by = "rule"};
  options.agents = "each";
  const auto rows = compare(bed.file(), options);
  ASSERT_EQ(rows.size(), 12u);
  EXPECT_EQ(rows[0].cell, "loss=0 agent=0");
  EXPECT_NEAR(rows[0].value.estimate, 65.0 / 2.0, 1e-9);
}

TEST(Compare, UnknownNamesAreAnsweredWithTheNearest) {
  const Costs bed;
  EXPECT_THAT(bed.refusal({.metric = "cots", .by = "rule"}),
              testing::AllOf(HasSubstr("no metric 'cots'"), HasSubstr("'cost'")));
  EXPECT_THAT(bed.refusal({.metric = "cost", .by = "rul"}),
              testing::AllOf(HasSubstr("no axis 'rul'"), HasSubstr("'rule'")));
  EXPECT_THAT(bed.refusal({.metric = "cost", .by = "rule", .baseline = "nome"}),
              testing::AllOf(HasSubstr("no label 'nome'"), HasSubstr("'none'")));
  CompareOptions options{.metric = "cost", .by = "rule"};
  options.agents = "a9";
  EXPECT_THAT(bed.refusal(options), HasSubstr("no agent 'a9'"));
}

TEST(Compare, OneOfSeveralStudiesMustBeChosen) {
  Costs bed;
  {
    DatabaseWriter writer(bed.file());
    writer.add_study({"another", "another.study.toml", ""});
    Record record({});
    record.finish();
    RunRow row;
    row.id = 1000;
    row.study = "another";
    writer.add(row, record);
    writer.commit();
    writer.close();
  }
  CompareOptions options{.metric = "cost", .by = "rule"};
  EXPECT_THAT(bed.refusal(options),
              testing::AllOf(HasSubstr("--study"), HasSubstr("another"), HasSubstr("made up")));
  options.study = "made up";
  EXPECT_EQ(compare(bed.file(), options).size(), 6u);
  options.study = "made";
  EXPECT_THAT(bed.refusal(options), HasSubstr("no run of study 'made'"));
}

TEST(Compare, RunsWithoutAPartnerAreNotPaired) {
  Bed bed(5, 1);
  bed.axis("rule", {text("none"), text("ci")});
  bed.fill([](const Asked& asked, Rows& rows) {
    rows.scalar(0, "cost", asked.repetition);
    if (asked.labels.at("rule") == "none" && asked.repetition > 3) return Outcome::failed;
    return Outcome::finished;
  });
  const auto rows = compare(bed.file(), {.metric = "cost", .by = "rule"});
  EXPECT_EQ(rows[1].pairs, 3);
  EXPECT_EQ(rows[1].value.estimate, 3.0);  // of all five
  EXPECT_EQ(rows[1].difference.estimate, 0.0);
}

}  // namespace
}  // namespace hearsay::analysis
