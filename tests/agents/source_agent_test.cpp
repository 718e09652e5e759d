// Sources against closed forms: when packets come, how large they are, how many leave.
#include "agents/source_agent.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>

namespace hearsay {
namespace {

using Arrivals = SourceTraffic::Arrivals;
using Law = PacketSizes::Law;
using ::testing::ElementsAre;

constexpr double sigmas = 4.0;

// Sources with the same traffic, all but the last; the last, whom all hear, listens.
struct Sources {
  struct Options {
    int senders = 1;
    RadioOptions radio;
    std::uint64_t seed = 1;
    Time end = Time::at(10_s);
  };
  Sources(const SourceTraffic& traffic, const Options& options)
      : simulation({.seed = options.seed, .end = options.end, .record = {.keep_messages = true}}),
        radio(simulation, Topology::full(options.senders + 1), options.radio) {
    for (AgentId id = 0; id <= options.senders; ++id) {
      contexts.push_back(std::make_unique<Context>(
          simulation, radio,
          Context::Identity{
              .id = id, .name = "a" + std::to_string(id), .kind = "source", .parameters = {}}));
      std::optional<SourceTraffic> own;
      if (id < options.senders) own = traffic;
      agents.push_back(std::make_unique<SourceAgent>(*contexts.back(), own));
      radio.attach(id, *agents.back());
    }
    for (auto& agent : agents) agent->start();
  }
  void run() {
    const RunEnd end = simulation.run();
    EXPECT_TRUE(end.ok()) << end.message;
    for (auto& agent : agents) agent->finish();
    radio.finish();
    simulation.record().finish();
  }
  // A final value of an agent; the last one's by default.
  double value(const std::string& name, AgentId agent = -1) const {
    if (agent < 0) agent = static_cast<AgentId>(agents.size()) - 1;
    for (const ScalarRow& row : simulation.record().scalars()) {
      if (row.agent == agent && simulation.record().text(row.name) == name) return row.value;
    }
    ADD_FAILURE() << "no " << name << " of " << agent;
    return 0.0;
  }
  // What agent 0 sent, one row a packet.
  std::vector<MessageRow> sent() const {
    std::vector<MessageRow> rows;
    for (const MessageRow& row : simulation.record().messages()) {
      if (row.sender == 0 && row.receiver == static_cast<AgentId>(agents.size()) - 1) {
        rows.push_back(row);
      }
    }
    return rows;
  }
  // When packets of agent 0 were made, in ns.
  std::vector<std::int64_t> made_ns() const {
    std::vector<std::int64_t> times;
    for (const MessageRow& row : sent()) times.push_back(row.sent.nanoseconds());
    return times;
  }
  void at(Duration time, bool up) {
    simulation.schedule(Time::at(time), Phase::world, [this, up] {
      radio.set_up(0, up);
      up ? agents[0]->on_up(false) : agents[0]->on_down();
    });
  }

  Simulation simulation;
  Radio radio;
  std::vector<std::unique_ptr<Context>> contexts;
  std::vector<std::unique_ptr<SourceAgent>> agents;
};

SourceTraffic periodic(Duration period, Duration phase) {
  return {.arrivals = Arrivals::periodic, .period = period, .phase = phase};
}
SourceTraffic poisson(Duration period) { return {.arrivals = Arrivals::poisson, .period = period}; }
SourceTraffic saturated(std::uint32_t bytes) {
  return {.arrivals = Arrivals::saturated, .sizes = PacketSizes(Law::fixed, bytes)};
}

TEST(SourceAgent, PeriodicPacketsComeEveryPeriodFromThePhaseOn) {
  Sources sources(periodic(3_s, 500_ms), {});
  sources.run();
  EXPECT_THAT(sources.made_ns(),
              ElementsAre(500'000'000, 3'500'000'000, 6'500'000'000, 9'500'000'000));
}

TEST(SourceAgent, ALoneSendersDelayIsAirTimeAndLatency) {
  // 100 bytes and 25 of header at 1 Mbit/s: 1 ms, and 7 ms of latency.
  Sources sources(periodic(100_ms, Duration()),
                  {.radio = {.rate_bps = 1e6, .header_bytes = 25, .latency = 7_ms}});
  sources.run();
  EXPECT_DOUBLE_EQ(sources.value("delay_mean_s"), 8e-3);
  EXPECT_EQ(sources.value("heard_packets"), 100.0);  // the one made at 10 s is still on the air
  EXPECT_DOUBLE_EQ(sources.value("goodput_bps"), 100.0 * 800.0 / 10.0);
  EXPECT_EQ(sources.value("heard_packets", 0), 0.0);
  EXPECT_TRUE(std::isnan(sources.value("delay_mean_s", 0))) << "who heard nothing has no delay";
}

TEST(SourceAgent, ASourceStopsAfterItsLastPacket) {
  for (SourceTraffic traffic : {periodic(10_ms, 5_ms), poisson(10_ms), saturated(50)}) {
    traffic.packets_max = 7;
    Sources sources(traffic, {});
    sources.run();
    EXPECT_EQ(sources.radio.counts(0).packets, 7u);
    EXPECT_EQ(sources.value("heard_packets"), 7.0);
  }
}

TEST(SourceAgent, PoissonPacketsHaveExponentialGapsOfTheGivenMean) {
  Sources sources(poisson(1_ms), {.radio = {.rate_bps = 1e9}, .end = Time::at(20_s)});
  sources.run();
  const std::vector<std::int64_t> times = sources.made_ns();
  const double expected = 20'000.0;  // a Poisson number
  EXPECT_NEAR(static_cast<double>(times.size()), expected, sigmas * std::sqrt(expected));
  // P(gap > k periods) = e^-k.
  std::map<int, int> longer;
  std::int64_t before = 0;
  for (const std::int64_t time : times) {
    for (int k = 1; k <= 5; ++k) longer[k] += time - before > k * 1'000'000 ? 1 : 0;
    before = time;
  }
  const auto n = static_cast<double>(times.size());
  for (const auto& [k, count] : longer) {
    const double p = std::exp(-k);
    EXPECT_NEAR(count, n * p, sigmas * std::sqrt(n * p * (1.0 - p))) << k << " periods";
  }
}

TEST(SourceAgent, ExponentialSizesAreGeometricWithTheGivenMean) {
  constexpr std::uint32_t mean = 20;
  const PacketSizes sizes(Law::exponential, mean);
  Stream draws(3, Purpose("sizes"), Entity::agent(0));
  constexpr int n = 50'000;
  std::vector<int> longer(100, 0);
  double sum = 0.0;
  for (int i = 0; i < n; ++i) {
    const std::uint32_t size = sizes.draw(draws);
    ASSERT_GE(size, 1u);
    ASSERT_LE(size, sizes.largest());
    sum += size;
    for (std::uint32_t k = 0; k < 100; ++k) longer[k] += size > k ? 1 : 0;
  }
  // Variance (1 − p)/p² with p = 1/mean.
  EXPECT_NEAR(sum / n, mean, sigmas * std::sqrt(mean * (mean - 1.0) / n));
  for (const int k : {1, 5, 20, 60, 99}) {
    const double p = std::pow(1.0 - 1.0 / mean, k);
    EXPECT_NEAR(longer[static_cast<std::size_t>(k)], n * p, sigmas * std::sqrt(n * p * (1.0 - p)));
  }
}

TEST(SourceAgent, FixedSizesAreFixedAndOfOneByteThereIsOneSize) {
  Stream draws(3, Purpose("sizes"), Entity::agent(0));
  EXPECT_EQ(PacketSizes(Law::fixed, 77).draw(draws), 77u);
  EXPECT_EQ(PacketSizes(Law::fixed, 77).largest(), 77u);
  EXPECT_EQ(PacketSizes(Law::exponential, 1).draw(draws), 1u);
  EXPECT_EQ(PacketSizes(Law::exponential, 1).largest(), 1u);
  EXPECT_EQ(PacketSizes(Law::exponential, 1000).largest(), 37'000u);
}

TEST(SourceAgent, WhenPacketsComeDoesNotDependOnTheirSizesNorOnTheQueue) {
  SourceTraffic traffic = poisson(20_ms);
  Sources fixed(traffic, {.seed = 4});
  traffic.sizes = PacketSizes(Law::exponential, 100);
  Sources differing(traffic, {.radio = {.rate_bps = 1e4, .queue = {.packets_max = 1}}, .seed = 4});
  Sources other(traffic, {.seed = 5});
  for (Sources* sources : {&fixed, &differing, &other}) sources->run();
  auto made = differing.made_ns();
  std::sort(made.begin(), made.end());  // rows come in the order in which fates are known
  EXPECT_EQ(fixed.made_ns(), made);
  EXPECT_GT(differing.radio.counts(0).fates[static_cast<std::size_t>(Fate::queue_full)], 0u);
  EXPECT_NE(fixed.made_ns(), other.made_ns());
}

TEST(SourceAgent, ASaturatedSourceLeavesNoGap) {
  // 125 bytes at 1 Mbit/s: 1 ms; at 10 s the 10,001st begins.
  Sources sources(saturated(125), {});
  sources.run();
  const SenderCounts& counts = sources.radio.counts(0);
  EXPECT_EQ(counts.begun, 10'001u);
  EXPECT_EQ(counts.packets, 10'002u) << "one waits, no more";
  EXPECT_EQ(counts.air_time, 10_s);
  // A packet waits from when its predecessor begins; the first not at all, the last is in the
  // queue.
  EXPECT_EQ(counts.queue_delay, 10_s);
  EXPECT_EQ(counts.fates[static_cast<std::size_t>(Fate::queue_full)], 0u);
}

TEST(SourceAgent, SaturatedSlottedAlohaTakesEachSlotWithItsProbability) {
  constexpr double p = 0.25;
  constexpr int n = 4;
  constexpr double slots = 10'000;
  const AccessOptions aloha{.sharing = Sharing::slotted_aloha, .slot = 1_ms, .send_probability = p};
  SourceTraffic traffic = saturated(125);
  traffic.receiver = n;
  Sources sources(traffic, {.senders = n, .radio = {.half_duplex = true, .access = aloha}});
  sources.run();
  for (AgentId a = 0; a < n; ++a) {
    EXPECT_NEAR(static_cast<double>(sources.radio.counts(a).frames), slots * p,
                sigmas * std::sqrt(slots * p * (1.0 - p)));
  }
  const double success = n * p * std::pow(1.0 - p, n - 1);  // a slot has just one frame
  EXPECT_NEAR(sources.value("heard_packets"), slots * success,
              sigmas * std::sqrt(slots * success * (1.0 - success)));
}

TEST(SourceAgent, ALoneSaturatedSourceThatIsAcknowledgedWaitsHalfAWindowAFrame) {
  const AccessOptions access{.sharing = Sharing::carrier_sense,
                             .slot = 50_us,
                             .interframe = 128_us,
                             .window_min = 32,
                             .window_max = 1024};
  SourceTraffic traffic = saturated(125);
  traffic.receiver = 1;
  traffic.acknowledged = true;
  Sources sources(traffic, {.radio = {.half_duplex = true,
                                      .access = access,
                                      .acknowledgement = {.bytes = 30, .interframe = 28_us}}});
  sources.run();
  // 128 µs, 0 … 31 slots, 1 ms, 28 µs, 240 µs. The slots have the variance (32² − 1)/12.
  const double cycle_s = 128e-6 + 15.5 * 50e-6 + 1e-3 + 28e-6 + 240e-6;
  const double n = 10.0 / cycle_s;
  const double sigma = std::sqrt(n * (32.0 * 32.0 - 1.0) / 12.0) * 50e-6 / cycle_s;
  EXPECT_NEAR(sources.value("heard_packets"), n, sigmas * sigma + 1.0);
  EXPECT_EQ(static_cast<double>(sources.radio.counts(1).acknowledgements),
            sources.value("heard_packets"));
}

TEST(SourceAgent, ASourceIsSilentWhileItIsDownAndGoesOnAsIfNothingHadHappened) {
  Sources undisturbed(poisson(100_ms), {}), disturbed(poisson(100_ms), {});
  disturbed.at(2_s, false);
  disturbed.at(5_s, true);
  undisturbed.run();
  disturbed.run();
  std::vector<std::int64_t> expected = undisturbed.made_ns();
  std::erase_if(expected, [](std::int64_t t) { return t >= 2'000'000'000 && t < 5'000'000'000; });
  EXPECT_EQ(disturbed.made_ns(), expected);
}

TEST(SourceAgent, ASaturatedSourceGoesOnAfterAnOutageAndAfterPacketsThatExpired) {
  Sources down(saturated(125), {});
  down.at(2_s, false);
  down.at(5_s, true);
  down.run();
  EXPECT_NEAR(down.value("heard_packets"), 7000.0, 2.0);

  // What waits for a packet of 1 ms expires after 0.4 ms, whenever its turn would come.
  Sources expired(saturated(125), {.radio = {.queue = {.wait_max = 400_us}}});
  expired.run();
  const SenderCounts& counts = expired.radio.counts(0);
  EXPECT_GT(counts.fates[static_cast<std::size_t>(Fate::expired)], 4000u);
  EXPECT_NEAR(counts.air_time.seconds(), 10.0, 0.01) << "its successor begins at once";
}

}  // namespace
}  // namespace hearsay
