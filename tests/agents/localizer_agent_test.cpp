// Localizers with a radio between them, and one who listens in.
#include "agents/localizer_agent.hpp"

#include "agents/pose_witness.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace hearsay {
namespace {

using gaussian::Belief;
using gaussian::Rule;
using gaussian::StampedMessage;
using localization::Place;
using localization::Pose;
using localization::PoseFilter;
using localization::RelativeSighting;

struct Listener : Receiver {
  void on_packet(const Packet& packet) override {
    StampedMessage message;
    EXPECT_TRUE(gaussian::decode(packet.bytes, message));
    EXPECT_EQ(message.message.beliefs.size(), 1U);
    heard.push_back({packet.sender, packet.sent, message});
  }
  struct Heard {
    AgentId sender;
    Time sent;
    StampedMessage message;
  };
  std::vector<Heard> heard;
};

constexpr double all_pass = 1e12;
const Eigen::Vector2d landmark(0.0, 4.0);

/// Robot 0 stands at the origin and faces +x, robot 1 at (3, 0) and faces it. Robot 0 alone knows
/// the landmark, and talks.
struct Pair {
  struct Setting {
    Rule rule = Rule::naive;
    std::vector<Encounter> of_0 = {}, of_1 = {};
    std::optional<PeriodicTalk> talk = PeriodicTalk{.period = 1_s, .phase = 500_ms};
    double gate = all_pass;
    std::vector<Drive> drives_1 = {};
    Duration memory = 4_s;
  };
  explicit Pair(const Setting& setting)
      : simulation({.end = Time::at(10_s)}), radio(simulation, Topology::full(3), {}) {
    journeys.push_back({.start = {0.0, 0.0, 0.0}, .encounters = setting.of_0});
    journeys.push_back(
        {.start = {3.0, 0.0, 3.0}, .drives = setting.drives_1, .encounters = setting.of_1});
    PoseWitness::Options watched;
    watched.names = {"a", "b"};
    watched.journeys = journeys;
    watched.central = options_of(0, setting.gate);
    watched.central.start.push_back(journeys[1].start);
    watched.series_period = 1_s;
    witness = std::make_unique<PoseWitness>(simulation, watched);
    for (AgentId id = 0; id < 2; ++id) {
      contexts.push_back(std::make_unique<Context>(
          simulation, radio, Context::Identity{.id = id, .name = "r", .kind = "localizer"}));
      const Journey& journey = journeys[static_cast<std::size_t>(id)];
      LocalizerAgent::Options options;
      options.filter = options_of(id, setting.gate);
      options.drives = journey.drives;
      options.encounters = journey.encounters;
      if (id == 0) options.landmarks = std::span(&landmark, 1);
      options.memory = setting.memory;
      options.rule = setting.rule;
      if (id == 0) options.talk = setting.talk;
      agents.push_back(std::make_unique<LocalizerAgent>(*contexts.back(), *witness, options));
      witness->watch(id, *agents.back());
      radio.attach(id, *agents.back());
    }
    radio.attach(2, listener);
  }
  PoseFilter::Options options_of(AgentId id, double gate = all_pass) const {
    PoseFilter::Options options;
    options.start = {journeys[static_cast<std::size_t>(id)].start};
    options.start_sigma_m = id == 0 ? 0.05 : 1.0;
    options.gate = gate;
    return options;
  }
  void run() {
    witness->start();
    for (auto& agent : agents) agent->start();
    const RunEnd end = simulation.run();
    EXPECT_TRUE(end.ok()) << end.message;
    for (auto& agent : agents) agent->finish();
  }
  double count(AgentId id, const std::string& name) const {
    for (const ScalarRow& row : simulation.record().scalars()) {
      if (row.agent == id && simulation.record().text(row.name) == name) return row.value;
    }
    ADD_FAILURE() << "no " << name;
    return -1;
  }
  /// Robot 1 hears these bytes from `sender` at `time`.
  void hear(Time time, std::vector<std::byte> bytes, AgentId sender = 0) {
    simulation.schedule(time, Phase::act, [this, bytes = std::move(bytes), sender] {
      agents[1]->on_packet({.sender = sender,
                            .receiver = 1,
                            .kind = simulation.record().name("position"),
                            .bytes = bytes,
                            .sent = simulation.now(),
                            .rider = nullptr});
    });
  }
  Simulation simulation;
  Radio radio;
  std::vector<Journey> journeys;
  std::unique_ptr<PoseWitness> witness;
  std::vector<std::unique_ptr<Context>> contexts;
  std::vector<std::unique_ptr<LocalizerAgent>> agents;
  Listener listener;
};

Pair::Setting silent_with(Rule rule) {
  Pair::Setting setting;
  setting.rule = rule;
  setting.talk = std::nullopt;
  return setting;
}

std::vector<std::byte> bytes_of(const StampedMessage& message) {
  std::vector<std::byte> bytes;
  gaussian::encode(message, bytes);
  return bytes;
}

const Place told{{3.4, 0.3}, (Eigen::Matrix2d() << 0.04, 0.01, 0.01, 0.09).finished()};

std::vector<std::byte> about(AgentId subject, Time stamp, const Place& place = told) {
  return bytes_of({stamp.nanoseconds(),
                   {0,
                    1,
                    {{static_cast<std::uint32_t>(subject),
                      Belief::from_moments(place.mean, place.covariance)}}}});
}

void expect_same(const PoseFilter& filter, const PoseFilter& expected) {
  EXPECT_NEAR(filter.pose(0).x_m, expected.pose(0).x_m, 1e-10);
  EXPECT_NEAR(filter.pose(0).y_m, expected.pose(0).y_m, 1e-10);
  EXPECT_NEAR(filter.pose(0).heading_rad, expected.pose(0).heading_rad, 1e-10);
  EXPECT_LT((filter.covariance(0) - expected.covariance(0)).cwiseAbs().maxCoeff(), 1e-10);
}

void expect_place(const StampedMessage& said, const Place& place) {
  const Belief& belief = said.message.beliefs.front().belief;
  EXPECT_LT((gaussian::state(belief).value() - place.mean).norm(), 1e-9);
  EXPECT_LT((gaussian::covariance(belief).value() - place.covariance).norm(), 1e-9);
}

TEST(LocalizerAgent, SaysWhereItIsNowAndWhereItSawCompanionsThen) {
  Pair pair(
      {.of_0 = {{Time::at(1_s), false, 0, 4.1, 1.5}, {Time::at(1200_ms), true, 1, 3.0, 0.1}}});
  PoseFilter expected(pair.options_of(0));
  pair.run();
  std::vector<Listener::Heard> of_0;
  for (const auto& heard : pair.listener.heard) {
    if (heard.sender == 0) of_0.push_back(heard);
  }
  ASSERT_EQ(of_0.size(), 10U + 1U);  // 0.5, 1.5, … and once of what it saw
  const auto position = [&] {
    const Pose& pose = expected.pose(0);
    return Place{{pose.x_m, pose.y_m}, expected.covariance(0).topLeftCorner<2, 2>()};
  };
  expected.drive(0, 0, 0, 0.5);
  EXPECT_EQ(of_0[0].message.stamp, Time::at(500_ms).nanoseconds());
  EXPECT_EQ(of_0[0].message.message.beliefs[0].subject, 0U);
  expect_place(of_0[0].message, position());
  expected.drive(0, 0, 0, 0.5);
  expected.saw_place(0, landmark, {4.1, 1.5, 0.15, 0.08});
  expected.drive(0, 0, 0, 0.2);
  const Place seen =
      localization::place_of(expected.pose(0), expected.covariance(0), {3.0, 0.1, 0.15, 0.08});
  expected.drive(0, 0, 0, 0.3);
  EXPECT_EQ(of_0[1].message.stamp, Time::at(1500_ms).nanoseconds());
  expect_place(of_0[1].message, position());
  EXPECT_EQ(of_0[2].message.stamp, Time::at(1200_ms).nanoseconds());
  EXPECT_EQ(of_0[2].message.message.beliefs[0].subject, 1U);
  expect_place(of_0[2].message, seen);
  EXPECT_EQ(of_0[3].message.message.beliefs[0].subject, 0U);  // what it saw is said once
  EXPECT_EQ(pair.count(0, "measurements"), 2.0);
}

TEST(LocalizerAgent, WhoIsSeenLearnsWhereItIs) {
  Pair pair({.of_0 = {{Time::at(1200_ms), true, 1, 3.0, 0.0}}});
  pair.run();
  EXPECT_EQ(pair.count(1, "fusions"), 1.0);
  EXPECT_EQ(pair.count(1, "messages_refused"), 0.0);
  // It began with 1 m an axis; the one who saw it with 0.05 m, and sees 0.15 m and 0.08 rad · 3 m.
  EXPECT_LT(std::sqrt(pair.agents[1]->filter().covariance(0)(0, 0)), 0.3);
  EXPECT_EQ(pair.count(0, "fusions"), 0.0);
}

TEST(LocalizerAgent, ALandmarkBeyondThoseItKnowsTellsItNothing) {
  Pair pair(
      {.of_0 = {{Time::at(1_s), false, 1, 4.1, 1.5}}, .of_1 = {{Time::at(1_s), false, 0, 5, 1}}});
  pair.run();
  EXPECT_EQ(pair.count(0, "measurements"), 0.0);
  EXPECT_EQ(pair.count(1, "measurements"), 0.0);
}

// It drives on meanwhile: what it is told of is 2 s behind.
TEST(LocalizerAgent, TakesInWhatItHearsAboutItselfAsOfThen) {
  Pair::Setting setting = silent_with(Rule::naive);
  for (int i = 0; i < 500; ++i) setting.drives_1.push_back({Time() + 20_ms * i, 0.2, 0.1});
  Pair pair(setting);
  PoseFilter expected(pair.options_of(1));
  pair.hear(Time::at(6_s), about(1, Time::at(4_s)));
  DeadReckoning reckoning(10_s, 20_ms);
  Odometer odometer(pair.journeys[1].drives);
  const auto drive_to = [&](Time time) {
    odometer.advance(time, [&](Time until, double forward, double turn, double dt_s) {
      expected.drive(0, forward, turn, dt_s);
      reckoning.drive(until, forward, turn, dt_s);
    });
  };
  pair.run();
  drive_to(Time::at(6_s));
  const auto behind = reckoning.behind(Time::at(4_s));
  ASSERT_TRUE(behind);
  EXPECT_EQ(localization::take_position(expected, {Rule::naive, all_pass}, told, *behind, 2.0, {}),
            localization::Taken::fused);
  drive_to(Time::at(10_s));
  EXPECT_EQ(pair.count(1, "fusions"), 1.0);
  const PoseFilter& filter = pair.agents[1]->filter();
  // Its own samples are 50 ms apart, these 20 ms: an arc of 0.2 m/s and 0.1 rad/s is 6e-6 m off.
  EXPECT_NEAR(filter.pose(0).x_m, expected.pose(0).x_m, 1e-5);
  EXPECT_NEAR(filter.pose(0).y_m, expected.pose(0).y_m, 1e-5);
  EXPECT_LT((filter.covariance(0) - expected.covariance(0)).cwiseAbs().maxCoeff(), 1e-5);
}

TEST(LocalizerAgent, KeepsWhatACompanionSaysOfItselfUntilItSeesIt) {
  Pair::Setting setting = silent_with(Rule::naive);
  setting.of_1 = {{Time::at(3_s), true, 0, 3.2, 0.2}};
  Pair pair(setting);
  const Place of_0{{0.1, -0.1}, told.covariance};
  pair.hear(Time::at(1_s), about(0, Time::at(1_s), of_0));
  pair.run();
  PoseFilter expected(pair.options_of(1));
  expected.drive(0, 0, 0, 3.0);
  Place aged = of_0;  // by 2 s at 0.1 m/s
  aged.covariance += 0.04 * Eigen::Matrix2d::Identity();
  EXPECT_EQ(
      localization::take_sighting(expected, {Rule::naive, all_pass}, aged, {3.2, 0.2, 0.15, 0.08}),
      localization::Taken::fused);
  expected.drive(0, 0, 0, 7.0);
  EXPECT_EQ(pair.count(1, "fusions"), 1.0);
  expect_same(pair.agents[1]->filter(), expected);
}

TEST(LocalizerAgent, RefusesWhatIsNoNewsOrNoMessage) {
  Pair pair(silent_with(Rule::naive));
  const Time now = Time::at(3_s);
  std::vector<std::byte> cut = about(1, Time::at(1_s));
  cut.pop_back();
  const auto with = [](const Belief& belief) {
    return bytes_of({Time::at(1_s).nanoseconds(), {0, 1, {{1, belief}}}});
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Belief mean_nan = Belief::from_moments(told.mean, told.covariance), matrix_nan = mean_nan;
  mean_nan.xi(0) = nan;
  matrix_nan.omega(0, 0) = nan;
  Belief infinite = matrix_nan, indefinite = matrix_nan;
  infinite.omega(0, 0) = std::numeric_limits<double>::infinity();
  indefinite.omega(0, 0) = -1.0;
  int refused = 0;
  const auto refuses = [&](std::vector<std::byte> bytes) {
    pair.hear(now, std::move(bytes));
    ++refused;
  };
  refuses({});
  refuses(cut);
  refuses(with(mean_nan));
  refuses(with(matrix_nan));
  refuses(with(infinite));
  refuses(with(indefinite));
  refuses(with(Belief::unknown(2)));
  refuses(with(Belief::from_moments(Eigen::Vector3d(1, 2, 3), Eigen::Matrix3d::Identity())));
  refuses(
      with(Belief::from_moments(Eigen::Matrix<double, 1, 1>(1), Eigen::Matrix<double, 1, 1>(1))));
  refuses(about(1, now + 1_ms));
  refuses(about(1, Time() - 1_ms));
  refuses(bytes_of({0, {0, 1, {}}}));
  refuses(bytes_of({0, {0, 1, {{1, Belief::unknown(2)}, {0, Belief::unknown(2)}}}}));
  pair.run();
  EXPECT_EQ(pair.count(1, "messages_refused"), refused);
  EXPECT_EQ(pair.count(1, "fusions"), 0.0);
  PoseFilter expected(pair.options_of(1));
  expected.drive(0, 0, 0, 10.0);
  expect_same(pair.agents[1]->filter(), expected);
}

TEST(LocalizerAgent, TakesTheSameFromTheSameSenderOnce) {
  Pair pair(silent_with(Rule::naive));
  pair.hear(Time::at(3_s), about(1, Time::at(2_s)));
  pair.hear(Time::at(4_s), about(1, Time::at(2_s)));         // twice
  pair.hear(Time::at(4_s), about(1, Time::at(1_s)));         // overtaken
  pair.hear(Time::at(4_s), about(1, Time::at(2_s)), 2);      // another's
  pair.hear(Time::at(4_s), about(1, Time::at(2_s) + 1_ms));  // newer
  pair.hear(Time::at(5_s), about(0, Time::at(5_s)));
  pair.hear(Time::at(6_s), about(0, Time::at(5_s)));  // twice
  pair.hear(Time::at(6_s), about(0, Time::at(4_s)));  // overtaken
  pair.hear(Time::at(6_s), about(7, Time::at(4_s)));  // about a third: nothing to it
  pair.run();
  EXPECT_EQ(pair.count(1, "fusions"), 3.0);
  EXPECT_EQ(pair.count(1, "messages_refused"), 4.0);
}

TEST(LocalizerAgent, WhatIsOlderThanItsMemoryIsLate) {
  Pair pair(silent_with(Rule::naive));  // 4 s
  pair.hear(Time::at(7_s), about(1, Time::at(3_s) - Duration::nanoseconds(1)));
  pair.hear(Time::at(7_s), about(1, Time::at(3_s)));
  pair.run();
  EXPECT_EQ(pair.count(1, "news_late"), 1.0);
  EXPECT_EQ(pair.count(1, "fusions"), 1.0);
  EXPECT_EQ(pair.count(1, "messages_refused"), 0.0);
}

TEST(LocalizerAgent, WhatLiesBeyondTheGateIsCounted) {
  Pair::Setting setting = silent_with(Rule::ci_det);
  setting.gate = 9.0;
  setting.of_0 = {{Time::at(1_s), false, 0, 9.0, 1.5}, {Time::at(2_s), false, 0, 4.0, 1.57}};
  Pair pair(setting);
  pair.hear(Time::at(3_s), about(1, Time::at(3_s), {{8.0, 0.0}, told.covariance}));
  pair.run();
  EXPECT_EQ(pair.count(0, "outside_gate"), 1.0);
  EXPECT_EQ(pair.count(0, "measurements"), 2.0);
  EXPECT_EQ(pair.count(1, "outside_gate"), 1.0);
  EXPECT_EQ(pair.count(1, "fusions"), 0.0);
}

TEST(LocalizerAgent, AfterLosingItsMemoryItKnowsWhereItIsButNotWhatOthersSaid) {
  for (const bool forgets : {false, true}) {
    Pair::Setting setting = silent_with(Rule::naive);
    setting.of_1 = {{Time::at(6_s), true, 0, 3.2, 0.2}};
    Pair pair(setting);
    pair.hear(Time::at(3_s), about(1, Time::at(3_s)));
    pair.hear(Time::at(3_s), about(0, Time::at(3_s), {{0.0, 0.0}, told.covariance}));
    Eigen::Matrix3d before = Eigen::Matrix3d::Zero(), after = before;
    pair.simulation.schedule(Time::at(5_s), Phase::act, [&] {
      before = pair.agents[1]->filter().covariance(0);
      pair.agents[1]->on_up(forgets);
      after = pair.agents[1]->filter().covariance(0);
    });
    pair.hear(Time::at(6500_ms), about(1, Time::at(3_s)));
    pair.run();
    EXPECT_EQ(before, after);
    EXPECT_LT(before(0, 0), 0.1);
    // Who forgets has no place of 0 when it sees it, but takes the old news as new.
    EXPECT_EQ(pair.count(1, "fusions"), 2.0);
    EXPECT_EQ(pair.count(1, "messages_refused"), forgets ? 0.0 : 1.0);
  }
}

TEST(LocalizerAgent, WithoutARuleItNeitherSaysNorTakesAnything) {
  Pair pair({.rule = Rule::none, .of_0 = {{Time::at(1_s), true, 1, 3.0, 0.1}}});
  pair.hear(Time::at(3_s), about(1, Time::at(3_s)));
  pair.hear(Time::at(3_s), {});
  pair.run();
  EXPECT_TRUE(pair.listener.heard.empty());
  EXPECT_EQ(pair.count(1, "fusions"), 0.0);
  EXPECT_EQ(pair.count(1, "messages_refused"), 0.0);
  EXPECT_EQ(pair.count(0, "measurements"), 1.0);  // the central filter uses it
}

// Whatever arrives, its pose stays one, and the run goes on.
TEST(LocalizerAgent, BearsAnyBytes) {
  for (const Rule rule : {Rule::naive, Rule::ci_det, Rule::ci_trace, Rule::ci_half}) {
    Pair::Setting setting = silent_with(rule);
    setting.gate = 100.0;
    for (int k = 0; k < 900; ++k) {
      setting.of_1.push_back({Time() + 11_ms * (k + 1), k % 2 == 0, 0, 3.0, 0.1});
    }
    Pair pair(setting);
    Stream random(1, Purpose("fuzz"), Entity::agent(0));
    for (int i = 0; i < 4000; ++i) {
      const Time now = Time() + 2_ms * (i + 1);
      Place place{{random.normal(3.0, 0.5), random.normal(0.0, 0.5)},
                  std::pow(10.0, random.uniform(-12.0, 3.0)) * told.covariance};
      std::vector<std::byte> bytes = about(static_cast<AgentId>(random.below(2)),
                                           now - 1_ms * static_cast<int>(random.below(3)), place);
      for (std::uint64_t k = random.below(3); k-- > 0;) {
        bytes[random.below(bytes.size())] = static_cast<std::byte>(random.below(256));
      }
      if (random.below(8) == 0) bytes.resize(random.below(bytes.size() + 1));
      pair.hear(now, std::move(bytes));
    }
    pair.run();
    const PoseFilter& filter = pair.agents[1]->filter();
    EXPECT_EQ(filter.covariance(0).llt().info(), Eigen::Success);
    EXPECT_TRUE(std::isfinite(filter.pose(0).x_m));
    EXPECT_GT(pair.count(1, "messages_refused"), 100.0);
    EXPECT_GT(pair.count(1, "fusions"), 0.0);
  }
}

}  // namespace
}  // namespace hearsay
