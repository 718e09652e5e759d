#include "tools/analysis/quantity.hpp"

#include <gtest/gtest.h>

#include "agents/metrics.hpp"

namespace hearsay::analysis {
namespace {

TEST(MetricRule, BringsRepetitionsTogetherAsTheListOfMetricsSays) {
  for (const MetricInfo& metric : metrics()) {
    const MetricRule rule = metric_rule(std::string(metric.name));
    EXPECT_EQ(rule.rms, metric.aggregate == Aggregate::rms) << metric.name;
    EXPECT_EQ(rule.median, metric.aggregate == Aggregate::median) << metric.name;
  }
}

}  // namespace
}  // namespace hearsay::analysis
