#include "filters/trails/parameters.hpp"

#include <gtest/gtest.h>

#include "filters/trails/laying.hpp"
#include "filters/trails/store.hpp"

namespace hearsay::trails {
namespace {

TEST(Parameters, AreFoundByName) {
  for (const ParameterSet& set : parameter_sets()) {
    EXPECT_EQ(parameter_set(set.name), &set);
    EXPECT_FALSE(set.source.empty());
  }
  EXPECT_EQ(parameter_sets().size(), 3u);
  EXPECT_EQ(parameter_set("lost"), nullptr);
}

TEST(Parameters, MakeAStoreAndATrailOfWhateverTheyGive) {
  for (const ParameterSet& set : parameter_sets()) {
    StoreOptions options{.age_max_s = set.age_max_s.value_or(1e9),
                         .life_arrivals = set.life_arrivals.value_or(0)};
    EXPECT_NO_THROW(MetricStore{options}) << set.name;
    TemporaryTrail<Point>::Options laying;
    laying.interval_s = set.interval_s.value_or(1.0);
    laying.crumbs_max = set.crumbs_max.value_or(500);
    EXPECT_NO_THROW(TemporaryTrail<Point>{laying}) << set.name;
  }
}

TEST(Parameters, OfLostKeepCrumbsInReachOfEachOther) {
  const ParameterSet& lost = *parameter_set("lost-2002");
  // A gap less than 2r, and a crumb is left before it is reached.
  EXPECT_LT(*lost.speed_mps * *lost.interval_s, 2.0 * *lost.sense_radius_m);
  EXPECT_EQ(*lost.age_max_s, 4.0 * 60.0);
  EXPECT_EQ(lost.laying, Laying::at_once);
}

TEST(Parameters, OfTextAndProgramOfTheThesisDiffer) {
  const ParameterSet& text = *parameter_set("thesis-2019-text");
  const ParameterSet& code = *parameter_set("thesis-2019-code");
  EXPECT_EQ(text.views->nearest, 10);
  EXPECT_EQ(code.views->nearest, 3);
  EXPECT_EQ(*text.crumbs_max, 500u);
  EXPECT_EQ(*code.crumbs_max, 700u);
  EXPECT_FALSE(text.life_arrivals);
  EXPECT_EQ(*code.life_arrivals, 11);
  EXPECT_EQ(text.distance, Distance::time);
  EXPECT_EQ(code.distance, Distance::steps_without_turns);
}

}  // namespace
}  // namespace hearsay::trails
