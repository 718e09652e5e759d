// What scenarios of explorers must not say: refused with file, line, key and what is allowed.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/scenarios/explorer_bed.hpp"

namespace hearsay {
namespace {

const std::string scenario = R"(duration_s = 30
[world]
area = { columns = 8, rows = 6, cell_m = 5.0 }
targets = [{ name = "alarm", position_m = [12.5, 17.5] }]
[radio]
topology = "full"
[record]
series = ["cells_hearsay"]
[[agents]]
kind = "explorer"
position_m = [2.5, 2.5]
motion = { kind = "steered", altitude_m = 20 }
exploration = { speed_m_per_s = 5 }
sensor = { kind = "presence", detector = "infrared", range_max_m = 60, angle_max_rad = 0.5 }
grid = { fusion = "naive" }
talk = { period_s = 5 }
)";

class ExplorerChecks : public ExplorerBed {
 protected:
  struct Change {
    std::string from, to;
  };
  std::string changed(const std::vector<Change>& changes) {
    std::string text = scenario;
    for (const Change& change : changes) text = with(text, change.from, change.to);
    return error(text);
  }
  std::string changed(const std::string& from, const std::string& to) {
    return changed({{from, to}});
  }
  std::string grid(const std::string& keys) {
    return changed("grid = { fusion = \"naive\" }", "grid = { " + keys + " }");
  }
  std::string talk(const std::string& keys) { return changed("period_s = 5", keys); }
  std::string exploration(const std::string& keys) {
    return changed("exploration = { ", "exploration = { " + keys + ", ");
  }
  std::string presence(const std::string& keys) {
    return changed("sensor = { kind = \"presence\", ", "sensor = { kind = \"presence\", " + keys);
  }
  std::string camera(const std::string& keys) {
    return changed(
        "kind = \"presence\", detector = \"infrared\", range_max_m = 60, angle_max_rad = 0.5",
        "kind = \"segmented-camera\", detector = \"infrared\", range_max_m = 60" + keys);
  }
  std::string other_agent(const std::string& kind, const std::string& keys = "") {
    return error(scenario + "[[agents]]\nkind = \"" + kind + "\"\n" + keys);
  }
};

TEST_F(ExplorerChecks, TheseAreFine) {
  EXPECT_EQ(error(scenario), "no error");
  EXPECT_EQ(camera(", image_px = [1, 1]"), "no error");
  EXPECT_EQ(camera(", image_px = [4096, 64], sigma_pixel = 0.5, depression_rad = 0.01"),
            "no error");
  EXPECT_EQ(changed("{ name = \"alarm\", position_m = [12.5, 17.5] }", "{}, {}"), "no error");
  EXPECT_EQ(changed("targets = [{ name = \"alarm\", position_m = [12.5, 17.5] }]", ""), "no error");
  EXPECT_EQ(other_agent("source"), "no error");
  EXPECT_EQ(exploration("vehicle = \"constant-speed\", headings = 63, turn_max_rad = 3.14"),
            "no error");
  EXPECT_EQ(grid("belief = \"beta\", fusion = \"averaged-parameters\", omega = 0, prior_alpha = 9, "
                 "prior_beta = 0.5, message = \"changed\", whole_every = 1"),
            "no error");
  EXPECT_EQ(grid("fusion = \"linear-pool\", omega = 1, prior = 0.000001, log_odds_max = 14, "
                 "packet_bytes_max = 64, message = \"runs\""),
            "no error");
  EXPECT_EQ(talk("policy = \"never\""), "no error");
  EXPECT_EQ(talk("service = \"acknowledged\""), "no error");
}

TEST_F(ExplorerChecks, TyposGetTheNearestName) {
  EXPECT_EQ(changed("columns", "colums"),
            "s.toml:3: unknown key 'colums' in [world.area]; did you mean 'columns'?");
  EXPECT_EQ(grid("beleif = \"beta\""),
            "s.toml:15: unknown key 'beleif' in [agents[0].grid]; did you mean 'belief'?");
  EXPECT_EQ(exploration("horizon_cell = 3"),
            "s.toml:13: unknown key 'horizon_cell' in [agents[0].exploration]; did you mean "
            "'horizon_cells'?");
  EXPECT_EQ(changed("[record]\n", "[record]\nalarms = { treshold = [0.5] }\n"),
            "s.toml:8: unknown key 'treshold' in [record.alarms]; did you mean 'thresholds'?");
  EXPECT_EQ(grid("fusion = \"maximun\""),
            "s.toml:15: agents[0].grid.fusion = \"maximun\": unknown; allowed: none, naive, "
            "channel, channel-robust, maximum, strongest, dictatorship, geometric-mean, "
            "linear-pool, elementwise-maximum, averaged-parameters; did you mean 'maximum'?");
  EXPECT_EQ(changed("\"infrared\"", "\"infared\""),
            "s.toml:14: agents[0].sensor.detector = \"infared\": unknown; "
            "allowed: infrared, visual, combined; did you mean 'infrared'?");
  EXPECT_EQ(changed("\"cells_hearsay\"", "\"cells_hearsey\""),
            "s.toml:8: record.series[0] = \"cells_hearsey\": unknown; did you mean "
            "'cells_hearsay'?");
}

TEST_F(ExplorerChecks, AnAreaIsThereForExplorersAlone) {
  const std::string lone = "duration_s = 9\nworld = { area = {} }\n[[agents]]\nkind = \"source\"\n";
  EXPECT_EQ(error(lone), "s.toml:2: world.area: without effect: no agent is of kind \"explorer\"");
  EXPECT_EQ(changed("area = { columns = 8, rows = 6, cell_m = 5.0 }", ""),
            "s.toml:2: world.area: missing; agents of kind \"explorer\" need cells to explore");
  EXPECT_EQ(changed("columns = 8", "columns = 4097"),
            "s.toml:3: world.area.columns = 4097: must be between 1 and 4096");
  EXPECT_EQ(changed("cell_m = 5.0", "cell_m = 2e7"),
            "s.toml:3: world.area: must lie within 100000 km of the origin");
  EXPECT_EQ(changed("cell_m = 5.0", "origin_m = [0, -1.1e8]"),
            "s.toml:3: world.area: must lie within 100000 km of the origin");
  EXPECT_EQ(changed({{"columns = 8, rows = 6", "columns = 4000, rows = 2500"},
                     {"kind = \"explorer\"", "kind = \"explorer\"\ncount = 101"}}),
            "s.toml:3: world.area: has more than 1e9 cells, for all explorers together");
  EXPECT_EQ(changed({{"targets = [{ name = \"alarm\", position_m = [12.5, 17.5] }]",
                      "[world.log]\ndirectory = \"d\""},
                     {"topology = \"full\"",
                      "topology = \"full\"\n[[agents]]\nkind = "
                      "\"source\"\nsensor = { kind = \"log\" }"}}),
            "s.toml:3: world.area: not with [world.log]");
}

TEST_F(ExplorerChecks, TargetsStandStillInTheArea) {
  EXPECT_EQ(changed("[12.5, 17.5]", "[40, 17.5]"),
            "s.toml:4: world.targets[0].position_m: lies outside world.area");
  EXPECT_EQ(changed("[12.5, 17.5]", "[0, 0]"), "no error");
  EXPECT_EQ(changed({{"[12.5, 17.5] }", "[12.5, 17.5], motion = { kind = \"hover\" } }"},
                     {"[world]", "[world]\nstep_s = 1"}}),
            "s.toml:5: world.targets[0].motion: grids are about what stands still");
}

TEST_F(ExplorerChecks, AlarmsAndRecordedGridsAreOfExplorers) {
  const std::string lone = "duration_s = 9\nrecord = { KEYS }\n[[agents]]\nkind = \"source\"\n";
  EXPECT_EQ(error(with(lone, "KEYS", "alarms = { gate_m = 3 }")),
            "s.toml:2: record.alarms: without effect: no agent is of kind \"explorer\"");
  EXPECT_EQ(error(with(lone, "KEYS", "grids = \"on\"")),
            "s.toml:2: record.grids: without effect: no agent is of kind \"explorer\"");
  const auto record = [&](const std::string& keys) {
    return changed("[record]\n", "[record]\n" + keys + "\n");
  };
  EXPECT_EQ(record("alarms = { thresholds = [0.5, 0.5] }"),
            "s.toml:8: record.alarms.thresholds: must rise");
  EXPECT_EQ(record("alarms = { thresholds = [0.5, 0.4] }"),
            "s.toml:8: record.alarms.thresholds: must rise");
  EXPECT_EQ(record("alarms = { thresholds = [1] }"),
            "s.toml:8: record.alarms.thresholds[0] = 1: must be between 1e-09 and 0.999999999");
  std::string many = "0.001";
  for (int i = 2; i <= 100; ++i) many += ", " + std::to_string(0.001 * i);
  EXPECT_EQ(record("alarms = { thresholds = [" + many + "] }"), "no error");
  EXPECT_EQ(record("alarms = { thresholds = [" + many + ", 0.5] }"),
            "s.toml:8: record.alarms.thresholds: has more than 100 thresholds");
  const Change on{"[record]\n", "[record]\ngrids = \"on\"\n"};
  EXPECT_EQ(changed({on, {"columns = 8, rows = 6", "columns = 300, rows = 201"}}),
            "s.toml:8: record.grids: more than 60000 cells of an area are not recorded");
  EXPECT_EQ(changed({on,
                     {"columns = 8, rows = 6", "columns = 300, rows = 200"},
                     {"kind = \"explorer\"", "kind = \"explorer\"\ncount = 17"}}),
            "s.toml:8: record.grids: more than a million cells of all agents together are not "
            "recorded");
}

TEST_F(ExplorerChecks, KeysOfTheirSensorsAreForThemAlone) {
  const auto scan = [&](const std::string& key) {
    return other_agent("source", "sensor = { kind = \"scan\", sigma_m = 1, " + key + " }\n");
  };
  const std::string at = "s.toml:19: agents[1].sensor.";
  const std::string both = ": only for kind = \"segmented-camera\" or \"presence\"; found \"scan\"";
  EXPECT_EQ(scan("detector = \"visual\""), at + "detector" + both);
  EXPECT_EQ(scan("p_detect = 0.9"), at + "p_detect" + both);
  EXPECT_EQ(scan("p_false = 0.1"), at + "p_false" + both);
  EXPECT_EQ(scan("depression_rad = 0.5"), at + "depression_rad" + both);
  EXPECT_EQ(scan("angle_max_rad = 0.5"),
            at + "angle_max_rad: only for kind = \"presence\"; found \"scan\"");
  EXPECT_EQ(presence("image_px = [4, 4], "),
            "s.toml:14: agents[0].sensor.image_px: only for kind = \"segmented-camera\"; found "
            "\"presence\"");
  EXPECT_EQ(camera(", angle_max_rad = 1"),
            "s.toml:14: agents[0].sensor.angle_max_rad: only for kind = \"presence\"; found "
            "\"segmented-camera\"");
}

TEST_F(ExplorerChecks, KeysOfExplorersAreForThemAlone) {
  EXPECT_EQ(other_agent("source", "grid = { fusion = \"naive\" }"),
            "s.toml:19: agents[1].grid: only for kind = \"explorer\"; found \"source\"");
  EXPECT_EQ(other_agent("source", "exploration = {}"),
            "s.toml:19: agents[1].exploration: only for kind = \"explorer\"; found \"source\"");
  EXPECT_EQ(other_agent("source", "sensor = { kind = \"presence\" }"),
            "s.toml:19: agents[1].sensor.kind: \"presence\" looks at the cells of grids: only for "
            "kind = \"explorer\"; found \"source\"");
  EXPECT_EQ(other_agent("estimator"),
            "s.toml:18: agents[1].kind: \"estimator\" does not go with agents of kind "
            "\"explorer\"");
}

TEST_F(ExplorerChecks, TheySayWhatTheyCan) {
  EXPECT_EQ(changed("grid = {", "estimator = { fusion = \"naive\" }\ngrid = {"),
            "s.toml:15: agents[0].estimator: without effect: kind = \"explorer\" has agents.grid "
            "instead");
  EXPECT_EQ(talk("policy = \"adaptive\""),
            "s.toml:16: agents[0].talk.policy: kind \"explorer\" knows \"periodic\" and \"never\" "
            "alone; found \"adaptive\"");
  EXPECT_EQ(talk("content = \"diagonal\""),
            "s.toml:16: agents[0].talk.content: kind \"explorer\" has agents.grid.message "
            "instead");
  EXPECT_EQ(talk("service = \"blackboard\""),
            "s.toml:16: agents[0].talk.service: kind \"explorer\" knows \"broadcast\" and "
            "\"acknowledged\" alone; found \"blackboard\"");
  EXPECT_EQ(talk("period_s = 1.1e-7"),
            "s.toml:16: agents[0].talk.period_s: more than 2^28 talks in a run");
}

TEST_F(ExplorerChecks, RulesGoWithTheirGrids) {
  EXPECT_EQ(grid("belief = \"beta\", fusion = \"maximum\""),
            "s.toml:15: agents[0].grid.fusion: \"maximum\" does not go with belief = \"beta\"; "
            "allowed: none, naive, channel, channel-robust, dictatorship, elementwise-maximum, "
            "averaged-parameters");
  EXPECT_EQ(grid("fusion = \"elementwise-maximum\""),
            "s.toml:15: agents[0].grid.fusion: \"elementwise-maximum\" does not go with belief = "
            "\"bernoulli\"; allowed: none, naive, channel, channel-robust, maximum, strongest, "
            "dictatorship, geometric-mean, linear-pool");
  EXPECT_EQ(grid("fusion = \"naive\", omega = 0.5"),
            "s.toml:15: agents[0].grid.omega: without effect under fusion \"naive\"; only with "
            "geometric-mean, linear-pool, averaged-parameters");
  EXPECT_EQ(grid("belief = \"beta\", prior = 0.1"),
            "s.toml:15: agents[0].grid.prior: only for belief = \"bernoulli\"");
  EXPECT_EQ(grid("belief = \"beta\", log_odds_max = 9"),
            "s.toml:15: agents[0].grid.log_odds_max: only for belief = \"bernoulli\"");
  EXPECT_EQ(grid("prior_alpha = 2"),
            "s.toml:15: agents[0].grid.prior_alpha: only for belief = \"beta\"");
  EXPECT_EQ(grid("prior_beta = 2"),
            "s.toml:15: agents[0].grid.prior_beta: only for belief = \"beta\"");
  EXPECT_EQ(grid("prior = 0.9, log_odds_max = 2"),
            "s.toml:15: agents[0].grid.log_odds_max: the prior is believed in more firmly than "
            "that");
  EXPECT_EQ(grid("message = \"runs\", whole_every = 2"),
            "s.toml:15: agents[0].grid.whole_every: only for message = \"changed\"; found "
            "\"runs\"");
  EXPECT_EQ(grid("packet_bytes_max = 63"),
            "s.toml:15: agents[0].grid.packet_bytes_max = 63: must be between 64 and 65000");
}

TEST_F(ExplorerChecks, AMessageIsOfAMillionPacketsAtTheMost) {
  const auto of = [&](const std::string& keys) {
    return changed({{"columns = 8, rows = 6", "columns = 4000, rows = 1750"},
                    {"fusion = \"naive\"", "packet_bytes_max = 64, " + keys},
                    {"topology = \"full\"", "topology = \"full\"\nqueue_packets_max = 1_000_000"}});
  };
  const std::string refused =
      "s.toml:16: agents[0].grid.packet_bytes_max: all cells would take more than 2^20 packets";
  EXPECT_EQ(of("fusion = \"naive\""), "no error");  // seven cells a packet
  EXPECT_EQ(of("fusion = \"naive\", message = \"changed\""), refused);
  EXPECT_EQ(of("fusion = \"naive\", message = \"runs\""), refused);
  EXPECT_EQ(of("fusion = \"naive\", belief = \"beta\""), refused);
  EXPECT_EQ(of("fusion = \"none\", belief = \"beta\""), "no error");
}

TEST_F(ExplorerChecks, AWholeMapFitsIntoTheQueueOfTheRadio) {
  const auto of = [&](const std::string& columns, const std::string& keys = "") {
    return changed({{"columns = 8, rows = 6", "columns = " + columns + ", rows = 7"},
                    {"fusion = \"naive\"", "fusion = \"naive\", packet_bytes_max = 64" + keys}});
  };
  EXPECT_EQ(of("64"), "no error");  // a packet a column
  EXPECT_EQ(of("65"),
            "s.toml:15: agents[0].grid.packet_bytes_max: all cells take 65 packets, but "
            "radio.queue_packets_max is 64");
  EXPECT_EQ(of("65", ", message = \"changed\""), "no error");
}

TEST_F(ExplorerChecks, AllHaveOneKindOfGrid) {
  const auto second = [&](const std::string& keys) {
    return error(scenario +
                 "[[agents]]\nkind = \"explorer\"\nposition_m = [9, 9]\n"
                 "motion = { kind = \"hover\" }\ngrid = { " +
                 keys + " }\n");
  };
  EXPECT_EQ(second("fusion = \"maximum\", message = \"runs\", packet_bytes_max = 99"), "no error");
  const std::string refused =
      "s.toml:21: agents[1].grid: all explorers of a run share belief, prior and limit: they "
      "understand each other, and have one central grid";
  EXPECT_EQ(second("belief = \"beta\""), refused);
  EXPECT_EQ(second("prior = 0.4"), refused);
  EXPECT_EQ(second("log_odds_max = 19"), refused);
  EXPECT_EQ(second("fusion = \"channel-robust\""),
            "s.toml:21: agents[1].grid.fusion: \"channel-robust\" and \"naive\" of another "
            "explorer do not understand each other");
  EXPECT_EQ(second("fusion = \"none\""), "no error");
}

TEST_F(ExplorerChecks, ASensorMustReachTheGround) {
  EXPECT_EQ(
      changed("kind = \"presence\", detector = \"infrared\", range_max_m = 60, angle_max_rad = 0.5",
              "kind = \"scan\", sigma_m = 5"),
      "s.toml:14: agents[0].sensor.kind: agents of kind \"explorer\" have a sensor of kind "
      "\"segmented-camera\" or \"presence\", or none; found \"scan\"");
  EXPECT_EQ(changed(", altitude_m = 20", ""),
            "s.toml:14: agents[0].sensor.kind: \"presence\" needs to know how high over the ground "
            "the agent flies, as motion = { kind = \"steered\", altitude_m = 40 }");
  EXPECT_EQ(changed("range_max_m = 60, ", ""),
            "s.toml:14: agents[0].sensor.range_max_m: missing; from how far does a look tell "
            "nothing any more?");
  EXPECT_EQ(changed("range_max_m = 60", "range_max_m = 20"),
            "s.toml:14: agents[0].sensor.range_max_m: must be more than motion.altitude_m (20.0 "
            "m), or the ground is out of sight");
  EXPECT_EQ(changed(", angle_max_rad = 0.5", ""),
            "s.toml:14: agents[0].sensor.angle_max_rad: missing; kind \"presence\" needs how wide "
            "it looks");
}

TEST_F(ExplorerChecks, ADetectorHasANameOrTwoProbabilities) {
  const auto detector = [&](const std::string& keys) {
    return changed("detector = \"infrared\"", keys);
  };
  EXPECT_EQ(detector("p_detect = 0.9, p_false = 0.1"), "no error");
  EXPECT_EQ(presence("p_detect = 0.9, "),
            "s.toml:14: agents[0].sensor.p_detect: not together with detector");
  EXPECT_EQ(presence("p_false = 0.1, "),
            "s.toml:14: agents[0].sensor.p_false: not together with detector");
  EXPECT_EQ(detector("p_false = 0.1"),
            "s.toml:14: agents[0].sensor.p_detect: missing; give it with p_false, or a detector");
  EXPECT_EQ(detector("p_detect = 0.9"),
            "s.toml:14: agents[0].sensor.p_false: missing; give it with p_detect, or a detector");
  EXPECT_EQ(detector("p_detect = 0.5, p_false = 0.5"),
            "s.toml:14: agents[0].sensor.p_false: must be less than p_detect (0.5)");
}

TEST_F(ExplorerChecks, AnImageHasWholePixelsNotTooMany) {
  EXPECT_EQ(camera(", sigma_pixel = 0.4"),
            "s.toml:14: agents[0].sensor.sigma_pixel: must be at least 0.5 for kind "
            "\"segmented-camera\"");
  const std::string whole =
      "s.toml:14: agents[0].sensor.image_px: must be two whole numbers of pixels, at most 4096 "
      "each";
  EXPECT_EQ(camera(", image_px = [40.5, 40]"), whole);
  EXPECT_EQ(camera(", image_px = [40, 0.5]"), whole);
  EXPECT_EQ(camera(", image_px = [1, 4097]"), whole);
  EXPECT_EQ(camera(", image_px = [513, 512]"),
            "s.toml:14: agents[0].sensor.image_px: has more than 262144 pixels");
}

TEST_F(ExplorerChecks, WhoIsSteeredExploresFromAPlaceInTheArea) {
  EXPECT_EQ(changed("\"steered\"", "\"hover\""),
            "s.toml:13: agents[0].exploration: needs motion.kind = \"steered\"");
  const std::string sensor =
      "sensor = { kind = \"presence\", detector = \"infrared\", range_max_m = 60, angle_max_rad = "
      "0.5 }\n";
  const std::string way =
      "motion = { kind = \"steered\", altitude_m = 20 }\nexploration = { speed_m_per_s = 5 }\n";
  EXPECT_EQ(changed({{way, ""}, {sensor, ""}}),
            "s.toml:9: agents[0].motion: missing; agents of kind \"explorer\" fly, or hover, over "
            "the area");
  EXPECT_EQ(changed("exploration = { speed_m_per_s = 5 }\n", ""),
            "s.toml:12: agents[0].motion.kind: \"steered\" needs agents.exploration: where does it "
            "go?");
  EXPECT_EQ(changed(sensor, ""),
            "s.toml:13: agents[0].exploration.choice: \"gain\" is that of a look, and there is no "
            "sensor");
  EXPECT_EQ(
      changed({{sensor, ""}, {"exploration = { ", "exploration = { choice = \"random-walk\", "}}),
      "no error");
  EXPECT_EQ(changed("[2.5, 2.5]", "[40, 2.5]"),
            "s.toml:11: agents[0].position_m: an explorer begins inside world.area");
  EXPECT_EQ(changed("[2.5, 2.5]", "[2.5, -1e-9]"),
            "s.toml:11: agents[0].position_m: an explorer begins inside world.area");
  EXPECT_EQ(changed("position_m = [2.5, 2.5]", "circle = { radius_m = 3 }"), "no error");
  EXPECT_EQ(changed("position_m = [2.5, 2.5]", "circle = { radius_m = 3 }\ncount = 3"),
            "s.toml:11: agents[0].circle: an explorer begins inside world.area");
  EXPECT_EQ(
      changed("position_m = [2.5, 2.5]", "circle = { radius_m = 3, center_m = [5, 5] }\ncount = 3"),
      "no error");
}

TEST_F(ExplorerChecks, AnExplorationHasTheKeysOfItsKind) {
  const std::string at = "s.toml:13: agents[0].exploration.";
  EXPECT_EQ(exploration("turn_max_rad = 1"),
            at + "turn_max_rad: only for vehicle = \"constant-speed\"");
  EXPECT_EQ(exploration("headings = 5"), at + "headings: only for vehicle = \"constant-speed\"");
  const std::string gain = ": only for choice = \"gain\"";
  for (const char* key : {"horizon_cells", "gain_weight", "cost_weight"}) {
    EXPECT_EQ(exploration("choice = \"random-walk\", " + std::string(key) + " = 2"),
              at + key + gain);
  }
  EXPECT_EQ(exploration("vehicle = \"constant-speed\", headings = 4"),
            at + "headings: must be odd");
  EXPECT_EQ(exploration("cost_weight = 2e9"),
            at + "cost_weight = 2e+09: must be between 0 and 1000000000");
  const std::string slow = at + "speed_m_per_s: a cell (5.0 m) must take 1e-9 s to 1e9 s";
  EXPECT_EQ(changed("speed_m_per_s = 5", "speed_m_per_s = 4e-9"), slow);
  EXPECT_EQ(changed("speed_m_per_s = 5", "speed_m_per_s = 5.1e9"), slow);
  EXPECT_EQ(changed("speed_m_per_s = 5", "speed_m_per_s = 5e-9"), "no error");
}

}  // namespace
}  // namespace hearsay
