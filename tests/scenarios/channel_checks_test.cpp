// Every way to get a channel or a failure wrong.
#include <gtest/gtest.h>

#include "channel_bed.hpp"

namespace hearsay {
namespace {

class ChannelChecks : public ChannelBed {
 protected:
  static std::string loss_error(const std::string& loss) {
    return error("[radio]\nloss = { " + loss + " }\n");
  }
  static std::string link_error(const std::string& links) {
    return error("[radio]\nloss.model = \"bernoulli\"\nloss.links = [\n" + links + "]\n");
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
};

TEST_F(ChannelChecks, ALossHasTheKeysOfItsModel) {
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

TEST_F(ChannelChecks, GilbertElliottNeedsOneWholeDescription) {
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

TEST_F(ChannelChecks, LinksJoinTwoAgentsThatAreThereOnce) {
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

TEST_F(ChannelChecks, PropagationNeedsATopologyByPositionAndPlaces) {
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
            "position_m, circle or motion");
  EXPECT_EQ(error(by_position("range_m = 3") + "propagation_m_per_s = 343\n"), "no error");
}

TEST_F(ChannelChecks, APropagationHasTheKeysOfItsModel) {
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

TEST_F(ChannelChecks, APropagationHasValuesThatCanBe) {
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

TEST_F(ChannelChecks, AJammerHasAPlaceAReachAndTimes) {
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
  EXPECT_EQ(
      jammer_error(five + "[[agents]]\n"),
      "s.toml:5: agents[0]: a jammer needs to know where it stands: position_m, circle or motion");
}

TEST_F(ChannelChecks, ADropoutIsPlannedOrRandom) {
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

TEST_F(ChannelChecks, OnlyTheDeadStayAway) {
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

TEST_F(ChannelChecks, ADropoutBefallsAgentsThatAreThereOnce) {
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

}  // namespace
}  // namespace hearsay
