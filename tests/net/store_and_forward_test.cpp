// Bundles: who gets them when, once, and what bounds do to them.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "tests/net/gossip_bed.hpp"

namespace hearsay {
namespace {

constexpr auto bundles = Policy::bundles;

RadioOptions fast() { return {.rate_bps = 1e6, .latency = 1_ms}; }

TEST(StoreAndForward, ABundleGoesDownALineAndIsDeliveredOnceToEach) {
  // 29 bytes at 1 Mbit/s take 232 µs, and 1 ms of latency: 1232 µs a hop.
  GossipBed bed(bundles, Topology::line(5),
                {.radio = fast(), .gossip = {.summary_period = 1000_s}, .end = Time::at(500_ms)});
  bed.at(100_us, [&] { bed.write(0, "x"); });
  bed.run();
  std::vector<Heard> expected;
  for (int hop = 1; hop < 5; ++hop) {
    expected.push_back({100'000 + 1'232'000 * hop, 0, hop, "x"});
  }
  EXPECT_EQ(bed.heard, expected);
  for (AgentId a = 0; a < 5; ++a) EXPECT_EQ(bed.counts(a).sent, 1u) << "each passes it on once";
  EXPECT_EQ(bed.counts(2).known, 1u) << "from agent 3";
}

TEST(StoreAndForward, DelayIsFromWritingToDelivery) {
  GossipBed bed(bundles, Topology::line(3),
                {.radio = fast(), .gossip = {.summary_period = 1000_s}, .end = Time::at(500_ms)});
  bed.at(100_ms, [&] { bed.write(0, "x"); });
  bed.at(200_ms, [&] { bed.write(0, "yy"); });
  Time sent;
  bed.reaction = [&](const Packet& packet) { sent = packet.sent; };
  bed.run();
  EXPECT_EQ(sent, Time::at(200_ms)) << "the packet says when it was written";
  EXPECT_EQ(bed.counts(1).delay, 1232_us + 1240_us);
  EXPECT_EQ(bed.counts(2).delay, (1232_us + 1240_us) * 2);
  EXPECT_EQ(bed.counts(0).delay, Duration());
}

// A connected graph with loops: a random tree and some edges more.
Topology random_connected(int agents, Stream& draws) {
  std::vector<std::pair<AgentId, AgentId>> edges;
  for (AgentId a = 1; a < agents; ++a) {
    edges.emplace_back(static_cast<AgentId>(draws.below(static_cast<std::uint64_t>(a))), a);
  }
  for (std::uint64_t more = draws.below(6); more > 0; --more) {
    const auto a = static_cast<AgentId>(draws.below(static_cast<std::uint64_t>(agents)));
    const auto b = static_cast<AgentId>(draws.below(static_cast<std::uint64_t>(agents)));
    if (a != b) edges.emplace_back(a, b);
  }
  return Topology::edges(agents, edges);
}

TEST(StoreAndForward, EverythingReachesEverybodyOnceOnAnyConnectedGraphWithLossAndReordering) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Stream draws(seed, Purpose("graphs"), Entity::agent(0));
    const int agents = 2 + static_cast<int>(draws.below(7));
    RadioOptions radio = fast();
    radio.loss = Loss::bernoulli(0.4);
    radio.jitter = {.law = JitterOptions::Law::exponential, .spread = 200_ms};
    GossipBed bed(bundles, random_connected(agents, draws), {.radio = radio, .seed = seed});
    const int count = 12;
    for (int n = 0; n < count; ++n) {
      const auto from = static_cast<AgentId>(draws.below(static_cast<std::uint64_t>(agents)));
      bed.at(317_ms * n, [&bed, n, from] { bed.write(from, std::to_string(n)); });
    }
    bed.run();
    for (int n = 0; n < count; ++n) {
      std::size_t once = 0;
      for (AgentId a = 0; a < agents; ++a) {
        ASSERT_LE(bed.times(a, std::to_string(n)), 1u) << "seed " << seed;
        once += bed.times(a, std::to_string(n));
      }
      EXPECT_EQ(once, static_cast<std::size_t>(agents - 1)) << "seed " << seed << ", bundle " << n;
    }
  }
}

// Epochs of a random graph each, long enough for everything to spread through its components; a
// bundle is written at the beginning of an epoch. Who has it is then: who was joined, in any epoch
// since, to somebody who had it.
TEST(StoreAndForward, WithoutLossItGetsExactlyWhereContactsLeadInTime) {
  constexpr int agents = 8, epochs = 6;
  const Duration epoch = 30_s;
  std::size_t reached = 0, missed = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    Stream draws(seed, Purpose("contacts"), Entity::agent(0));
    std::vector<LinkChange> trace;
    std::vector<std::vector<std::pair<AgentId, AgentId>>> edges(epochs);
    for (int e = 0; e < epochs; ++e) {
      for (AgentId a = 0; a < agents; ++a) {
        for (AgentId b = a + 1; b < agents; ++b) {
          if (!draws.bernoulli(0.1)) continue;
          edges[static_cast<std::size_t>(e)].emplace_back(a, b);
          trace.push_back({Time::at(epoch * e), a, b, true});
          trace.push_back({Time::at(epoch * (e + 1) - 1_s), a, b, false});
        }
      }
    }
    std::sort(trace.begin(), trace.end());
    GossipBed bed(bundles, plan_contacts(agents, trace, {}),
                  {.radio = fast(), .seed = seed, .end = Time::at(epoch * epochs)});
    // has[n]: who has the n-th bundle.
    std::vector<std::set<AgentId>> has;
    std::vector<AgentId> writers;
    for (int e = 0; e < epochs; ++e) {
      const int from = static_cast<int>(draws.below(agents));
      bed.at(epoch * e + 1_ms, [&bed, e, from] { bed.write(from, std::to_string(e)); });
      has.push_back({from});
      writers.push_back(from);
      for (std::set<AgentId>& who : has) {
        for (std::size_t size = 0; size != who.size();) {
          size = who.size();
          for (const auto& [a, b] : edges[static_cast<std::size_t>(e)]) {
            if (who.contains(a) || who.contains(b)) who.insert({a, b});
          }
        }
      }
    }
    bed.run();
    for (int e = 0; e < epochs; ++e) {
      std::set<AgentId> delivered;
      for (const Heard& h : bed.heard) {
        if (h.text != std::to_string(e)) continue;
        EXPECT_TRUE(delivered.insert(h.receiver).second) << "twice";
      }
      std::set<AgentId> others = has[static_cast<std::size_t>(e)];
      others.erase(writers[static_cast<std::size_t>(e)]);
      EXPECT_EQ(delivered, others) << "seed " << seed << ", bundle " << e;
      reached += others.size();
      missed += agents - 1 - others.size();
    }
  }
  EXPECT_GT(reached, 100u);
  EXPECT_GT(missed, 50u);
}

// Everything that can go wrong, at random: whoever gets a bundle gets it once until it loses its
// memory, and after that once more at most.
TEST(StoreAndForward, NothingIsDeliveredTwiceWhateverHappens) {
  constexpr int agents = 6;
  std::size_t deliveries = 0, again = 0;
  for (std::uint64_t seed = 1; seed <= 15; ++seed) {
    Stream draws(seed, Purpose("storm"), Entity::agent(0));
    RadioOptions radio = fast();
    radio.rate_bps = 50e3;
    radio.queue = {.packets_max = 4,
                   .policy = seed % 2 == 0 ? QueuePolicy::drop_oldest : QueuePolicy::replace};
    radio.loss = Loss::bernoulli(0.2);
    radio.jitter = {.law = JitterOptions::Law::exponential, .spread = 700_ms};
    const Partition cut{
        .groups = {{0, 1, 2}, {3, 4, 5}}, .from = Time::at(5_s), .until = Time::at(25_s)};
    GossipOptions gossip{.summary_period = 700_ms, .buffer_packets_max = 20};
    if (seed % 3 == 0) gossip.lifetime = 4_s;
    GossipBed bed(bundles, plan_links(Topology::ring(agents), {.partitions = {cut}}),
                  {.radio = radio, .gossip = gossip, .seed = seed});
    for (int n = 0; n < 80; ++n) {
      const auto from = static_cast<AgentId>(draws.below(agents));
      bed.at(509_ms * n, [&bed, n, from] { bed.write(from, std::to_string(n)); });
    }
    std::array<int, agents> life{};
    for (int n = 0; n < 8; ++n) {
      const auto who = static_cast<AgentId>(draws.below(agents));
      bed.at(Duration::seconds(draws.uniform(1.0, 45.0)), [&bed, &life, who, n] {
        if (n % 2 == 0) {
          bed.radio.set_up(who, false);
          bed.radio.set_up(who, true);
          return;
        }
        bed.reboot(who);
        ++life[static_cast<std::size_t>(who)];
      });
    }
    std::set<std::tuple<AgentId, int, std::string>> had;
    bed.reaction = [&](const Packet& packet) {
      const int lives = life[static_cast<std::size_t>(packet.receiver)];
      const std::string text = text_of(packet.bytes);
      ASSERT_TRUE(had.insert({packet.receiver, lives, text}).second)
          << "seed " << seed << ": " << text << " twice at " << packet.receiver;
      ++deliveries;
      again += lives > 0 && had.contains({packet.receiver, lives - 1, text}) ? 1 : 0;
      for (AgentId a = 0; a < agents; ++a) ASSERT_LE(bed.node(a).store().held(), 20u);
    };
    bed.run();
  }
  EXPECT_GT(deliveries, 2000u);
  EXPECT_GT(again, 10u) << "who has lost its memory hears again";
}

TEST(StoreAndForward, ABundleGoesAsManyHopsAsItMay) {
  GossipBed bed(bundles, Topology::line(6), {.radio = fast(), .gossip = {.hops_max = 3}});
  bed.at(1_s, [&] { bed.write(1, "x"); });
  bed.run();
  std::set<AgentId> got;
  for (const Heard& h : bed.heard) got.insert(h.receiver);
  EXPECT_EQ(got, (std::set<AgentId>{0, 2, 3, 4}));
}

TEST(StoreAndForward, AShorterWayThatComesLaterLetsItGoOn) {
  // 2 has the bundle of 0 by two hops and may not pass it on. Then 0 answers 4, and 2 hears that.
  std::vector<LinkChange> trace = {
      {Time(), 0, 1, true},         {Time(), 1, 2, true},         {Time::at(10_s), 0, 2, true},
      {Time::at(10_s), 0, 4, true}, {Time::at(10_s), 2, 3, true},
  };
  GossipBed bed(bundles, plan_contacts(5, trace, {}),
                {.radio = fast(), .gossip = {.hops_max = 2}, .end = Time::at(20_s)});
  bed.at(1_s, [&] { bed.write(0, "x"); });
  std::size_t before = 99;
  bed.at(10_s, [&] { before = bed.times(3, "x"); });
  bed.run();
  EXPECT_EQ(before, 0u);
  EXPECT_EQ(bed.times(2, "x"), 1u);
  EXPECT_EQ(bed.times(3, "x"), 1u);
  EXPECT_EQ(bed.times(4, "x"), 1u);
}

TEST(StoreAndForward, AnAddressedBundleIsCarriedByAllAndDeliveredToOne) {
  GossipBed bed(bundles, Topology::ring(6), {.radio = fast()});
  bed.at(1_s, [&] { bed.write(1, "x", 4); });
  bed.run();
  ASSERT_EQ(bed.heard.size(), 1u);
  EXPECT_EQ(bed.heard[0].receiver, 4);
  EXPECT_EQ(bed.heard[0].sender, 1);
  for (AgentId a = 0; a < 6; ++a) EXPECT_EQ(bed.node(a).store().held(), 1u);
}

// Agent 1 is away from agent 0 until 10 s.
LinkPlan reunion() {
  return plan_links(Topology::line(2), {.outages = {{0, 1, Time(), Time::at(10_s)}}});
}

TEST(StoreAndForward, WhatHasExpiredIsNotDelivered) {
  GossipBed bed(bundles, reunion(), {.radio = fast(), .gossip = {.lifetime = 5_s}});
  bed.at(4_s, [&] { bed.write(0, "old"); });
  bed.at(8_s, [&] { bed.write(0, "new"); });
  bed.run();
  EXPECT_EQ(bed.times(1, "old"), 0u);
  EXPECT_EQ(bed.times(1, "new"), 1u);
  EXPECT_EQ(bed.counts(0).expired, 2u);
  EXPECT_EQ(bed.node(0).store().held(), 0u);
}

TEST(StoreAndForward, AnExpiredBundleHeardAgainIsNotDeliveredTwice) {
  GossipBed bed(bundles, Topology::line(2), {.radio = fast(), .gossip = {.lifetime = 5_s}});
  const NameId kind = bed.simulation.record().name("bundle");
  std::vector<std::byte> first, second;
  gossip::encode({.written = Time::at(1_s), .origin = 0, .sequence = 0, .kind = bed.kind},
                 bytes_of("first"), first);
  gossip::encode({.written = Time::at(1_s), .origin = 0, .sequence = 3, .kind = bed.kind},
                 bytes_of("never heard in time"), second);
  for (const Duration when : {2_s, 3_s, 5999_ms, 7_s, 30_s}) {
    bed.at(when, [&] { bed.radio.send(0, {.kind = kind, .bytes = first}); });
  }
  for (const Duration when : {20_s, 21_s}) {
    bed.at(when, [&] { bed.radio.send(0, {.kind = kind, .bytes = second}); });
  }
  bed.run();
  EXPECT_EQ(bed.heard.size(), 1u);
  EXPECT_EQ(bed.times(1, "first"), 1u);
  EXPECT_EQ(bed.counts(1).known + bed.counts(1).expired, 4u + 1u + 2u);
}

TEST(StoreAndForward, AFullBufferGivesUpTheOldest) {
  GossipBed bed(bundles, reunion(), {.radio = fast(), .gossip = {.buffer_packets_max = 3}});
  for (int n = 0; n < 5; ++n) {
    bed.at(1_s * (n + 1), [&bed, n] { bed.write(0, std::to_string(n)); });
  }
  std::size_t held = 0;
  bed.at(9_s, [&] { held = bed.node(0).store().held(); });
  bed.run();
  EXPECT_EQ(held, 3u);
  EXPECT_EQ(bed.counts(0).dropped, 2u);
  ASSERT_EQ(bed.heard.size(), 3u);
  for (std::size_t n = 0; n < 3; ++n) EXPECT_EQ(bed.heard[n].text, std::to_string(n + 2));
}

TEST(StoreAndForward, AnOlderBundleThanAllInAFullBufferIsDeliveredAndNotHeld) {
  GossipBed bed(bundles, Topology::line(2),
                {.radio = fast(), .gossip = {.buffer_packets_max = 1}, .end = Time::at(9_s)});
  std::vector<std::byte> frame;
  gossip::encode({.written = Time::at(1_s), .origin = 0, .kind = bed.kind, .hops_left = 9},
                 bytes_of("old"), frame);
  bed.at(2_s, [&] { bed.write(1, "own"); });
  bed.at(3_s, [&] {
    bed.radio.send(0, {.kind = bed.simulation.record().name("bundle"), .bytes = frame});
  });
  bed.run();
  EXPECT_EQ(bed.times(1, "old"), 1u);
  EXPECT_EQ(bed.counts(1).dropped, 1u);
  EXPECT_EQ(bed.counts(1).sent, 1u) << "its own";
}

TEST(StoreAndForward, AnswersToASummaryAreBounded) {
  GossipBed bed(bundles, reunion(), {.radio = fast(), .gossip = {.answers_max = 4}});
  for (int n = 0; n < 30; ++n) bed.at(100_ms * n, [&bed, n] { bed.write(0, std::to_string(n)); });
  bed.run();
  ASSERT_EQ(bed.heard.size(), 30u);
  std::map<std::int64_t, int> by_second;  // since it was first answered
  for (const Heard& h : bed.heard) {
    ++by_second[(h.at_ns - bed.heard[0].at_ns) / 1'000'000'000];
  }
  EXPECT_EQ(by_second.size(), 8u);
  for (const auto& [second, count] : by_second) EXPECT_EQ(count, second == 7 ? 2 : 4);
  for (std::size_t n = 0; n < 30; ++n) EXPECT_EQ(bed.heard[n].text, std::to_string(n)) << "in turn";
}

TEST(StoreAndForward, SummariesThatAreTooLargeAreSentInParts) {
  RadioOptions radio = fast();
  radio.loss = Loss::bernoulli(0.5);
  constexpr int agents = 25;
  GossipBed bed(bundles, Topology::star(agents),
                {.radio = radio, .gossip = {.summary_bytes_max = 128}, .end = Time::at(120_s)});
  for (AgentId a = 0; a < agents; ++a) {
    bed.at(1_s + 10_ms * a, [&bed, a] { bed.write(a, std::to_string(a)); });
  }
  bed.run();
  EXPECT_EQ(bed.heard.size(), static_cast<std::size_t>(agents * (agents - 1)));
  std::size_t large = 0;
  for (const MessageRow& row : bed.simulation.record().messages()) {
    if (bed.simulation.record().text(row.kind) != "bundles seen") continue;
    ASSERT_LE(row.bytes, 128u);
    large += row.bytes > 100 ? 1 : 0;
  }
  EXPECT_GT(large, 100u);
}

TEST(StoreAndForward, WhatTheRadioDoesNotTakeIsSentLater) {
  // Ten bundles at once into a queue of two; the agents hear each other all the time.
  for (const QueuePolicy policy :
       {QueuePolicy::drop_new, QueuePolicy::drop_oldest, QueuePolicy::replace}) {
    RadioOptions radio = fast();
    radio.rate_bps = 10e3;
    radio.queue = {.packets_max = 2, .policy = policy};
    GossipBed bed(bundles, Topology::line(2), {.radio = radio, .gossip = {.answers_max = 1}});
    bed.at(1_s, [&] {
      for (int n = 0; n < 10; ++n) EXPECT_TRUE(bed.write(0, std::to_string(n)));
    });
    bed.run();
    EXPECT_EQ(bed.heard.size(), 10u);
  }
}

TEST(StoreAndForward, BundlesThatWaitAreNoNewsOfOneAnother) {
  RadioOptions radio = fast();
  radio.rate_bps = 10e3;
  radio.queue = {.packets_max = 20, .policy = QueuePolicy::replace};
  GossipBed bed(bundles, Topology::line(2),
                {.radio = radio, .gossip = {.summary_period = 50_s}, .end = Time::at(20_s)});
  bed.at(1_s, [&] {
    for (int n = 0; n < 10; ++n) bed.write(0, std::to_string(n));
  });
  bed.run();
  EXPECT_EQ(bed.heard.size(), 10u);
  EXPECT_EQ(bed.radio.counts(0).fates[static_cast<std::size_t>(Fate::replaced)], 0u);
}

TEST(StoreAndForward, WhoIsDownWritesNothingAndHearsLater) {
  GossipBed bed(bundles, Topology::line(3), {.radio = fast()});
  bed.at(1_s, [&] { bed.write(0, "kept"); });
  bed.at(2_s, [&] { bed.radio.set_up(2, false); });
  bed.at(3_s, [&] {
    EXPECT_FALSE(bed.write(2, "from a dead man"));
    bed.write(0, "later");
  });
  std::size_t summaries = 0;
  bed.at(5_s, [&] { summaries = bed.counts(2).summaries; });
  bed.at(10_s, [&] {
    EXPECT_EQ(bed.counts(2).summaries, summaries) << "silent while it is down";
    bed.radio.set_up(2, true);
  });
  bed.run();
  EXPECT_EQ(bed.times(2, "kept"), 1u) << "its memory outlives sleep";
  EXPECT_EQ(bed.times(2, "later"), 1u);
  EXPECT_EQ(bed.times(0, "from a dead man"), 0u);
  EXPECT_EQ(bed.counts(2).written, 0u);
}

TEST(StoreAndForward, WhoHasLostItsMemoryWritesAnewAndHearsAllAgainItsOwnWordsToo) {
  GossipBed bed(bundles, Topology::line(2), {.radio = fast()});
  bed.at(1_s, [&] { bed.write(0, "of 0"); });
  bed.at(2_s, [&] { bed.write(1, "of 1, first life"); });
  bed.at(10_s, [&] { bed.reboot(1); });
  bed.at(20_s, [&] { bed.write(1, "of 1, second life"); });
  bed.run();
  EXPECT_EQ(bed.times(1, "of 0"), 2u);
  EXPECT_EQ(bed.times(1, "of 1, first life"), 1u);
  EXPECT_EQ(bed.times(0, "of 1, first life"), 1u);
  EXPECT_EQ(bed.times(0, "of 1, second life"), 1u);
  EXPECT_EQ(bed.times(1, "of 1, second life"), 0u);
}

TEST(StoreAndForward, OnlySoManyLivesOfAnAgentAreToldApart) {
  GossipBed bed(bundles, Topology::line(2),
                {.radio = fast(), .gossip = {.summary_period = 1000_s}});
  std::vector<std::byte> frame;
  for (int life = 0; life < 20; ++life) {
    bed.at(1_s * life + 100_ms, [&bed, life] { bed.write(0, std::to_string(life)); });
    bed.at(1_s * life + 500_ms, [&bed] { bed.node(0).forget(); });
  }
  bed.at(30_s, [&] {  // a bundle of the first life again
    gossip::encode({.written = Time::at(100_ms), .origin = 0, .kind = bed.kind}, bytes_of("0"),
                   frame);
    bed.radio.send(0, {.kind = bed.simulation.record().name("bundle"), .bytes = frame});
  });
  bed.run();
  EXPECT_EQ(bed.heard.size(), 20u);
  EXPECT_EQ(bed.times(1, "0"), 1u);
  EXPECT_EQ(bed.counts(1).late, 1u);
  EXPECT_EQ(bed.node(1).store().held(), 16u);
  EXPECT_EQ(bed.counts(1).dropped, 4u);
}

TEST(StoreAndForward, ABundleFromBeforeTheWindowIsRefusedAsLate) {
  GossipBed bed(bundles, Topology::line(2), {.radio = fast(), .end = Time::at(9_s)});
  std::vector<std::byte> frame;
  const auto hear = [&](std::uint32_t sequence) {
    gossip::encode({.written = Time(), .origin = 0, .sequence = sequence, .kind = bed.kind},
                   bytes_of(std::to_string(sequence)), frame);
    bed.radio.send(0, {.kind = bed.simulation.record().name("bundle"), .bytes = frame});
  };
  bed.at(1_s, [&] { hear(600); });
  bed.at(2_s, [&] { hear(600 - 512); });
  bed.at(3_s, [&] { hear(600 - 511); });
  bed.at(4_s, [&] { hear(600 - 511); });
  bed.run();
  EXPECT_EQ(bed.times(1, "600"), 1u);
  EXPECT_EQ(bed.times(1, "88"), 0u);
  EXPECT_EQ(bed.times(1, "89"), 1u);
  EXPECT_EQ(bed.counts(1).late, 2u) << "88, and 89 again: it is not told apart any more";
}

}  // namespace
}  // namespace hearsay
