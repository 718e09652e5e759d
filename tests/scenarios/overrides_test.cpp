// --set, and what is laid over a file in general.
#include <gtest/gtest.h>

#include "rule_names.hpp"
#include "scenarios/schema.hpp"
#include "temp_files.hpp"

namespace hearsay {
namespace {

class Overrides : public InTempDirectory {
 protected:
  static Scenario load(const std::vector<std::string>& set) {
    write("s.toml", ring + "\n[[agents]]\nname = \"extra\"\n");
    return load_scenario("s.toml", sets(set), {});
  }
  static std::string error(const std::vector<std::string>& set) {
    return error_of([&] { load(set); });
  }
};

TEST_F(Overrides, AKeyWithoutANumberSetsEveryAgentAndOneWithItThatOne) {
  const Scenario all = load({"agents.talk.period_s=2.5"});
  EXPECT_EQ(all.agents[0].talk.period_s, 2.5);
  EXPECT_EQ(all.agents[1].talk.period_s, 2.5);
  const Scenario one = load({"agents[1].talk.period_s=2.5"});
  EXPECT_EQ(one.agents[0].talk.period_s, 5.0);
  EXPECT_EQ(one.agents[1].talk.period_s, 2.5);
}

TEST_F(Overrides, LaterOnesWin) {
  const Scenario s =
      load({"agents[1].talk.period_s=2", "agents.talk.period_s=3", "seed=4", "seed=5"});
  EXPECT_EQ(s.agents[1].talk.period_s, 3.0);
  EXPECT_EQ(s.seed, 5u);
}

TEST_F(Overrides, ABareWordIsAString) {
  EXPECT_EQ(load({"agents.estimator.fusion=naive"}).agents[0].estimator.fusion, "naive");
  EXPECT_EQ(load({"agents.estimator.fusion=\"naive\""}).agents[0].estimator.fusion, "naive");
  EXPECT_EQ(load({"radio.topology = full"}).radio.topology, "full");
  EXPECT_EQ(load({"world.targets[0].name=../a b"}).world.targets[0].name, "../a b");
}

TEST_F(Overrides, ValuesAreToml) {
  EXPECT_EQ(load({"world.targets.position_m=[1, -2]"}).world.targets[0].position_m,
            (std::vector{1.0, -2.0}));
  EXPECT_EQ(load({"record.series=[\"a\", \"b\"]"}).record.series.size(), 2u);
  EXPECT_EQ(load({"radio.rate_bps=1_000"}).radio.rate_bps, 1000.0);
}

TEST_F(Overrides, WhatTheFileDoesNotMentionCanBeSet) {
  const Scenario s = load({"agents[1].circle.radius_m=3", "agents.parameters.gain=0.5"});
  EXPECT_EQ(s.agents[1].circle->radius_m, 3.0);
  EXPECT_EQ(s.agents[0].parameters.at("gain"), 0.5);
}

TEST_F(Overrides, ATableReplacesTheOneInTheFile) {
  const Scenario s = load({"agents[0].sensor={kind=\"none\"}"});
  EXPECT_EQ(s.agents[0].sensor.kind, "none");
  EXPECT_EQ(s.agents[0].sensor.sigma_m, std::nullopt);
  EXPECT_EQ(load({"agents[1]={count=3}"}).agent_count(), 7);
  EXPECT_EQ(load({"agents=[{count=3}]"}).agent_count(), 3);
}

TEST_F(Overrides, ErrorsNameTheOptionInPlaceOfALine) {
  EXPECT_EQ(error({"agents[0].sensor.period_s=-1"}),
            "--set agents[0].sensor.period_s=-1: agents[0].sensor.period_s = -1: must be greater "
            "than 0");
  EXPECT_EQ(error({"agents.estimator.fusion=ci-dett"}),
            "--set agents.estimator.fusion=ci-dett: agents[0].estimator.fusion = \"ci-dett\": "
            "unknown; did you mean 'ci-det'?");
  EXPECT_EQ(error({"radio.topology=disk"}),
            "--set radio.topology=disk: radio.topology: \"disk\" needs radio.range_m above 0");
  EXPECT_EQ(error({"radio.loss={probablity=0.5}"}),
            "--set radio.loss={probablity=0.5}: unknown key 'probablity' in [radio.loss]; did you "
            "mean 'probability'?");
  EXPECT_EQ(error({"agents.parameters.gain=high"}),
            "--set agents.parameters.gain=high: agents[0].parameters.gain = \"high\": expected a "
            "number, found a string");
}

TEST_F(Overrides, AKeyThatIsNotInTheSchemaIsRefused) {
  EXPECT_EQ(error({"agents.sensr.period_s=1"}),
            "--set agents.sensr.period_s=1: unknown key 'agents.sensr.period_s'; did you mean "
            "'agents.sensor.period_s'?");
  EXPECT_EQ(error({"agents[1].talk.perid_s=1"}),
            "--set agents[1].talk.perid_s=1: unknown key 'agents[1].talk.perid_s'; did you mean "
            "'agents[1].talk.period_s'?");
  EXPECT_EQ(error({"loss.probability=1"}),
            "--set loss.probability=1: unknown key 'loss.probability'; did you mean "
            "'radio.loss.probability'?");
  EXPECT_EQ(error({"radio.loss.chance=1"}),
            "--set radio.loss.chance=1: unknown key 'radio.loss.chance'; allowed in [radio.loss]: "
            "model, probability, links, mean_burst, good_to_bad, bad_to_good, loss_good, loss_bad");
  EXPECT_EQ(error({"seed.x=1"}), "--set seed.x=1: unknown key 'seed.x'; 'seed' is not a table");
  EXPECT_EQ(error({"radio[0].rate_bps=1"}),
            "--set radio[0].rate_bps=1: unknown key 'radio[0].rate_bps'; 'radio' takes no number "
            "in brackets");
  for (const std::string key : {"a..b", ".a", "a.", "agents[", "agents[]", "agents[-1]",
                                "agents[x]", "agents[1]x", "[1]", "agents[99999999999]"}) {
    EXPECT_EQ(error({key + "=1"}), "--set " + key + "=1: '" + key +
                                       "' is not a key; keys look like agents[1].talk.period_s");
  }
}

TEST_F(Overrides, AnElementThatIsNotInTheFileIsRefused) {
  EXPECT_EQ(error({"agents[2].count=1"}),
            "--set agents[2].count=1: there is no agents[2]; in the file: 0 … 1");
  EXPECT_EQ(error({"world={}", "world.targets.name=a"}),
            "--set world.targets.name=a: there is no 'targets' in the file to set");
}

TEST_F(Overrides, SetNeedsAKeyAndAValue) {
  EXPECT_EQ(error_of([] { parse_set("seed"); }), "--set needs key=value, found 'seed'");
  EXPECT_EQ(error_of([] { parse_set("seed="); }), "--set needs key=value, found 'seed='");
  EXPECT_EQ(error_of([] { parse_set(" = 3"); }), "--set needs key=value, found ' = 3'");
  EXPECT_EQ(error_of([] { parse_set(""); }), "--set needs key=value, found ''");
  EXPECT_EQ(error_of([] {
              parse_set("record.series=[1,");
            }).starts_with("--set record.series=[1,: the value is not TOML: "),
            true);
  EXPECT_EQ(error_of([] {
              parse_set("seed=\"a");
            }).starts_with("--set seed=\"a: the value is not TOML: "),
            true);
}

TEST_F(Overrides, AValueCannotSmuggleInFurtherKeys) {
  EXPECT_EQ(error({"seed=1\nevents_max=2"}).substr(0, 5), "--set");
}

TEST_F(Overrides, OnlyTheSameKeyOrItsTableCoversAnEarlierSetting) {
  const auto covered = [](const char* later, const char* earlier) {
    return covers(parse_key(later, ""), parse_key(earlier, ""));
  };
  EXPECT_TRUE(covered("radio.loss", "radio.loss.model"));
  EXPECT_TRUE(covered("seed", "seed"));
  EXPECT_TRUE(covered("agents.count", "agents[1].count"));
  EXPECT_FALSE(covered("agents[1].count", "agents.count"));
  EXPECT_FALSE(covered("agents[1].count", "agents[0].count"));
  EXPECT_FALSE(covered("radio.loss.model", "radio.loss"));
}

TEST(Schema, ListsEveryKeyWithTypeDefaultAndRange) {
  KnownNames names;
  names.agent_kinds = {"estimator", "gossip"};
  std::map<std::string, KeyInfo> keys;
  for (const KeyInfo& key : schema_keys(names)) {
    EXPECT_TRUE(keys.emplace(key.path, key).second) << key.path;
    EXPECT_FALSE(key.meaning.empty()) << key.path;
    EXPECT_NO_THROW(parse_key(key.path, "")) << key.path;
  }
  const KeyInfo& rate = keys.at("radio.rate_bps");
  EXPECT_EQ(rate.type, "number");
  EXPECT_EQ(rate.default_value, "1e+06");
  EXPECT_EQ(rate.allowed, "> 0");
  EXPECT_EQ(keys.at("radio.loss.probability").allowed, "0 … 1");
  EXPECT_EQ(keys.at("radio.loss.probability").default_value, "0.0");
  EXPECT_EQ(keys.at("agents.kind").allowed, "estimator | gossip");
  EXPECT_EQ(keys.at("agents.sensor.sigma_m").default_value, "");
  EXPECT_EQ(keys.at("agents.count").type, "integer");
  EXPECT_EQ(keys.at("agents.parameters.*").type, "number");
  EXPECT_EQ(keys.at("world.targets.position_m").type, "2 coordinates");
  EXPECT_EQ(keys.at("world.log.directory").type, "string");
  EXPECT_EQ(keys.at("duration_s").type, "number");
}

}  // namespace
}  // namespace hearsay
