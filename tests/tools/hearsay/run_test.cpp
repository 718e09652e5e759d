// What holds for whole runs.
#include "scenarios/run.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <stdexcept>
#include <thread>

#include "sim/record/digest.hpp"

namespace hearsay {
namespace {

using OneRun = Run;  // in a test, Run is GoogleTest's

const std::string kRumour = HEARSAY_SOURCE_DIR "/scenarios/rumour/rumour.toml";

std::shared_ptr<const PreparedScenario> rumour(const std::vector<std::string>& settings) {
  static const Catalog catalog;
  std::vector<Override> overrides;
  for (const std::string& setting : settings) overrides.push_back(parse_set(setting));
  LogCache logs;
  return prepare(load_scenario(kRumour, overrides, known_names(catalog)), catalog, logs);
}

std::string digest_of(const std::shared_ptr<const PreparedScenario>& prepared, std::uint64_t seed) {
  const Catalog catalog;
  Xxh3Digest digest, ledger;
  OneRun run(prepared, catalog, {.seed = seed, .digest = &digest, .ledger_digest = &ledger});
  EXPECT_EQ(run.run().reason, EndReason::time_reached);
  return digest_text(digest, &ledger);
}

/// Values of one metric over a run: (agent, instant in s) → value.
using Series = std::map<std::pair<AgentId, double>, double>;
Series series_of(const std::shared_ptr<const PreparedScenario>& prepared, std::uint64_t seed,
                 std::string_view metric) {
  const Catalog catalog;
  OneRun run(prepared, catalog, {.seed = seed});
  EXPECT_TRUE(run.run().ok());
  Series found;
  for (const SeriesRow& row : run.record().series()) {
    if (run.record().text(row.name) == metric) found[{row.agent, row.time.seconds()}] = row.value;
  }
  EXPECT_FALSE(found.empty()) << metric;
  return found;
}

TEST(Run, HasTheSameDigestAloneAndAmongEightThreads) {
  const auto scenario = rumour({"radio.topology=ring"});
  std::vector<std::string> alone;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) alone.push_back(digest_of(scenario, seed));
  std::vector<std::string> together(8);
  {
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < 8; ++i) {
      threads.emplace_back([&, i] { together[i] = digest_of(scenario, i + 1); });
    }
  }
  EXPECT_EQ(alone, together);
  EXPECT_NE(alone[0], alone[1]);
}

TEST(Run, AHundredOfThemLiveInOneProcessSideBySide) {
  const auto scenario = rumour({"duration_s=20", "agents.sensor.end_s=19"});
  const Catalog catalog;
  const std::string wanted = digest_of(scenario, 5);
  std::vector<std::unique_ptr<Xxh3Digest>> digests, ledgers;
  std::vector<std::unique_ptr<OneRun>> runs;
  for (int i = 0; i < 100; ++i) {
    digests.push_back(std::make_unique<Xxh3Digest>());
    ledgers.push_back(std::make_unique<Xxh3Digest>());
    runs.push_back(std::make_unique<OneRun>(
        scenario, catalog,
        OneRun::Options{
            .seed = 5, .digest = digests.back().get(), .ledger_digest = ledgers.back().get()}));
  }
  for (int i = 99; i >= 0; --i) {
    const auto n = static_cast<std::size_t>(i);
    runs[n]->run();
    EXPECT_EQ(digest_text(*digests[n], ledgers[n].get()), wanted);
  }
}

TEST(Run, TheSamePacketsAreLostUnderEveryRule) {
  // Under channel-robust each neighbour gets a frame of its own, under the others all hear one.
  using Key = std::tuple<AgentId, AgentId, std::int64_t>;
  std::map<Key, std::string> reference;
  for (const char* rule : {"naive", "channel", "channel-robust", "ci-det", "ci-trace"}) {
    const auto scenario =
        rumour({"radio.topology=full", "radio.loss.probability=0.4", "record.messages=all",
                std::string("agents.estimator.fusion=") + rule});
    const Catalog catalog;
    OneRun run(scenario, catalog, {.seed = 3});
    ASSERT_TRUE(run.run().ok());
    std::map<Key, std::string> fates;
    for (const MessageRow& row : run.record().messages()) {
      fates[{row.sender, row.receiver, row.sent.nanoseconds()}] = run.record().text(row.fate);
    }
    if (reference.empty()) reference = fates;
    EXPECT_EQ(fates, reference) << rule;
  }
  EXPECT_GT(reference.size(), 400u);
}

TEST(Run, TheMeasurementsAreTheSameUnderEveryRuleAndLoss) {
  const Series none = series_of(rumour({"agents.estimator.fusion=none"}), 9, "rms_error_m");
  for (const char* rule : {"naive", "ci-det"}) {
    const Series other = series_of(
        rumour({std::string("agents.estimator.fusion=") + rule, "radio.loss.probability=0.9"}), 9,
        "rms_error_m");
    for (const auto& [key, value] : other) {
      if (key.first != central_agent) continue;
      EXPECT_EQ(value, none.at(key)) << key.second;
    }
  }
}

TEST(Run, ChannelRobustEqualsTheCentralFilterOverWhatReachedItOnEveryTree) {
  for (const char* topology : {"line", "star", "edges"}) {
    for (const char* phase : {"staggered", "together", "random"}) {
      std::vector<std::string> settings = {
          std::string("radio.topology=") + topology, std::string("agents.talk.phase=") + phase,
          "agents.estimator.fusion=channel-robust",  "radio.loss.probability=0.4",
          "record.series=[\"reach_gap\"]",           "record.series_period_s=1"};
      if (topology == std::string("edges")) {
        settings.push_back("radio.edges=[[0, 1], [1, 2], [1, 3], [3, 4]]");
      }
      for (const auto& [key, gap] : series_of(rumour(settings), 4, "reach_gap")) {
        EXPECT_LE(gap, 1e-9) << topology << ' ' << phase << " agent " << key.first;
      }
    }
  }
}

TEST(Run, WhoIsDownDisagreesWithNobody) {
  const Series apart = series_of(
      rumour({"radio.topology=line", "agents.estimator.fusion=none", "record.series_period_s=10",
              "record.series=['disagreement_m']",
              "dropouts=[{ agents = ['agent4'], kind = 'sleep', from_s = 15, until_s = 35 }]"}),
      2, "disagreement_m");
  for (const auto& [key, distance_m] : apart) {
    const auto [agent, t_s] = key;
    EXPECT_EQ(std::isnan(distance_m), agent == 4 && t_s > 15.0 && t_s < 35.0)
        << agent << " at " << t_s;
  }
}

TEST(Run, AgreementIsReachedAgainAfterAHealAndAskingForItChangesNothing) {
  const std::vector<std::string> cut = {
      "radio.topology=line",
      "radio.loss.probability=0",
      "agents.estimator.fusion=channel-robust",
      "duration_s=60",
      "agents.sensor.end_s=29",
      "radio.partitions=[{ groups = [[0, 1], [2, 3, 4]], from_s = 10, until_s = 30 }]"};
  std::vector<std::string> asked = cut;
  asked.push_back("record.agreement={ from_s = 30, within_m = 1e-9 }");
  const Catalog catalog;
  OneRun without(rumour(cut), catalog, {.seed = 6});
  OneRun with(rumour(asked), catalog, {.seed = 6});
  ASSERT_TRUE(without.run().ok() && with.run().ok());
  std::vector<double> times;
  for (const ScalarRow& row : with.record().scalars()) {
    if (with.record().text(row.name) == "agree_again_s") times.push_back(row.value);
  }
  // News goes one hop a talk (5 s) at least, over four hops; by then all have every measurement.
  ASSERT_EQ(times.size(), 1u);
  EXPECT_GT(times[0], 0.0);
  EXPECT_LE(times[0], 20.0);
  EXPECT_EQ(with.record().scalars().size(), without.record().scalars().size() + 1);
  ASSERT_EQ(with.record().series().size(), without.record().series().size());
  for (std::size_t i = 0; i < with.record().series().size(); ++i) {
    const SeriesRow &a = with.record().series()[i], &b = without.record().series()[i];
    EXPECT_TRUE(a.value == b.value || (std::isnan(a.value) && std::isnan(b.value)));
  }
}

TEST(Run, OnALoopChannelRobustCountsTwice) {
  const Series gaps =
      series_of(rumour({"agents.estimator.fusion=channel-robust", "record.series=[\"reach_gap\"]"}),
                4, "reach_gap");
  EXPECT_GT(gaps.at({0, 120.0}), 0.1);
}

TEST(Run, TheLedgersTrueCovarianceAgreesWithMonteCarlo) {
  // Over repetitions with the same losses in each (none), e is N(0, P_true): its mean square must
  // be tr P_true / n. A χ² mean of 2·200 degrees of freedom: four standard errors are 4·√(2/400) =
  // 28 %.
  for (const char* rule : {"naive", "channel", "channel-robust", "ci-det", "none"}) {
    const auto scenario =
        rumour({std::string("agents.estimator.fusion=") + rule, "radio.loss.probability=0.0",
                "agents.sensor.sigma_along_m=4", "agents.sensor.sigma_across_m=4"});
    const Catalog catalog;
    std::map<AgentId, double> square, variance;
    constexpr int repetitions = 200;
    for (std::uint64_t seed = 1; seed <= repetitions; ++seed) {
      OneRun run(scenario, catalog, {.seed = seed});
      ASSERT_TRUE(run.run().ok());
      const Record& record = run.record();
      for (const SeriesRow& row : record.series()) {
        if (row.time != Time::at(120_s) || row.agent < 0) continue;
        const double term = row.value * row.value / repetitions;
        if (record.text(row.name) == "rms_error_m") square[row.agent] += term;
        if (record.text(row.name) == "true_sigma_m") variance[row.agent] += term;
      }
    }
    ASSERT_EQ(square.size(), 5u);
    for (const auto& [agent, value] : square) {
      EXPECT_NEAR(value / variance.at(agent), 1.0, 0.28) << rule << " agent " << agent;
    }
  }
}

TEST(Run, SwitchingTheLedgerOffChangesNothingElse) {
  const Catalog catalog;
  std::string hex[2];
  std::size_t i = 0;
  for (const char* ledger : {"on", "off"}) {
    Xxh3Digest digest;
    OneRun run(rumour({std::string("record.ledger=") + ledger}), catalog,
               {.seed = 2, .digest = &digest});
    ASSERT_TRUE(run.run().ok());
    hex[i++] = digest.hex();
  }
  EXPECT_EQ(hex[0], hex[1]);
}

class Fragile final : public Agent {
 public:
  explicit Fragile(Context& own) : Agent(own) {}
  void start() override { spawn(live()); }

 private:
  Process live() {
    co_await context().sleep(2_s);
    if (context().id() == 1) throw std::runtime_error("out of battery");
  }
};

TEST(Run, AFailureNamesTheAgentAndTheSimulatedTime) {
  Catalog catalog;
  catalog.add_agent<Fragile>("fragile", "breaks");
  Scenario scenario;
  scenario.duration_s = 10;
  scenario.agents = {AgentSpec{.name = "vase", .kind = "fragile", .count = 3}};
  LogCache logs;
  OneRun run(prepare(scenario, catalog, logs), catalog, {});
  const RunEnd end = run.run();
  EXPECT_EQ(end.reason, EndReason::agent_failed);
  EXPECT_EQ(end.agent, 1);
  EXPECT_EQ(end.at, Time::at(2_s));
  EXPECT_EQ(end.message, "agent 'vase1' failed at 2.000000000 s: out of battery");
}

}  // namespace
}  // namespace hearsay
