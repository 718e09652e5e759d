#include "scenarios/scenario.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scenarios/document.hpp"
#include "scenarios/names.hpp"
#include "temp_files.hpp"

namespace hearsay {
namespace {

using ::testing::DoubleNear;
using ::testing::ElementsAre;

TEST(Scenario, AgentsWithoutANameAreCalledAfterKindAndNumber) {
  Scenario s;
  s.agents.resize(4);
  s.agents[0].count = 2;
  s.agents[1].name = "base";
  s.agents[2].name = "uav";
  s.agents[2].count = 2;
  s.agents[3].kind = "gossip";
  EXPECT_EQ(s.agent_count(), 6);
  EXPECT_THAT(agent_names(s),
              ElementsAre("estimator0", "estimator1", "base", "uav0", "uav1", "gossip5"));
}

TEST(Scenario, AgentsOfACircleStandAtEqualAngles) {
  Scenario s;
  s.agents.resize(3);
  s.agents[0].position_m = {7.0, -1.0};
  s.agents[1].count = 4;
  s.agents[1].circle = CircleSpec{{10.0, 20.0}, 2.0};
  const auto at = agent_positions(s);
  ASSERT_EQ(at.size(), 6u);
  EXPECT_EQ(at[0], (std::array{7.0, -1.0}));
  const auto near = [](double x, double y) {
    return ElementsAre(DoubleNear(x, 1e-12), DoubleNear(y, 1e-12));
  };
  EXPECT_THAT(*at[1], near(12.0, 20.0));
  EXPECT_THAT(*at[2], near(10.0, 22.0));
  EXPECT_THAT(*at[3], near(8.0, 20.0));
  EXPECT_THAT(*at[4], near(10.0, 18.0));
  EXPECT_FALSE(at[5]);
}

class CanonicalText : public InTempDirectory {};

TEST_F(CanonicalText, IsItselfAScenarioWithTheSameText) {
  write("a.toml", ring + "parameters = 1\n");
  EXPECT_THROW(load_scenario("a.toml", {}, {}), InputError);
  write("a.toml", ring);
  const auto set =
      sets({"agents.parameters={ \"odd \\\" name\" = 0.1, b = 1e300 }",
            "agents.circle.radius_m=0.30000000000000004",
            "agents.sensor={kind=\"position\", sigma_along_m=1, sigma_across_m=2, end_s=3}",
            "radio.topology=edges", "radio.edges=[[0, 1], [2, 3]]", "events_max=5",
            "world.targets[0].name=\"a\\\\b\""});
  const std::string text = canonical_text(load_scenario("a.toml", set, {}));
  write("b.toml", text);
  EXPECT_EQ(canonical_text(load_scenario("b.toml", {}, {})), text);
  EXPECT_NE(text.find("radius_m = 0.30000000000000004"), std::string::npos) << text;
  EXPECT_NE(text.find("events_max = 5"), std::string::npos) << text;
  EXPECT_NE(text.find("latency_s = 0.0"), std::string::npos) << "defaults are written, too";
}

TEST_F(CanonicalText, DependsOnContentAlone) {
  write("a.toml", ring);
  write("b.toml",
        "# a comment\n[[agents]]\ncount=0x4\nestimator.fusion='ci-det'\nsensor.kind='position'\n"
        "sensor.sigma_m=5\n[radio]\nloss.probability=1e-1\nloss.model='bernoulli'\n"
        "topology='ring'\nrate_bps=2.5e5\n[record]\nseries=['nees']\n[world]\n"
        "targets=[{position_m=[40,25],name='alarm'}]\n[world.dummy]\n");
  EXPECT_EQ(error_of([] { load_scenario("b.toml", {}, {}); }),
            "b.toml:16: unknown key 'dummy' in [world]; allowed: targets, step_s, log, area, plan, "
            "sources");
  write("b.toml",
        "duration_s=6e1\nseed=7\n[[agents]]\ncount=0x4\nestimator.fusion='ci-det'\n"
        "sensor.kind='position'\nsensor.sigma_m=5\n[radio]\nloss.probability=1e-1\n"
        "loss.model='bernoulli'\ntopology='ring'\nrate_bps=2.5e5\n[record]\n"
        "series=['nees']\n[world]\ntargets=[{position_m=[40,25],name='alarm'}]\n");
  const std::string a = canonical_text(load_scenario("a.toml", {}, {}));
  EXPECT_EQ(a, canonical_text(load_scenario("b.toml", {}, {})));
  EXPECT_NE(a, canonical_text(load_scenario("a.toml", sets({"seed=8"}), {})));
  EXPECT_NE(
      a, canonical_text(load_scenario("a.toml", sets({"radio.rate_bps=250000.00000000003"}), {})));
}

TEST(Toml, NumbersReadBackAsTheyWere) {
  EXPECT_EQ(to_toml(0.1), "0.1");
  EXPECT_EQ(to_toml(5.0), "5.0");
  EXPECT_EQ(to_toml(1e300), "1e+300");
  EXPECT_EQ(to_toml(-0.0), "-0.0");
  EXPECT_EQ(to_toml(std::string_view("a\"\\\n\x01")), "\"a\\\"\\\\\\u000A\\u0001\"");
}

TEST(Names, DistanceCountsSwapsOfNeighboursOnce) {
  EXPECT_EQ(edit_distance("", ""), 0u);
  EXPECT_EQ(edit_distance("abc", ""), 3u);
  EXPECT_EQ(edit_distance("", "ab"), 2u);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3u);
  EXPECT_EQ(edit_distance("fusoin", "fusion"), 1u);
  EXPECT_EQ(edit_distance("ca", "abc"), 3u);
}

TEST(Names, OnlyANearNameIsOffered) {
  const std::vector<std::string> known = {"period_s", "phase", "phase_s", "policy"};
  EXPECT_EQ(nearest_name("perod_s", known), "period_s");
  EXPECT_EQ(nearest_name("phases", known), "phase");
  EXPECT_EQ(nearest_name("polizy", known), "policy");
  EXPECT_EQ(nearest_name("colour", known), std::nullopt);
  EXPECT_EQ(nearest_name("", known), std::nullopt);
  EXPECT_EQ(nearest_name("x", {}), std::nullopt);
}

}  // namespace
}  // namespace hearsay
