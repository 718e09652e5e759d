// What both services share: summaries, riders, frames that make no sense, memory.
#include "net/gossip.hpp"

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <map>
#include <set>

#include "sim/kernel/error.hpp"
#include "tests/net/gossip_bed.hpp"
#include "tools/memory/memory.hpp"

namespace hearsay {
namespace {

RadioOptions fast() { return {.rate_bps = 1e6, .latency = 1_ms}; }

class CountedRider final : public Rider {
 public:
  int recycled = 0;

 private:
  void recycle() override { ++recycled; }
};

class Gossiping : public testing::TestWithParam<Policy> {
 protected:
  static const char* item() { return GetParam() == Policy::bundles ? "bundle" : "slot"; }
  static const char* summary() {
    return GetParam() == Policy::bundles ? "bundles seen" : "slots held";
  }
};
INSTANTIATE_TEST_SUITE_P(Of, Gossiping, testing::Values(Policy::bundles, Policy::slots),
                         [](const auto& of) {
                           return of.param == Policy::bundles ? "bundles" : "slots";
                         });

TEST_P(Gossiping, EachAgentSaysWhatItHasOncePerPeriodFromAPhaseOfItsOwn) {
  GossipBed bed(GetParam(), Topology::ring(8),
                {.radio = fast(), .gossip = {.summary_period = 3_s}, .end = Time::at(30_s)});
  bed.run();
  std::set<std::int64_t> phases;
  std::map<AgentId, std::int64_t> last;
  for (const MessageRow& row : bed.simulation.record().messages()) {
    EXPECT_EQ(bed.simulation.record().text(row.kind), summary());
    const std::int64_t ns = row.sent.nanoseconds();
    const auto known = last.find(row.sender);
    if (known == last.end()) {
      EXPECT_LT(ns, 3'000'000'000);
      phases.insert(ns);
    } else if (known->second != ns) {
      EXPECT_EQ(ns - known->second, 3'000'000'000);
    }
    last[row.sender] = ns;
  }
  EXPECT_EQ(phases.size(), 8u);
  for (AgentId a = 0; a < 8; ++a) EXPECT_EQ(bed.counts(a).summaries, 10u);
}

TEST_P(Gossiping, OfWhatNobodyLacksNothingIsSentTwice) {
  GossipBed bed(GetParam(), Topology::ring(5), {.radio = fast()});
  bed.at(1_s, [&] { bed.write(0, "x"); });
  bed.run();
  for (AgentId a = 0; a < 5; ++a) EXPECT_EQ(bed.counts(a).sent, 1u);
  EXPECT_EQ(bed.heard.size(), 4u);
}

TEST_P(Gossiping, WhatWasSentIsNotSentAgainWithinAPeriod) {
  // Everybody answers everybody at 90 % loss; each item leaves each agent at most once a period.
  RadioOptions radio = fast();
  radio.loss = Loss::bernoulli(0.9);
  GossipBed bed(GetParam(), Topology::full(5), {.radio = radio, .end = Time::at(30_s)});
  bed.at(1_s, [&] { bed.write(0, "x"); });
  bed.run();
  std::map<AgentId, std::set<std::int64_t>> sent_ns;
  for (const MessageRow& row : bed.simulation.record().messages()) {
    if (bed.simulation.record().text(row.kind) == item()) {
      sent_ns[row.sender].insert(row.sent.nanoseconds());
    }
  }
  std::size_t repeated = 0;
  for (const auto& [sender, times] : sent_ns) {
    for (auto at = times.begin(); std::next(at) != times.end(); ++at, ++repeated) {
      EXPECT_GE(*std::next(at) - *at, 1'000'000'000);
    }
  }
  EXPECT_GT(repeated, 3u);
}

TEST_P(Gossiping, PacketsOfOtherKindsPassThrough) {
  GossipBed bed(GetParam(), Topology::line(2), {.radio = fast(), .end = Time::at(500_ms)});
  bed.at(100_ms, [&] { bed.radio.send(0, {.kind = bed.kind, .bytes = bytes_of("plain")}); });
  bed.run();
  ASSERT_EQ(bed.heard.size(), 1u);
  EXPECT_EQ(bed.heard[0].text, "plain");
  EXPECT_EQ(bed.counts(1).delivered, 0u);
}

TEST_P(Gossiping, ARiderTravelsWithItsItemAtEachHopAndIsLetGo) {
  CountedRider riders[3];
  {
    GossipBed bed(GetParam(), Topology::line(4), {.radio = fast()});
    std::map<std::string, Rider*> seen;
    bed.reaction = [&](const Packet& packet) {
      Rider*& rider = seen[text_of(packet.bytes)];
      EXPECT_TRUE(rider == nullptr || packet.rider == rider);
      rider = packet.rider;
    };
    for (int n = 0; n < 3; ++n) {
      bed.at(1_s * (n + 1), [&, n] {
        bed.write(n, std::to_string(n), no_agent, GetParam() == Policy::slots ? 5 : 0,
                  RiderPtr(&riders[n]));
      });
    }
    bed.run();
    EXPECT_EQ(bed.heard.size(), 9u);
    for (int n = 0; n < 3; ++n) {
      EXPECT_EQ(seen[std::to_string(n)], &riders[n]);
      const bool gone = GetParam() == Policy::slots && n < 2;  // a later version has its place
      EXPECT_EQ(riders[n].recycled, gone ? 1 : 0);
    }
  }
  for (const CountedRider& rider : riders) EXPECT_EQ(rider.recycled, 1);
}

TEST_P(Gossiping, ForgettingLetsGoOfRiders) {
  CountedRider rider;
  GossipBed bed(GetParam(), Topology::line(1), {.radio = fast()});
  bed.at(1_s, [&] { bed.write(0, "x", no_agent, 0, RiderPtr(&rider)); });
  bed.at(9_s, [&] {
    EXPECT_EQ(rider.recycled, 0);
    bed.reboot(0);
    EXPECT_EQ(rider.recycled, 1);
    EXPECT_EQ(bed.node(0).store().held(), 0u);
  });
  bed.run();
}

// Noise between two agents that also have something to say.
TEST_P(Gossiping, FramesThatMakeNoSenseAreCountedAndDoNoHarm) {
  GossipBed bed(GetParam(), Topology::full(3), {.radio = fast()});
  Stream draws(1, Purpose("noise"), Entity::agent(0));
  std::vector<std::byte> noise;
  const NameId kinds[] = {bed.simulation.record().name(item()),
                          bed.simulation.record().name(summary())};
  for (int n = 0; n < 2000; ++n) {
    bed.at(20_ms * n, [&, n] {
      noise.resize(draws.below(80));
      for (std::byte& b : noise) b = static_cast<std::byte>(draws.below(256));
      if (!noise.empty() && n % 2 == 0) noise[0] = static_cast<std::byte>(1 + draws.below(4));
      bed.radio.send(2, {.kind = kinds[draws.below(2)], .bytes = noise});
    });
  }
  for (int n = 0; n < 20; ++n) {
    bed.at(1_s * n + 5_ms, [&bed, n] {
      bed.write(n % 2, std::to_string(n), no_agent, static_cast<std::uint64_t>(n));
    });
  }
  bed.run();
  for (int n = 0; n < 20; ++n) EXPECT_EQ(bed.times(1 - n % 2, std::to_string(n)), 1u);
  EXPECT_GT(bed.counts(0).malformed, 1000u);
  EXPECT_EQ(bed.counts(0).malformed, bed.counts(1).malformed);
}

TEST_P(Gossiping, AgentsThatAreNotThereAreNotBelieved) {
  GossipBed bed(GetParam(), Topology::line(2), {.radio = fast(), .end = Time::at(9_s)});
  std::vector<std::byte> frame;
  if (GetParam() == Policy::bundles) {
    gossip::encode({.origin = 2, .kind = bed.kind}, bytes_of("x"), frame);
  } else {
    gossip::encode({.key = 1, .version = {.written = Time(), .writer = 2}}, bytes_of("x"), frame);
  }
  bed.at(1_s, [&] {
    bed.radio.send(0, {.kind = bed.simulation.record().name(item()), .bytes = frame});
  });
  bed.run();
  EXPECT_TRUE(bed.heard.empty());
  EXPECT_EQ(bed.counts(1).malformed, 1u);
}

TEST_P(Gossiping, OneWhoHearsMayWriteAtOnce) {
  GossipBed bed(GetParam(), Topology::line(3), {.radio = fast()});
  bed.reaction = [&](const Packet& packet) {
    const std::string text = text_of(packet.bytes);
    if (text.size() < 12) {
      bed.write(packet.receiver, text + std::to_string(packet.receiver), no_agent,
                100 * text.size() + static_cast<std::uint64_t>(packet.receiver));
    }
  };
  bed.at(1_s, [&] { bed.write(1, "x"); });
  bed.run();
  std::set<std::pair<AgentId, std::string>> once;
  for (const Heard& h : bed.heard) EXPECT_TRUE(once.insert({h.receiver, h.text}).second);
  EXPECT_GT(once.size(), 1000u);
}

TEST_P(Gossiping, NothingIsAllocatedInSteadyState) {
  constexpr int agents = 6;
  FnvDigest digest;
  Simulation simulation({.end = Time::at(120_s), .record = {.digest = &digest}});
  Radio radio(simulation, Topology::ring(agents),
              {.rate_bps = 1e6, .latency = 1_ms, .loss = Loss::bernoulli(0.2)});
  GossipOptions options{.buffer_packets_max = 32, .lifetime = 10_s};
  std::vector<std::unique_ptr<Gossip>> nodes;
  for (AgentId a = 0; a < agents; ++a) {
    auto store = GetParam() == Policy::bundles ? make_bundle_store(a, agents, options)
                                               : make_slot_store(a, agents, options);
    nodes.push_back(std::make_unique<Gossip>(simulation, radio, a, std::move(store), options));
    nodes.back()->start();
  }
  std::array<std::byte, 512> payload{};
  std::uint64_t written = 0;
  std::function<void()> write = [&] {
    nodes[written % agents]->write(
        {.bytes = std::span(payload).first(written * 37 % 200), .subject = written % 30});
    ++written;
    simulation.schedule(simulation.now() + 100_ms, Phase::act, [&write] { write(); });
  };
  // First a crowd, so that the radio's queues have been as full as they will be.
  simulation.schedule(Time::at(50_ms), Phase::act, [&] {
    for (std::uint64_t n = 0; n < 40 * agents; ++n) {
      nodes[n % agents]->write({.bytes = payload, .subject = n % 30});
    }
  });
  simulation.schedule(Time::at(100_ms), Phase::act, [&write] { write(); });
  std::uint64_t counted[2] = {}, delivered[2] = {};
  for (const std::size_t i : {0u, 1u}) {
    simulation.schedule(Time::at(40_s + 79_s * static_cast<int>(i)), Phase::observe, [&, i] {
      counted[i] = memory::allocations();
      for (const auto& node : nodes) delivered[i] += node->counts().delivered;
    });
  }
  const std::uint64_t before = memory::allocations();
  simulation.run();
  radio.finish();
  EXPECT_GT(counted[0], before) << "the counter does not count";
  EXPECT_GT(delivered[1], delivered[0] + 3000);
  EXPECT_EQ(counted[1], counted[0]);
}

TEST_P(Gossiping, EqualRunsHaveEqualDigests) {
  const auto digest = [](std::uint64_t seed) {
    RadioOptions radio = fast();
    radio.loss = Loss::bernoulli(0.3);
    GossipBed bed(GetParam(), Topology::ring(5), {.radio = radio, .seed = seed});
    for (int n = 0; n < 20; ++n) bed.at(1_s * n, [&bed, n] { bed.write(n % 5, "text"); });
    bed.run();
    return bed.digest.hash;
  };
  EXPECT_EQ(digest(1), digest(1));
  EXPECT_NE(digest(1), digest(2));
}

TEST(Gossip, RefusesOptionsOutsideTheirRange) {
  const auto refused = [](const GossipOptions& options, const std::string& name) {
    try {
      check(options);
    } catch (const InputError& error) {
      return std::string(error.what()).find(name) != std::string::npos;
    }
    return false;
  };
  EXPECT_NO_THROW(check(GossipOptions{}));
  EXPECT_TRUE(refused({.summary_period = Duration()}, "summary_period"));
  EXPECT_TRUE(refused({.summary_bytes_max = 127}, "summary_bytes_max"));
  EXPECT_TRUE(refused({.answers_max = 0}, "answers_max"));
  EXPECT_TRUE(refused({.buffer_packets_max = 0}, "buffer_packets_max"));
  EXPECT_TRUE(refused({.hops_max = 0}, "hops_max"));
  EXPECT_TRUE(refused({.lifetime = Duration()}, "lifetime"));
}

}  // namespace
}  // namespace hearsay
