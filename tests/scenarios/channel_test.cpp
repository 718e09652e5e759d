#include "scenarios/channel.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "channel_bed.hpp"
#include "scenarios/schema.hpp"

namespace hearsay {
namespace {

class Channel : public ChannelBed {};

TEST_F(Channel, WithoutALossLosesNothing) {
  EXPECT_TRUE(loss_of(load("").radio.loss).never());
  EXPECT_TRUE(loss_of(load("radio.loss.model = \"bernoulli\"\n").radio.loss).never());
}

TEST_F(Channel, BernoulliTakesProbabilityAndLinks) {
  const Scenario s = load(
      "[radio.loss]\nmodel = \"bernoulli\"\nprobability = 0.25\n"
      "[[radio.loss.links]]\nfrom = \"base\"\nto = 2\nprobability = 1\n"
      "[[radio.loss.links]]\nfrom = \"a1\"\nto = \"base\"\nprobability = 0.5\n");
  EXPECT_EQ(s.radio.loss.links[0].to, AgentRef{2});
  EXPECT_EQ(s.radio.loss.links[1].from, AgentRef{2});
  const Loss loss = loss_of(s.radio.loss);
  const Loss plain = Loss::bernoulli(0.25);
  const Loss half = Loss::bernoulli(0.5);
  for (std::uint64_t i = 0; i < 200; ++i) {
    const auto on = [&](AgentId from, AgentId to) {
      return PacketOnLink{.seed = 1, .from = from, .to = to, .index = i};
    };
    EXPECT_TRUE(loss.lost(on(0, 2)));
    EXPECT_EQ(loss.lost(on(2, 0)), half.lost(on(2, 0)));
    EXPECT_EQ(loss.lost(on(0, 1)), plain.lost(on(0, 1)));
  }
}

TEST_F(Channel, GilbertElliottComesByBurstOrByItsChain) {
  const GilbertElliott by_burst = chain_of(
      load("[radio.loss]\nmodel = \"gilbert-elliott\"\nprobability = 0.2\nmean_burst = 5\n")
          .radio.loss);
  EXPECT_DOUBLE_EQ(by_burst.bad_to_good, 0.2);
  EXPECT_DOUBLE_EQ(by_burst.loss_rate(), 0.2);
  const Scenario s = load(
      "[radio.loss]\nmodel = \"gilbert-elliott\"\ngood_to_bad = 0.1\nbad_to_good = 0.3\n"
      "loss_good = 0.05\nloss_bad = 0.9\n");
  const GilbertElliott chain = chain_of(s.radio.loss);
  EXPECT_EQ(chain.good_to_bad, 0.1);
  EXPECT_EQ(chain.bad_to_good, 0.3);
  EXPECT_EQ(chain.loss_good, 0.05);
  EXPECT_EQ(chain.loss_bad, 0.9);
  EXPECT_FALSE(loss_of(s.radio.loss).never());
  // A study's axis of loss rates begins with none.
  EXPECT_EQ(chain_of(load("[radio.loss]\nmodel = \"gilbert-elliott\"\nmean_burst = 5\n").radio.loss)
                .loss_rate(),
            0.0);
}

TEST_F(Channel, PropagationIsThatOfTheTopology) {
  const auto reach_m = [](const std::string& lines) {
    return propagation_of(load(lines).radio).reach_m();
  };
  EXPECT_TRUE(std::isinf(reach_m("")));
  EXPECT_EQ(reach_m("[radio]\ntopology = \"disk\"\nrange_m = 30\n"), 30.0);
  EXPECT_EQ(reach_m(by_position("model = \"disk\", range_m = 40")), 40.0);
  EXPECT_EQ(reach_m(by_position("model = \"grey-zone\", inner_m = 20, outer_m = 60")), 60.0);
  EXPECT_EQ(reach_m(by_position("model = \"log-distance\", range_m = 70")), 70.0);
  EXPECT_EQ(reach_m(by_position("model = \"log-distance\"")),
            Propagation::log_distance({}).reach_m());
}

TEST_F(Channel, EveryParameterOfLogDistanceArrives) {
  const Scenario s = load(by_position(
      "model = \"log-distance\", exponent = 2.4, reference_loss_db = 40, reference_m = 2, "
      "shadowing_sigma_db = 4, transmit_dbm = 10, noise_dbm = -95"));
  const Propagation model = propagation_of(s.radio);
  EXPECT_EQ(model.received_dbm(2.0), -30.0);
  EXPECT_NEAR(model.received_dbm(20.0), -54.0, 1e-12);
  EXPECT_EQ(model.quality(2.0).snr_db, 65.0);
  EXPECT_EQ(model.shadowing_db(1, 0, 1),
            4.0 * Stream(1, Purpose("shadowing"), Entity::link(0, 1)).normal());
  const PropagationSpec spec;
  const LogDistance plain = log_distance_of(spec);
  EXPECT_EQ(plain.exponent, LogDistance{}.exponent);
  EXPECT_EQ(plain.reference_loss_db, LogDistance{}.reference_loss_db);
  EXPECT_EQ(plain.reference_m, LogDistance{}.reference_m);
  EXPECT_EQ(plain.shadowing_sigma_db, LogDistance{}.shadowing_sigma_db);
  EXPECT_EQ(plain.transmit_dbm, LogDistance{}.transmit_dbm);
  EXPECT_EQ(plain.noise_dbm, LogDistance{}.noise_dbm);
}

TEST_F(Channel, JammersArrive) {
  const Scenario s =
      load(by_position("model = \"log-distance\", exponent = 2, reference_loss_db = 40") +
           "[[radio.jammers]]\nposition_m = [3, 4]\nradius_m = 5\nfrom_s = 1\nuntil_s = 2\n"
           "[[radio.jammers]]\nposition_m = [0, 10]\npower_dbm = 20\nperiod_s = 1\nduty = 0.25\n");
  const Jammers jammers = jammers_of(s.radio);
  const auto at = [](double t_s) { return Time::at(Duration::seconds(t_s)); };
  EXPECT_TRUE(jammers.jams({0, 0, 0}, at(1.5), at(1.6)));
  EXPECT_FALSE(jammers.jams({0, 0, 0}, at(0.5), at(0.6)));
  EXPECT_FALSE(jammers.jams({0, 0, 0}, at(2.0), at(3.0)));
  const Propagation path = propagation_of(s.radio);
  EXPECT_NEAR(jammers.interference_mw({0, 0, 0}, at(7.1), at(7.2), path), 1e-4, 1e-12);
  EXPECT_EQ(jammers.interference_mw({0, 0, 0}, at(7.3), at(7.9), path), 0.0);
  EXPECT_TRUE(jammers_of(load("").radio).none());
}

TEST_F(Channel, DropoutsArrive) {
  const Scenario s = load(
      "[[dropouts]]\nagents = [\"base\"]\nfrom_s = 3\nuntil_s = 5\n"
      "[[dropouts]]\nagents = [\"a1\", 0]\nkind = \"die\"\nfrom_s = 7\n"
      "[[dropouts]]\nkind = \"reboot\"\nmean_up_s = 2\nmean_down_s = 1\noutages_max = 2\n"
      "[[dropouts]]\nagents = [1]\nkind = \"reboot\"\nmemory = true\nmean_up_s = 1e5\n"
      "mean_down_s = 1\n");
  EXPECT_EQ(s.dropouts[1].agents, (std::vector<AgentRef>{{2}, {0}}));
  const auto at = [](double t_s) { return Time::at(Duration::seconds(t_s)); };
  const OutageRate churn{.mean_up_s = 2.0, .mean_down_s = 1.0, .forgets = true, .outages_max = 2};
  Dropouts::Options expected{.seed = 4,
                             .end = at(1e6),
                             .schedule = {{0, at(3), at(5)}, {2, at(7)}, {0, at(7)}},
                             .rates = {churn, churn, churn, {1, 1e5, 1.0}}};
  for (AgentId a = 0; a < 3; ++a) expected.rates[static_cast<std::size_t>(a)].agent = a;
  Dropouts wanted(expected);
  Dropouts found = dropouts_of(s, 4, at(1e6));
  for (AgentId a = 0; a < 3; ++a) {
    for (int n = 0; n < 12; ++n) EXPECT_EQ(found.next(a), wanted.next(a)) << a << ", " << n;
  }
  EXPECT_TRUE(dropouts_of(load(""), 4, at(1)).agents().empty());
}

TEST_F(Channel, SettingsReachTheElementsOfItsTables) {
  const std::string lines =
      "[[radio.jammers]]\nposition_m = [0, 0]\nradius_m = 5\n[[dropouts]]\nmean_up_s = 3\n"
      "mean_down_s = 1\n[[dropouts]]\nmean_up_s = 4\nmean_down_s = 1\n";
  const Scenario s = load(
      lines, {"radio.jammers.radius_m=7", "dropouts.mean_down_s=2", "dropouts[1].mean_up_s=9"});
  EXPECT_EQ(s.radio.jammers[0].radius_m, 7.0);
  EXPECT_EQ(s.dropouts[0].mean_down_s, 2.0);
  EXPECT_EQ(s.dropouts[0].mean_up_s, 3.0);
  EXPECT_EQ(s.dropouts[1].mean_up_s, 9.0);
  EXPECT_EQ(error("", {"dropouts.mean_up_s=9"}),
            "--set dropouts.mean_up_s=9: there is no 'dropouts' in the file to set");
  EXPECT_EQ(error(lines, {"radio.jammers[1].duty=1"}),
            "--set radio.jammers[1].duty=1: there is no jammers[1]; in the file: 0 … 0");
  EXPECT_EQ(load("", {"radio.loss={model=\"bernoulli\"}",
                      "radio.loss.links=[{from=\"base\", to=1, probability=0.5}]"})
                .radio.loss.links.at(0)
                .from,
            AgentRef{0});
}

TEST_F(Channel, CanonicalTextIsItselfAScenario) {
  const Scenario s =
      load(by_position("model = \"log-distance\", shadowing_sigma_db = 4") +
           "[[radio.jammers]]\nposition_m = [0, 0]\npower_dbm = 5\nperiod_s = 1\nduty = 0.5\n"
           "[radio.loss]\nmodel = \"bernoulli\"\nprobability = 0.1\n"
           "links = [{ from = \"a1\", to = \"base\", probability = 1 }]\n"
           "[[dropouts]]\nagents = [\"a0\"]\nkind = \"reboot\"\nmemory = true\nmean_up_s = 3\n"
           "mean_down_s = 1\noutages_max = 5\n");
  const std::string text = canonical_text(s);
  EXPECT_NE(text.find("from = 2, to = 0"), std::string::npos) << text;
  EXPECT_NE(text.find("agents = [1]"), std::string::npos) << text;
  EXPECT_NE(text.find("memory = true"), std::string::npos) << text;
  write("again.toml", text);
  EXPECT_EQ(canonical_text(load_scenario("again.toml", {}, {})), text);
  for (const std::string model :
       {"model = \"disk\", range_m = 5", "model = \"grey-zone\", outer_m = 5"}) {
    write("again.toml", canonical_text(load(by_position(model))));
    EXPECT_NO_THROW(load_scenario("again.toml", {}, {}));
  }
}

TEST(ChannelSchema, SaysWhatItsKeysTake) {
  std::map<std::string, KeyInfo> keys;
  for (const KeyInfo& key : schema_keys()) keys[key.path] = key;
  EXPECT_EQ(keys.at("radio.loss.bad_to_good").allowed, "> 0 … 1");
  EXPECT_EQ(keys.at("radio.loss.links.from").type, "agent");
  EXPECT_EQ(keys.at("radio.propagation.exponent").default_value, "3.0");
  EXPECT_EQ(keys.at("radio.propagation.noise_dbm").allowed, "-200 … 200");
  EXPECT_EQ(keys.at("radio.jammers.position_m").type, "2 coordinates");
  EXPECT_EQ(keys.at("dropouts.agents").type, "array of agents");
  EXPECT_EQ(keys.at("dropouts.memory").type, "boolean");
  EXPECT_EQ(keys.at("dropouts.memory").default_value, "");
}

}  // namespace
}  // namespace hearsay
