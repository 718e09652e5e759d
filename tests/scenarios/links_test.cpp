#include "scenarios/links.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <utility>

#include "net/random_graphs.hpp"
#include "temp_files.hpp"

namespace hearsay {
namespace {

using testing::ElementsAre;
using Pair = std::pair<AgentId, AgentId>;

class Links : public InTempDirectory {
 protected:
  // Four agents a0 … a3; `radio` are lines of [radio], from line 3 on.
  static Scenario load(const std::string& radio, const std::vector<std::string>& set = {}) {
    write("s.toml",
          "duration_s = 60\n[radio]\n" + radio + "\n[[agents]]\nname = \"a\"\ncount = 4\n");
    return load_scenario("s.toml", sets(set), {});
  }
  static std::string error(const std::string& radio, const std::vector<std::string>& set = {}) {
    return error_of([&] { load(radio, set); });
  }
  static LinkPlan plan(const std::string& radio, std::uint64_t seed = 1) {
    const Scenario scenario = load(radio);
    return make_link_plan(scenario, agent_positions(scenario), seed);
  }
};

std::set<Pair> edges(const Topology& topology) {
  std::set<Pair> all;
  for (AgentId a = 0; a < topology.agents(); ++a) {
    for (const AgentId b : topology.neighbours(a)) all.insert({std::min(a, b), std::max(a, b)});
  }
  return all;
}

std::vector<std::string> texts(const std::vector<LinkChange>& changes) {
  std::vector<std::string> all;
  for (const LinkChange& change : changes) {
    all.push_back(std::to_string(change.time.nanoseconds() / 1'000'000'000) +
                  (change.up ? " up " : " down ") + std::to_string(change.a) + "-" +
                  std::to_string(change.b));
  }
  return all;
}

TEST_F(Links, GraphsAreKnownByName) {
  EXPECT_EQ(edges(plan("topology = \"binary-tree\"").topology), edges(Topology::binary_tree(4)));
  EXPECT_EQ(edges(plan("topology = \"grid\"\ncolumns = 3").topology), edges(Topology::grid(4, 3)));
  EXPECT_EQ(edges(plan("topology = \"erdos-renyi\"\nlink_probability = 0.5", 7).topology),
            edges(erdos_renyi(4, 0.5, 7)));
  EXPECT_EQ(
      edges(
          plan("topology = \"small-world\"\nmean_degree = 2\nrewire_probability = 1", 7).topology),
      edges(small_world(4, {.mean_degree = 2, .rewire_probability = 1.0}, 7)));
  const LinkPlan geometric = plan("topology = \"random-geometric\"\nside_m = 10\nrange_m = 6", 7);
  EXPECT_EQ(edges(geometric.topology),
            edges(random_geometric(4, {.side_m = 10.0, .range_m = 6.0}, 7).topology));
  EXPECT_TRUE(geometric.topology.has_lengths());
}

TEST_F(Links, AGraphDrawnAtRandomDependsOnTheSeedOfTheRun) {
  const Scenario scenario = load("topology = \"erdos-renyi\"\nlink_probability = 0.5");
  const auto places = agent_positions(scenario);
  std::set<std::set<Pair>> graphs;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    graphs.insert(edges(make_link_plan(scenario, places, seed).topology));
  }
  EXPECT_GT(graphs.size(), 5u);
  EXPECT_EQ(edges(topology_of(scenario, places)),
            edges(topology_of(scenario, places, scenario.seed)));
}

TEST_F(Links, OutagesPartitionsAndRotationsMakeThePlan) {
  const LinkPlan outage = plan(
      "topology = \"line\"\n[[radio.outages]]\nlinks = [[\"a1\", \"a0\"], [2, 3]]\nup_s = 4\n"
      "[[radio.outages]]\nlinks = [[2, 3]]\ndown_s = 3");
  EXPECT_THAT(texts(outage.changes), ElementsAre("0 down 0-1", "0 down 2-3", "4 up 0-1"));
  const LinkPlan partition = plan(
      "topology = \"line\"\n[[radio.partitions]]\nfrom_s = 5\nuntil_s = 9\n"
      "groups = [[\"a0\", 1], [\"a2\", \"a3\"]]\n[[radio.partitions]]\nfrom_s = 50\n"
      "groups = [[0], [1, 2, 3]]");
  EXPECT_THAT(texts(partition.changes), ElementsAre("5 down 1-2", "9 up 1-2", "50 down 0-1"));
  const LinkPlan rotation =
      plan("topology = \"line\"\n[radio.rotation]\nperiod_s = 25\ngroups = [[0], [1, 2], [3]]");
  EXPECT_THAT(texts(rotation.changes),
              ElementsAre("0 down 0-1", "25 down 2-3", "50 up 0-1", "60 up 2-3"));
  const LinkPlan part = plan(
      "topology = \"line\"\n[radio.rotation]\nperiod_s = 25\ncut_s = 10\nfrom_s = 5\nuntil_s = 35\n"
      "groups = [[0, 1], [2, 3]]");
  EXPECT_THAT(texts(part.changes),
              ElementsAre("5 down 1-2", "15 up 1-2", "30 down 1-2", "35 up 1-2"));
}

TEST_F(Links, AnOutageNeedNotHitAGraphDrawnAtRandom) {
  const std::string radio =
      "topology = \"erdos-renyi\"\nlink_probability = 0\n[[radio.outages]]\nlinks = [[0, 1]]";
  EXPECT_TRUE(plan(radio).changes.empty());
}

TEST_F(Links, CanonicalTextKeepsThem) {
  const Scenario scenario = load(
      "topology = \"grid\"\ncolumns = 2\n[[radio.outages]]\nlinks = [[0, \"a1\"]]\ndown_s = 2\n"
      "[[radio.partitions]]\ngroups = [[0, 1], [\"a2\", 3]]\nuntil_s = 3.5\n"
      "[radio.rotation]\nperiod_s = 5\ngroups = [[0], [1], [2, 3]]");
  const std::string text = canonical_text(scenario);
  EXPECT_NE(text.find("groups = [[0, 1], [2, 3]]"), std::string::npos) << text;
  write("b.toml", text);
  EXPECT_EQ(canonical_text(load_scenario("b.toml", {}, {})), text);
}

TEST_F(Links, SetReachesIntoThem) {
  const std::string radio =
      "topology = \"ring\"\n[[radio.partitions]]\ngroups = [[0, 1], [2, 3]]\n[[radio.partitions]]\n"
      "groups = [[0, 1], [2, 3]]\nfrom_s = 3\n[radio.rotation]\nperiod_s = 5\n"
      "groups = [[0], [1], [2, 3]]";
  const Scenario one = load(radio, {"radio.partitions[1].until_s=9", "radio.rotation.cut_s=1"});
  EXPECT_EQ(one.radio.partitions[0].until_s, std::nullopt);
  EXPECT_EQ(one.radio.partitions[1].until_s, 9.0);
  EXPECT_EQ(one.radio.rotation->cut_s, 1.0);
  EXPECT_EQ(load(radio, {"radio.partitions.until_s=9"}).radio.partitions[0].until_s, 9.0);
  EXPECT_EQ(load(radio, {"radio.partitions=[]"}).radio.partitions.size(), 0u);
  EXPECT_EQ(error(radio, {"radio.partitions[1].until_s=2"}),
            "--set radio.partitions[1].until_s=2: radio.partitions[1].until_s = 2: must be after "
            "from_s (3.0 s)");
  EXPECT_EQ(error(radio, {"radio.partitions[2].until_s=2"}),
            "--set radio.partitions[2].until_s=2: there is no partitions[2]; in the file: 0 … 1");
}

TEST_F(Links, AKeyOfAnotherTopologyIsRefused) {
  const auto only = [](const std::string& key, const std::string& topology) {
    return "s.toml:4: radio." + key + ": only for topology = \"" + topology + "\"; found \"ring\"";
  };
  EXPECT_EQ(error("topology = \"ring\"\ncolumns = 2"), only("columns", "grid"));
  EXPECT_EQ(error("topology = \"ring\"\nlink_probability = 0"),
            only("link_probability", "erdos-renyi"));
  EXPECT_EQ(error("topology = \"ring\"\nmean_degree = 2"), only("mean_degree", "small-world"));
  EXPECT_EQ(error("topology = \"ring\"\nrewire_probability = 0"),
            only("rewire_probability", "small-world"));
  EXPECT_EQ(error("topology = \"ring\"\nside_m = 2"), only("side_m", "random-geometric"));
  EXPECT_EQ(error("topology = \"ring\"\ncontacts = \"t.csv\""), only("contacts", "contacts"));
}

TEST_F(Links, ATopologyNeedsItsKeys) {
  const auto needs = [](const std::string& topology, const std::string& key) {
    return "s.toml:3: radio.topology: \"" + topology + "\" needs radio." + key;
  };
  EXPECT_EQ(error("topology = \"grid\""), needs("grid", "columns"));
  EXPECT_EQ(error("topology = \"erdos-renyi\""), needs("erdos-renyi", "link_probability"));
  EXPECT_EQ(error("topology = \"small-world\"\nrewire_probability = 0"),
            needs("small-world", "mean_degree"));
  EXPECT_EQ(error("topology = \"small-world\"\nmean_degree = 2"),
            needs("small-world", "rewire_probability"));
  EXPECT_EQ(error("topology = \"random-geometric\"\nrange_m = 3"),
            needs("random-geometric", "side_m"));
  EXPECT_EQ(error("topology = \"random-geometric\"\nside_m = 3"),
            needs("random-geometric", "range_m above 0"));
  EXPECT_EQ(error("topology = \"contacts\""),
            needs("contacts", "contacts, a CSV file t_s,a,b,state"));
}

TEST_F(Links, SizesFitTheNumberOfAgents) {
  EXPECT_EQ(error("topology = \"grid\"\ncolumns = 5"),
            "s.toml:4: radio.columns = 5: must be at most 4, the number of agents");
  EXPECT_EQ(error("topology = \"grid\"\ncolumns = 0"),
            "s.toml:4: radio.columns = 0: must be at least 1");
  const std::string small_world =
      "topology = \"small-world\"\nrewire_probability = 0\nmean_degree = ";
  EXPECT_EQ(error(small_world + "3"),
            "s.toml:5: radio.mean_degree = 3: must be even: as many neighbours on either side of a "
            "ring");
  EXPECT_EQ(error(small_world + "4"),
            "s.toml:5: radio.mean_degree = 4: must be less than 4, the number of agents");
  EXPECT_EQ(error("topology = \"erdos-renyi\"\nlink_probability = 1.5"),
            "s.toml:4: radio.link_probability = 1.5: must be between 0 and 1");
  EXPECT_EQ(error("topology = \"erdos-renyi\"\nlink_probability = 0.5", {"agents.count=30001"}),
            "s.toml:3: radio.topology: \"erdos-renyi\" is for at most 30000 agents; there are "
            "30001");
}

TEST_F(Links, PlacesAreDrawnOrGivenNotBoth) {
  EXPECT_EQ(error("topology = \"random-geometric\"\nside_m = 9\nrange_m = 5",
                  {"agents.circle.radius_m=3"}),
            "--set agents.circle.radius_m=3: agents[0].circle: not with topology = "
            "\"random-geometric\", which draws where agents stand; for places of your own take "
            "\"disk\"");
  EXPECT_EQ(error("topology = \"random-geometric\"\nside_m = 9\nrange_m = 5\n"
                  "propagation_m_per_s = 343"),
            "no error");
}

TEST_F(Links, AnOutageIsOfLinksThatThereAre) {
  const auto outage = [](const std::string& lines) {
    return error("topology = \"line\"\n[[radio.outages]]\n" + lines);
  };
  EXPECT_EQ(outage("links = [[0, 1], [\"a0\", \"a2\"]]"),
            "s.toml:5: radio.outages[0].links[1] = [\"a0\", \"a2\"]: there is no such link in the "
            "topology \"line\"");
  EXPECT_EQ(outage("links = [[1, 1]]"),
            "s.toml:5: radio.outages[0].links[0] = [1, 1]: joins an agent to itself");
  EXPECT_EQ(outage("links = [[0, 4]]"),
            "s.toml:5: radio.outages[0].links[0] = [0, 4]: there is no agent 4; they are 0 … 3");
  EXPECT_EQ(outage("down_s = 3"),
            "s.toml:4: radio.outages[0].links: missing; which links, as [[0, 1], [1, 2]]");
  EXPECT_EQ(outage("links = [[0, 1]]\ndown_s = 3\nup_s = 3"),
            "s.toml:7: radio.outages[0].up_s = 3: must be after down_s (3.0 s)");
  write("t.csv", "t_s,a,b,state\n0,0,1,up\n");
  EXPECT_EQ(error("topology = \"contacts\"\ncontacts = \"t.csv\"\n[[radio.outages]]\n"
                  "links = [[0, 1], [1, 2]]"),
            "s.toml:6: radio.outages[0].links[1] = [1, 2]: there is no such link in the topology "
            "\"contacts\"");
}

TEST_F(Links, APartitionHasEachAgentInOneGroup) {
  const auto partition = [](const std::string& lines) {
    return error("topology = \"line\"\n[[radio.partitions]]\n" + lines);
  };
  EXPECT_EQ(partition("groups = [[0, 1], [\"a3\"]]"),
            "s.toml:5: radio.partitions[0].groups: leaves out agent 2, 'a2'; each stands in one "
            "group");
  EXPECT_EQ(partition("groups = [[0, 1],\n [2, 3, \"a1\"]]"),
            "s.toml:6: radio.partitions[0].groups[1][2] = \"a1\": stands in groups twice");
  EXPECT_EQ(partition("groups = [[0, 1], [2, 4]]"),
            "s.toml:5: radio.partitions[0].groups[1][1] = 4: there is no agent 4; they are 0 … 3");
  EXPECT_EQ(partition("groups = [[0, 1], [2, \"b3\"]]"),
            "s.toml:5: radio.partitions[0].groups[1][1] = \"b3\": there is no such agent; did you "
            "mean 'a3'?");
  EXPECT_EQ(partition("groups = [[0, 1, 2, 3], []]"),
            "s.toml:5: radio.partitions[0].groups[1] = []: must name at least one agent");
  EXPECT_EQ(partition("groups = [[0, 1, 2, 3]]"),
            "s.toml:5: radio.partitions[0].groups: needs at least two groups, as [[0, 1], [2, 3]]");
  EXPECT_EQ(partition("from_s = 3"),
            "s.toml:4: radio.partitions[0].groups: needs at least two groups, as [[0, 1], [2, 3]]");
  EXPECT_EQ(partition("groups = [0, 1]"),
            "s.toml:5: radio.partitions[0].groups[0] = 0: expected a group of agents, as [0, 1], "
            "found an integer");
  EXPECT_EQ(partition("groups = [[0, 1.5]]"),
            "s.toml:5: radio.partitions[0].groups[0][1] = 1.5: expected an integer, found a "
            "number");
}

TEST_F(Links, APartitionEndsAfterItBegins) {
  EXPECT_EQ(error("[[radio.partitions]]\ngroups = [[0, 1], [2, 3]]\nfrom_s = 5\nuntil_s = 4"),
            "s.toml:6: radio.partitions[0].until_s = 4: must be after from_s (5.0 s)");
  EXPECT_EQ(error("[[radio.partitions]]\ngroups = [[0, 1], [2, 3]]\nfrom_s = -5"),
            "s.toml:5: radio.partitions[0].from_s = -5: must be at least 0");
}

TEST_F(Links, ARotationIsWhole) {
  const auto rotation = [](const std::string& lines) {
    return error("topology = \"line\"\n[radio.rotation]\ngroups = [[0], [1], [2, 3]]\n" + lines);
  };
  EXPECT_EQ(rotation("period_s = 5"), "no error");
  EXPECT_EQ(rotation(""), "s.toml:4: radio.rotation.period_s: missing");
  EXPECT_EQ(rotation("period_s = 5\ncut_s = 6"),
            "s.toml:7: radio.rotation.cut_s = 6: must be at most period_s (5.0 s)");
  EXPECT_EQ(rotation("period_s = 5\nfrom_s = 6\nuntil_s = 6"),
            "s.toml:8: radio.rotation.until_s = 6: must be after from_s (6.0 s)");
  EXPECT_EQ(error("[radio.rotation]\nperiod_s = 5\ngroups = [[0, 1], [2, 3]]"),
            "s.toml:5: radio.rotation.groups: two groups would be apart all the time; give cut_s "
            "below period_s, or [[radio.partitions]]");
  EXPECT_EQ(error("[radio.rotation]\nperiod_s = 5\ngroups = [[0, 1], [2]]"),
            "s.toml:5: radio.rotation.groups: leaves out agent 3, 'a3'; each stands in one group");
  write("log.toml",
        "world.log.directory = \"d\"\nradio.rotation = { period_s = 5, groups = [[0], [1], [2]] }\n"
        "[[agents]]\ncount = 3\nsensor.kind = \"log\"\n");
  EXPECT_EQ(error_of([] { load_scenario("log.toml", {}, {}); }),
            "log.toml:2: radio.rotation.until_s: missing; only with duration_s it has a default");
}

TEST_F(Links, ThatChangeTooOftenAreRefused) {
  const Scenario scenario = load("[radio.rotation]\nperiod_s = 1e-6\ngroups = [[0], [1], [2, 3]]");
  EXPECT_EQ(error_of([&] { make_link_plan(scenario, agent_positions(scenario), 1); }),
            "s.toml: links change too often: more than 10000000 changes in a run");
}

}  // namespace
}  // namespace hearsay
