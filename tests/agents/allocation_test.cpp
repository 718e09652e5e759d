// A fleet that talks allocates nothing a packet once it is warm.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "agents/estimator_agent.hpp"
#include "agents/localizer_agent.hpp"
#include "agents/lookout.hpp"
#include "agents/pose_witness.hpp"
#include "sim/math/functions.hpp"
#include "tools/memory/memory.hpp"

namespace hearsay {
namespace {

using memory::allocations;

/// Allocations between 60 s and 119 s of a fleet of five on a full graph that talks every second.
std::size_t allocations_of(gaussian::Rule rule, bool ledger, bool measures) {
  Simulation simulation({.seed = 1, .end = Time::at(120_s), .record = {}});
  Witness witness(simulation, {.subjects = {{.name = "target", .truth = {0.0, 0.0}}},
                               .series = {},
                               .series_period = 1000_s,
                               .ledger = ledger});
  Radio radio(simulation, Topology::full(5), {.latency = 10_ms, .loss = Loss::bernoulli(0.2)});
  std::vector<std::unique_ptr<Context>> contexts;
  std::vector<std::unique_ptr<EstimatorAgent>> agents;
  std::vector<std::unique_ptr<Lookout>> lookouts;
  for (AgentId id = 0; id < 5; ++id) {
    contexts.push_back(std::make_unique<Context>(
        simulation, radio,
        Context::Identity{.id = id, .name = "agent", .kind = "estimator", .parameters = {}}));
    EstimatorAgent::Options options;
    options.rule = rule;
    options.talk = PeriodicTalk{.period = 1_s, .phase = 100_ms * id};
    agents.push_back(std::make_unique<EstimatorAgent>(*contexts.back(), witness, options));
    Lookout::Options looks;
    looks.sensors = {PositionSensor(
        {.sensor_m = {10.0 + id, 5.0}, .sigma_along_m = 3.0 + id, .sigma_across_m = 1.0})};
    if (!measures) looks.end = Time::at(50_s);
    lookouts.push_back(std::make_unique<Lookout>(*contexts.back(), witness, *agents.back(), looks));
    radio.attach(id, *agents.back());
  }
  witness.start();
  for (AgentId id = 0; id < 5; ++id) {
    lookouts[static_cast<std::size_t>(id)]->start();
    agents[static_cast<std::size_t>(id)]->start();
  }
  std::size_t before = 0, after = 0;
  simulation.schedule(Time::at(60_s), Phase::observe, [&] { before = allocations(); });
  simulation.schedule(Time::at(119_s), Phase::observe, [&] { after = allocations(); });
  EXPECT_TRUE(simulation.run().ok());
  EXPECT_GT(agents[0]->estimator().counts().fusions, 300u);
  return after - before;
}

TEST(Allocation, WithoutLedgerAFleetAllocatesNothingOnceItIsWarm) {
  using gaussian::Rule;
  for (const Rule rule :
       {Rule::naive, Rule::channel, Rule::channel_robust, Rule::ci_det, Rule::ci_batch,
        Rule::split_ci, Rule::consensus_information, Rule::hybrid_consensus}) {
    EXPECT_EQ(allocations_of(rule, false, true), 0u) << gaussian::info(rule).name;
  }
}

TEST(Allocation, WithLedgerAFleetAllocatesNothingWhileNoMeasurementIsNew) {
  using gaussian::Rule;
  for (const Rule rule : {Rule::naive, Rule::channel, Rule::channel_robust, Rule::ci_det}) {
    EXPECT_EQ(allocations_of(rule, true, false), 0u) << gaussian::info(rule).name;
  }
}

/// Between 60 s and 119 s of two robots that see a landmark and each other, and talk every second.
std::size_t allocations_of_localizers(gaussian::Rule rule) {
  Simulation simulation({.seed = 1, .end = Time::at(120_s), .record = {}});
  Radio radio(simulation, Topology::full(2), {.latency = 10_ms, .loss = Loss::bernoulli(0.2)});
  std::vector<Journey> journeys(2);
  const Eigen::Vector2d landmark(2.0, 3.0);
  PoseWitness::Options watched{.names = {"a", "b"}, .series_period = 1000_s};
  for (int robot = 0; robot < 2; ++robot) {
    Journey& journey = journeys[static_cast<std::size_t>(robot)];
    journey.start = {4.0 * robot, 0.0, math::pi * robot};
    for (int k = 1; k < 1200; ++k) {
      journey.drives.push_back({Time() + 100_ms * k, k % 4 < 2 ? 0.1 : -0.1, 0.0});
      journey.encounters.push_back({Time() + 100_ms * k, k % 2 == 0, k % 2 == 0 ? 1 - robot : 0,
                                    k % 2 == 0 ? 4.0 : std::hypot(2.0, 3.0),
                                    k % 2 == 0 ? 0.0 : std::atan2(3.0, 2.0) * (1 - 2 * robot)});
    }
    watched.central.start.push_back(journey.start);
  }
  watched.journeys = journeys;
  PoseWitness witness(simulation, watched);
  std::vector<std::unique_ptr<Context>> contexts;
  std::vector<std::unique_ptr<LocalizerAgent>> agents;
  for (AgentId id = 0; id < 2; ++id) {
    contexts.push_back(std::make_unique<Context>(
        simulation, radio,
        Context::Identity{.id = id, .name = "robot", .kind = "localizer", .parameters = {}}));
    const Journey& journey = journeys[static_cast<std::size_t>(id)];
    agents.push_back(std::make_unique<LocalizerAgent>(
        *contexts.back(), witness,
        LocalizerAgent::Options{.filter = {.start = {journey.start}},
                                .drives = journey.drives,
                                .encounters = journey.encounters,
                                .landmarks = std::span(&landmark, 1),
                                .memory = 20_s,
                                .rule = rule,
                                .talk = PeriodicTalk{.period = 1_s, .phase = 100_ms * id}}));
    radio.attach(id, *agents.back());
  }
  for (const auto& agent : agents) agent->start();
  std::size_t before = 0, after = 0;
  simulation.schedule(Time::at(60_s), Phase::observe, [&] { before = allocations(); });
  simulation.schedule(Time::at(119_s), Phase::observe, [&] { after = allocations(); });
  EXPECT_TRUE(simulation.run().ok());
  for (const auto& agent : agents) agent->finish();
  for (const ScalarRow& row : simulation.record().scalars()) {
    if (simulation.record().text(row.name) == "fusions") {
      EXPECT_GT(row.value, 300.0);
    }
  }
  return after - before;
}

TEST(Allocation, LocalizersAllocateNothingOnceTheyAreWarm) {
  EXPECT_EQ(allocations_of_localizers(gaussian::Rule::naive), 0u);
  EXPECT_EQ(allocations_of_localizers(gaussian::Rule::ci_half), 0u);
}

}  // namespace
}  // namespace hearsay
