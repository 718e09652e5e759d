// Trackers with a radio between them.
#include "agents/tracker_agent.hpp"

#include <gtest/gtest.h>

#include <array>
#include <memory>

#include "agents/track_witness.hpp"
#include "agents/trail_message.hpp"

namespace hearsay {
namespace {

struct Pair {
  explicit Pair(gaussian::Rule rule = gaussian::Rule::ci_det,
                std::array<Duration, 2> trails = {Duration(), Duration()})
      : simulation({.end = Time::at(10_s)}), radio(simulation, Topology::full(2), {}) {
    targets.push_back({"a", {{0.0, 0.0}}, Duration()});
    targets.push_back({"b", {{500.0, 0.0}}, Duration()});
    for (AgentId id = 0; id < 2; ++id) {
      contexts.push_back(std::make_unique<Context>(
          simulation, radio, Context::Identity{.id = id, .name = "t", .kind = "tracker"}));
      TrackerAgent::Options options;
      options.tracker = {.q = 0.1, .sigma_max = 50, .tracks_max = 100, .rule = rule};
      options.tracker.trail = trails[id].nanoseconds();
      if (id == 0) {
        scan = std::make_unique<TargetScan>(*contexts.back(), ScanSensor::Options{}, targets);
        options.scanner = scan.get();
      }
      options.talk = PeriodicTalk{.period = 1_s, .phase = 500_ms};
      agents.push_back(std::make_unique<TrackerAgent>(*contexts.back(), options));
      radio.attach(id, *agents.back());
    }
  }
  void start() {
    for (auto& agent : agents) agent->start();
  }
  std::uint64_t refused() {
    agents[1]->finish();
    for (const ScalarRow& row : simulation.record().scalars()) {
      if (simulation.record().text(row.name) == std::string("messages_refused")) {
        return static_cast<std::uint64_t>(row.value);
      }
    }
    return 0;
  }
  Packet packet(std::span<const std::byte> bytes, const char* kind = "tracks") {
    return Packet{.sender = 0,
                  .receiver = 1,
                  .kind = simulation.record().name(kind),
                  .bytes = bytes,
                  .sent = Time(),
                  .rider = nullptr};
  }
  Simulation simulation;
  Radio radio;
  std::vector<TargetTruth> targets;
  std::vector<std::unique_ptr<Context>> contexts;
  std::unique_ptr<TargetScan> scan;
  std::vector<std::unique_ptr<TrackerAgent>> agents;
};

TEST(TrackerAgent, TellsTheOtherOfWhatItSees) {
  Pair pair;
  pair.start();
  EXPECT_TRUE(pair.simulation.run().ok());
  ASSERT_EQ(pair.agents[0]->tracker().tracks().size(), 2u);
  ASSERT_EQ(pair.agents[1]->tracker().tracks().size(), 2u);
  EXPECT_FALSE(pair.agents[1]->tracker().tracks()[0].seen);
  EXPECT_GT(pair.agents[1]->tracker().counts().fusions, 10u);
  EXPECT_EQ(pair.refused(), 0u);
}

// Who keeps trails is understood by who does not, and the other way round.
TEST(TrackerAgent, TellsOfTrailsIfItKeepsThem) {
  std::uint64_t bytes[4];
  for (int i = 0; i < 4; ++i) {
    Pair pair(gaussian::Rule::ci_det, {Duration::nanoseconds(i % 2 * 4'000'000'000ll),
                                       Duration::nanoseconds(i / 2 * 4'000'000'000ll)});
    pair.start();
    EXPECT_TRUE(pair.simulation.run().ok());
    ASSERT_EQ(pair.agents[1]->tracker().tracks().size(), 2u);
    EXPECT_GT(pair.agents[1]->tracker().counts().fusions, 10u);
    EXPECT_EQ(pair.agents[1]->tracker().counts().refused, 0u);
    EXPECT_FALSE(pair.agents[1]->tracker().tracks()[0].trail);  // it sees nothing itself
    const auto& track = pair.agents[0]->tracker().tracks()[0];
    ASSERT_EQ(track.trail.has_value(), i % 2 == 1);
    if (track.trail) {
      EXPECT_EQ(track.trail->steps(), 5);
    }
    EXPECT_EQ(pair.refused(), 0u);
    bytes[i] = pair.radio.counts(0).bytes_sent;
  }
  EXPECT_EQ(bytes[0], bytes[2]);
  EXPECT_EQ(bytes[1], bytes[3]);
  EXPECT_GT(bytes[1], 5 * bytes[0]);
}

TEST(TrackerAgent, WithoutARuleSaysNothing) {
  Pair pair(gaussian::Rule::none);
  pair.start();
  EXPECT_TRUE(pair.simulation.run().ok());
  EXPECT_TRUE(pair.agents[1]->tracker().tracks().empty());
  EXPECT_EQ(pair.radio.counts(0).packets, 0u);
}

gaussian::StampedMessage told(std::uint32_t incarnation, std::uint32_t count, double x) {
  gaussian::Vector mean = gaussian::Vector::Zero(4);
  mean(0) = x;
  return {0,
          {incarnation,
           count,
           {{7, gaussian::Belief::from_moments(mean, gaussian::Matrix::Identity(4, 4))}}}};
}

TEST(TrackerAgent, RefusesWhatIsNotNewerAndForgetsLabelsOfAnotherLife) {
  Pair pair;
  TrackerAgent& agent = *pair.agents[1];
  std::vector<std::byte> bytes;
  const auto hear = [&](std::uint32_t incarnation, std::uint32_t count, double x) {
    gaussian::encode(told(incarnation, count, x), bytes);
    agent.on_packet(pair.packet(bytes));
  };
  hear(0, 2, 0);
  hear(0, 2, 0);
  hear(0, 1, 0);
  EXPECT_EQ(agent.tracker().counts().fusions, 0u);
  EXPECT_EQ(agent.tracker().labels().mine_of(0, 7), 0u);
  // In its next life 7 is something else: in this one it would only have lain apart.
  hear(1, 1, 1000);
  EXPECT_EQ(agent.tracker().labels().mine_of(0, 7), 1u);
  EXPECT_EQ(pair.refused(), 2u);
}

TEST(TrackerAgent, AfterLosingItsMemoryItHasNoTracks) {
  Pair pair;
  std::vector<std::byte> bytes;
  gaussian::encode(told(0, 2, 0), bytes);
  pair.agents[1]->on_packet(pair.packet(bytes));
  pair.agents[1]->on_up(false);
  EXPECT_EQ(pair.agents[1]->tracker().tracks().size(), 1u);
  pair.agents[1]->on_up(true);
  EXPECT_TRUE(pair.agents[1]->tracker().tracks().empty());
  pair.agents[1]->on_packet(pair.packet(bytes));  // as new as any
  EXPECT_EQ(pair.agents[1]->tracker().tracks().size(), 1u);
}

// Whatever arrives is a message or is refused; tracks keep to their bounds.
TEST(TrackerAgent, BearsAnyBytes) {
  Pair pair;
  Stream random(1, Purpose("fuzz"), Entity::agent(0));
  std::vector<std::byte> valid, bytes;
  const int packets = 6000;
  for (int i = 0; i < packets; ++i) {
    gaussian::encode(told(0, static_cast<std::uint32_t>(i + 1), random.normal(0, 1000)), valid);
    bytes = valid;
    for (std::uint64_t k = random.below(4); k-- > 0;) {
      bytes[random.below(bytes.size())] = static_cast<std::byte>(random.below(256));
    }
    if (random.below(4) == 0) bytes.resize(random.below(bytes.size() + 1));
    Packet packet = pair.packet(bytes);
    packet.sender = static_cast<AgentId>(2 + i % 150);  // one that counts too far is heard no more
    pair.agents[1]->on_packet(packet);
  }
  for (const tracking::Track& track : pair.agents[1]->tracker().tracks()) {
    EXPECT_EQ(gaussian::definiteness(track.belief), gaussian::Definiteness::positive);
  }
  EXPECT_LE(pair.agents[1]->tracker().tracks().size(), 100u);
  EXPECT_GT(pair.agents[1]->tracker().counts().born_of_hearsay, 50u);
  EXPECT_GT(pair.refused(), 1000u);
}

TEST(TrackerAgent, BearsAnyBytesOfTrails) {
  Pair pair(gaussian::Rule::ci_det, {4_s, 4_s});
  Stream random(1, Purpose("fuzz"), Entity::agent(0));
  std::vector<std::byte> valid, bytes;
  gaussian::TrajectoryMessage message;
  const gaussian::Belief belief = told(0, 1, 0).message.beliefs[0].belief;
  gaussian::Trajectory trail(4, -2);
  trail.update(0, belief);
  trail.augment(-1, gaussian::white_noise_acceleration(2, 1.0, 0.1));
  for (int i = 0; i < 6000; ++i) {
    const double x = random.normal(0, 1000);
    put_tracks(std::vector<tracking::Report>{{7, told(0, 1, x).message.beliefs[0].belief, trail}},
               0, message);
    message.count = static_cast<std::uint32_t>(i + 1);
    gaussian::encode(message, valid);
    bytes = valid;
    for (std::uint64_t k = random.below(4); k-- > 0;) {
      bytes[random.below(bytes.size())] = static_cast<std::byte>(random.below(256));
    }
    if (random.below(4) == 0) bytes.resize(random.below(bytes.size() + 1));
    Packet packet = pair.packet(bytes, "trails");
    packet.sender = static_cast<AgentId>(2 + i % 150);
    pair.agents[1]->on_packet(packet);
  }
  EXPECT_LE(pair.agents[1]->tracker().tracks().size(), 100u);
  EXPECT_GT(pair.agents[1]->tracker().counts().born_of_hearsay, 50u);
  EXPECT_GT(pair.refused(), 1000u);
}

TEST(TrackWitness, JudgesWithoutBeingNoticed) {
  const auto digest_of = [](Duration period) {
    Pair pair;
    TrackWitness witness(pair.simulation, {.targets = pair.targets,
                                           .score = {},
                                           .period = period,
                                           .gospa_m = true,
                                           .missed_targets = true});
    for (AgentId id = 0; id < 2; ++id) {
      witness.watch(id, *pair.agents[static_cast<std::size_t>(id)]);
    }
    witness.start();
    pair.start();
    EXPECT_TRUE(pair.simulation.run().ok());
    witness.finish();
    const auto& series = pair.simulation.record().series();
    EXPECT_EQ(series[0].value, 10.0);  // at first both are missed: √(2·½·10²)
    EXPECT_EQ(series[1].value, 2.0);
    EXPECT_EQ(series.back().value, 0.0);
    return *gaussian::state(pair.agents[1]->tracker().tracks()[0].belief);
  };
  EXPECT_EQ(digest_of(1_s), digest_of(300_ms));
}

TEST(TargetTruth, LiesBetweenItsStamps) {
  const TargetTruth moving{"m", {{0, 0}, {10, 20}, {30, 20}}, 2_s};
  EXPECT_EQ(moving.at(Time::at(1_s)), (std::array{5.0, 10.0}));
  EXPECT_EQ(moving.at(Time::at(2_s)), (std::array{10.0, 20.0}));
  EXPECT_EQ(moving.at(Time::at(9_s)), (std::array{30.0, 20.0}));
}

}  // namespace
}  // namespace hearsay
