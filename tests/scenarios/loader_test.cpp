#include "scenarios/loader.hpp"

#include <gtest/gtest.h>

#include "rule_names.hpp"
#include "temp_files.hpp"

namespace hearsay {
namespace {

class Loader : public InTempDirectory {
 protected:
  static Scenario load(const std::string& content, const std::vector<std::string>& set = {}) {
    write("s.toml", content);
    return load_scenario("s.toml", sets(set), {});
  }
  static std::string error(const std::string& content, const std::vector<std::string>& set = {}) {
    return error_of([&] { load(content, set); });
  }
  // The valid scenario with one text in it replaced.
  static std::string error_with(const std::string& from, const std::string& to) {
    std::string content = ring;
    const auto at = content.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return error(content.replace(at, from.size(), to));
  }
  static std::string agent(const std::string& lines) {
    return "duration_s = 1\nworld.targets = [{ position_m = [1, 2] }]\n[[agents]]\n" + lines;
  }
};

TEST_F(Loader, EveryFieldOfAFileArrives) {
  const Scenario s = load(R"(
duration_s = 120.5
seed = 9
events_max = 1000
[world]
targets = [{ name = "a", position_m = [1, 2.5] }, { position_m = [-3.0, 4.0] }]
[radio]
topology = "edges"
edges = [[0, 1], ["base", "estimator2"]]
rate_bps = 9600
header_bytes = 12
queue_packets_max = 3
latency_s = 0.01
loss = { model = "bernoulli", probability = 0.25 }
[[agents]]
name = "base"
position_m = [5, 6]
sensor.kind = "position"
sensor.period_s = 2
sensor.start_s = 1
sensor.end_s = 9
sensor.sigma_along_m = 10
sensor.sigma_across_m = 1.5
estimator = { kind = "static-gaussian", fusion = "channel-robust" }
talk = { policy = "never", period_s = 4, phase = "together", phase_s = 3 }
parameters = { gain = 2, "odd name" = 0.5 }
[[agents]]
count = 2
circle = { center_m = [1, 1], radius_m = 8 }
sensor.sigma_range_m = 0.2
sensor.sigma_bearing_rad = 0.1
sensor.sigma_heading_rad = 0
sensor.sigma_position_m = 0.3
[record]
series = ["nees", "rms_error_m"]
series_period_s = 20
messages = "all"
ledger = "off"
)");
  EXPECT_EQ(s.file, "s.toml");
  EXPECT_EQ(s.duration_s, 120.5);
  EXPECT_EQ(s.seed, 9u);
  EXPECT_EQ(s.events_max, 1000u);
  ASSERT_EQ(s.world.targets.size(), 2u);
  EXPECT_EQ(s.world.targets[0].name, "a");
  EXPECT_EQ(s.world.targets[0].position_m, (std::vector{1.0, 2.5}));
  EXPECT_EQ(s.world.targets[1].name, "target1");
  EXPECT_FALSE(s.world.log);
  EXPECT_EQ(s.radio.topology, "edges");
  EXPECT_EQ(s.radio.edges, (std::vector<std::array<int, 2>>{{0, 1}, {0, 2}}));
  EXPECT_EQ(s.radio.rate_bps, 9600.0);
  EXPECT_EQ(s.radio.header_bytes, 12);
  EXPECT_EQ(s.radio.queue_packets_max, 3);
  EXPECT_EQ(s.radio.latency_s, 0.01);
  EXPECT_EQ(s.radio.loss.model, "bernoulli");
  EXPECT_EQ(s.radio.loss.probability, 0.25);
  ASSERT_EQ(s.agents.size(), 2u);
  const AgentSpec& base = s.agents[0];
  EXPECT_EQ(base.name, "base");
  EXPECT_EQ(base.position_m, (std::vector{5.0, 6.0}));
  EXPECT_EQ(base.sensor.period_s, 2.0);
  EXPECT_EQ(base.sensor.start_s, 1.0);
  EXPECT_EQ(base.sensor.end_s, 9.0);
  EXPECT_EQ(base.sensor.sigma_m, std::nullopt);
  EXPECT_EQ(base.sensor.sigma_along_m, 10.0);
  EXPECT_EQ(base.sensor.sigma_across_m, 1.5);
  EXPECT_EQ(base.estimator.fusion, "channel-robust");
  EXPECT_EQ(base.talk.policy, "never");
  EXPECT_EQ(base.talk.phase, "together");
  EXPECT_EQ(base.talk.phase_s, 3.0);
  EXPECT_EQ(base.parameters, (std::map<std::string, double>{{"gain", 2.0}, {"odd name", 0.5}}));
  EXPECT_EQ(s.agents[1].count, 2);
  EXPECT_EQ(s.agents[1].circle->center_m, (std::vector{1.0, 1.0}));
  EXPECT_EQ(s.agents[1].circle->radius_m, 8.0);
  EXPECT_EQ(s.agents[1].sensor.sigma_range_m, 0.2);
  EXPECT_EQ(s.agents[1].sensor.sigma_heading_rad, 0.0);
  EXPECT_EQ(s.record.series, (std::vector<std::string>{"nees", "rms_error_m"}));
  EXPECT_EQ(s.record.series_period_s, 20.0);
  EXPECT_EQ(s.record.messages, "all");
  EXPECT_EQ(s.record.ledger, "off");
}

TEST_F(Loader, AKeyLeftOutKeepsItsDefault) {
  const Scenario s = load("duration_s = 1\n[[agents]]\n");
  EXPECT_EQ(s.radio.topology, "full");
  EXPECT_EQ(s.radio.rate_bps, 1e6);
  EXPECT_EQ(s.seed, 1u);
  EXPECT_EQ(s.agents.at(0).talk.period_s, 5.0);
  EXPECT_EQ(s.agent_count(), 1);
}

TEST_F(Loader, ADirectoryIsMeantFromTheScenarioFileButWithSetAsGiven) {
  std::filesystem::create_directories("logs");
  write("logs/m.toml", "[world.log]\ndirectory = \"../data\"\n[[agents]]\nsensor.kind = \"log\"\n");
  EXPECT_EQ(load_scenario("logs/m.toml", {}, {}).world.log->directory, "data");
  const auto set = sets({"world.log.directory=../elsewhere"});
  EXPECT_EQ(load_scenario("logs/m.toml", set, {}).world.log->directory, "../elsewhere");
  const auto absolute = sets({"world.log.directory=/data/six"});
  EXPECT_EQ(load_scenario("logs/m.toml", absolute, {}).world.log->directory, "/data/six");
}

TEST_F(Loader, AnUnknownKeyIsNamedWithTheNearestKnownOne) {
  EXPECT_EQ(error_with("topology", "topolgy"),
            "s.toml:8: unknown key 'topolgy' in [radio]; did you mean 'topology'?");
  EXPECT_EQ(error_with("duration_s", "duraton_s"),
            "s.toml:1: unknown key 'duraton_s' at the top level; did you mean 'duration_s'?");
  EXPECT_EQ(error_with("fusion", "fusoin"),
            "s.toml:15: unknown key 'fusoin' in [agents[0].estimator]; did you mean 'fusion'?");
  EXPECT_EQ(error_with("probability", "chance"),
            "s.toml:10: unknown key 'chance' in [radio.loss]; allowed: model, probability, links, "
            "mean_burst, good_to_bad, bad_to_good, loss_good, loss_bad");
}

TEST_F(Loader, AWrongTypeSaysWhatWasExpectedAndFound) {
  EXPECT_EQ(error_with("250_000", "\"fast\""),
            "s.toml:9: radio.rate_bps = \"fast\": expected a number, found a string");
  EXPECT_EQ(error_with("count = 4", "count = 4.0"),
            "s.toml:13: agents[0].count = 4.0: expected an integer, found a number");
  EXPECT_EQ(error_with("\"ring\"", "3"),
            "s.toml:8: radio.topology = 3: expected a string, found an integer");
  EXPECT_EQ(error_with("[\"nees\"]", "\"nees\""),
            "s.toml:19: record.series = \"nees\": expected an array of strings, found a string");
  EXPECT_EQ(error_with("{ model = \"bernoulli\", probability = 0.1 }", "0.1"),
            "s.toml:10: radio.loss = 0.1: expected a table, found a number");
  EXPECT_EQ(error_with("seed = 7", "seed = 2020-01-02"),
            "s.toml:2: seed = 2020-01-02: expected an integer, found a date or time");
  EXPECT_EQ(error_with("seed = 7", "seed = true"),
            "s.toml:2: seed = true: expected an integer, found a boolean");
  EXPECT_EQ(error("agents = 3\nduration_s = 1"),
            "s.toml:1: agents = 3: expected an array of tables, found an integer");
  EXPECT_EQ(error("[agents]\n"),
            "s.toml:1: agents = {}: expected an array of tables, found a table");
}

TEST_F(Loader, ANumberOutOfItsRangeIsRefused) {
  EXPECT_EQ(error_with("250_000", "-1"), "s.toml:9: radio.rate_bps = -1: must be greater than 0");
  EXPECT_EQ(error_with("0.1 }", "1.5 }"),
            "s.toml:10: radio.loss.probability = 1.5: must be between 0 and 1");
  EXPECT_EQ(error_with("0.1 }", "-0.5 }"),
            "s.toml:10: radio.loss.probability = -0.5: must be between 0 and 1");
  EXPECT_EQ(error_with("period_s = 5.0", "period_s = -1.0"),
            "s.toml:16: agents[0].talk.period_s = -1.0: must be greater than 0");
  EXPECT_EQ(error_with("period_s = 5.0", "period_s = 1e-12"),
            "s.toml:16: agents[0].talk.period_s = 1e-12: must be at least 1e-09");
  EXPECT_EQ(error_with("duration_s = 60", "duration_s = 1e10"),
            "s.toml:1: duration_s = 1e+10: must be at most 1000000000");
  EXPECT_EQ(error_with("seed = 7", "seed = -7"), "s.toml:2: seed = -7: must be at least 0");
  EXPECT_EQ(error_with("\"ring\"", "\"ring\"\nheader_bytes = 70000"),
            "s.toml:9: radio.header_bytes = 70000: must be between 0 and 65535");
  EXPECT_EQ(error_with("\"ring\"", "\"ring\"\nlatency_s = -1"),
            "s.toml:9: radio.latency_s = -1: must be at least 0");
  EXPECT_EQ(error_with("[40.0, 25.0]", "[40.0, 25.0, 3]"),
            "s.toml:5: world.targets[0].position_m = [40.0, 25.0, 3]: must have 2 coordinates");
}

TEST_F(Loader, NumbersThatAreNoneAreRefused) {
  EXPECT_EQ(error_with("250_000", "nan"),
            "s.toml:9: radio.rate_bps = nan: must be a finite number");
  EXPECT_EQ(error_with("250_000", "inf"),
            "s.toml:9: radio.rate_bps = inf: must be a finite number");
  EXPECT_EQ(error_with("25.0]", "-inf]"),
            "s.toml:5: world.targets[0].position_m[1] = -inf: must be a finite number");
}

TEST_F(Loader, AnUnknownChoiceIsAnsweredWithTheAllowedOnes) {
  EXPECT_EQ(error_with("ci-det", "ci-dett"),
            "s.toml:15: agents[0].estimator.fusion = \"ci-dett\": unknown; did you mean 'ci-det'?");
  EXPECT_EQ(error_with("\"ring\"", "\"moebius\""),
            "s.toml:8: radio.topology = \"moebius\": unknown; allowed: line, ring, star, full, "
            "binary-tree, grid, erdos-renyi, small-world, random-geometric, edges, contacts, disk, "
            "by-position");
  write("s.toml", ring);
  KnownNames names;
  names.metrics = {"kl_to_central_nats", "neess"};
  EXPECT_EQ(error_of([&] { load_scenario("s.toml", {}, names); }),
            "s.toml:19: record.series[0] = \"nees\": unknown; allowed: kl_to_central_nats, neess; "
            "did you mean 'neess'?");
  names.metrics = {"nees"};
  EXPECT_NO_THROW(load_scenario("s.toml", {}, names));
  EXPECT_EQ(error_with("[\"nees\"]", "[\"nees\", \"nees\"]"),
            "s.toml:19: record.series[1] = \"nees\": stands there twice");
}

TEST_F(Loader, AgreementIsCheckedAgainstTheRest) {
  const std::string estimators =
      "duration_s = 9\nworld.targets = [{ position_m = [1, 2] }]\n"
      "[[agents]]\ncount = 2\n[record]\n";
  const AgreementSpec given =
      load(estimators + "agreement = { from_s = 3, within_m = 0.1, period_s = 0.5 }\n")
          .record.agreement.value();
  EXPECT_EQ(given.from_s, 3.0);
  EXPECT_EQ(given.within_m, 0.1);
  EXPECT_EQ(given.period_s, 0.5);
  EXPECT_FALSE(load(estimators).record.agreement);
  EXPECT_EQ(error(estimators + "agreement = { from_s = 3 }\n"),
            "s.toml:6: record.agreement.within_m: missing; how near is agreement?");
  EXPECT_EQ(error(estimators + "agreement = { from_s = 9, within_m = 1 }\n"),
            "s.toml:6: record.agreement.from_s: must be before the end of the run (9.0 s)");
  KnownNames names;
  names.agent_kinds.push_back("gossip");
  write("s.toml",
        "duration_s = 1\n[[agents]]\nkind = \"gossip\"\n[record]\n"
        "agreement = { within_m = 1 }\n");
  EXPECT_EQ(error_of([&] { load_scenario("s.toml", {}, names); }),
            "s.toml:5: record.agreement: no agent of kind \"estimator\" is there to agree with "
            "another");
}

TEST_F(Loader, AKindThatAProgramAddsIsKnown) {
  write("s.toml", "duration_s = 1\n[[agents]]\nkind = \"gossip\"\n");
  EXPECT_EQ(error_of([] { load_scenario("s.toml", {}, {}); }),
            "s.toml:3: agents[0].kind = \"gossip\": unknown; allowed: estimator, tracker, "
            "localizer, explorer, forager, source");
  KnownNames names;
  names.agent_kinds.push_back("gossip");
  EXPECT_EQ(load_scenario("s.toml", {}, names).agents.at(0).kind, "gossip");
}

TEST_F(Loader, AFileThatIsNoTomlOrCannotBeReadIsNamed) {
  EXPECT_EQ(error("duration_s = 1\n[radio\n").substr(0, 10), "s.toml:2: ");
  EXPECT_EQ(error("\x7f"
                  "ELF\x02\x01")
                .substr(0, 10),
            "s.toml:1: ");
  EXPECT_EQ(error_of([] { load_scenario("none.toml", {}, {}); }), "none.toml: cannot be read");
  std::filesystem::create_directories("folder");
  EXPECT_EQ(error_of([] { load_scenario("folder", {}, {}); }), "folder: cannot be read");
  EXPECT_EQ(error("scenario = \"ring.toml\"\n"),
            "s.toml:1: has a key 'scenario', so it is a study, not a scenario");
}

TEST_F(Loader, AScenarioNeedsAgents) {
  EXPECT_EQ(error("duration_s = 1\n"),
            "s.toml: there are no [[agents]]; a scenario needs at least one agent");
  EXPECT_EQ(error("duration_s = 1\nagents = []\n"),
            "s.toml:2: there are no [[agents]]; a scenario needs at least one agent");
  EXPECT_EQ(error_with("count = 4", "count = 0"),
            "s.toml:13: agents[0].count = 0: must be between 1 and 1000000; a scenario needs at "
            "least one agent");
  EXPECT_EQ(error(agent("count = 600000\n[[agents]]\ncount = 600000\n")),
            "s.toml:3: agents: there are 1200000 agents; at most 1000000 are allowed");
}

TEST_F(Loader, NamesAreGivenOnce) {
  EXPECT_EQ(error(agent("name = \"a\"\n[[agents]]\nname = \"a\"\n")),
            "s.toml:6: agents[1].name: two agents are called 'a'");
  EXPECT_EQ(error(agent("name = \"estimator1\"\n[[agents]]\n")),
            "s.toml:5: agents[1].name: two agents are called 'estimator1'");
  EXPECT_EQ(
      error(agent("name = \"central\"\n")),
      "s.toml:4: agents[0].name: 'central' means something else in claims; take another name");
  EXPECT_EQ(error("duration_s = 1\n[world]\ntargets = [\n{ name = \"t\", position_m = [1, 2] },\n"
                  "{ name = \"t\", position_m = [1, 2] }]\n[[agents]]\n"),
            "s.toml:5: world.targets[1].name: two targets are called 't'");
}

TEST_F(Loader, EdgesJoinAgentsThatAreThere) {
  const auto edges = [](const std::string& list) {
    return error("duration_s = 1\n[radio]\ntopology = \"edges\"\nedges = " + list +
                 "\n[[agents]]\nname = \"base\"\n[[agents]]\ncount = 2\n");
  };
  EXPECT_EQ(edges("[[0, 1], [\"base\", 2]]"), "no error");
  EXPECT_EQ(edges("[[0, 1],\n [1, 7]]"),
            "s.toml:5: radio.edges[1] = [1, 7]: there is no agent 7; they are 0 … 2");
  EXPECT_EQ(edges("[[-1, 1]]"),
            "s.toml:4: radio.edges[0] = [-1, 1]: there is no agent -1; they are 0 … 2");
  EXPECT_EQ(edges("[[1, 1]]"), "s.toml:4: radio.edges[0] = [1, 1]: joins an agent to itself");
  EXPECT_EQ(edges("[[\"bse\", 1]]"),
            "s.toml:4: radio.edges[0] = \"bse\": there is no such agent; did you mean 'base'?");
  EXPECT_EQ(edges("[[0, 1, 2]]"), "s.toml:4: radio.edges[0] = [0, 1, 2]: must name two agents");
  EXPECT_EQ(edges("[0, 1]"),
            "s.toml:4: radio.edges[0] = 0: expected a pair of agents, as [0, 1], found an integer");
  EXPECT_EQ(edges("[]"),
            "s.toml:3: radio.topology: \"edges\" needs radio.edges, as [[0, 1], [1, 2]]");
  EXPECT_EQ(error_with("\"ring\"", "\"ring\"\nedges = [[0, 1]]"),
            "s.toml:9: radio.edges: only for topology = \"edges\"; found \"ring\"");
}

TEST_F(Loader, ADiskNeedsARangeAndPlaces) {
  EXPECT_EQ(error_with("\"ring\"", "\"disk\""),
            "s.toml:8: radio.topology: \"disk\" needs radio.range_m above 0");
  EXPECT_EQ(error_with("\"ring\"", "\"disk\"\nrange_m = 5"),
            "s.toml:13: agents[0]: topology = \"disk\" needs to know where it stands: position_m, "
            "circle or motion");
}

TEST_F(Loader, APropagationNeedsASpeedAndADisk) {
  const auto with = [](const std::string& value) {
    return error_with("\"ring\"", "\"ring\"\npropagation_m_per_s = " + value);
  };
  EXPECT_EQ(with("3e8"),
            "s.toml:9: radio.propagation_m_per_s: only for topology = \"disk\", \"by-position\" or "
            "\"random-geometric\", which know how long links are; found \"ring\"");
  EXPECT_EQ(with("0"), "s.toml:9: radio.propagation_m_per_s = 0: must be greater than 0");
  EXPECT_EQ(with("-3e8"), "s.toml:9: radio.propagation_m_per_s = -3e+08: must be greater than 0");
  EXPECT_EQ(with("inf"), "s.toml:9: radio.propagation_m_per_s = inf: must be a finite number");
  EXPECT_EQ(with("\"light\""),
            "s.toml:9: radio.propagation_m_per_s = \"light\": expected a number, found a string");
  const std::string disk = "duration_s = 1\n[radio]\ntopology = \"disk\"\nrange_m = 9\n";
  const std::string agents = "[[agents]]\ncount = 3\ncircle.radius_m = 2\n";
  EXPECT_EQ(load(disk + "propagation_m_per_s = 343\n" + agents).radio.propagation_m_per_s, 343.0);
  EXPECT_EQ(load(disk + agents).radio.propagation_m_per_s, std::nullopt);
}

TEST_F(Loader, APositionSensorNeedsOneKindOfNoise) {
  EXPECT_EQ(error_with(", sigma_m = 5.0", ""),
            "s.toml:14: agents[0].sensor: kind \"position\" needs sigma_m, or sigma_along_m and "
            "sigma_across_m");
  EXPECT_EQ(error_with("sigma_m = 5.0", "sigma_m = 5.0, sigma_along_m = 1.0"),
            "s.toml:14: agents[0].sensor.sigma_m: not together with sigma_along_m and "
            "sigma_across_m");
  EXPECT_EQ(error_with("sigma_m", "sigma_across_m"),
            "s.toml:14: agents[0].sensor.sigma_across_m: needs sigma_along_m, too");
  EXPECT_EQ(error_with("sigma_m = 5.0", "sigma_along_m = 1, sigma_across_m = 2"),
            "s.toml:14: agents[0].sensor.sigma_along_m: needs to know where the agent stands: "
            "position_m, circle or motion");
  EXPECT_EQ(error("duration_s = 1\n[[agents]]\nsensor = { kind = \"position\", sigma_m = 1 }"),
            "s.toml:3: agents[0].sensor.kind: \"position\" needs at least one target in "
            "world.targets");
  EXPECT_EQ(error_with(", position_m = [40.0, 25.0]", ""),
            "s.toml:5: world.targets[0].position_m: missing");
}

TEST_F(Loader, TimesFitTogether) {
  EXPECT_EQ(error_with("duration_s = 60", ""),
            "s.toml: duration_s: missing; only with [world.log] does a run have a span of its own");
  EXPECT_EQ(error(agent("talk = { period_s = 5, phase_s = 5 }")),
            "s.toml:4: agents[0].talk.phase_s: must be less than period_s (5.0 s)");
  EXPECT_EQ(error(agent("sensor = { start_s = 3, end_s = 2 }")),
            "s.toml:4: agents[0].sensor.end_s: must not be before start_s (3.0 s)");
}

TEST_F(Loader, AnAgentStandsInOnePlace) {
  EXPECT_EQ(error(agent("position_m = [1, 2]\ncircle = { radius_m = 2 }\n")),
            "s.toml:5: agents[0].circle: not together with position_m; give one of them");
}

TEST_F(Loader, ALossNeedsAModel) {
  EXPECT_EQ(error_with("model = \"bernoulli\", ", ""),
            "s.toml:10: radio.loss.probability: without effect; set radio.loss.model = "
            "\"bernoulli\", too");
}

TEST_F(Loader, ALogAndItsSensorsComeTogether) {
  const std::string log = "[world.log]\ndirectory = \"d\"\n";
  EXPECT_EQ(error(log + "[[agents]]\nsensor.kind = \"log\"\n"), "no error");
  EXPECT_EQ(error("duration_s = 1\n[[agents]]\nsensor.kind = \"log\"\n"),
            "s.toml:3: agents[0].sensor.kind: \"log\" needs a [world.log] to read");
  EXPECT_EQ(error(log + "[[agents]]\n"),
            "s.toml:1: world.log: no agent has a sensor of kind \"log\" that would read it");
  EXPECT_EQ(error("[world.log]\nkind = \"mrclam\"\n[[agents]]\nsensor.kind = \"log\"\n"),
            "s.toml:1: world.log.directory: missing; say where the data set lies");
  EXPECT_EQ(error("[world]\ntargets = [{ position_m = [1, 2] }]\n" + log +
                  "[[agents]]\nsensor.kind = \"log\"\n"),
            "s.toml:2: world.targets: not with [world.log], whose landmarks are the targets");
}

}  // namespace
}  // namespace hearsay
