// The way from sender to hearer takes time, and a broadcast goes from hearer to hearer.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "sim/kernel/error.hpp"
#include "tests/net/bed.hpp"

namespace hearsay {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// Agent 0 in the middle; 1 and 3 are 5 m away, 2 is 2.5 m, 4 is 13 m.
Topology spread() {
  const std::vector<std::array<double, 3>> positions_m{
      {0, 0, 0}, {3, 4, 0}, {0, 0, 2.5}, {-5, 0, 0}, {3, -4, 12}};
  return Topology::disk(positions_m, 13.0);
}

TEST(RadioPropagation, APacketArrivesLaterByTheWay) {
  Bed bed(spread(), {.radio = {.rate_bps = 8.0, .latency = 5_ms, .propagation_m_per_s = 2000.0}});
  bed.at(1_s, [&] { bed.send(0, "x"); });
  bed.at(3_s, [&] { bed.send(0, "y", 4); });
  bed.run();
  // 1 s of sending, 5 ms of latency, and 2.5 ms, 1.25 ms or 6.5 ms of way.
  EXPECT_THAT(bed.heard,
              ElementsAre(Heard{2'006'250'000, 0, 2, "x"}, Heard{2'007'500'000, 0, 1, "x"},
                          Heard{2'007'500'000, 0, 3, "x"}, Heard{2'011'500'000, 0, 4, "x"},
                          Heard{4'011'500'000, 0, 4, "y"}));
  for (const MessageRow& row : bed.simulation.record().messages()) {
    EXPECT_EQ(row.sent,
              row.bytes == 1 && row.arrived > Time::at(4_s) ? Time::at(3_s) : Time::at(1_s));
  }
  EXPECT_EQ(bed.radio->counts(0).air_time, 2_s);
}

TEST(RadioPropagation, TheWayIsRoundedToTheNearestNanosecond) {
  const auto way_ns = [](double m_per_s) {
    Bed bed(spread(), {.radio = {.rate_bps = 8.0, .propagation_m_per_s = m_per_s}});
    bed.at(0_s, [&] { bed.send(0, "x", 4); });
    bed.run();
    return bed.heard.at(0).at_ns - 1'000'000'000;
  };
  EXPECT_EQ(way_ns(299'792'458.0), 43);  // 43.36
  EXPECT_EQ(way_ns(3.1e8), 42);          // 41.94
  EXPECT_EQ(way_ns(2.6e10), 1);          // 0.5
  EXPECT_EQ(way_ns(2.7e10), 0);          // 0.48
  EXPECT_EQ(way_ns(343.0), 37'900'875);  // 37900874.64
}

TEST(RadioPropagation, WithoutASpeedAllHearAtOnceInOrderOfNumber) {
  Bed bed(spread(), {.radio = {.rate_bps = 8.0}});
  bed.at(0_s, [&] { bed.send(0, "x"); });
  bed.run();
  std::vector<AgentId> order;
  for (const Heard& h : bed.heard) {
    order.push_back(h.receiver);
    EXPECT_EQ(h.at_ns, 1'000'000'000);
  }
  EXPECT_THAT(order, ElementsAre(1, 2, 3, 4));
}

TEST(RadioPropagation, EachInstantIsOneEvent) {
  for (const auto& [m_per_s, events] : {std::pair{2000.0, 4u}, std::pair{1e300, 2u}}) {
    Bed bed(spread(), {.radio = {.rate_bps = 8.0, .propagation_m_per_s = m_per_s}});
    bed.at(0_s, [&] { bed.send(0, "x"); });
    EXPECT_EQ(bed.run().events, events);
  }
}

TEST(RadioPropagation, WhatHappensBetweenTwoHearersHappensBetweenThem) {
  Bed bed(spread(), {.radio = {.rate_bps = 8.0, .propagation_m_per_s = 1.0}});
  std::vector<std::size_t> heard;
  bed.at(0_s, [&] { bed.send(0, "x"); });                   // arrives at 3.5, 6, 6 and 14 s
  bed.at(4_s, [&] { heard.push_back(bed.heard.size()); });  // between
  bed.at(6_s, [&] { heard.push_back(bed.heard.size()); });  // agents act behind the arrivals
  bed.simulation.schedule(Time::at(14_s), Phase::update,    // in the queue before the arrival
                          [&] { heard.push_back(bed.heard.size()); });
  bed.simulation.schedule(Time::at(14_s), Phase::observe,
                          [&] { heard.push_back(bed.heard.size()); });
  bed.run();
  EXPECT_THAT(heard, ElementsAre(1u, 3u, 3u, 4u));
}

TEST(RadioPropagation, TheEndOfTheRunMayComeBetweenTwoHearers) {
  Bed bed(spread(), {.radio = {.rate_bps = 8.0, .propagation_m_per_s = 1.0}, .end = Time::at(6_s)});
  bed.at(0_s, [&] { bed.send(0, "x"); });
  bed.at(0_s, [&] { bed.send(2, "y"); });
  const RunEnd end = bed.run();
  EXPECT_EQ(end.reason, EndReason::time_reached);
  std::vector<std::string> fates;
  for (const MessageRow& row : bed.simulation.record().messages()) {
    fates.push_back(std::to_string(row.sender) + "→" + std::to_string(row.receiver) + " " +
                    bed.fate_of(row) + " " +
                    std::to_string(row.arrived.nanoseconds() / 100'000'000));
  }
  // From 2 the way to 0 is 2.5 m, to 1 and 3 it is 5.59 m, to 4 10.74 m.
  EXPECT_THAT(fates,
              ElementsAre("0→2 delivered 35", "2→0 delivered 35", "0→1 delivered 60",
                          "0→3 delivered 60", "0→4 in_flight_at_end 60", "2→1 in_flight_at_end 60",
                          "2→3 in_flight_at_end 60", "2→4 in_flight_at_end 60"));
}

TEST(RadioPropagation, AnExceptionOnTheWayIsTheHearersAtItsInstant) {
  Bed bed(spread(), {.radio = {.rate_bps = 8.0, .propagation_m_per_s = 1.0}});
  bed.reaction = [](const Packet& packet) {
    if (packet.receiver == 1) throw std::runtime_error("ouch");
  };
  bed.at(0_s, [&] { bed.send(0, "x"); });
  const RunEnd end = bed.run();  // finish() balances nevertheless
  EXPECT_EQ(end.message, "agent 1 failed at 6.000000000 s: ouch");
  EXPECT_EQ(end.at, Time::at(6_s));
  EXPECT_EQ(bed.count(0, Fate::delivered), 2u);
  EXPECT_EQ(bed.count(0, Fate::in_flight_at_end), 2u);
}

TEST(RadioPropagation, ARadioThatGoesTakesBackWhatIsOnTheWay) {
  Bed bed(spread(), {.radio = {.rate_bps = 8.0, .propagation_m_per_s = 1.0}});
  bed.at(0_s, [&] { bed.send(0, "x"); });
  bed.at(5_s, [&] { bed.radio.reset(); });
  const RunEnd end = bed.simulation.run();
  EXPECT_TRUE(end.ok()) << end.message;
  EXPECT_EQ(bed.heard.size(), 1u);
  EXPECT_EQ(end.at, Time::at(5_s));
}

TEST(RadioPropagation, LossesAreTheSameAtEverySpeed) {
  const auto lost = [](double m_per_s, bool timed) {
    Bed bed(spread(), {.radio = {.loss = Loss::bernoulli(0.4), .propagation_m_per_s = m_per_s}});
    for (int n = 0; n < 200; ++n) {
      bed.at(100_ms * n, [&bed, timed, n] {
        const AgentId to = n % 7 == 0 ? 4 : n % 11 == 0 ? 3 : no_agent;
        std::optional<std::uint64_t> tick;
        if (timed) tick = static_cast<std::uint64_t>(n);
        bed.send(0, "x", to, tick);
      });
    }
    bed.run();
    std::vector<std::pair<Time, AgentId>> rows;
    for (const MessageRow& row : bed.simulation.record().messages()) {
      if (bed.fate_of(row) == "lost") rows.emplace_back(row.sent, row.receiver);
    }
    std::sort(rows.begin(), rows.end());
    return rows;
  };
  for (const bool timed : {true, false}) {
    const auto at_once = lost(std::numeric_limits<double>::infinity(), timed);
    EXPECT_GT(at_once.size(), 200u);
    EXPECT_EQ(lost(3e8, timed), at_once);
    EXPECT_EQ(lost(20.0, timed), at_once);
  }
}

TEST(RadioPropagation, AnAbsurdlySlowWayNeverEnds) {
  Bed bed(spread(), {.radio = {.rate_bps = 8.0, .latency = 5_s, .propagation_m_per_s = 1e-300},
                     .end = Time::never()});
  bed.at(1'000'000'000_s, [&] {
    bed.send(0, "x");
    bed.send(0, "x", 4);
  });
  bed.run();
  EXPECT_TRUE(bed.heard.empty());
  EXPECT_EQ(bed.count(0, Fate::in_flight_at_end), 5u);
}

TEST(RadioPropagation, ASpeedIsPositiveAndNeedsPositions) {
  const auto message = [](const Topology& topology, double m_per_s) -> std::string {
    Simulation simulation(Simulation::Options{});
    try {
      Radio radio(simulation, topology, {.propagation_m_per_s = m_per_s});
    } catch (const InputError& error) {
      return error.what();
    }
    return "nothing thrown";
  };
  EXPECT_EQ(message(spread(), 0.0), "radio: propagation_m_per_s must be greater than 0, not 0");
  EXPECT_THAT(message(spread(), std::numeric_limits<double>::quiet_NaN()), HasSubstr("nan"));
  EXPECT_EQ(message(Topology::line(2), 3e8),
            "radio: propagation_m_per_s needs a topology with positions");
  EXPECT_EQ(message(Topology::line(2), std::numeric_limits<double>::infinity()), "nothing thrown");
}

}  // namespace
}  // namespace hearsay
