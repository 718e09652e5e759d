#include "net/radio.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "sim/kernel/error.hpp"
#include "tests/net/bed.hpp"

namespace hearsay {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(Radio, PacketsLeaveOneAfterAnotherAndArriveAfterTheLatency) {
  Bed bed(Topology::line(2), {.radio = {.rate_bps = 1000.0, .header_bytes = 2, .latency = 5_ms}});
  bed.at(1_s, [&] {
    bed.send(0, "eight by");  // 80 bits: 1.000 … 1.080 s
    bed.send(0, "tw");        // 32 bits: 1.080 … 1.112 s
  });
  bed.at(1100_ms, [&] { bed.send(0, ""); });      // 16 bits: 1.112 … 1.128 s
  bed.at(2_s, [&] { bed.send(0, "again ok"); });  // the air has long been free
  bed.run();
  EXPECT_THAT(bed.heard,
              ElementsAre(Heard{1'085'000'000, 0, 1, "eight by"}, Heard{1'117'000'000, 0, 1, "tw"},
                          Heard{1'133'000'000, 0, 1, ""}, Heard{2'085'000'000, 0, 1, "again ok"}));
  const SenderCounts& counts = bed.radio->counts(0);
  EXPECT_EQ(counts.packets, 4u);
  EXPECT_EQ(counts.bytes_sent, 26u);
  EXPECT_EQ(counts.air_time, 208_ms);
  EXPECT_EQ(bed.radio->counts(1).packets, 0u);
}

TEST(Radio, AirTimeIsRoundedToTheNearestNanosecond) {
  const auto air_ns = [](double rate_bps) {
    Bed bed(Topology::line(2), {.radio = {.rate_bps = rate_bps}});
    bed.at(1_s, [&] { bed.send(0, "x"); });
    bed.run();
    return bed.radio->counts(0).air_time.nanoseconds();
  };
  EXPECT_EQ(air_ns(3e9), 3);   // 2.67
  EXPECT_EQ(air_ns(7e9), 1);   // 1.14
  EXPECT_EQ(air_ns(1e12), 0);  // 0.008
  EXPECT_EQ(air_ns(250'000), 32'000);
}

TEST(Radio, TransmittersDoNotWaitForEachOther) {
  Bed bed(Topology::line(3), {.radio = {.rate_bps = 8.0}});
  bed.at(0_s, [&] {
    bed.send(0, "a");
    bed.send(2, "c");
  });
  bed.run();
  EXPECT_THAT(bed.heard,
              ElementsAre(Heard{1'000'000'000, 0, 1, "a"}, Heard{1'000'000'000, 2, 1, "c"}));
}

TEST(Radio, ABroadcastReachesTheNeighboursInOrderOfNumber) {
  Bed bed(Topology::star(4), {.radio = {.rate_bps = 8e6}});
  bed.at(1_s, [&] { bed.send(0, "all"); });
  bed.at(2_s, [&] { bed.send(3, "one"); });
  bed.run();
  EXPECT_THAT(bed.heard,
              ElementsAre(Heard{1'000'003'000, 0, 1, "all"}, Heard{1'000'003'000, 0, 2, "all"},
                          Heard{1'000'003'000, 0, 3, "all"}, Heard{2'000'003'000, 3, 0, "one"}));
}

TEST(Radio, PacketsArriveBeforeAgentsActAtTheSameInstant) {
  Bed bed(Topology::line(2), {.radio = {.rate_bps = 8.0}});
  std::size_t heard_before_acting = 99;
  bed.at(1_s, [&] { heard_before_acting = bed.heard.size(); });  // scheduled first, acts later
  bed.at(0_s, [&] { bed.send(0, "x"); });
  bed.run();
  EXPECT_EQ(heard_before_acting, 1u);
}

TEST(Radio, APacketSaysWhoWhatAndWhen) {
  Bed bed(Topology::line(2), {.radio = {.rate_bps = 8.0}});
  int calls = 0;
  bed.reaction = [&](const Packet& packet) {
    ++calls;
    EXPECT_EQ(packet.kind, bed.kind);
    EXPECT_EQ(packet.sent, Time::at(3_s));
    EXPECT_EQ(packet.rider, nullptr);
  };
  bed.at(3_s, [&] { bed.send(1, "x"); });
  bed.run();
  EXPECT_EQ(calls, 1);
  const auto rows = bed.simulation.record().messages();
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].sent, Time::at(3_s));
  EXPECT_EQ(rows[0].arrived, Time::at(4_s));
  EXPECT_EQ(rows[0].sender, 1);
  EXPECT_EQ(rows[0].receiver, 0);
  EXPECT_EQ(rows[0].kind, bed.kind);
  EXPECT_EQ(rows[0].bytes, 1u);
  EXPECT_EQ(bed.fate_of(rows[0]), "delivered");
}

TEST(Radio, AFullQueueDropsWhatComes) {
  Bed bed(Topology::star(3), {.radio = {.rate_bps = 8.0, .queue = {.packets_max = 2}}});
  std::vector<bool> found_room;
  bed.at(1_s, [&] {
    for (const char* text : {"a", "b", "c", "d"}) found_room.push_back(bed.send(0, text));
  });
  bed.run();
  EXPECT_THAT(found_room, ElementsAre(true, true, false, false));
  EXPECT_EQ(bed.count(0, Fate::delivered), 4u);
  EXPECT_EQ(bed.count(0, Fate::queue_full), 4u);
  EXPECT_EQ(bed.radio->counts(0).packets, 4u);
  EXPECT_EQ(bed.radio->counts(0).bytes_sent, 2u);
  EXPECT_EQ(bed.radio->counts(0).air_time, 2_s);
  for (const MessageRow& row : bed.simulation.record().messages()) {
    if (bed.fate_of(row) == "queue_full") {
      EXPECT_EQ(row.arrived, Time::at(1_s));
    }
  }
}

TEST(Radio, APlaceIsFreeFromTheInstantTheLastBitLeft) {
  Bed bed(Topology::line(2),
          {.radio = {.rate_bps = 8.0, .queue = {.packets_max = 1}, .latency = 10_s}});
  std::vector<bool> found_room;
  bed.at(0_s, [&] { found_room.push_back(bed.send(0, "a")); });
  bed.at(1_s - 1_ns, [&] { found_room.push_back(bed.send(0, "b")); });
  bed.at(1_s, [&] { found_room.push_back(bed.send(0, "c")); });
  bed.run();
  EXPECT_THAT(found_room, ElementsAre(true, false, true));
  EXPECT_THAT(bed.heard,
              ElementsAre(Heard{11'000'000'000, 0, 1, "a"}, Heard{12'000'000'000, 0, 1, "c"}));
}

TEST(Radio, TheQueueNeverHoldsMoreThanItsBound) {
  // Bursts of 0 … 12 one-second packets every 3 s, against a queue kept by hand.
  constexpr std::size_t bound = 7;
  Bed bed(Topology::line(2), {.radio = {.rate_bps = 8.0, .queue = {.packets_max = bound}}});
  std::vector<std::int64_t> ends_s;
  std::uint64_t dropped = 0;
  for (int burst = 0; burst < 60; ++burst) {
    bed.at(Duration::nanoseconds(3'000'000'000LL * burst), [&, burst] {
      const std::int64_t now_s = 3 * burst;
      for (int i = 0; i < burst * 5 % 13; ++i) {
        std::erase_if(ends_s, [&](std::int64_t end) { return end <= now_s; });
        const bool room = ends_s.size() < bound;
        if (room) ends_s.push_back((ends_s.empty() ? now_s : ends_s.back()) + 1);
        dropped += !room;
        EXPECT_EQ(bed.send(0, "x"), room) << "burst " << burst << " packet " << i;
      }
    });
  }
  bed.run();
  EXPECT_GT(dropped, 50u);
  EXPECT_EQ(bed.count(0, Fate::queue_full), dropped);
}

TEST(Radio, AQueueThatGrowsKeepsItsOrder) {
  Bed bed(Topology::line(2), {.radio = {.rate_bps = 8.0, .queue = {.packets_max = 10}}});
  int fitted = 0;
  const auto fill = [&] {
    fitted = 0;
    while (bed.send(0, "x")) ++fitted;
  };
  bed.at(0_s, [&] {
    for (int i = 0; i < 3; ++i) bed.send(0, "x");
  });
  bed.at(2500_ms, [&] {  // one is left
    fill();
    EXPECT_EQ(fitted, 9);
  });
  bed.at(5500_ms, [&] {  // the packets of 3, 4 and 5 s have gone
    fill();
    EXPECT_EQ(fitted, 3);
  });
  bed.run();
  EXPECT_EQ(bed.heard.size(), 15u);
}

TEST(Radio, AnAddressedPacketIsHeardByItsAddresseeAlone) {
  Bed bed(Topology::full(4), {.radio = {.rate_bps = 8.0}});
  bed.at(0_s, [&] { bed.send(1, "x", 3); });
  bed.run();
  EXPECT_THAT(bed.heard, ElementsAre(Heard{1'000'000'000, 1, 3, "x"}));
  EXPECT_EQ(bed.radio->counts(1).expected, 1u);
}

TEST(Radio, AnEmptyNeighbourhoodTakesAirTimeOnly) {
  Bed bed(Topology::line(1), {.radio = {.rate_bps = 8.0}});
  bed.at(1_s, [&] { EXPECT_TRUE(bed.send(0, "x")); });
  bed.run();
  EXPECT_EQ(bed.radio->counts(0).expected, 0u);
  EXPECT_EQ(bed.radio->counts(0).air_time, 1_s);
  EXPECT_TRUE(bed.simulation.record().messages().empty());
}

TEST(Radio, StrangersAreABrokenInvariant) {
  Bed bed(Topology::line(3), {});
  const auto message = [](auto call) -> std::string {
    try {
      call();
    } catch (const BrokenInvariant& error) {
      return error.what();
    }
    return "nothing thrown";
  };
  EXPECT_EQ(message([&] { bed.send(3, "x"); }), "radio: sender 3 is not there (agents are 0 … 2)");
  EXPECT_EQ(message([&] { bed.send(central_agent, "x"); }),
            "radio: sender -1 is not there (agents are 0 … 2)");
  EXPECT_EQ(message([&] { bed.send(0, "x", 17); }),
            "radio: receiver 17 is not there (agents are 0 … 2)");
  EXPECT_EQ(message([&] { bed.send(0, "x", -1); }),
            "radio: receiver -1 is not there (agents are 0 … 2)");
  EXPECT_EQ(message([&] { bed.send(0, "x", 1, std::uint64_t{1} << 48); }),
            "radio: a tick must be below 2^48");
  EXPECT_THAT(message([&] { bed.radio->counts(3); }), HasSubstr("sender 3"));
  EXPECT_EQ(bed.radio->counts(0).packets, 0u);
}

TEST(Radio, OptionsOutsideTheirRangeAreNamed) {
  const auto message = [](RadioOptions options) -> std::string {
    Simulation simulation(Simulation::Options{});
    try {
      Radio radio(simulation, Topology::line(2), options);
    } catch (const InputError& error) {
      return error.what();
    }
    return "nothing thrown";
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(message({.rate_bps = -5.0}), "radio: rate_bps must be positive and finite, not -5");
  EXPECT_THAT(message({.rate_bps = nan}), HasSubstr("rate_bps"));
  EXPECT_EQ(message({.queue = {.packets_max = 0}}),
            "radio: queue_packets_max must be at least 1, not 0");
  EXPECT_EQ(message({.latency = -1_s}), "radio: latency_s must be at least 0, not -1");
  EXPECT_EQ(message({.mtu_bytes = 0}), "radio: mtu_bytes must be at least 1, not 0");
  EXPECT_EQ(message({.queue = {.wait_max = 0_s}}),
            "radio: queue_wait_max_s must be greater than 0, not 0");
  EXPECT_EQ(message({.access = {.sharing = Sharing::tdma}}),
            "radio: slot_s must be greater than 0, not 0");
  EXPECT_EQ(message({.loss = Loss::bernoulli(1.0)}), "nothing thrown");
}

}  // namespace
}  // namespace hearsay
