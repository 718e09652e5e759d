// What becomes of packets, above all at the end of a run.
#include "net/radio.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <stdexcept>

#include "sim/kernel/error.hpp"
#include "tests/net/bed.hpp"

namespace hearsay {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(RadioFate, APacketToSomebodyOutOfRangeTakesAirTime) {
  Bed bed(Topology::line(3), {.radio = {.rate_bps = 8.0, .latency = 100_ms}});
  bed.at(0_s, [&] {
    bed.send(0, "far", 2);
    bed.send(0, "self", 0);
    bed.send(0, "near", 1);
  });
  bed.run();
  EXPECT_THAT(bed.heard, ElementsAre(Heard{11'100'000'000, 0, 1, "near"}));
  const auto rows = bed.simulation.record().messages();
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(bed.fate_of(rows[0]), "out_of_range");
  EXPECT_EQ(rows[0].receiver, 2);
  EXPECT_EQ(rows[0].arrived, Time::at(3_s));  // when its last bit left
  EXPECT_EQ(bed.fate_of(rows[1]), "out_of_range");
  EXPECT_EQ(rows[1].arrived, Time::at(7_s));
  EXPECT_EQ(bed.radio->counts(0).air_time, 11_s);
}

TEST(RadioFate, WhatArrivesAtTheEndIsDeliveredAndWhatWouldArriveLaterIsInFlight) {
  for (const auto& [latency, fate] :
       {std::pair{2_s, Fate::delivered}, std::pair{2_s + 1_ns, Fate::in_flight_at_end}}) {
    Bed bed(Topology::line(2),
            {.radio = {.rate_bps = 8.0, .latency = latency}, .end = Time::at(3_s)});
    bed.at(0_s, [&] { bed.send(0, "x"); });
    bed.run();
    EXPECT_EQ(bed.rows(fate), 1u);
    EXPECT_EQ(bed.simulation.record().messages().size(), 1u);
    EXPECT_EQ(bed.simulation.record().messages()[0].arrived, Time::at(3_s));
    EXPECT_EQ(bed.radio->counts(0).bytes_sent, 1u);
  }
}

TEST(RadioFate, WhatHasNotBegunAtTheEndIsNeitherBytesNorAirTime) {
  for (const auto& [end, bytes] : {std::pair{3_s, 4u}, std::pair{4_s, 6u}}) {
    Bed bed(Topology::line(2),
            {.radio = {.rate_bps = 8.0, .header_bytes = 1, .latency = 1_s}, .end = Time::at(end)});
    bed.at(0_s, [&] {
      bed.send(0, "a");  // 0 … 2 s
      bed.send(0, "b");  // 2 … 4 s: half of it is out at 3 s
      bed.send(0, "c");  // 4 … 6 s: its first bit leaves at 4 s
    });
    bed.run();
    EXPECT_EQ(bed.count(0, Fate::delivered), 1u);
    EXPECT_EQ(bed.count(0, Fate::in_flight_at_end), 2u);
    EXPECT_EQ(bed.radio->counts(0).bytes_sent, bytes);
    EXPECT_EQ(bed.radio->counts(0).air_time, end);
  }
}

TEST(RadioFate, WhatFinishSettledDoesNotArrive) {
  Bed bed(Topology::line(2), {.radio = {.rate_bps = 8.0}, .end = Time::at(9_s)});
  bed.at(0_s, [&] {
    for (const char* text : {"a", "b", "c"}) bed.send(0, text);
  });
  bed.at(1500_ms, [&] { bed.radio->finish(); });
  bed.at(4_s, [&] {  // what is sent now must find its own place, though b and c were taken back
    for (const char* text : {"d", "e", "f"}) bed.send(0, text);
  });
  bed.run();
  EXPECT_THAT(bed.heard,
              ElementsAre(Heard{1'000'000'000, 0, 1, "a"}, Heard{5'000'000'000, 0, 1, "d"},
                          Heard{6'000'000'000, 0, 1, "e"}, Heard{7'000'000'000, 0, 1, "f"}));
  EXPECT_EQ(bed.count(0, Fate::in_flight_at_end), 2u);
}

TEST(RadioFate, WhatIsUnderWayAtTheEndIsSettledInOrderOfSending) {
  Bed bed(Topology::full(3), {.radio = {.rate_bps = 8.0}, .end = Time::at(9_s)});
  // The last slot to come free is the first to be used again.
  bed.at(0_s, [&] {
    bed.send(0, "a");
    bed.send(1, "ab");
    bed.send(2, "long one");
  });
  bed.at(8500_ms, [&] {
    bed.send(2, "x");
    bed.send(0, "y");
    bed.send(1, "z");
  });
  bed.run();
  std::vector<std::pair<AgentId, AgentId>> order;
  for (const MessageRow& row : bed.simulation.record().messages()) {
    if (bed.fate_of(row) == "in_flight_at_end") order.emplace_back(row.sender, row.receiver);
  }
  using P = std::pair<AgentId, AgentId>;
  EXPECT_THAT(order, ElementsAre(P{2, 0}, P{2, 1}, P{0, 1}, P{0, 2}, P{1, 0}, P{1, 2}));
}

TEST(RadioFate, EveryPacketHasOneFateAtEachPotentialReceiver) {
  Bed bed(Topology::ring(6), {.radio = {.rate_bps = 80.0,
                                        .queue = {.packets_max = 3},
                                        .latency = 300_ms,
                                        .loss = Loss::bernoulli(0.3)},
                              .end = Time::at(40_s)});
  // Each packet is sent at an instant of its own, which names it.
  std::map<std::pair<Time, AgentId>, std::set<AgentId>> expected;
  for (int n = 0; n < 400; ++n) {
    const Duration when = Duration::nanoseconds(n * 97'000'001LL);
    const AgentId from = n * 7 % 6;
    const AgentId to = n % 3 == 0 ? n % 5 : no_agent;
    auto& hearers = expected[{Time::at(when), from}];
    if (to == no_agent) {
      hearers = {(from + 1) % 6, (from + 5) % 6};
    } else {
      hearers = {to};
    }
    bed.at(when, [&bed, from, to, n] { bed.send(from, std::string(n % 17, 'x'), to); });
  }
  bed.run();
  for (const MessageRow& row : bed.simulation.record().messages()) {
    auto found = expected.find({row.sent, row.sender});
    ASSERT_NE(found, expected.end());
    EXPECT_EQ(found->second.erase(row.receiver), 1u) << "a second fate";
  }
  for (const auto& [packet, hearers] : expected) EXPECT_TRUE(hearers.empty()) << "no fate";
  std::uint64_t packets = 0;
  for (AgentId a = 0; a < 6; ++a) {
    const SenderCounts& counts = bed.radio->counts(a);
    std::uint64_t sum = 0;
    for (const std::uint64_t fates : counts.fates) sum += fates;
    EXPECT_EQ(sum, counts.expected);
    packets += counts.packets;
  }
  EXPECT_EQ(packets, 400u);
  for (const Fate fate : {Fate::delivered, Fate::lost, Fate::out_of_range, Fate::queue_full,
                          Fate::in_flight_at_end}) {
    std::uint64_t counted = 0;
    for (AgentId a = 0; a < 6; ++a) counted += bed.count(a, fate);
    EXPECT_EQ(bed.rows(fate), counted);
    EXPECT_GT(counted, 0u) << to_string(fate) << " is not put to the test";
  }
}

TEST(RadioFate, FatesThatDoNotBalanceAreABrokenInvariant) {
  SenderCounts counts{.packets = 3, .expected = 6, .fates = {4, 1, 0, 1, 0}};
  EXPECT_NO_THROW(require_balance(7, counts));
  counts.fates[1] = 0;
  try {
    require_balance(7, counts);
    FAIL() << "nothing thrown";
  } catch (const BrokenInvariant& error) {
    EXPECT_STREQ(error.what(),
                 "radio: agent 7 sent 3 packets to 6 potential receivers, but 5 fates are known");
  }
}

TEST(RadioFate, PacketsToTheDeafCountAsDelivered) {
  Simulation simulation({.end = Time::at(5_s), .record = {}});
  Radio radio(simulation, Topology::line(2), {});
  simulation.schedule(Time::at(1_s), Phase::act,
                      [&] { radio.send(0, {.kind = 0, .bytes = bytes_of("x")}); });
  simulation.run();
  radio.finish();
  EXPECT_EQ(radio.counts(0).fates[static_cast<std::size_t>(Fate::delivered)], 1u);
}

TEST(RadioFate, AnExceptionInAReceiverEndsTheRunInItsName) {
  Bed bed(Topology::star(4), {.radio = {.rate_bps = 8.0}});
  bed.reaction = [](const Packet& packet) {
    if (packet.receiver == 2) throw std::runtime_error("ouch");
  };
  bed.at(1_s, [&] { bed.send(0, "x"); });
  const RunEnd end = bed.run();  // finish() balances nevertheless
  EXPECT_EQ(end.reason, EndReason::agent_failed);
  EXPECT_EQ(end.agent, 2);
  EXPECT_THAT(end.message, HasSubstr("ouch"));
  EXPECT_EQ(bed.count(0, Fate::delivered), 2u);
  EXPECT_EQ(bed.count(0, Fate::in_flight_at_end), 1u);
}

TEST(RadioFate, AnAbsurdlySlowRadioNeverDelivers) {
  Bed bed(Topology::line(2), {.radio = {.rate_bps = 1e-300, .latency = 5_s}});
  bed.at(1_s, [&] {
    for (int i = 0; i < 5; ++i) bed.send(0, "x");
  });
  bed.run();
  EXPECT_EQ(bed.count(0, Fate::in_flight_at_end), 5u);
  EXPECT_EQ(bed.radio->counts(0).bytes_sent, 1u);
}

}  // namespace
}  // namespace hearsay
