// Time division against its closed forms, in whole runs.
//
// With n radios and slots of length s the cycle is C = n s. One that always has a frame sends in
// each of its slots. Poisson arrivals with rate λ wait, ρ = λC, as in an M/D/1 queue with service C
// and half a cycle more until the first slot: C/(2(1 − ρ)) until the first bit (D. Bertsekas,
// R. Gallager, Data Networks, 2nd ed. 1992, section 3.5.1).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "net/random_graphs.hpp"
#include "tests/net/bed.hpp"
#include "tests/net/graphs.hpp"

namespace hearsay {
namespace {

constexpr Duration slot = 1_ms;
const std::string frame(800, 'x');  // takes 800 µs

RadioOptions time_division(int slots = 0) {
  return {.rate_bps = 8e6,
          .queue = {.packets_max = 1'000'000},
          .half_duplex = true,
          .access = {.sharing = Sharing::tdma, .slot = slot, .slots = slots}};
}

TEST(RadioTdma, WhoeverAlwaysHasAFrameSendsOnceACycleAndNothingCollides) {
  constexpr int cycles = 60;
  for (const Topology& graph : {Topology::full(7), Topology::line(7), erdos_renyi(7, 0.5, 2)}) {
    Bed bed(graph, {.radio = time_division(), .end = Time::at(slot * 7 * cycles - 1_ns)});
    for (AgentId a = 0; a < 7; ++a) {
      for (int k = 0; k < cycles + 10; ++k) bed.send(a, frame);
    }
    bed.run();
    EXPECT_EQ(bed.rows(Fate::collided), 0u);
    EXPECT_EQ(bed.rows(Fate::half_duplex), 0u);
    EXPECT_EQ(bed.rows(Fate::delivered), cycles * graph.links());
    for (AgentId a = 0; a < 7; ++a) {
      EXPECT_EQ(bed.radio->counts(a).begun, static_cast<std::uint64_t>(cycles));
      EXPECT_EQ(bed.radio->counts(a).air_time, 800_us * cycles);
    }
    for (const Heard& h : bed.heard) {  // when its slot is 800 µs old
      ASSERT_EQ(h.at_ns % (7 * slot.nanoseconds()), (slot * h.sender + 800_us).nanoseconds());
    }
  }
}

TEST(RadioTdma, SlotsThatAreSharedCollideEachTime) {
  // Four radios in three slots: 0 and 3 share one, and 1 and 2 never hear either.
  Bed bed(Topology::full(4), {.radio = time_division(3), .end = Time::at(slot * 30 - 1_ns)});
  for (AgentId a = 0; a < 4; ++a) {
    for (int k = 0; k < 20; ++k) bed.send(a, frame);
  }
  bed.run();
  for (const AgentId a : {0, 3}) {
    EXPECT_EQ(bed.count(a, Fate::delivered), 0u);
    EXPECT_EQ(bed.count(a, Fate::collided), 2 * 10u);
    EXPECT_EQ(bed.count(a, Fate::half_duplex), 10u);
  }
  for (const AgentId a : {1, 2}) EXPECT_EQ(bed.count(a, Fate::delivered), 3 * 10u);
}

TEST(RadioTdma, APacketAloneWaitsForItsSlotAtMostACycle) {
  constexpr int n = 5, packets = 4000;
  const Duration cycle = slot * n;
  Bed bed(Topology::full(n), {.radio = time_division()});
  Stream draw(1, Purpose("arrivals"), Entity{0});
  std::vector<Duration> waits;
  for (int k = 0; k < packets; ++k) {
    // One at a time: the one before has left.
    const Duration at = cycle * (2 * k) + Duration::seconds(cycle.seconds() * draw.uniform());
    bed.at(at, [&bed, k] { bed.send(k % n, frame); });
  }
  bed.run();
  for (const MessageRow& row : bed.simulation.record().messages()) {
    if (row.receiver == (row.sender + 1) % n) waits.push_back(row.arrived - row.sent - 800_us);
  }
  ASSERT_EQ(waits.size(), static_cast<std::size_t>(packets));
  Average wait_s;
  for (const Duration wait : waits) wait_s.add(wait.seconds());
  // Uniform in [0, C): mean C/2, variance C²/12; the extremes of so many come near its ends.
  EXPECT_NEAR(wait_s.mean(), cycle.seconds() / 2,
              4.0 * cycle.seconds() / std::sqrt(12.0 * packets));
  const auto [least, most] = std::minmax_element(waits.begin(), waits.end());
  EXPECT_GE(*least, Duration());
  EXPECT_LT(*most, cycle);
  EXPECT_LT(*least, cycle / 200);
  EXPECT_GT(*most, cycle - cycle / 200);
}

TEST(RadioTdma, PoissonArrivalsWaitAsInAQueueWithHalfACycleMore) {
  constexpr int n = 4, batches = 40, cycles_a_batch = 1000;
  const Duration cycle = slot * n;
  for (const double load : {0.3, 0.7}) {
    Bed bed(Topology::line(n), {.radio = time_division(),
                                .end = Time::at(cycle * (batches * cycles_a_batch)),
                                .keep_messages = false});
    Stream draw(2, Purpose("arrivals"), Entity{0});
    Duration at;
    while (at < cycle * (batches * cycles_a_batch)) {
      at = at + Duration::seconds(draw.exponential(load / cycle.seconds()));
      bed.simulation.schedule(Time::at(at), Phase::act, [&] { bed.send(2, "x"); });
    }
    Average wait_s;
    SenderCounts before;
    for (int b = 1; b <= batches; ++b) {
      bed.simulation.schedule(Time::at(cycle * (b * cycles_a_batch)), Phase::observe, [&] {
        const SenderCounts& now = bed.radio->counts(2);
        wait_s.add((now.queue_delay - before.queue_delay).seconds() /
                   static_cast<double>(now.begun - before.begun));
        before = now;
      });
    }
    bed.run();
    const double expected_s = cycle.seconds() / (2.0 * (1.0 - load));
    EXPECT_NEAR(wait_s.mean(), expected_s, 4.0 * wait_s.error());
    EXPECT_LT(wait_s.error(), 0.05 * expected_s) << "the test is too weak";
  }
}

}  // namespace
}  // namespace hearsay
