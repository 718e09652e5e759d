#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "sim/kernel/error.hpp"
#include "tools/analysis/claims.hpp"

namespace hearsay::analysis {
namespace {

using testing::HasSubstr;

constexpr double infinity = std::numeric_limits<double>::infinity();

class ClaimsReport : public testing::Test {
 protected:
  void SetUp() override {
    directory_ = testing::TempDir() + "hearsay-report-" + std::to_string(getpid());
    std::filesystem::create_directories(directory_);
  }
  void TearDown() override { std::filesystem::remove_all(directory_); }

  static std::vector<ClaimResult> results() {
    ClaimResult kept;
    kept.claim.text = "Intersection | stays\nconsistent";
    kept.claim.source = "a paper, section 3";
    kept.claim.expect.metric = "anees";
    kept.claim.expect.kind = Expectation::Kind::at_most;
    kept.verdict = Verdict::reproduced;
    kept.quantity = "mean of anees";
    kept.worst = {1.05, 0.9, 1.25};
    kept.worst_where = "rule=ci agent=2";
    kept.bound_low = -infinity;
    kept.bound_high = 1.5;
    kept.comparisons = 15;
    kept.repetitions = 100;
    kept.missing_values = 3;
    ClaimResult open;
    open.claim.text = "Nothing is known";
    open.claim.expect.kind = Expectation::Kind::grows;
    open.worst = {std::numeric_limits<double>::quiet_NaN(), -infinity, infinity};
    open.bound_high = infinity;
    open.comparisons = 1;
    open.open = 1;
    open.note = "too few";
    return {kept, open};
  }

  std::string path(const std::string& name) const { return directory_ + "/" + name; }
  static std::string content(const std::string& file) {
    std::ifstream stream(file);
    std::stringstream text;
    text << stream.rdbuf();
    return text.str();
  }
  std::size_t files() const {
    std::size_t count = 0;
    for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(directory_)) {
      ++count;
    }
    return count;
  }

 private:
  std::string directory_;
};

TEST_F(ClaimsReport, IsATableWithARowEachClaim) {
  write_claims_report(results(), "What rumour does", path("claims.md"), path("claims.json"));
  const std::string text = content(path("claims.md"));
  EXPECT_THAT(text, testing::StartsWith("# What rumour does\n"));
  EXPECT_THAT(text, HasSubstr("2 claims: 1 reproduced, 0 not reproduced, 1 undecided."));
  EXPECT_THAT(text, HasSubstr("| Intersection \\| stays consistent | a paper, section 3 | "
                              "**reproduced** | mean of anees | 1.05 | [0.9, 1.25] | ≤ 1.5 | 15 | "
                              "100 | rule=ci agent=2 | 3 missing values left out |\n"));
  EXPECT_THAT(text, HasSubstr("| **undecided** |  | – | (−∞, ∞) | > 0 | 1, 1 open | 0 |"));
  EXPECT_EQ(files(), 2u);
}

TEST_F(ClaimsReport, HasATwinInJson) {
  write_claims_report(results(), "What rumour does", path("claims.md"), path("claims.json"));
  const auto json = nlohmann::json::parse(content(path("claims.json")));
  EXPECT_EQ(json["title"], "What rumour does");
  EXPECT_EQ(json["counts"]["undecided"], 1);
  ASSERT_EQ(json["claims"].size(), 2u);
  EXPECT_EQ(json["claims"][0]["verdict"], "reproduced");
  EXPECT_EQ(json["claims"][0]["estimate"], 1.05);
  EXPECT_EQ(json["claims"][0]["bound_low"], "-inf");
  EXPECT_EQ(json["claims"][0]["missing_values"], 3);
  EXPECT_TRUE(json["claims"][1]["estimate"].is_null());
  EXPECT_EQ(json["claims"][1]["high"], "inf");
}

TEST_F(ClaimsReport, LeavesNothingBehindIfOneFileCannotBeWritten) {
  try {
    write_claims_report(results(), "t", path("claims.md"), path("not/there/claims.json"));
    FAIL() << "written";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("not/there/claims.json: cannot be written"));
  }
  EXPECT_EQ(files(), 0u);
}

}  // namespace
}  // namespace hearsay::analysis
