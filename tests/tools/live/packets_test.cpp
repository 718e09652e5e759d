// What goes wrong on the air of a fleet in real time is dropped and counted, and nobody fuses it.
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <thread>

#include "agents/remote/protocol.hpp"
#include "filters/gaussian/codec.hpp"
#include "net/live/messages.hpp"
#include "tests/net/live/port_bed.hpp"
#include "tools/live/agent.hpp"
#include "tools/live/air.hpp"
#include "tools/live/reactor.hpp"
#include "tools/live/world.hpp"

namespace hearsay::fleet {
namespace {

using Bytes = std::vector<std::byte>;

// A test ends the world when it has seen enough.
constexpr const char* two_agents = R"(
duration_s = 100000
[world]
targets = [{ name = "alarm", position_m = [40.0, 25.0] }]
[radio]
topology = "full"
rate_bps = 1_000_000
loss = { model = "bernoulli", probability = 0.0 }
[[agents]]
count = 2
sensor = { kind = "position", period_s = 1.0, sigma_m = 5.0 }
estimator = { kind = "static-gaussian", fusion = "naive" }
talk = { policy = "periodic", period_s = 90000.0 }
[record]
ledger = "off"
series = ["rms_error_m"]
series_period_s = 1.0
)";

const Tongue tongue{"gaussian", live::States::still};

Bytes message_of(double xi, double omega_first, double omega_second, double beside = 0.0) {
  gaussian::Belief belief = gaussian::Belief::unknown(2);
  belief.xi << xi, 1.0;
  belief.omega << omega_first, beside, beside, omega_second;
  Bytes bytes;
  encode(gaussian::Message{.beliefs = {{0, belief}}}, bytes);
  return bytes;
}
Bytes sound_message() { return message_of(1.0, 0.1, 0.1); }

/// Well-formed as DDS sees it, but of more dimensions than there are: unsigned longs, and sequences
/// of doubles at multiples of 8.
Bytes nine_dimensions() {
  Bytes bytes = sound_message();
  bytes.resize(4);  // the header
  const auto put = [&bytes](std::uint32_t value) {
    for (int i = 0; i < 4; ++i) bytes.push_back(static_cast<std::byte>(value >> (8 * i)));
  };
  for (const std::uint32_t value : {0u, 0u, 1u, 0u, 9u, 0u}) put(value);
  bytes.resize(bytes.size() + 9 * sizeof(double));
  for (const std::uint32_t value : {45u, 0u}) put(value);
  bytes.resize(bytes.size() + 45 * sizeof(double));
  return bytes;
}

/// Messages that nobody may fuse.
std::vector<Bytes> unsound_messages() {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  constexpr double infinite = std::numeric_limits<double>::infinity();
  std::vector<Bytes> all = {message_of(nan, 1.0, 1.0), message_of(1.0, nan, 1.0),
                            message_of(infinite, 1.0, 1.0), message_of(1.0, -1.0, 1.0),
                            message_of(1.0, 1.0, 1.0, 2.0)};
  Bytes truncated = sound_message();
  truncated.resize(truncated.size() - 8);
  all.push_back(truncated);
  Bytes oversized = sound_message();
  oversized.resize(std::size_t{1} << 20);
  all.push_back(oversized);
  all.push_back(nine_dimensions());
  return all;
}

/// A world in a thread. Agents that the test is itself know the topics alone.
class Fleet {
 public:
  explicit Fleet(const std::string& name) : fleet_(live::own_fleet(name)) {
    const std::string file = testing::TempDir() + fleet_ + ".toml";
    std::ofstream(file) << two_agents;
    LogCache logs;
    prepared_ = prepare(load_scenario(file, {}, known_names(catalog_)), catalog_, logs);
    std::filesystem::remove(file);
    world_ = std::thread([this] {
      result_ = run_world(
          prepared_, catalog_,
          {.fleet = {.fleet = fleet_}, .speed = 10.0, .scenario_hash = "s", .version = "hearsay t"},
          [](const std::string&) {});
    });
  }
  ~Fleet() { end(); }

  /// As a program of somebody else.
  void take_part(std::uint32_t agent) {
    lives_.push_back(port_.writer(live::report_topic(), live::agent_partition(fleet_, agent)));
    live::Writer hellos = port_.writer(live::hello_topic(), live::fleet_partition(fleet_));
    live::Reader welcomes = port_.reader(live::welcome_topic(), live::fleet_partition(fleet_));
    ASSERT_TRUE(
        live::wait(port_, [&] { return hellos.matched() && welcomes.writers_alive() > 0; }));
    Bytes hello, bytes;
    live::encode(live::Hello{.agent = agent, .process = agent + 1, .version = "test"}, hello);
    // Until DDS has matched the world's reader with this writer, nothing is heard.
    ASSERT_TRUE(live::wait(port_, [&] {
      if (welcomes.take(bytes)) return true;
      EXPECT_TRUE(hellos.write(hello));
      return false;
    }));
    live::Welcome welcome;
    ASSERT_TRUE(live::decode(bytes, welcome));
    ASSERT_TRUE(welcome.accepted) << welcome.reason;
  }
  void begin_agent(AgentId id) {
    agent_ = std::thread([this, id] {
      trouble_ = run_agent(prepared_, catalog_,
                           {.fleet = {.fleet = fleet_},
                            .id = id,
                            .direct = true,
                            .scenario_hash = "s",
                            .version = "hearsay t"},
                           [](const std::string&) {});
    });
  }
  void wait_for_the_run() {
    live::Reader clock = port_.reader(live::clock_topic(), live::fleet_partition(fleet_));
    ASSERT_TRUE(live::wait(port_, [&] {
      Bytes bytes;
      live::Clock now;
      while (clock.take(bytes)) {
        if (live::decode(bytes, now) && now.state == live::Clock::State::running) return true;
      }
      return false;
    }));
  }
  const WorldResult& end() {
    if (world_.joinable()) {
      raise(SIGTERM);
      world_.join();
      if (agent_.joinable()) agent_.join();
    }
    return result_;
  }
  live::Port& port() { return port_; }
  const std::string& name() const { return fleet_; }
  const std::string& trouble() const { return trouble_; }

 private:
  std::string fleet_;
  Catalog catalog_;
  std::shared_ptr<const PreparedScenario> prepared_;
  live::Port port_{{.fleet = fleet_}};
  Reactor reactor_{port_};  // so that signals end nobody else than those who wait for them
  std::vector<live::Writer> lives_;
  std::thread world_, agent_;
  WorldResult result_;
  std::string trouble_;
};

/// Until somebody listens on the partition: what is written before is heard by nobody.
void wait_for_listeners(Fleet& fleet, const std::string& partition) {
  const live::Writer probe =
      fleet.port().writer(live::air_topics("gaussian", live::States::still).front(), partition);
  ASSERT_TRUE(live::wait(fleet.port(), [&] { return probe.matched(); }));
}

TEST(Packets, WhatIsUnsoundOldOrForNobodyIsDroppedByTheWorld) {
  Fleet fleet("packets");
  fleet.take_part(0);
  fleet.take_part(1);
  AirIn hears(fleet.port(), live::agent_partition(fleet.name(), 1), {tongue});
  AirOut says(fleet.port(), said_partition(fleet.name(), 0));
  fleet.wait_for_the_run();
  wait_for_listeners(fleet, said_partition(fleet.name(), 0));

  const auto say = [&](const live::Envelope& envelope, const Bytes& message) {
    ASSERT_TRUE(says.write(tongue, {envelope, "gaussian", message}));
  };
  // Until DDS has matched the first writer with the reader, nothing is heard.
  Parcel heard;
  std::uint64_t number = 0;
  ASSERT_TRUE(live::wait(fleet.port(), [&] {
    say({.sender = 0, .number = ++number}, sound_message());
    return hears.take(heard);
  }));
  const std::uint64_t first = heard.envelope.number;
  number = 1000;
  for (const Bytes& message : unsound_messages()) {
    say({.sender = 0, .number = ++number}, message);
  }
  std::uint64_t bad = unsound_messages().size();
  const std::vector<live::Envelope> strange = {
      {.sender = 0, .number = first},  // from the past
      {.sender = 0, .number = 0},
      {.sender = 1, .number = 2000},  // of somebody else
      {.sender = 77, .number = 2000},
      {.sender = 0, .receiver = 77, .number = 2000},  // for nobody
      {.sender = 0, .receiver = 0, .number = 2000},
      {.sender = 0, .number = 2000, .tick = std::numeric_limits<std::int64_t>::max()}};
  for (const live::Envelope& envelope : strange) say(envelope, sound_message());
  bad += strange.size();
  say({.sender = 0, .receiver = 1, .number = 1999, .sent_ns = -5}, message_of(7.0, 0.5, 0.5));

  // The first ones that were heard, and then the last; nothing in between.
  ASSERT_TRUE(live::wait(fleet.port(), [&] {
    while (hears.take(heard)) {
      if (heard.message == message_of(7.0, 0.5, 0.5)) return true;
      EXPECT_EQ(heard.message, sound_message());
    }
    return false;
  }));
  EXPECT_EQ(heard.envelope.sender, 0u);
  EXPECT_EQ(hears.dropped(), 0u);
  const WorldResult& result = fleet.end();
  EXPECT_EQ(result.trouble, "it was asked to stop");
  ASSERT_TRUE(result.run);
  EXPECT_TRUE(result.end.ok()) << result.end.message;
  EXPECT_EQ(result.dropped, bad);
}

TEST(Packets, WithoutTheWorldsRadioTheAgentItselfDropsThem) {
  Fleet fleet("direct");
  fleet.take_part(1);
  live::Reader reports =
      fleet.port().reader(live::report_topic(), live::agent_partition(fleet.name(), 0));
  fleet.begin_agent(0);
  fleet.wait_for_the_run();
  const std::string air = live::air_partition(fleet.name());
  wait_for_listeners(fleet, air);
  AirOut says(fleet.port(), air);
  const auto say = [&](const live::Envelope& envelope, const Bytes& message) {
    ASSERT_TRUE(says.write(tongue, {envelope, "gaussian", message}));
  };
  live::Report report;
  const auto read_until = [&](const std::function<bool()>& done) {
    return live::wait(fleet.port(), [&] {
      Bytes bytes;
      while (reports.take(bytes)) EXPECT_TRUE(live::decode(bytes, report));
      return done();
    });
  };
  std::uint64_t number = 0, first = 0;
  ASSERT_TRUE(read_until([&] {
    if (report.counts.fusions == 0) say({.sender = 1, .number = ++number}, sound_message());
    return report.counts.fusions > 0;
  }));
  // Those that were on their way count, too.
  first = number;
  say({.sender = 1, .number = ++number}, sound_message());
  say({.sender = 1, .number = number}, sound_message());  // from the past
  ASSERT_TRUE(read_until([&] { return report.counts.refused == 1; }));
  const std::uint64_t fusions = report.counts.fusions;
  EXPECT_GE(fusions, 2u);
  EXPECT_LE(fusions, first + 1);

  std::uint64_t bad = 1;
  for (const Bytes& message : unsound_messages()) {
    say({.sender = 1, .number = ++number}, message);
    ++bad;
  }
  for (const std::uint32_t sender : {2u, 77u, live::everybody}) {  // strangers
    say({.sender = sender, .number = 5000}, sound_message());
    ++bad;
  }
  say({.sender = 1, .number = 1}, sound_message());
  ++bad;
  // For others, and what it said itself: none of its business.
  say({.sender = 1, .receiver = 77, .number = ++number}, sound_message());
  say({.sender = 0, .number = 9000}, sound_message());
  say({.sender = 1, .receiver = 0, .number = ++number, .sent_ns = -1}, sound_message());
  ASSERT_TRUE(read_until([&] { return report.counts.fusions > fusions; }));
  EXPECT_EQ(report.counts.fusions, fusions + 1);
  EXPECT_EQ(report.counts.refused, bad);
  ASSERT_EQ(report.beliefs.size(), 1u);
  EXPECT_TRUE(report.beliefs[0].belief.xi.allFinite());
  EXPECT_EQ(gaussian::definiteness(report.beliefs[0].belief), gaussian::Definiteness::positive);
  EXPECT_EQ(fleet.end().trouble, "it was asked to stop");
  EXPECT_EQ(fleet.trouble(), "");
}

TEST(Packets, QuestionsThatMakeNoSenseAreDroppedByTheWorld) {
  Fleet fleet("questions");
  fleet.take_part(1);
  const std::string partition = live::agent_partition(fleet.name(), 0);
  live::Reader orders = fleet.port().reader(live::order_topic(), partition);
  live::Writer answers = fleet.port().writer(live::answer_topic(), partition);
  fleet.begin_agent(0);
  fleet.wait_for_the_run();
  ASSERT_TRUE(live::wait(fleet.port(), [&] { return answers.matched(); }));
  Bytes bytes;
  live::Frame frame;
  const auto write = [&](const remote::Answer& answer, std::size_t without = 0) {
    remote::pack(answer, frame.content);
    frame.content.resize(frame.content.size() - without);
    live::encode(frame, bytes);
    ASSERT_TRUE(answers.write(bytes));
  };
  using remote::AnswerKind;
  write({.kind = AnswerKind::ask}, 1);                                    // malformed
  write({.kind = AnswerKind::done, .notes = Bytes(7, std::byte{0xff})});  // no notes
  write({.kind = AnswerKind::ask, .content = Bytes(1, std::byte{200})});  // nothing that is known
  write({.kind = AnswerKind::ask, .content = Bytes(65, std::byte{0})});   // it cannot be steered
  write({.kind = AnswerKind::ask, .number = 77, .content = Bytes(1, std::byte{1})});  // no body
  // Whoever asked is answered all the same.
  ASSERT_TRUE(live::wait(fleet.port(), [&] {
    remote::Order order;
    while (orders.take(bytes)) {
      if (!live::decode(bytes, frame) || !remote::unpack(frame.content, order)) continue;
      if (order.kind == remote::OrderKind::go_on && order.number == 77) return true;
    }
    return false;
  }));
  const WorldResult& result = fleet.end();
  EXPECT_EQ(result.trouble, "it was asked to stop");
  ASSERT_TRUE(result.run);
  EXPECT_TRUE(result.end.ok()) << result.end.message;
  EXPECT_EQ(result.dropped, 5u);
  EXPECT_EQ(fleet.trouble(), "");
}

}  // namespace
}  // namespace hearsay::fleet
