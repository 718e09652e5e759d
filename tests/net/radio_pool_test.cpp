// What the radio keeps: slots and buffers used again, riders held and let go, the same run twice.
#include <gtest/gtest.h>

#include "tests/net/bed.hpp"
#include "tools/memory/memory.hpp"

namespace hearsay {
namespace {

using memory::allocations;

class CountedRider final : public Rider {
 public:
  int recycled = 0;

 private:
  void recycle() override { ++recycled; }
};

// Agents that broadcast now and then, answer some of what they hear and keep nothing.
class Chatter final : public Receiver {
 public:
  Chatter(Simulation& simulation, Radio& radio, AgentId me)
      : simulation_(simulation), radio_(radio), me_(me) {
    radio.attach(me, *this);
  }
  void talk() {
    const std::uint64_t n = talks_++;
    radio_.send(me_, {.kind = 0, .bytes = std::span(payload_).first(n * 37 % 256), .tick = n});
    simulation_.schedule(simulation_.now() + 10_ms, Phase::act, [this] { talk(); });
  }
  void on_packet(const Packet& packet) override {
    ++heard;
    if (packet.bytes.size() % 3 == 1) {
      radio_.send(
          me_, {.kind = packet.kind, .bytes = packet.bytes.subspan(1), .receiver = packet.sender});
    }
  }
  std::uint64_t heard = 0;

 private:
  Simulation& simulation_;
  Radio& radio_;
  AgentId me_;
  std::uint64_t talks_ = 0;
  std::array<std::byte, 256> payload_{};
};

TEST(RadioPool, NothingIsAllocatedInSteadyState) {
  FnvDigest digest;
  Simulation simulation({.end = Time::at(6_s), .record = {.digest = &digest}});
  Radio radio(simulation, Topology::full(5),
              {.rate_bps = 1e6,
               .queue = {.packets_max = 8},
               .latency = 3_ms,
               .loss = Loss::bernoulli(0.1)});
  std::vector<std::unique_ptr<Chatter>> agents;
  for (AgentId a = 0; a < 5; ++a) {
    agents.push_back(std::make_unique<Chatter>(simulation, radio, a));
    simulation.schedule(Time::at(1_ms * a), Phase::act, [c = agents.back().get()] { c->talk(); });
  }
  std::uint64_t heard[2] = {}, counted[2] = {};
  for (const std::size_t i : {0u, 1u}) {
    simulation.schedule(Time::at(2_s + 4_s * static_cast<int>(i)), Phase::observe,
                        [&counted, &heard, &agents, i] {
                          counted[i] = allocations();
                          for (const auto& agent : agents) heard[i] += agent->heard;
                        });
  }
  const std::uint64_t before = allocations();
  simulation.run();
  radio.finish();
  EXPECT_GT(counted[0], before) << "the counter does not count";
  EXPECT_GT(heard[1], heard[0] + 5000);
  EXPECT_EQ(counted[1], counted[0]);
}

TEST(RadioPool, ReceiversMaySendWhileAPacketIsBeingDelivered) {
  // A word travels along a star from hop to hop; each hearer sends on three copies of the very
  // bytes it was given, so the pool grows under the delivery.
  Bed bed(Topology::star(6), {.radio = {.rate_bps = 8e9, .queue = {.packets_max = 1'000'000}}});
  bed.reaction = [&](const Packet& packet) {
    if (packet.bytes.size() <= 20) return;
    for (int copy = 0; copy < 3; ++copy) {
      bed.radio->send(packet.receiver, {.kind = bed.kind, .bytes = packet.bytes.subspan(1)});
    }
  };
  const std::string word = "abcdefghijklmnopqrstuvwxyz";
  bed.at(1_s, [&] { bed.send(0, word); });
  bed.run();
  // 0 → 5 leaves; each 3 → 0; each of those 3 → 5 leaves …: 5 · 3 · 15 · 3 · 15 · 3 at length 20.
  std::map<std::size_t, std::size_t> by_length;
  for (const Heard& h : bed.heard) {
    ++by_length[h.text.size()];
    ASSERT_EQ(h.text, word.substr(word.size() - h.text.size()));
  }
  const std::map<std::size_t, std::size_t> expected{
      {26, 5}, {25, 15}, {24, 225}, {23, 675}, {22, 10125}, {21, 30375}, {20, 455625}};
  EXPECT_EQ(by_length, expected);
}

TEST(RadioPool, ARiderTravelsAndIsLetGoWithTheLastDelivery) {
  CountedRider rider;
  Bed bed(Topology::star(4), {.radio = {.rate_bps = 8.0}});
  int seen = 0;
  bed.reaction = [&](const Packet& packet) {
    EXPECT_EQ(packet.rider, &rider);
    EXPECT_EQ(rider.recycled, 0);
    ++seen;
  };
  bed.at(1_s, [&] { bed.send(0, "x", no_agent, {}, RiderPtr(&rider)); });
  int recycled_at_3_s = -1;
  bed.at(3_s, [&] { recycled_at_3_s = rider.recycled; });
  bed.run();
  EXPECT_EQ(seen, 3);
  EXPECT_EQ(recycled_at_3_s, 1);
  EXPECT_EQ(rider.recycled, 1);
}

TEST(RadioPool, ARiderThatAReceiverKeepsStays) {
  CountedRider rider;
  RiderPtr kept;
  Bed bed(Topology::line(2), {.radio = {.rate_bps = 8.0}});
  bed.reaction = [&](const Packet& packet) { kept = RiderPtr(packet.rider); };
  bed.at(1_s, [&] { bed.send(0, "x", no_agent, {}, RiderPtr(&rider)); });
  bed.run();
  EXPECT_EQ(rider.recycled, 0);
  kept = RiderPtr();
  EXPECT_EQ(rider.recycled, 1);
}

TEST(RadioPool, ADroppedOrLostPacketLetsGoOfItsRider) {
  CountedRider lost, dropped;
  Bed bed(Topology::line(2),
          {.radio = {.rate_bps = 8.0, .queue = {.packets_max = 1}, .loss = Loss::bernoulli(1.0)}});
  bed.at(1_s, [&] {
    bed.send(0, "x", no_agent, {}, RiderPtr(&lost));
    bed.send(0, "x", no_agent, {}, RiderPtr(&dropped));
    EXPECT_EQ(dropped.recycled, 1);
    EXPECT_EQ(lost.recycled, 0);
  });
  bed.run();
  EXPECT_EQ(lost.recycled, 1);
  EXPECT_EQ(dropped.recycled, 1);
}

TEST(RadioPool, FinishLetsGoOfTheRidersUnderWay) {
  CountedRider queued, on_air;
  Bed bed(Topology::line(2), {.radio = {.rate_bps = 8.0}, .end = Time::at(1_s)});
  bed.at(500_ms, [&] {
    bed.send(0, "x", no_agent, {}, RiderPtr(&on_air));
    bed.send(0, "x", no_agent, {}, RiderPtr(&queued));
  });
  bed.simulation.run();
  EXPECT_EQ(on_air.recycled + queued.recycled, 0);
  bed.radio->finish();
  EXPECT_EQ(on_air.recycled, 1);
  EXPECT_EQ(queued.recycled, 1);
  EXPECT_EQ(bed.count(0, Fate::in_flight_at_end), 2u);
  bed.radio->finish();  // once more changes nothing
  EXPECT_EQ(bed.count(0, Fate::in_flight_at_end), 2u);
  EXPECT_EQ(on_air.recycled, 1);
}

TEST(RadioPool, ARadioDestroyedMidRunLetsGoAndCallsNobody) {
  CountedRider rider;
  Bed bed(Topology::line(2), {.radio = {.rate_bps = 8.0}, .end = Time::at(10_s)});
  bed.at(1_s, [&] {
    bed.send(0, "a");
    bed.send(0, "b", no_agent, {}, RiderPtr(&rider));
  });
  bed.at(2500_ms, [&] {
    EXPECT_EQ(bed.heard.size(), 1u);
    bed.radio.reset();
    EXPECT_EQ(rider.recycled, 1);
  });
  const RunEnd end = bed.simulation.run();
  EXPECT_TRUE(end.ok()) << end.message;
  EXPECT_EQ(bed.heard.size(), 1u);
  EXPECT_EQ(rider.recycled, 1);
}

std::uint64_t digest_of_a_run(std::uint64_t seed, std::size_t other_packets) {
  Bed bed(Topology::ring(5), {.radio = {.rate_bps = 2000.0,
                                        .queue = {.packets_max = 4},
                                        .latency = 7_ms,
                                        .loss = Loss::bernoulli(0.2)},
                              .seed = seed,
                              .end = Time::at(20_s),
                              .keep_messages = false});
  for (int n = 0; n < 500; ++n) {
    bed.at(41_ms * n, [&bed, n] {
      bed.send(n % 5, std::string(static_cast<std::size_t>(n % 23), 'x'), n % 4 ? no_agent : n % 3,
               {});
    });
  }
  bed.at(1_s, [&bed, other_packets] {
    for (std::size_t i = 0; i < other_packets; ++i) bed.send(0, "more");
  });
  bed.run();
  return bed.digest.hash;
}

TEST(RadioPool, EqualRunsHaveEqualDigests) {
  EXPECT_EQ(digest_of_a_run(3, 0), digest_of_a_run(3, 0));
  EXPECT_NE(digest_of_a_run(3, 0), digest_of_a_run(4, 0));
  EXPECT_NE(digest_of_a_run(3, 0), digest_of_a_run(3, 1));
}

}  // namespace
}  // namespace hearsay
