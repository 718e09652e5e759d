// Explorers with a radio between them, one who listens in, and the witness of their grids.
#include "agents/explorer_agent.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "net/movement.hpp"

namespace hearsay {
namespace {

using grid::Form;
using grid::Rule;

const grid::Area area({.columns = 4, .rows = 4, .cell_m = 10.0});
const grid::Point target{15.0, 15.0};  // in cell 5

/// Sees cells within 20·tan(angle) of the place below it.
GridSensor::Options presence(double angle_rad = 0.65) {
  return {.detector = {.p_detect = 0.999, .p_false = 0.001},
          .range_max_m = 200.0,
          .kind = GridSensor::Presence{angle_rad}};
}

/// Paths of one leg each.
class Straight final : public PathSource {
 public:
  std::vector<Leg> legs;
  Leg next(AgentId agent, Time) override { return legs[static_cast<std::size_t>(agent)]; }
};

struct Listener : Receiver {
  void on_packet(const Packet& packet) override {
    if (packet.sender == 0) heard.push_back({packet.sent, packet.bytes.size()});
  }
  struct Heard {
    Time sent;
    std::size_t bytes;
  };
  std::vector<Heard> heard;
};

/// Explorers, and a listener behind them; for 10 s.
class Bed {
 public:
  struct One {
    Point place_m{15.0, 15.0, 20.0};
    Point velocity_m_per_s{};
    ExplorerAgent::Options options;
    bool steered = false;
  };
  explicit Bed(std::vector<One> all, const RadioOptions& radio_options = {}, Duration period = 1_s,
               std::uint64_t seed = 3)
      : count_(static_cast<AgentId>(all.size())),
        simulation({.seed = seed, .end = Time::at(10_s), .record = {.keep_messages = true}}),
        places_(count_ + 1, 1e6, 1e5) {
    for (const One& one : all) {
      paths_.legs.push_back({.from_m = one.place_m, .velocity_m_per_s = one.velocity_m_per_s});
    }
    paths_.legs.push_back({});
    movement_ = std::make_unique<Movement>(simulation, places_, paths_);
    Reach reach{.topology = Topology::full(count_ + 1)};
    reach.places = &places_;
    witness_ = std::make_unique<GridWitness>(
        simulation,
        GridWitness::Options{
            .area = area,
            .belief = all.front().options.estimator.belief,
            .targets = {target},
            .thresholds = {0.8},
            .gate_m = 12.0,
            .period = period,
            .series = {"disagreement_probability", "kl_to_central_nats", "cells_hearsay",
                       "multiplicity_mean", "multiplicity_max", "multiplicity_share"},
            .grids = true,
            .place_of = [this](AgentId id) { return radio->position(id); }});
    radio = std::make_unique<Radio>(simulation, std::move(reach), radio_options);
    for (AgentId id = 0; id < count_; ++id) {
      const One& one = all[static_cast<std::size_t>(id)];
      contexts_.push_back(std::make_unique<Context>(
          simulation, *radio, Context::Identity{.id = id, .name = "e", .kind = "explorer"},
          Context::Service{.steers = one.steered ? movement_.get() : nullptr}));
      ExplorerAgent::Options options = one.options;
      if (options.sensor) {
        looks_.push_back(
            std::make_unique<AreaLook>(*contexts_.back(), *witness_, *options.sensor, area));
        options.looks = looks_.back().get();
      }
      agents.push_back(
          std::make_unique<ExplorerAgent>(*contexts_.back(), witness_->riders(), options));
      radio->attach(id, *agents.back());
      witness_->watch(id, agents.back()->estimator());
    }
    radio->attach(count_, listener);
  }
  void run() {
    witness_->start();
    for (AgentId id = 0; id < count_; ++id) {
      simulation.acting_for(id);
      agents[static_cast<std::size_t>(id)]->start();
    }
    const RunEnd end = simulation.run();
    EXPECT_TRUE(end.ok()) << end.message;
    for (auto& agent : agents) agent->finish();
    witness_->finish();
  }
  double scalar(AgentId id, const std::string& name) {
    for (const ScalarRow& row : simulation.record().scalars()) {
      if (row.agent == id && simulation.record().text(row.name) == name) return row.value;
    }
    ADD_FAILURE() << "no " << name;
    return -1;
  }
  /// By time and subject.
  std::map<std::pair<double, std::string>, double> series(AgentId id, const std::string& name) {
    std::map<std::pair<double, std::string>, double> values;
    for (const SeriesRow& row : simulation.record().series()) {
      if (row.agent != id || simulation.record().text(row.name) != name) continue;
      values[{row.time.seconds(), simulation.record().text(row.subject)}] = row.value;
    }
    return values;
  }
  double probability(AgentId id, int column, int row) {
    return series(id, "cell_probability")
        .at({10.0, std::to_string(column) + "," + std::to_string(row)});
  }
  const GridBelief& belief(std::size_t id) const { return agents[id]->estimator().belief(); }
  int fates(const std::string& fate) const {
    int count = 0;
    for (const MessageRow& row : simulation.record().messages()) {
      count += simulation.record().text(row.fate) == fate;
    }
    return count;
  }

 private:
  AgentId count_;

 public:
  Simulation simulation;

 private:
  Straight paths_;
  Places places_;
  std::unique_ptr<Movement> movement_;
  std::unique_ptr<GridWitness> witness_;  // owns the riders of packets in flight

 public:
  std::unique_ptr<Radio> radio;
  Listener listener;

 private:
  std::vector<std::unique_ptr<Context>> contexts_;
  std::vector<std::unique_ptr<AreaLook>> looks_;

 public:
  std::vector<std::unique_ptr<ExplorerAgent>> agents;
};

ExplorerAgent::Options silent() {
  ExplorerAgent::Options options{.area = area};
  options.estimator.belief = grid::BernoulliGrid::Options{.limit = 64.0};
  options.sensor = presence();
  return options;
}
ExplorerAgent::Options talking(Rule rule, Form form = Form::whole) {
  ExplorerAgent::Options options = silent();
  options.estimator.rule = rule;
  options.estimator.form = form;
  options.talk = PeriodicTalk{.period = 2_s, .phase = 500_ms};
  return options;
}
ExplorerAgent::Options deaf_to_the_world(Rule rule) {
  ExplorerAgent::Options options = talking(rule);
  options.sensor.reset();
  return options;
}

struct Look {
  Point place_m;
  std::uint64_t count;
  double heading_rad = 0.0;
  AgentId agent = 0;
};

/// One grid given these looks.
GridBelief given(const std::vector<Look>& looks, const GridSensor::Options& sensor = presence()) {
  GridBelief belief(area, grid::BernoulliGrid::Options{.limit = 64.0});
  std::vector<unsigned char> truth(16, 0);
  truth[5] = 1;
  GridSensor eye(sensor, area);
  for (const Look& look : looks) {
    belief.add(eye.look(look.place_m, look.heading_rad, truth, 3, look.agent, look.count));
  }
  return belief;
}

void expect_same(const GridBelief& belief, const GridBelief& expected) {
  EXPECT_TRUE(std::ranges::equal(belief.evidence(), expected.evidence()));
}

TEST(ExplorerAgent, LooksAtItsPeriodFromWhereItHovers) {
  auto options = silent();
  options.sensor_start = Time::at(1_s);
  options.sensor_period = 2_s;
  options.sensor_end = Time::at(7_s);
  Bed bed({{.options = options}});
  bed.run();
  const Point here{15.0, 15.0, 20.0};
  const GridBelief expected = given({{here, 0}, {here, 1}, {here, 2}, {here, 3}});
  expect_same(bed.belief(0), expected);
  EXPECT_GT(*expected.probability(5), 0.99);
  GridSensor eye(presence(), area);
  const auto in_view = eye.view(here, 0.0).size();
  EXPECT_EQ(in_view, 9U);  // of 10 m and 14.1 m apart, over 20 m
  EXPECT_EQ(bed.scalar(0, "measurements"), 4.0 * 9.0);
  EXPECT_EQ(bed.scalar(central_agent, "measurements"), 4.0 * 9.0);
  EXPECT_EQ(bed.scalar(0, "cells_seen_share"), 9.0 / 16.0);
  EXPECT_EQ(bed.scalar(0, "distance_flown_m"), 0.0);
}

TEST(ExplorerAgent, TheCentralGridHasEveryLookAndEachAgentItsOwn) {
  const Point one{15.0, 15.0, 20.0}, two{25.0, 35.0, 20.0};
  Bed bed({{.place_m = one, .options = silent()}, {.place_m = two, .options = silent()}});
  bed.run();
  std::vector<Look> all, of_1;
  for (std::uint64_t count = 0; count <= 10; ++count) {
    all.push_back({one, count, 0.0, 0});
    all.push_back({two, count, 0.0, 1});
    of_1.push_back({two, count, 0.0, 1});
  }
  expect_same(bed.belief(1), given(of_1));
  const GridBelief central = given(all);
  for (int k = 0; k < 16; ++k) {
    EXPECT_EQ(bed.probability(central_agent, k % 4, k / 4), *central.probability(k)) << k;
    EXPECT_EQ(bed.probability(1, k % 4, k / 4), *bed.belief(1).probability(k)) << k;
  }
  const auto kl = bed.series(1, "kl_to_central_nats");
  EXPECT_DOUBLE_EQ(kl.at({10.0, ""}), central.divergence(bed.belief(1)).value());
  EXPECT_GT(kl.at({10.0, ""}), 1.0);
}

TEST(ExplorerAgent, FliesOnAndLooksTheWayItFlies) {
  auto options = silent();
  options.sensor = presence(0.35);
  options.sensor->depression_rad = 0.8;
  options.sensor_period = 2_s;
  Bed bed({{.place_m = {2.0, 3.0, 20.0}, .velocity_m_per_s = {1.5, 2.0, 0.0}, .options = options}});
  bed.run();
  EXPECT_NEAR(bed.scalar(0, "distance_flown_m"), 25.0, 1e-9);
  std::vector<Look> looks{{{2.0, 3.0, 20.0}, 0, 0.0}};  // it did not fly yet
  for (std::uint64_t k = 1; k <= 5; ++k) {
    const double t = 2.0 * static_cast<double>(k);
    looks.push_back({{2.0 + 1.5 * t, 3.0 + 2.0 * t, 20.0}, k, math::atan2(4.0, 3.0)});
  }
  expect_same(bed.belief(0), given(looks, *options.sensor));
  EXPECT_GT(bed.scalar(0, "measurements"), 5.0);
}

TEST(ExplorerAgent, WhoIsDownNeitherLooksNorTalks) {
  Bed bed({{.options = talking(Rule::naive)}});
  bed.simulation.schedule(Time::at(1500_ms), Phase::act, [&] { bed.radio->set_up(0, false); });
  bed.simulation.schedule(Time::at(5700_ms), Phase::act, [&] {
    bed.radio->set_up(0, true);
    bed.agents[0]->on_up(false);
  });
  bed.run();
  const Point here{15.0, 15.0, 20.0};
  std::vector<Look> looks;
  // Every look has the luck of its own number.
  for (const std::uint64_t count : {0, 1, 6, 7, 8, 9, 10}) looks.push_back({here, count});
  expect_same(bed.belief(0), given(looks));
  std::vector<double> sent_s;
  for (const auto& heard : bed.listener.heard) sent_s.push_back(heard.sent.seconds());
  EXPECT_EQ(sent_s, (std::vector{0.5, 6.5, 8.5}));
}

TEST(ExplorerAgent, WhoForgetsKnowsOnlyWhatItSawSince) {
  for (const bool forgets : {false, true}) {
    Bed bed({{.options = silent()}});
    bed.simulation.schedule(Time::at(8500_ms), Phase::act, [&] { bed.agents[0]->on_up(forgets); });
    bed.run();
    std::vector<Look> looks;
    for (std::uint64_t count = forgets ? 9 : 0; count <= 10; ++count) {
      looks.push_back({{15.0, 15.0, 20.0}, count});
    }
    expect_same(bed.belief(0), given(looks));
    EXPECT_EQ(bed.scalar(0, "measurements"), 11.0 * 9.0);
  }
}

TEST(ExplorerAgent, TellsWhatItBelievesAndTakesInWhatItHears) {
  Bed bed({{.options = talking(Rule::maximum)}, {.options = deaf_to_the_world(Rule::maximum)}});
  bed.run();
  // 0.5, 2.5, … 8.5 s: what it knew at 8 s.
  ASSERT_EQ(bed.listener.heard.size(), 5U);
  EXPECT_EQ(bed.listener.heard[0].bytes, grid::packet_size(Form::whole, 1, 16));
  EXPECT_EQ(bed.scalar(1, "fusions"), 5.0);
  EXPECT_EQ(bed.scalar(1, "measurements"), 0.0);
  EXPECT_EQ(bed.scalar(0, "fusions"), 4.0);  // once 1 knows something
  EXPECT_GT(*bed.belief(1).probability(5), 0.99);
  // 0 counts what it hears again but once; 1 has not heard of the looks since 8 s.
  EXPECT_EQ(bed.series(0, "multiplicity_max").at({10.0, ""}), 1.0);
  EXPECT_EQ(bed.series(1, "multiplicity_share").at({10.0, ""}), 0.0);
  EXPECT_EQ(bed.agents[1]->estimator().ledger().weights(5).size(), 9U);
  const std::vector<std::byte> noise(10);
  bed.agents[1]->on_packet({.sender = 0,
                            .receiver = 1,
                            .kind = bed.simulation.record().name("tracks"),
                            .bytes = noise,
                            .sent = Time(),
                            .rider = nullptr});
  EXPECT_EQ(bed.agents[1]->estimator().counts().refused, 0U);  // not meant for it
}

TEST(ExplorerAgent, WithoutARuleSaysNothing) {
  Bed bed({{.options = talking(Rule::none)}});
  bed.run();
  EXPECT_TRUE(bed.listener.heard.empty());
  EXPECT_GT(bed.scalar(0, "measurements"), 0.0);
}

// A radio as slow as that is still busy with a message when the next one comes.
TEST(ExplorerAgent, ANewMapTakesThePlaceOfAnOldOneThatWaitsAndAChangeDoesNot) {
  RadioOptions slow;
  slow.rate_bps = 150.0;  // 128 bytes in 7 s
  slow.queue.policy = QueuePolicy::replace;
  for (const Form form : {Form::whole, Form::changed}) {
    auto options = talking(Rule::naive, form);
    Bed bed({{.options = options}}, slow);
    bed.run();
    EXPECT_EQ(bed.fates("replaced") > 0, form == Form::whole);
  }
}

// Talks that were not held, for there was nothing to tell, change nothing in the luck of others.
TEST(ExplorerAgent, EachTalkHasTheLuckOfItsOwnNumber) {
  RadioOptions lossy;
  lossy.loss = Loss::bernoulli(0.5);
  std::map<double, std::string> fates[2];
  for (const bool late : {false, true}) {
    auto options = talking(Rule::naive);
    options.talk->period = 250_ms;
    options.estimator.packet_bytes = 64;
    if (late) options.sensor_start = Time::at(5_s);
    Bed bed({{.options = options}}, lossy);
    bed.run();
    const Record& record = bed.simulation.record();
    for (const MessageRow& row : record.messages()) {
      fates[late][row.sent.seconds()] += record.text(row.fate) + " ";
    }
  }
  EXPECT_EQ(fates[0].size(), 38U);
  EXPECT_EQ(fates[1].size(), 20U);
  int lost = 0;
  for (const auto& [sent, fate] : fates[1]) {
    EXPECT_EQ(fate, fates[0].at(sent)) << sent;
    lost += fate.find("lost") != std::string::npos;
  }
  EXPECT_GT(lost, 5);
  EXPECT_LT(lost, 21);  // two parts a talk, each with draws of its own
}

TEST(ExplorerAgent, TheWitnessMeasuresHowFarAgentsDisagree) {
  Bed alone({{.options = silent()}});
  alone.run();
  for (const auto& [at, value] : alone.series(central_agent, "disagreement_probability")) {
    EXPECT_EQ(value, 0.0) << at.first;
  }
  Bed bed({{.options = silent()}, {.options = deaf_to_the_world(Rule::none)}});
  bed.run();
  double sum = 0.0;
  for (int k = 0; k < 16; ++k) {
    sum += std::fabs(*bed.belief(0).probability(k) - *bed.belief(1).probability(k)) / 16.0;
  }
  const auto disagreement = bed.series(central_agent, "disagreement_probability");
  EXPECT_NEAR(disagreement.at({10.0, ""}), sum, 1e-7);
  EXPECT_GT(sum, 0.1);
}

TEST(ExplorerAgent, AlarmsAreFoundWhenTheyAreFirstSeenInASample) {
  auto options = talking(Rule::naive);
  options.sensor = presence(0.2);  // the cell below it alone
  options.sensor_start = Time::at(2500_ms);
  options.talk->phase = 1_s;
  Bed bed({{.options = options},
           {.options = deaf_to_the_world(Rule::naive)},
           {.options = deaf_to_the_world(Rule::none)}});
  bed.run();
  EXPECT_EQ(bed.scalar(central_agent, "alarms_found_s"), 3.0);
  EXPECT_EQ(bed.scalar(0, "alarms_found_s"), 3.0);
  EXPECT_EQ(bed.scalar(1, "alarms_found_s"), 4.0);  // told at 3 s, just after the sample
  EXPECT_EQ(bed.scalar(2, "alarms_found_s"), std::numeric_limits<double>::infinity());
  EXPECT_EQ(bed.scalar(central_agent, "cells_seen_share"), 1.0 / 16.0);
  EXPECT_EQ(bed.scalar(central_agent, "agents_a_cell"), 1.0);
}

TEST(ExplorerAgent, IsNotChangedByBeingWatched) {
  std::vector<float> evidence[2];
  for (const int often : {0, 1}) {
    const Duration period = often == 1 ? 50_ms : 5_s;
    Bed bed({{.options = talking(Rule::naive)}, {.options = deaf_to_the_world(Rule::naive)}}, {},
            period);
    bed.run();
    const auto e = bed.belief(1).evidence();
    evidence[often].assign(e.begin(), e.end());
  }
  EXPECT_EQ(evidence[0], evidence[1]);
  EXPECT_NE(evidence[0], std::vector<float>(16, 0.0F));
}

TEST(ExplorerAgent, WhoIsSteeredFliesToWhereALookTellsMore) {
  auto options = silent();
  options.sensor = presence(0.2);
  options.sensor_period = 100_ms;
  options.exploration = Exploration::Options{};
  options.speed_m_per_s = 10.0;  // a cell a second
  Bed bed({{.place_m = {5.0, 5.0, 20.0}, .options = options, .steered = true}});
  bed.run();
  EXPECT_GE(bed.scalar(0, "cells_seen_share"), 6.0 / 16.0);
  EXPECT_GE(bed.scalar(0, "distance_flown_m"), 70.0);
  const Point place = bed.radio->position(0);
  EXPECT_TRUE(area.at({place[0], place[1]}).has_value());
  EXPECT_EQ(place[2], 20.0);
}

TEST(ExplorerAgent, WhoIsNotSteeredDoesNotExplore) {
  auto options = silent();
  options.exploration = Exploration::Options{};
  EXPECT_THROW(Bed({{.options = options}}), BrokenInvariant);
}

}  // namespace
}  // namespace hearsay
