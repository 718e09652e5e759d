#include "scenarios/study.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "net/random_graphs.hpp"
#include "rule_names.hpp"
#include "scenarios/links.hpp"
#include "temp_files.hpp"

namespace hearsay {
namespace {

using ::testing::ElementsAre;

class StudyLoader : public InTempDirectory {
 protected:
  void SetUp() override {
    InTempDirectory::SetUp();
    write("ring.toml", ring);
  }
  static Study load(const std::string& content, const std::vector<std::string>& set = {}) {
    write("s.study.toml", "scenario = \"ring.toml\"\n" + content);
    return load_study("s.study.toml", {}, sets(set));
  }
  static std::string error(const std::string& content, const std::vector<std::string>& set = {}) {
    return error_of([&] { load(content, set); });
  }
  static std::string labels(const Cell& cell) {
    std::string text;
    for (const auto& [axis, label] : cell.labels) text += axis + "=" + to_string(label) + " ";
    return text;
  }
};

const std::string two_axes = R"([axes]
rule = { key = "agents.estimator.fusion", values = ["naive", "ci-det"] }
loss = { key = "radio.loss.probability", values = [0, 0.1, 0.3] }
)";

TEST_F(StudyLoader, AxesKeepTheOrderOfTheFileAndTheLastTurnsFastest) {
  const Study study = load(two_axes);
  ASSERT_EQ(study.axes.size(), 2u);
  EXPECT_EQ(study.axes[0].name, "rule");
  EXPECT_EQ(study.axes[0].line, 3);
  EXPECT_EQ(study.axes[1].name, "loss");
  std::vector<std::string> found;
  for (const Cell& cell : cells(study)) found.push_back(labels(cell));
  EXPECT_THAT(found, ElementsAre("rule=\"naive\" loss=0.0 ", "rule=\"naive\" loss=0.1 ",
                                 "rule=\"naive\" loss=0.3 ", "rule=\"ci-det\" loss=0.0 ",
                                 "rule=\"ci-det\" loss=0.1 ", "rule=\"ci-det\" loss=0.3 "));
}

TEST_F(StudyLoader, ACellSetsWhatItsLabelsSay) {
  const Study study =
      load("[set]\n\"agents.talk.period_s\" = 2.0\nradio.latency_s = 0.5\n" + two_axes);
  const Scenario s = load_scenario(study.scenario_file, cells(study).at(4).set, {});
  EXPECT_EQ(s.agents[0].estimator.fusion, "ci-det");
  EXPECT_EQ(s.radio.loss.probability, 0.1);
  EXPECT_EQ(s.agents[0].talk.period_s, 2.0);
  EXPECT_EQ(s.radio.latency_s, 0.5);
  EXPECT_EQ(s.radio.rate_bps, 250000.0) << "[set] of one key leaves its neighbours alone";
}

TEST_F(StudyLoader, PointsSetSeveralKeysAtOnce) {
  const Study study =
      load(R"([axes.sensors]
points = [
  { label = "equal", set = { "agents.sensor.sigma_m" = 5.0 } },
  { label = "split", set = {)"
           R"(agents.sensor = { kind = "position", sigma_along_m = 9, sigma_across_m = 2 }, )"
           R"(agents.circle.radius_m = 3 } },
]
)");
  const auto all = cells(study);
  ASSERT_EQ(all.size(), 2u);
  const Scenario split = load_scenario(study.scenario_file, all[1].set, {});
  EXPECT_EQ(split.agents[0].sensor.sigma_m, std::nullopt);
  EXPECT_EQ(split.agents[0].sensor.sigma_along_m, 9.0);
  EXPECT_EQ(split.agents[0].circle->radius_m, 3.0);
}

TEST_F(StudyLoader, SkippedCellsAreLeftOut) {
  const Study study = load(two_axes + "[[skip]]\nwhen = { rule = \"naive\", loss = [0.1, 0.3] }\n" +
                           "[[skip]]\nwhen = { loss = 0 }\n");
  std::vector<std::string> found;
  for (const Cell& cell : cells(study)) found.push_back(labels(cell));
  EXPECT_THAT(found, ElementsAre("rule=\"ci-det\" loss=0.1 ", "rule=\"ci-det\" loss=0.3 "));
  EXPECT_EQ(error(two_axes + "[[skip]]\nwhen = { rule = [\"naive\", \"ci-det\"] }\n"),
            "s.study.toml:5: every cell is skipped");
}

TEST_F(StudyLoader, AStudyWithoutAxesIsOneCell) {
  const Study study = load("");
  EXPECT_EQ(cells(study).size(), 1u);
  EXPECT_EQ(study.repetitions, 1);
  EXPECT_EQ(study.name, "s");
  EXPECT_EQ(study.scenario_file, "ring.toml");
}

TEST_F(StudyLoader, TheSeedIsTheScenariosUnlessGiven) {
  EXPECT_EQ(load("").seed, 7u);
  EXPECT_EQ(load("seed = 100\n").seed, 100u);
  EXPECT_EQ(load("seed = 100\n", {"seed=5"}).seed, 5u);
}

TEST_F(StudyLoader, ScalarsAndFiguresArrive) {
  const Study study = load(R"(title = "Rumour"
name = "rumour"
repetitions = 100
[[figures]]
script = "rumour.py"
output = "rumour.png"
arguments = ["--topology", "line", "line"]
)");
  EXPECT_EQ(study.title, "Rumour");
  EXPECT_EQ(study.name, "rumour");
  EXPECT_EQ(study.repetitions, 100);
  ASSERT_EQ(study.figures.size(), 1u);
  EXPECT_EQ(study.figures[0].script, "rumour.py");
  EXPECT_THAT(study.figures[0].arguments, ElementsAre("--topology", "line", "line"));
}

TEST_F(StudyLoader, FilesAreMeantFromTheStudy) {
  std::filesystem::create_directories("a/b");
  write("a/m.toml", "[world.log]\ndirectory = \"x\"\n[[agents]]\nsensor.kind = \"log\"\n");
  write("a/b/t.toml", "scenario = \"../m.toml\"\n[set]\nworld.log.directory = \"logs\"\n");
  const Study study = load_study("a/b/t.toml", {});
  EXPECT_EQ(study.scenario_file, "a/m.toml");
  EXPECT_EQ(study.name, "t");
  const Scenario s = load_scenario(study.scenario_file, cells(study)[0].set, {});
  EXPECT_EQ(s.world.log->directory, "a/b/logs");
  const Study set = load_study("a/b/t.toml", {}, sets({"world.log.directory=mine"}));
  EXPECT_EQ(load_scenario(set.scenario_file, cells(set)[0].set, {}).world.log->directory, "mine");
}

TEST_F(StudyLoader, AStudyIsToldFromAScenarioByItsContent) {
  load("");
  EXPECT_TRUE(is_study("s.study.toml"));
  EXPECT_FALSE(is_study("ring.toml"));
  EXPECT_EQ(error_of([] { is_study("none.toml"); }), "none.toml: cannot be read");
  EXPECT_EQ(error_of([] { load_study("ring.toml", {}); }),
            "ring.toml:1: unknown key 'duration_s' at the top level; allowed: scenario, name, "
            "title, repetitions, seed, set, axes, skip, claims, figures");
  write("none.toml", "title = \"x\"\n");
  EXPECT_EQ(error_of([] { load_study("none.toml", {}); }),
            "none.toml: scenario: missing; a study names its scenario file");
}

TEST_F(StudyLoader, AnAxisNeedsValues) {
  EXPECT_EQ(error("[axes]\nloss = { key = \"radio.loss.probability\", values = [] }\n"),
            "s.study.toml:3: axis 'loss' has no values");
  EXPECT_EQ(error("[axes]\nloss = { points = [] }\n"), "s.study.toml:3: axis 'loss' has no values");
  EXPECT_EQ(error("[axes]\nloss = { key = \"radio.loss.probability\" }\n"),
            "s.study.toml:3: axes.loss.values: missing");
  EXPECT_EQ(error("[axes]\nloss = {}\n"),
            "s.study.toml:3: axes.loss: needs either key and values, or points");
  EXPECT_EQ(error("[axes]\nloss = [1]\n"),
            "s.study.toml:3: axes.loss = [1]: expected a table, found an array");
  EXPECT_EQ(error("[axes]\nloss = { key = \"seed\", value = [1] }\n"),
            "s.study.toml:3: unknown key 'value' in [axes.loss]; did you mean 'values'?");
}

TEST_F(StudyLoader, AnAxisNeedsAKeyOfTheSchema) {
  EXPECT_EQ(error("[axes]\nloss = { key = \"radio.los.probability\", values = [0.1] }\n"),
            "s.study.toml:3: axis 'loss': unknown key 'radio.los.probability'; did you mean "
            "'radio.loss.probability'?");
  EXPECT_EQ(error("[axes]\nx = { points = [{ label = 1, set = { radio.rate = 1 } }] }\n"),
            "s.study.toml:3: axis 'x': unknown key 'radio.rate'; allowed in [radio]: topology, "
            "edges, range_m, columns, link_probability, mean_degree, rewire_probability, side_m, "
            "contacts, outages, partitions, rotation, rate_bps, header_bytes, mtu_bytes, "
            "queue_packets_max, queue_bytes_max, queue_policy, queue_wait_max_s, half_duplex, "
            "sharing, acknowledgement, gossip, latency_s, propagation_m_per_s, jitter, loss, "
            "propagation, "
            "jammers");
  EXPECT_EQ(error("[set]\n\"radio.latency\" = 1\n").substr(0, 48),
            "s.study.toml:3: unknown key 'radio.latency'; did");
  EXPECT_EQ(error("[axes]\nseed = { key = \"seed\", values = [1, 2] }\n"),
            "s.study.toml:3: axis 'seed': 'seed' comes from the study's own seed and the "
            "repetition");
}

TEST_F(StudyLoader, ValuesOfAnAxisAreDistinctScalars) {
  EXPECT_EQ(error("[axes]\nloss = { key = \"radio.loss.probability\", values = [0.1, 0, 0.0] }\n"),
            "s.study.toml:3: axis 'loss' has the value 0.0 twice");
  EXPECT_EQ(error("[axes]\nx = { key = \"record.series\", values = [[\"nees\"]] }\n"),
            "s.study.toml:3: axes.x.values[0] = [\"nees\"]: expected a number, string or boolean "
            "(for more, use points), found an array");
}

TEST_F(StudyLoader, AxesDoNotWipeOutOneAnother) {
  EXPECT_EQ(error(two_axes + "again = { key = \"radio.loss.probability\", values = [0.5] }\n"),
            "s.study.toml:5: axis 'again' sets 'radio.loss.probability', and so does axis 'loss'");
  EXPECT_EQ(error(two_axes, {"radio.loss.probability=0.9"}),
            "--set radio.loss.probability=0.9: without effect; axis 'loss' of s.study.toml sets "
            "'radio.loss.probability'");
  EXPECT_EQ(error(two_axes, {"radio.latency_s=0.9"}), "no error");
  EXPECT_EQ(error("[axes.agent]\nkey = \"seed\"\nvalues = [1]\n"),
            "s.study.toml:2: axes.agent: has another meaning in claims; take another name");
}

TEST_F(StudyLoader, AValueThatCannotBeIsFoundAtItsAxis) {
  EXPECT_EQ(error("[axes]\nloss = { key = \"radio.loss.probability\", values = [0.1, 1.5] }\n"),
            "s.study.toml:3: radio.loss.probability = 1.5: must be between 0 and 1");
  EXPECT_EQ(
      error("[axes]\nx = { key = \"agents.estimator.fusion\", values = [\n\"naive\",\n"
            "\"nave\"] }\n"),
      "s.study.toml:5: agents[0].estimator.fusion = \"nave\": unknown; did you mean 'naive'?");
}

TEST_F(StudyLoader, ACombinationThatCannotBeNamesTheCell) {
  write("ring.toml", ring + "[world.log]\n");
  EXPECT_EQ(error(two_axes),
            "ring.toml:20: world.log.directory: missing; say where the data set lies")
      << "a mistake of the scenario alone";
  write("ring.toml", ring);
  EXPECT_EQ(
      error("[axes]\nphase = { key = \"agents.talk.phase\", values = [\"random\", \"together\"] }\n"
            "model = { key = \"radio.loss.model\", values = [\"bernoulli\", \"none\"] }\n"),
      "s.study.toml:4: in the cell phase = \"random\", model = \"none\": ring.toml:10: "
      "radio.loss.probability: without effect; set radio.loss.model = \"bernoulli\", too");
  EXPECT_EQ(
      error("[axes]\ntopology = { key = \"radio.topology\", values = [\"line\", \"disk\"] }\n"),
      "s.study.toml:3: radio.topology: \"disk\" needs radio.range_m above 0");
}

TEST(Scenarios, ThatComeWithTheProgramAreInOrder) {
  int files = 0;
  const auto folder = std::filesystem::path(HEARSAY_SOURCE_DIR) / "scenarios";
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().extension() != ".toml") continue;
    const std::string file = entry.path().string();
    EXPECT_NO_THROW(is_study(file) ? (void)load_study(file, {}) : (void)load_scenario(file, {}, {}))
        << file;
    ++files;
  }
  EXPECT_GE(files, 4);
}

/// Whether those of `agents` hear one another, over others of them.
bool connected(const Topology& graph, const std::vector<AgentId>& agents) {
  std::vector<AgentId> found = {agents.front()};
  for (std::size_t next = 0; next < found.size(); ++next) {
    for (const AgentId agent : agents) {
      const bool is_new = std::find(found.begin(), found.end(), agent) == found.end();
      if (is_new && graph.link(found[next], agent) >= 0) found.push_back(agent);
    }
  }
  return found.size() == agents.size();
}

TEST(Scenarios, TheGeometricGraphOfTheRulesIsTheDrawThatItSaysItIs) {
  const std::string folder = std::string(HEARSAY_SOURCE_DIR) + "/scenarios/rumour/";
  const PlacedGraph drawn = random_geometric(25, {.side_m = 100.0, .range_m = 30.0}, 4);
  std::vector<AgentId> all, left, right;
  for (AgentId a = 0; a < 25; ++a) {
    all.push_back(a);
    (drawn.positions_m[static_cast<std::size_t>(a)][0] < 50.0 ? left : right).push_back(a);
  }
  EXPECT_TRUE(connected(drawn.topology, all));
  EXPECT_TRUE(connected(drawn.topology, left) && connected(drawn.topology, right));
  int graphs = 0;
  for (const Cell& cell : cells(load_study(folder + "rules.study.toml", {}))) {
    const Where geometric = {
        {"rule", {std::string("none")}},
        {"network",
         {std::string("geometric of 25, good"), std::string("geometric of 25, 30 % lost"),
          std::string("geometric of 25, cut for 30 s")}}};
    if (!matches(cell, geometric)) continue;
    ++graphs;
    const Scenario scenario = load_scenario(folder + "rumour.toml", cell.set, {});
    const Topology graph = topology_of(scenario, {});
    ASSERT_EQ(graph.links(), drawn.topology.links());
    for (const AgentId a : all) {
      for (const AgentId b : all) {
        EXPECT_EQ(graph.link(a, b) >= 0, drawn.topology.link(a, b) >= 0) << a << ' ' << b;
      }
    }
    for (const PartitionSpec& cut : scenario.radio.partitions) {
      EXPECT_EQ(cut.groups.size(), 2u);
      EXPECT_EQ(cut.groups.at(0), left);
      EXPECT_EQ(cut.groups.at(1), right);
    }
  }
  EXPECT_EQ(graphs, 3);
}

TEST_F(StudyLoader, RepetitionsAndFilesAreChecked) {
  EXPECT_EQ(error("repetitions = 0\n"),
            "s.study.toml:2: repetitions = 0: must be between 1 and 1000000");
  write("s.study.toml", "scenario = \"rng.toml\"\n");
  EXPECT_EQ(error_of([] { load_study("s.study.toml", {}); }),
            "s.study.toml:1: scenario = \"rng.toml\": there is no file rng.toml");
  write("rng.toml", "[radio\n");
  EXPECT_EQ(error_of([] { load_study("s.study.toml", {}); }).substr(0, 11), "rng.toml:1:");
}

TEST_F(StudyLoader, SkipsNameAxesAndTheirValues) {
  const auto skip = [](const std::string& when) {
    return error(two_axes + "[[skip]]\nwhen = " + when + "\n");
  };
  EXPECT_EQ(skip("{ rul = \"naive\" }"),
            "s.study.toml:6: skip[0].when.rul = \"naive\": there is no axis 'rul'; did you mean "
            "'rule'?");
  EXPECT_EQ(skip("{ rule = \"nave\" }"),
            "s.study.toml:6: skip[0].when.rule = \"nave\": not on axis 'rule'; allowed: naive, "
            "ci-det; did you mean 'naive'?");
  EXPECT_EQ(skip("{ loss = [0.1, 0.2] }"),
            "s.study.toml:6: skip[0].when.loss[1] = 0.2: not on axis 'loss'; allowed: 0.0, 0.1, "
            "0.3; did you mean '0.0'?");
  EXPECT_EQ(skip("{}"),
            "s.study.toml:6: skip[0].when = {}: names no axis, so every cell would be skipped");
}

TEST_F(StudyLoader, AStudyHasAtMostAMillionCells) {
  std::string content = "[axes]\n";
  for (const std::string axis : {"a", "b", "c", "d"}) {
    content += axis + " = { key = \"agents.parameters." + axis + "\", values = [0";
    for (int i = 1; i < 40; ++i) content += ", " + std::to_string(i);
    content += "] }\n";
  }
  EXPECT_EQ(error(content), "s.study.toml:2: the axes make more than 1000000 cells");
}

TEST(Value, IsWrittenAsTomlWritesIt) {
  EXPECT_EQ(to_string(Value(0.1)), "0.1");
  EXPECT_EQ(to_string(Value(std::int64_t{3})), "3");
  EXPECT_EQ(to_string(Value(std::string("ring"))), "\"ring\"");
  EXPECT_EQ(to_string(Value(true)), "true");
}

TEST(Value, NumbersAreEqualByValue) {
  EXPECT_TRUE(same_value(std::int64_t{1}, 1.0));
  EXPECT_FALSE(same_value(std::int64_t{1}, true));
  EXPECT_FALSE(same_value(std::string("1"), 1.0));
  EXPECT_TRUE(same_value(std::string("a"), std::string("a")));
}

}  // namespace
}  // namespace hearsay
