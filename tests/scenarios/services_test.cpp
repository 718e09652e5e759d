// What carries agents' words: which services go with which rules, and whole runs over each.
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "scenarios/run.hpp"
#include "tests/scenarios/rule_names.hpp"
#include "tests/scenarios/temp_files.hpp"

namespace hearsay {
namespace {

class Services : public InTempDirectory {
 protected:
  struct Ended {
    std::map<std::string, std::map<AgentId, double>> series;   // at the last sample
    std::map<std::string, std::map<AgentId, double>> scalars;  // by name and agent
  };

  static Ended run(const std::string& scenario, std::uint64_t seed,
                   const std::vector<std::string>& set = {}, const Catalog& catalog = {}) {
    write("s.toml", scenario);
    LogCache logs;
    hearsay::Run one(
        prepare(load_scenario("s.toml", sets(set), known_names(catalog)), catalog, logs), catalog,
        {.seed = seed});
    const RunEnd end = one.run();
    EXPECT_TRUE(end.ok()) << end.message;
    Ended ended;
    const Record& record = one.record();
    for (const SeriesRow& row : record.series()) {
      ended.series[record.text(row.name)][row.agent] = row.value;
    }
    for (const ScalarRow& row : record.scalars()) {
      ended.scalars[record.text(row.name)][row.agent] = row.value;
    }
    return ended;
  }
  static std::string error(const std::string& scenario, const std::vector<std::string>& set = {}) {
    write("s.toml", scenario);
    return error_of([&] { load_scenario("s.toml", sets(set), {}); });
  }
  // Every agent ends with the central filter's belief, each measurement counted once.
  static void expect_central(const Ended& ended, const std::string& what) {
    for (const char* name : {"rms_error_m", "claimed_sigma_m"}) {
      const double central = ended.series.at(name).at(central_agent);
      for (const auto& [agent, value] : ended.series.at(name)) {
        EXPECT_NEAR(value, central, 1e-9 * central) << what << ": " << name << " of " << agent;
      }
    }
    for (const auto& [agent, value] : ended.series.at("multiplicity_max")) {
      EXPECT_NEAR(value, 1.0, 1e-12) << what << ": agent " << agent;
    }
    const double all = ended.scalars.at("measurements").at(central_agent);
    EXPECT_GT(all, 60.0) << what;
  }
};

// Seven agents that look until 30 s and talk until 90 s.
const std::string seven = R"(duration_s = 90
[world]
targets = [{ name = "t", position_m = [0, 50] }]
[record]
series = ["rms_error_m", "claimed_sigma_m", "multiplicity_max"]
[[agents]]
count = 7
circle = { radius_m = 10 }
sensor = { kind = "position", sigma_along_m = 5, sigma_across_m = 1, end_s = 30 }
estimator = { fusion = "local-update" }
talk = { period_s = 3, service = "store-and-forward" }
[radio]
latency_s = 0.01
)";

TEST_F(Services, LocalUpdatesOverStoreAndForwardEndAtTheCentralFilterOnAnyGraphWithLoss) {
  const std::vector<std::vector<std::string>> graphs = {
      {"radio.topology=line"},
      {"radio.topology=ring"},
      {"radio.topology=full"},
      {"radio.topology=grid", "radio.columns=3"},
      {"radio.topology=small-world", "radio.mean_degree=2", "radio.rewire_probability=0.0"},
      {"radio.topology=edges", "radio.edges=[[0,1],[1,2],[2,0],[2,3],[3,4],[4,5],[5,3],[5,6]]"}};
  const std::vector<std::vector<std::string>> channels = {
      {"radio.loss.model=bernoulli", "radio.loss.probability=0.4"},
      {"radio.loss.model=gilbert-elliott", "radio.loss.probability=0.3", "radio.loss.mean_burst=5",
       "radio.jitter.law=exponential", "radio.jitter.spread_s=0.5"}};
  std::uint64_t seed = 0;
  for (const auto& graph : graphs) {
    for (const auto& channel : channels) {
      std::vector<std::string> set = graph;
      set.insert(set.end(), channel.begin(), channel.end());
      expect_central(run(seven, ++seed, set), graph.front() + ", " + channel.front());
    }
  }
}

TEST_F(Services, TheyDoSoAfterPartitionsSleepAndQueuesThatOverflowToo) {
  const std::string bad = R"(topology = "ring"
rate_bps = 4000
queue_packets_max = 3
partitions = [{ groups = [[0, 1, 2], [3, 4, 5, 6]], from_s = 5, until_s = 40 }]
[[dropouts]]
kind = "sleep"
agents = [1]
from_s = 10
until_s = 45
)";
  for (const char* policy : {"drop-new", "drop-oldest", "replace"}) {
    const Ended ended =
        run(seven + bad, 1, {std::string("radio.queue_policy=") + policy, "duration_s=300"});
    expect_central(ended, policy);
    double full = 0.0;
    for (const auto& [agent, count] : ended.scalars.at("packets_queue_full")) full += count;
    EXPECT_GT(full, 100.0) << policy;
  }
}

TEST_F(Services, WhoHasLostItsMemoryGetsBackWhatItEverSaid) {
  const std::string reboot = R"(topology = "line"
[[dropouts]]
kind = "reboot"
agents = [0, 3]
from_s = 20
until_s = 25
)";
  const Ended ended = run(seven + reboot, 1);
  const double sigma = ended.series.at("claimed_sigma_m").at(1);
  for (AgentId a = 0; a < 7; ++a) {
    EXPECT_NEAR(ended.series.at("claimed_sigma_m").at(a), sigma, 1e-9 * sigma);
    EXPECT_NEAR(ended.series.at("multiplicity_max").at(a), 1.0, 1e-12);
  }
  // What they had measured and not yet said is lost for ever.
  EXPECT_GT(sigma, ended.series.at("claimed_sigma_m").at(central_agent));
}

TEST_F(Services, OverBroadcastLocalUpdatesStayWithTheNeighbours) {
  const Ended ended = run(seven, 1, {"agents.talk.service=broadcast", "radio.topology=line"});
  const double central = ended.series.at("claimed_sigma_m").at(central_agent);
  for (AgentId a = 0; a < 7; ++a) {
    EXPECT_GT(ended.series.at("claimed_sigma_m").at(a), 1.3 * central);
  }
  EXPECT_FALSE(ended.scalars.contains("gossip_written"));
}

// A transmitter so slow that updates wait for one another.
TEST_F(Services, AQueueThatReplacesLosesNoLocalUpdates) {
  const Ended ended = run(seven, 1,
                          {"agents.talk.service=broadcast", "radio.topology=full",
                           "radio.rate_bps=150", "radio.queue_policy=replace", "duration_s=200"});
  EXPECT_GT(ended.scalars.at("queue_delay_mean_s").at(0), 3.0);
  expect_central(ended, "replace");
}

TEST_F(Services, ABlackboardCarriesBeliefsToAll) {
  const std::string line =
      "topology = \"line\"\nloss = { model = \"bernoulli\", probability = 0.3 }\n";
  const Ended ended =
      run(seven + line, 1, {"agents.talk.service=blackboard", "agents.estimator.fusion=ci-det"});
  for (AgentId a = 0; a < 7; ++a) {
    EXPECT_EQ(ended.scalars.at("gossip_written").at(a), 30.0) << "one each 3 s";
    EXPECT_GT(ended.scalars.at("gossip_delivered").at(a), 100.0);
    EXPECT_GT(ended.scalars.at("gossip_replaced").at(a), 90.0);
    EXPECT_GT(ended.scalars.at("fusions").at(a), 100.0);
    EXPECT_EQ(ended.scalars.at("messages_refused").at(a), 0.0);
    EXPECT_GT(ended.scalars.at("gossip_delay_mean_s").at(a), 0.01);
  }
}

TEST_F(Services, AcknowledgedGoesToEachNeighbourAndGetsThroughLoss) {
  const std::string line =
      "topology = \"line\"\nloss = { model = \"bernoulli\", probability = 0.3 }\n";
  const Ended ended = run(seven + line, 1,
                          {"agents.talk.service=acknowledged", "agents.talk.phase=together",
                           "radio.acknowledgement.attempts_max=50"});
  EXPECT_EQ(ended.scalars.at("packets").at(0), 11.0) << "from 0 s to 30 s, each 3 s";
  EXPECT_EQ(ended.scalars.at("packets").at(3), 22.0);
  EXPECT_EQ(ended.scalars.at("delivery_ratio").at(3), 1.0);
  EXPECT_GT(ended.scalars.at("frames").at(3), 24.0);
}

// An agent of a user: says one word at the start, writes down what it hears.
class Crier final : public Agent {
 public:
  explicit Crier(Context& own) : Agent(own) {}
  void start() override {
    if (context().id() == 0) spawn(cry());
  }
  void on_packet(const Packet& packet) override {
    context().record_final("from", packet.sender);
    context().record_final("word", value_of<double>(packet).value_or(-1.0));
  }

 private:
  Process cry() {
    co_await context().sleep(1_s);
    const double word = 7.0;
    context().broadcast("cry", bytes_of(word));
  }
};

TEST_F(Services, AreThoseOfUsersAgentsToo) {
  Catalog catalog;
  catalog.add_agent<Crier>("crier", "cries once");
  const std::string criers = R"(duration_s = 60
[radio]
topology = "line"
[[agents]]
kind = "crier"
count = 4
)";
  EXPECT_FALSE(run(criers, 1, {}, catalog).scalars.at("word").contains(2));
  for (const char* service : {"store-and-forward", "blackboard"}) {
    const Ended ended = run(criers, 1, {std::string("agents.talk.service=") + service}, catalog);
    for (AgentId a = 1; a < 4; ++a) {
      EXPECT_EQ(ended.scalars.at("word").at(a), 7.0);
      EXPECT_EQ(ended.scalars.at("from").at(a), 0.0);
    }
  }
}

TEST_F(Services, RulesThatSpeakToNeighboursDoNotGoWithGossip) {
  EXPECT_EQ(error(seven, {"agents.estimator.fusion=channel"}),
            "--set agents.estimator.fusion=channel: agents[0].estimator.fusion: \"channel\" does "
            "not go with talk.service = \"store-and-forward\": it books what it says as known to "
            "its neighbours, and to nobody else; allowed: " +
                rules_but({"channel", "channel-robust", "split-ci"}));
  EXPECT_EQ(error(seven, {"agents.talk.service=blackboard"}),
            "s.toml:10: agents[0].estimator.fusion: \"local-update\" does not go with "
            "talk.service = \"blackboard\": it says only what is new since it last spoke, and on "
            "a blackboard the next words would take the place of words that are not yet read; "
            "allowed: " +
                rules_but({"channel", "channel-robust", "local-update", "split-ci"}));
  const std::string robust = error(seven, {"agents.estimator.fusion=channel-robust"});
  EXPECT_NE(robust.find("it addresses each neighbour"), std::string::npos) << robust;
}

TEST_F(Services, AFleetHasOneService) {
  const std::string other = "[[agents]]\ntalk = { service = \"broadcast\" }\n";
  EXPECT_EQ(error(seven + other),
            "s.toml:15: agents[1].talk.service: \"broadcast\" and \"store-and-forward\" of "
            "agents[0] do not understand each other: give all agents the same service; agents "
            "that only carry have talk.policy = \"never\"");
}

TEST_F(Services, WrongValuesAreRefused) {
  EXPECT_EQ(error(seven, {"radio.gossip.hops_max=0"}),
            "--set radio.gossip.hops_max=0: radio.gossip.hops_max = 0: must be between 1 and 255");
  EXPECT_EQ(error(seven, {"radio.gossip.summary_period_s=0"}),
            "--set radio.gossip.summary_period_s=0: radio.gossip.summary_period_s = 0: must be "
            "greater than 0");
  const std::string unknown = error(seven, {"agents.talk.acknowledged=on"});
  EXPECT_NE(unknown.find("allowed in [agents.talk]: policy, period_s, phase, phase_s, service"),
            std::string::npos)
      << unknown;
  EXPECT_EQ(error(seven, {"agents.talk.service=acknowledged", "agents.talk.policy=never"}),
            "--set agents.talk.service=acknowledged: agents[0].talk.service: \"acknowledged\" is "
            "without effect: this agent never talks");
  const std::string queue = error(seven, {"radio.queue_bytes_max=1000"});
  EXPECT_NE(queue.find("or a summary, takes 1024 bytes"), std::string::npos) << queue;
}

}  // namespace
}  // namespace hearsay
