// From files to the models of net, and every way to get a file wrong.
#include "scenarios/channel.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "scenarios/schema.hpp"
#include "temp_files.hpp"

namespace hearsay {
namespace {

class Channel : public InTempDirectory {
 protected:
  // Line 1 is the duration; what is given begins on line 2.
  static Scenario load(const std::string& lines, const std::vector<std::string>& set = {}) {
    write("s.toml", "duration_s = 1\n" + lines + agents);
    return load_scenario("s.toml", sets(set), {});
  }
  static std::string error(const std::string& lines, const std::vector<std::string>& set = {}) {
    return error_of([&] { load(lines, set); });
  }
  static std::string loss_error(const std::string& loss) {
    return error("[radio]\nloss = { " + loss + " }\n");
  }
  static std::string link_error(const std::string& links) {
    return error("[radio]\nloss.model = \"bernoulli\"\nloss.links = [\n" + links + "]\n");
  }
  static std::string by_position(const std::string& propagation) {
    return "[radio]\ntopology = \"by-position\"\npropagation = { " + propagation + " }\n";
  }
  static std::string propagation_error(const std::string& propagation) {
    return error(by_position(propagation));
  }
  static std::string jammer_error(const std::string& jammer) {
    return error("[[radio.jammers]]\n" + jammer);
  }
  static std::string dropout_error(const std::string& dropout) {
    return error("[[dropouts]]\n" + dropout);
  }

  static inline const std::string agents =
      "[[agents]]\nname = \"base\"\nposition_m = [0, 0]\n"
      "[[agents]]\nname = \"a\"\ncount = 2\ncircle = { radius_m = 5 }\n";
};

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

TEST_F(Channel, ALossHasTheKeysOfItsModel) {
  EXPECT_EQ(loss_error("probability = 0.1"),
            "s.toml:3: radio.loss.probability: without effect; set radio.loss.model = "
            "\"bernoulli\", too");
  EXPECT_EQ(loss_error("model = \"bernoulli\", mean_burst = 5"),
            "s.toml:3: radio.loss.mean_burst: only for model = \"gilbert-elliott\"; found "
            "\"bernoulli\"");
  EXPECT_EQ(loss_error("good_to_bad = 0.5"),
            "s.toml:3: radio.loss.good_to_bad: only for model = \"gilbert-elliott\"; found "
            "\"none\"");
  EXPECT_EQ(loss_error("model = \"bernoulli\", bad_to_good = 0.5"),
            "s.toml:3: radio.loss.bad_to_good: only for model = \"gilbert-elliott\"; found "
            "\"bernoulli\"");
  EXPECT_EQ(loss_error("model = \"bernoulli\", loss_good = 0.5"),
            "s.toml:3: radio.loss.loss_good: only for model = \"gilbert-elliott\"; found "
            "\"bernoulli\"");
  EXPECT_EQ(loss_error("model = \"bernoulli\", loss_bad = 0.5"),
            "s.toml:3: radio.loss.loss_bad: only for model = \"gilbert-elliott\"; found "
            "\"bernoulli\"");
  EXPECT_EQ(loss_error("links = [{ from = 0, to = 1, probability = 0.5 }]"),
            "s.toml:3: radio.loss.links: only for model = \"bernoulli\"; found \"none\"");
  EXPECT_EQ(loss_error("model = \"gilbert\""),
            "s.toml:3: radio.loss.model = \"gilbert\": unknown; allowed: none, bernoulli, "
            "gilbert-elliott");
}

TEST_F(Channel, GilbertElliottNeedsOneWholeDescription) {
  const auto bursty = [](const std::string& keys) {
    return loss_error("model = \"gilbert-elliott\"" + keys);
  };
  EXPECT_EQ(bursty(""),
            "s.toml:3: radio.loss.model: \"gilbert-elliott\" needs probability and mean_burst, or "
            "good_to_bad and bad_to_good");
  EXPECT_EQ(bursty(", probability = 0.1"), bursty(""));
  EXPECT_EQ(bursty(", mean_burst = 3, good_to_bad = 0.1"),
            "s.toml:3: radio.loss.mean_burst: not together with good_to_bad and bad_to_good; give "
            "one of them");
  EXPECT_EQ(bursty(", good_to_bad = 0.1"),
            "s.toml:3: radio.loss.good_to_bad: needs bad_to_good, too");
  EXPECT_EQ(bursty(", bad_to_good = 0.1"),
            "s.toml:3: radio.loss.bad_to_good: needs good_to_bad, too");
  EXPECT_EQ(bursty(", good_to_bad = 0.1, bad_to_good = 0.2, probability = 0.3"),
            "s.toml:3: radio.loss.probability: not together with good_to_bad and bad_to_good, "
            "which say how much is lost");
  EXPECT_EQ(bursty(", probability = 0.9, mean_burst = 5"),
            "s.toml:3: radio.loss: a loss rate of 0.9 needs a mean_burst of at least 9 packets, "
            "not 5");
  EXPECT_EQ(bursty(", probability = 1, mean_burst = 5"),
            "s.toml:3: radio.loss: the loss rate must be at least loss_good (0) and below loss_bad "
            "(1), not 1");
  EXPECT_EQ(bursty(", good_to_bad = 1, bad_to_good = 1"),
            "s.toml:3: radio.loss: good_to_bad + bad_to_good must be between 1e-06 and 2 − 1e-06, "
            "not 1 + 1");
  EXPECT_EQ(bursty(", mean_burst = 0.5"),
            "s.toml:3: radio.loss.mean_burst = 0.5: must be between 1 and 1000000");
  EXPECT_EQ(bursty(", good_to_bad = 0.1, bad_to_good = 0"),
            "s.toml:3: radio.loss.bad_to_good = 0: must be greater than 0");
  EXPECT_EQ(bursty(", good_to_bad = 0.1, bad_to_good = 1.5"),
            "s.toml:3: radio.loss.bad_to_good = 1.5: must be at most 1");
  EXPECT_EQ(bursty(", good_to_bad = 2, bad_to_good = 1"),
            "s.toml:3: radio.loss.good_to_bad = 2: must be between 0 and 1");
}

TEST_F(Channel, LinksJoinTwoAgentsThatAreThereOnce) {
  EXPECT_EQ(link_error("{ from = 0, to = 7, probability = 0.5 }"),
            "s.toml:5: radio.loss.links[0].to = 7: there is no agent 7; they are 0 … 2");
  EXPECT_EQ(link_error("{ from = \"bse\", to = 1, probability = 0.5 }"),
            "s.toml:5: radio.loss.links[0].from = \"bse\": there is no such agent; did you mean "
            "'base'?");
  EXPECT_EQ(link_error("{ from = 1.5, to = 1, probability = 0.5 }"),
            "s.toml:5: radio.loss.links[0].from = 1.5: expected the number or name of an agent, "
            "found a number");
  EXPECT_EQ(link_error("{ from = 1, to = \"a0\", probability = 0.5 }"),
            "s.toml:5: radio.loss.links[0]: joins an agent to itself");
  EXPECT_EQ(link_error("{ to = 1, probability = 0.5 }"),
            "s.toml:5: radio.loss.links[0].from: missing");
  EXPECT_EQ(link_error("{ from = 1, probability = 0.5 }"),
            "s.toml:5: radio.loss.links[0].to: missing");
  EXPECT_EQ(link_error("{ from = 1, to = 0 }"),
            "s.toml:5: radio.loss.links[0].probability: missing");
  EXPECT_EQ(link_error("{ from = 1, to = 0, probability = 2 }"),
            "s.toml:5: radio.loss.links[0].probability = 2: must be between 0 and 1");
  EXPECT_EQ(link_error("{ from = 1, to = 0, probability = 0.5 },\n"
                       "{ from = 0, to = 1, probability = 0.5 },\n"
                       "{ from = \"a0\", to = \"base\", probability = 0.1 }\n"),
            "s.toml:7: radio.loss.links[2]: the link from a0 to base stands there twice");
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

TEST_F(Channel, PropagationNeedsATopologyByPositionAndPlaces) {
  EXPECT_EQ(error("[radio]\ntopology = \"by-position\"\n"),
            "s.toml:3: radio.topology: \"by-position\" needs radio.propagation, as { model = "
            "\"disk\", range_m = 100 }");
  EXPECT_EQ(error("[radio]\ntopology = \"ring\"\npropagation = { range_m = 3 }\n"),
            "s.toml:4: radio.propagation: only for topology = \"by-position\"; found \"ring\"");
  EXPECT_EQ(error("[radio]\ntopology = \"disk\"\nrange_m = 3\npropagation = { range_m = 3 }\n"),
            "s.toml:5: radio.propagation: only for topology = \"by-position\"; found \"disk\"");
  EXPECT_EQ(error(by_position("range_m = 3") + "range_m = 3\n"),
            "s.toml:5: radio.range_m: only for topology = \"disk\"; give "
            "radio.propagation.range_m");
  EXPECT_EQ(error(by_position("range_m = 3") + "[[agents]]\n"),
            "s.toml:5: agents[0]: topology = \"by-position\" needs to know where it stands: "
            "position_m or circle");
  EXPECT_EQ(error(by_position("range_m = 3") + "propagation_m_per_s = 343\n"), "no error");
}

TEST_F(Channel, APropagationHasTheKeysOfItsModel) {
  EXPECT_EQ(propagation_error(""), "s.toml:4: radio.propagation.range_m: missing");
  EXPECT_EQ(propagation_error("model = \"grey-zone\""),
            "s.toml:4: radio.propagation.outer_m: missing");
  EXPECT_EQ(propagation_error("model = \"grey-zone\", outer_m = 4, range_m = 5"),
            "s.toml:4: radio.propagation.range_m: only for model = \"disk\" or \"log-distance\"; "
            "found \"grey-zone\"");
  for (const std::string key : {"inner_m = 1", "outer_m = 1"}) {
    EXPECT_EQ(propagation_error("range_m = 5, " + key),
              "s.toml:4: radio.propagation." + key.substr(0, 7) +
                  ": only for model = \"grey-zone\"; found \"disk\"");
  }
  for (const std::string key : {"exponent", "reference_loss_db", "reference_m",
                                "shadowing_sigma_db", "transmit_dbm", "noise_dbm"}) {
    EXPECT_EQ(propagation_error("range_m = 5, " + key + " = 2"),
              "s.toml:4: radio.propagation." + key +
                  ": only for model = \"log-distance\"; found \"disk\"");
  }
  EXPECT_EQ(propagation_error("model = \"two-ray\""),
            "s.toml:4: radio.propagation.model = \"two-ray\": unknown; allowed: disk, grey-zone, "
            "log-distance");
}

TEST_F(Channel, APropagationHasValuesThatCanBe) {
  EXPECT_EQ(propagation_error("range_m = 0"),
            "s.toml:4: radio.propagation.range_m = 0: must be greater than 0");
  EXPECT_EQ(propagation_error("model = \"grey-zone\", inner_m = 9, outer_m = 4"),
            "s.toml:4: radio.propagation: outer_m must be at least inner_m, not 4");
  EXPECT_EQ(propagation_error("model = \"grey-zone\", inner_m = -9, outer_m = 4"),
            "s.toml:4: radio.propagation.inner_m = -9: must be at least 0");
  EXPECT_EQ(propagation_error("model = \"grey-zone\", outer_m = -4"),
            "s.toml:4: radio.propagation.outer_m = -4: must be at least 0");
  const auto log = [](const std::string& key) {
    return propagation_error("model = \"log-distance\", " + key);
  };
  EXPECT_EQ(log("exponent = 0.5"),
            "s.toml:4: radio.propagation.exponent = 0.5: must be between 1 and 10");
  EXPECT_EQ(log("reference_loss_db = 300"),
            "s.toml:4: radio.propagation.reference_loss_db = 300: must be between -200 and 200");
  EXPECT_EQ(log("reference_m = 0"),
            "s.toml:4: radio.propagation.reference_m = 0: must be greater than 0");
  EXPECT_EQ(log("shadowing_sigma_db = -1"),
            "s.toml:4: radio.propagation.shadowing_sigma_db = -1: must be between 0 and 30");
  EXPECT_EQ(log("transmit_dbm = 201"),
            "s.toml:4: radio.propagation.transmit_dbm = 201: must be between -200 and 200");
  EXPECT_EQ(log("noise_dbm = -201"),
            "s.toml:4: radio.propagation.noise_dbm = -201: must be between -200 and 200");
  EXPECT_EQ(log("transmit_dbm = -80"),
            "s.toml:4: radio.propagation: nobody would hear: even at reference_m the signal is "
            "-126.678 dBm against a noise of -105 dBm; raise transmit_dbm or lower "
            "reference_loss_db");
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

TEST_F(Channel, AJammerHasAPlaceAReachAndTimes) {
  const std::string here = "position_m = [0, 0]\n";
  EXPECT_EQ(jammer_error("radius_m = 5\n"), "s.toml:2: radio.jammers[0].position_m: missing");
  EXPECT_EQ(jammer_error("position_m = [0]\nradius_m = 5\n"),
            "s.toml:3: radio.jammers[0].position_m = [0]: must have 2 coordinates");
  EXPECT_EQ(jammer_error(here), "s.toml:2: radio.jammers[0]: needs either radius_m or power_dbm");
  EXPECT_EQ(jammer_error(here + "radius_m = 5\npower_dbm = 5\n"),
            "s.toml:2: radio.jammers[0]: needs either radius_m or power_dbm");
  EXPECT_EQ(jammer_error(here + "radius_m = 0\n"),
            "s.toml:4: radio.jammers[0].radius_m = 0: must be greater than 0");
  EXPECT_EQ(jammer_error(here + "power_dbm = 5\n"),
            "s.toml:4: radio.jammers[0].power_dbm: only for radio.propagation.model = "
            "\"log-distance\", which knows powers; give radius_m");
  EXPECT_EQ(jammer_error(here + "power_dbm = 500\n"),
            "s.toml:4: radio.jammers[0].power_dbm = 500: must be between -200 and 200");
  const std::string five = here + "radius_m = 5\n";
  EXPECT_EQ(jammer_error(five + "from_s = 3\nuntil_s = 3\n"),
            "s.toml:6: radio.jammers[0].until_s: must be after from_s (3.0 s)");
  EXPECT_EQ(jammer_error(five + "from_s = -3\n"),
            "s.toml:5: radio.jammers[0].from_s = -3: must be at least 0");
  EXPECT_EQ(jammer_error(five + "period_s = 3\n"),
            "s.toml:5: radio.jammers[0].period_s: needs duty, too");
  EXPECT_EQ(jammer_error(five + "duty = 0.5\n"),
            "s.toml:5: radio.jammers[0].duty: needs period_s, too");
  EXPECT_EQ(jammer_error(five + "period_s = 3\nduty = 1.5\n"),
            "s.toml:6: radio.jammers[0].duty = 1.5: must be at most 1");
  EXPECT_EQ(jammer_error(five + "period_s = 0\nduty = 0.5\n"),
            "s.toml:5: radio.jammers[0].period_s = 0: must be greater than 0");
  EXPECT_EQ(jammer_error(five + "[[agents]]\n"),
            "s.toml:5: agents[0]: a jammer needs to know where it stands: position_m or circle");
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

TEST_F(Channel, ADropoutIsPlannedOrRandom) {
  EXPECT_EQ(dropout_error(""),
            "s.toml:2: dropouts[0].from_s: missing; give it, or mean_up_s for random times");
  EXPECT_EQ(dropout_error("from_s = 1\nmean_up_s = 2\n"),
            "s.toml:4: dropouts[0].mean_up_s: not together with from_s; give one of them");
  EXPECT_EQ(dropout_error("from_s = 1\nuntil_s = 2\nmean_down_s = 2\n"),
            "s.toml:5: dropouts[0].mean_down_s: only with mean_up_s");
  EXPECT_EQ(dropout_error("mean_up_s = 1\nmean_down_s = 2\nuntil_s = 2\n"),
            "s.toml:5: dropouts[0].until_s: only with from_s");
  EXPECT_EQ(dropout_error("from_s = 1\nuntil_s = 2\noutages_max = 3\n"),
            "s.toml:5: dropouts[0].outages_max: only with mean_down_s");
  EXPECT_EQ(dropout_error("mean_up_s = 1\nmean_down_s = 2\noutages_max = 0\n"),
            "s.toml:5: dropouts[0].outages_max = 0: must be at least 1");
  EXPECT_EQ(dropout_error("mean_up_s = 0\nmean_down_s = 2\n"),
            "s.toml:3: dropouts[0].mean_up_s = 0: must be greater than 0");
  EXPECT_EQ(dropout_error("mean_up_s = 1\nmean_down_s = -2\n"),
            "s.toml:4: dropouts[0].mean_down_s = -2: must be greater than 0");
  EXPECT_EQ(dropout_error("from_s = -1\nuntil_s = 2\n"),
            "s.toml:3: dropouts[0].from_s = -1: must be at least 0");
  EXPECT_EQ(dropout_error("from_s = 2\nuntil_s = 2\n"),
            "s.toml:4: dropouts[0].until_s: must be after from_s (2.0 s)");
}

TEST_F(Channel, OnlyTheDeadStayAway) {
  const std::string die = "kind = \"die\"\n";
  EXPECT_EQ(dropout_error("from_s = 1\n"),
            "s.toml:2: dropouts[0].until_s: missing; only with kind = \"die\" is an outage "
            "without end");
  EXPECT_EQ(dropout_error("mean_up_s = 1\n"),
            "s.toml:2: dropouts[0].mean_down_s: missing; only with kind = \"die\" is an outage "
            "without end");
  EXPECT_EQ(dropout_error(die + "from_s = 1\nuntil_s = 2\n"),
            "s.toml:5: dropouts[0].until_s: not for kind = \"die\", from which nobody comes back");
  EXPECT_EQ(dropout_error(die + "mean_up_s = 1\nmean_down_s = 2\n"),
            "s.toml:5: dropouts[0].mean_down_s: not for kind = \"die\", from which nobody comes "
            "back");
  EXPECT_EQ(dropout_error(die + "mean_up_s = 1\noutages_max = 2\n"),
            "s.toml:5: dropouts[0].outages_max: only with mean_down_s");
  EXPECT_EQ(dropout_error(die + "memory = true\nmean_up_s = 1\n"),
            "s.toml:4: dropouts[0].memory: only for kind = \"reboot\"; found \"die\"");
  EXPECT_EQ(dropout_error("memory = 1\nmean_up_s = 1\n"),
            "s.toml:3: dropouts[0].memory = 1: expected true or false, found an integer");
  EXPECT_EQ(dropout_error("kind = \"faint\"\n"),
            "s.toml:3: dropouts[0].kind = \"faint\": unknown; allowed: die, sleep, reboot");
}

TEST_F(Channel, ADropoutBefallsAgentsThatAreThereOnce) {
  const std::string times = "from_s = 1\nuntil_s = 2\n";
  EXPECT_EQ(dropout_error("agents = [\"a\"]\n" + times),
            "s.toml:3: dropouts[0].agents[0] = \"a\": there is no such agent; did you mean 'a0'?");
  EXPECT_EQ(dropout_error("agents = [0, 3]\n" + times),
            "s.toml:3: dropouts[0].agents[1] = 3: there is no agent 3; they are 0 … 2");
  EXPECT_EQ(dropout_error("agents = [1, \"a0\"]\n" + times),
            "s.toml:3: dropouts[0].agents[1] = \"a0\": stands there twice");
  EXPECT_EQ(dropout_error("agents = [true]\n" + times),
            "s.toml:3: dropouts[0].agents[0] = true: expected the number or name of an agent, "
            "found a boolean");
  EXPECT_EQ(dropout_error("agents = 1\n" + times),
            "s.toml:3: dropouts[0].agents = 1: expected an array of agents, found an integer");
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
