#include "tools/analysis/labels.hpp"

#include <gtest/gtest.h>

namespace hearsay::analysis {
namespace {

TEST(Labels, EqualLabelsAreSpeltAlikeWhereverTheyComeFrom) {
  EXPECT_EQ(label_text(Value(0.1)), stored_label_text("0.1"));
  EXPECT_EQ(label_text(Value(1.0)), stored_label_text("1"));
  EXPECT_EQ(label_text(Value(std::int64_t{1})), stored_label_text("1.0"));
  EXPECT_EQ(label_text(Value(true)), stored_label_text("true"));
  EXPECT_EQ(label_text(Value(std::string("ring"))), stored_label_text("\"ring\""));
  EXPECT_EQ(label_text(Value(std::string("ring"))), stored_label_text("ring"));
}

TEST(Labels, DifferentLabelsStayDifferent) {
  EXPECT_NE(label_text(Value(0.1)), label_text(Value(0.3)));
  EXPECT_NE(stored_label_text("\"a b\""), stored_label_text("\"ab\""));
  EXPECT_EQ(stored_label_text("\"say \\\"hi\\\"\""), "say \"hi\"");
}

TEST(Labels, ACellReadsAsAxesAndLabels) {
  EXPECT_EQ(to_string(Labels{{"topology", "ring"}, {"loss", "0.1"}}), "topology=ring loss=0.1");
  EXPECT_EQ(to_string(Labels{}), "");
}

}  // namespace
}  // namespace hearsay::analysis
