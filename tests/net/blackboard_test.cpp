// Slots: the last version wins, everywhere, whatever happened on the way.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "tests/net/gossip_bed.hpp"

namespace hearsay {
namespace {

constexpr auto slots = Policy::slots;

RadioOptions fast() { return {.rate_bps = 1e6, .latency = 1_ms}; }

// What each agent's copy says, as seen from outside: by what it wrote and what it was handed.
class Copies {
 public:
  using Content = std::tuple<Time, AgentId, std::string>;  // later wins, then the higher writer

  explicit Copies(GossipBed& bed) : bed_(bed), of_(bed.nodes.size()) {
    bed.reaction = [this](const Packet& packet) {
      const std::string text = text_of(packet.bytes);
      put(packet.receiver, text.substr(0, 1), {packet.sent, packet.sender, text});
    };
  }
  // Slot "a", "b", …; the text says which it is.
  void write(AgentId agent, char slot, int n) {
    const std::string text = std::string(1, slot) + std::to_string(n);
    ASSERT_TRUE(bed_.write(agent, text, no_agent, static_cast<std::uint64_t>(slot)));
    put(agent, text.substr(0, 1), {bed_.simulation.now(), agent, text});
  }
  void reboot(AgentId agent) {
    bed_.reboot(agent);
    of_[static_cast<std::size_t>(agent)].clear();
  }
  const std::map<std::string, Content>& of(AgentId agent) const {
    return of_[static_cast<std::size_t>(agent)];
  }
  // The latest of all copies, slot by slot.
  std::map<std::string, Content> latest() const {
    std::map<std::string, Content> all;
    for (const auto& copy : of_) {
      for (const auto& [slot, content] : copy) all[slot] = std::max(all[slot], content);
    }
    return all;
  }

 private:
  void put(AgentId agent, const std::string& slot, const Content& content) {
    Content& mine = of_[static_cast<std::size_t>(agent)][slot];
    ASSERT_GT(content, mine) << "agent " << agent << " was handed an older version";
    mine = content;
  }
  GossipBed& bed_;
  std::vector<std::map<std::string, Content>> of_;
};

struct Storm {
  bool reboots = false;
  QueuePolicy policy = QueuePolicy::drop_new;
};

// Two groups that do not hear one another for a while, loss, reordering, slots that many write.
void weather(std::uint64_t seed, const Storm& storm) {
  constexpr int agents = 6;
  Stream draws(seed, Purpose("storm"), Entity::agent(0));
  RadioOptions radio = fast();
  radio.rate_bps = 50e3;
  radio.queue = {.packets_max = 6, .policy = storm.policy};
  radio.loss = Loss::bernoulli(0.3);
  radio.jitter = {.law = JitterOptions::Law::exponential, .spread = 700_ms};
  const Partition cut{
      .groups = {{0, 1, 2}, {3, 4, 5}}, .from = Time::at(3_s), .until = Time::at(25_s)};
  GossipBed bed(slots, plan_links(Topology::ring(agents), {.partitions = {cut}}),
                {.radio = radio, .seed = seed, .end = Time::at(90_s)});
  Copies copies(bed);
  std::map<std::string, Copies::Content> written;
  for (int n = 0; n < 60; ++n) {
    const auto from = static_cast<AgentId>(draws.below(agents));
    const char slot = static_cast<char>('a' + draws.below(4));
    bed.at(Duration::seconds(draws.uniform(0.0, 24.0)), [&copies, &written, &bed, from, slot, n] {
      copies.write(from, slot, n);
      Copies::Content& last = written[std::string(1, slot)];
      last = std::max(last, {bed.simulation.now(), from, slot + std::to_string(n)});
    });
  }
  for (int n = 0; storm.reboots && n < 6; ++n) {
    const auto who = static_cast<AgentId>(draws.below(agents));
    // Early enough that nothing is under way at 25 s that nobody has any more.
    bed.at(Duration::seconds(draws.uniform(1.0, 18.0)), [&copies, who] { copies.reboot(who); });
  }
  std::map<std::string, Copies::Content> latest;
  bed.at(25_s - 1_us, [&] { latest = copies.latest(); });
  bed.run();
  ASSERT_EQ(latest.size(), 4u);
  if (!storm.reboots) {
    EXPECT_EQ(latest, written);
  }
  for (AgentId a = 0; a < agents; ++a) EXPECT_EQ(copies.of(a), latest) << "seed " << seed;
}

TEST(Blackboard, AfterAHealAllCopiesSayWhatWasWrittenLast) {
  for (std::uint64_t seed = 1; seed <= 15; ++seed) weather(seed, {});
}

TEST(Blackboard, SoTheyDoWithAQueueThatReplaces) {
  for (std::uint64_t seed = 1; seed <= 15; ++seed) {
    weather(seed, {.policy = QueuePolicy::replace});
  }
}

TEST(Blackboard, AfterRebootsAllCopiesSayTheLastThatAnybodyStillHad) {
  for (std::uint64_t seed = 1; seed <= 15; ++seed) weather(seed, {.reboots = true});
}

TEST(Blackboard, OfTwoVersionsOfOneInstantTheHigherWritersWinsEverywhere) {
  GossipBed bed(slots, Topology::line(5), {.radio = fast()});
  Copies copies(bed);
  bed.at(1_s, [&] {
    copies.write(4, 'a', 4);
    copies.write(0, 'a', 0);
  });
  bed.run();
  for (AgentId a = 0; a < 5; ++a) EXPECT_EQ(std::get<2>(copies.of(a).at("a")), "a4");
}

TEST(Blackboard, OfTwoVersionsByOneWriterAtOneInstantTheSecondWins) {
  GossipBed bed(slots, Topology::line(2), {.radio = fast()});
  bed.at(1_s, [&] {
    bed.write(0, "first");
    bed.write(0, "second");
  });
  bed.run();
  ASSERT_EQ(bed.heard.size(), 2u);
  EXPECT_EQ(bed.heard[1].text, "second");
  EXPECT_EQ(bed.counts(1).replaced, 1u);
}

TEST(Blackboard, ALateOlderVersionIsIgnoredAndCounted) {
  GossipBed bed(slots, Topology::line(2), {.radio = fast(), .end = Time::at(9_s)});
  const NameId kind = bed.simulation.record().name("slot");
  std::vector<std::byte> frame;
  const auto hear = [&](Duration written, std::string_view text) {
    gossip::encode({.key = gossip::Slot::key_of(bed.kind, 7),
                    .version = {.written = Time::at(written), .writer = 0}},
                   bytes_of(text), frame);
    bed.radio.send(0, {.kind = kind, .bytes = frame});
  };
  bed.at(3_s, [&] { hear(2_s, "new"); });
  bed.at(4_s, [&] { hear(1_s, "old"); });
  bed.at(5_s, [&] { hear(2_s, "new"); });
  bed.run();
  EXPECT_EQ(bed.times(1, "new"), 1u);
  EXPECT_EQ(bed.times(1, "old"), 0u);
  EXPECT_EQ(bed.counts(1).late, 1u);
  EXPECT_EQ(bed.counts(1).known, 2u) << "5 s; and agent 0 passed on what it had of agent 1";
  EXPECT_EQ(bed.counts(1).replaced, 0u);
}

TEST(Blackboard, WhatAWriterSaysAfterItHasLostItsMemoryIsNews) {
  GossipBed bed(slots, Topology::line(2), {.radio = fast()});
  Copies copies(bed);
  for (int n = 0; n < 50; ++n) bed.at(100_ms * n, [&copies, n] { copies.write(0, 'a', n); });
  bed.at(6_s, [&] {
    copies.reboot(0);
    copies.write(0, 'a', 99);
  });
  bed.run();
  EXPECT_EQ(std::get<2>(copies.of(1).at("a")), "a99");
  EXPECT_EQ(std::get<2>(copies.of(0).at("a")), "a99");
}

TEST(Blackboard, WhoHasLostItsMemoryReadsItAgain) {
  GossipBed bed(slots, Topology::line(3), {.radio = fast()});
  Copies copies(bed);
  bed.at(1_s, [&] { copies.write(0, 'a', 1); });
  bed.at(2_s, [&] { copies.write(1, 'b', 2); });
  bed.at(10_s, [&] { copies.reboot(1); });
  bed.run();
  EXPECT_EQ(copies.of(1), copies.of(0));
  EXPECT_EQ(copies.of(1).size(), 2u);
}

TEST(Blackboard, ANewVersionTakesThePlaceOfOneThatWaitsAtTheRadio) {
  RadioOptions radio = fast();
  radio.rate_bps = 1000.0;  // a slot takes about 0.2 s
  radio.queue = {.packets_max = 8, .policy = QueuePolicy::replace};
  GossipBed bed(slots, Topology::line(2),
                {.radio = radio, .gossip = {.summary_period = 1000_s}, .end = Time::at(20_s)});
  bed.at(1_s, [&] {
    for (int n = 0; n < 10; ++n) {
      bed.write(0, "a" + std::to_string(n), no_agent, 1);
      bed.write(0, "b" + std::to_string(n), no_agent, 2);
    }
  });
  bed.run();
  std::vector<std::string> texts;
  for (const Heard& h : bed.heard) texts.push_back(h.text);
  EXPECT_EQ(texts, (std::vector<std::string>{"a0", "b9", "a9"}));
  EXPECT_EQ(bed.radio.counts(0).fates[static_cast<std::size_t>(Fate::replaced)], 17u);
}

TEST(Blackboard, SlotsOfOtherKindsAreOthers) {
  GossipBed bed(slots, Topology::line(2), {.radio = fast()});
  const NameId other = bed.simulation.record().name("other");
  bed.at(1_s, [&] {
    bed.write(0, "x");
    bed.node(0).write({.kind = other, .bytes = bytes_of("y")});
  });
  std::set<std::pair<NameId, std::string>> got;
  bed.reaction = [&](const Packet& packet) { got.insert({packet.kind, text_of(packet.bytes)}); };
  bed.run();
  EXPECT_EQ(got, (std::set<std::pair<NameId, std::string>>{{bed.kind, "x"}, {other, "y"}}));
}

TEST(Blackboard, AFullOneHasNoRoomForANewSlotButForNewVersions) {
  GossipBed bed(slots, Topology::line(2), {.radio = fast(), .gossip = {.buffer_packets_max = 2}});
  bed.at(1_s, [&] {
    EXPECT_TRUE(bed.write(0, "a", no_agent, 1));
    EXPECT_TRUE(bed.write(0, "b", no_agent, 2));
    EXPECT_FALSE(bed.write(0, "c", no_agent, 3));
    EXPECT_TRUE(bed.write(0, "b again", no_agent, 2));
  });
  bed.at(5_s, [&] { EXPECT_FALSE(bed.write(1, "d", no_agent, 4)); });
  bed.run();
  EXPECT_EQ(bed.node(0).store().held(), 2u);
  EXPECT_EQ(bed.node(1).store().held(), 2u);
  EXPECT_EQ(bed.counts(0).dropped, 1u);
  EXPECT_EQ(bed.counts(0).written, 3u);
  EXPECT_EQ(bed.counts(1).dropped, 1u);
}

TEST(Blackboard, SummariesThatAreTooLargeAreSentInParts) {
  RadioOptions radio = fast();
  radio.loss = Loss::bernoulli(0.4);
  GossipBed bed(slots, Topology::line(3),
                {.radio = radio, .gossip = {.summary_bytes_max = 128}, .end = Time::at(200_s)});
  bed.at(1_s, [&] {
    for (std::uint64_t s = 0; s < 40; ++s) bed.write(0, std::to_string(s), no_agent, s * 1000);
  });
  bed.run();
  for (AgentId a = 0; a < 3; ++a) EXPECT_EQ(bed.node(a).store().held(), 40u);
  for (const MessageRow& row : bed.simulation.record().messages()) {
    if (bed.simulation.record().text(row.kind) == "slots held") {
      ASSERT_LE(row.bytes, 128u);
    }
  }
}

}  // namespace
}  // namespace hearsay
