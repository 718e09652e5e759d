// Slotted ALOHA against its closed forms, in whole runs of radios that always have a frame.
//
// Frames fill their slots, so each radio sends in each slot with probability p, independently of
// all others and of all other slots: what happens in a slot has binomial laws over the slots. A
// frame is heard by a neighbour that does not send (half-duplex) if no other neighbour of it sends
// (N. Abramson, The throughput of packet broadcasting channels, IEEE Trans. Comm. 25(1), 1977). All
// intervals are 4 standard deviations of these laws.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "net/random_graphs.hpp"
#include "tests/net/bed.hpp"

namespace hearsay {
namespace {

constexpr Duration slot = 100_us;
constexpr double rate_bps = 8e6;  // a byte a µs
const std::string frame(100, 'x');

RadioOptions aloha(double p, bool half_duplex) {
  return {.rate_bps = rate_bps,
          .queue = {.packets_max = 1'000'000},
          .half_duplex = half_duplex,
          .access = {.sharing = Sharing::slotted_aloha, .slot = slot, .send_probability = p},
          .count_links = true};
}

// Everybody gets so many frames that some wait to the end.
struct Saturated {
  Saturated(const Topology& topology, double p, bool half_duplex, int slots)
      : bed(topology, {.radio = aloha(p, half_duplex),
                       .end = Time::at(slot * slots - 1_ns),
                       .keep_messages = false}) {
    const int frames = static_cast<int>(p * slots + 6.0 * std::sqrt(p * slots)) + 1;
    for (AgentId a = 0; a < topology.agents(); ++a) {
      for (int f = 0; f < frames; ++f) bed.send(a, frame);
    }
    bed.run();
    for (AgentId a = 0; a < topology.agents(); ++a) {
      EXPECT_LT(bed.radio->counts(a).begun, static_cast<std::uint64_t>(frames)) << "ran dry";
    }
  }
  double sum(Fate fate) const {
    std::uint64_t packets = 0;
    for (AgentId a = 0; a < bed.radio->topology().agents(); ++a) packets += bed.count(a, fate);
    return static_cast<double>(packets);
  }
  Bed bed;
};

void expect_share(double count, double share, int trials) {
  EXPECT_NEAR(count, share * trials, 4.0 * std::sqrt(share * (1.0 - share) * trials))
      << "of " << trials;
}

double throughput(int n, double p) { return n * p * std::pow(1.0 - p, n - 1); }

TEST(RadioAloha, ThroughputOfAFewStationsIsTheFiniteLaw) {
  constexpr int slots = 4000;
  for (const int n : {2, 3, 5, 10}) {
    for (const double load : {0.3, 1.0, 1.8}) {
      SCOPED_TRACE(testing::Message() << n << " stations, load " << load);
      const double p = load / n;
      const Saturated run(Topology::full(n), p, true, slots);
      // A frame that nobody disturbs is heard by all n − 1 others, one that meets another by none.
      expect_share(run.sum(Fate::delivered) / (n - 1), throughput(n, p), slots);
      double sent = 0.0;
      for (AgentId a = 0; a < n; ++a) sent += static_cast<double>(run.bed.radio->counts(a).begun);
      EXPECT_NEAR(sent, load * slots, 4.0 * std::sqrt(load * (1.0 - p) * slots));
    }
  }
}

TEST(RadioAloha, ThroughputOfManyStationsIsGTimesEToMinusG) {
  constexpr int slots = 6000, n = 60;
  for (const double load : {0.5, 1.0, 2.0}) {
    const Saturated run(Topology::full(n), load / n, true, slots);
    const double got = run.sum(Fate::delivered) / (n - 1);
    expect_share(got, throughput(n, load / n), slots);
    // n p (1 − p)^(n − 1) = G e^−G (1 + (G − G²/2)/n + …): within 4 % at 60 stations.
    EXPECT_NEAR(got / slots, load * std::exp(-load), 0.04);
    EXPECT_NEAR(throughput(n, load / n), load * std::exp(-load), 0.01);
  }
}

// Numbers of slots in which a link's frame was delivered, met the receiver's own, or another.
std::vector<std::array<double, 3>> fates_of_links(const Saturated& run) {
  std::vector<std::array<double, 3>> rows;
  run.bed.radio->visit_links([&](AgentId, AgentId, const FateCounts& fates) {
    const auto count = [&](Fate f) {
      return static_cast<double>(fates[static_cast<std::size_t>(f)]);
    };
    rows.push_back({count(Fate::delivered), count(Fate::half_duplex), count(Fate::collided)});
  });
  return rows;
}

TEST(RadioAloha, EachHearerMissesWhatItsOwnNeighboursDisturb) {
  constexpr int slots = 5000, agents = 12;
  constexpr double p = 0.25, q = 1.0 - p;
  const Topology graph = erdos_renyi(agents, 0.35, 3);
  for (const bool half_duplex : {true, false}) {
    const Saturated run(graph, p, half_duplex, slots);
    const auto rows = fates_of_links(run);
    ASSERT_EQ(rows.size(), graph.links());
    std::size_t link = 0, hidden = 0;
    for (AgentId from = 0; from < agents; ++from) {
      for (const AgentId to : graph.neighbours(from)) {
        SCOPED_TRACE(testing::Message() << from << " → " << to);
        int others = 0;
        for (const AgentId other : graph.neighbours(to)) {
          if (other == from) continue;
          ++others;
          if (graph.link(other, from) < 0) ++hidden;  // from could not know of it
        }
        const double alone = std::pow(q, others);
        const double deaf = half_duplex ? p : 0.0;
        expect_share(rows[link][0], p * (1.0 - deaf) * alone, slots);
        expect_share(rows[link][1], p * deaf, slots);
        expect_share(rows[link][2], p * (1.0 - deaf) * (1.0 - alone), slots);
        ++link;
      }
    }
    EXPECT_GT(hidden, 20u);
  }
}

TEST(RadioAloha, PoissonArrivalsFillSlotsWithTheirRate) {
  // Each station sends what came in the slots before, one a slot: a slot of it is taken with the
  // probability λ (what comes in goes out), whatever its queue. Stations are independent.
  constexpr int slots = 10'000, n = 8;
  constexpr double per_slot = 0.12;
  Bed bed(
      Topology::full(n),
      {.radio = aloha(1.0, true), .end = Time::at(slot * slots - 1_ns), .keep_messages = false});
  for (AgentId a = 0; a < n; ++a) {
    Stream draw(5, Purpose("arrivals"), Entity::agent(a));
    Duration at;
    while (true) {
      at = at + Duration::seconds(draw.exponential(per_slot / slot.seconds()));
      if (at >= slot * slots) break;
      bed.at(at, [&bed, a] { bed.send(a, frame); });
    }
  }
  bed.run();
  double delivered = 0.0;
  for (AgentId a = 0; a < n; ++a) {
    delivered += static_cast<double>(bed.count(a, Fate::delivered)) / (n - 1);
  }
  // A station's slots depend on each other through its queue: the count of taken ones has the
  // Poisson variance λ of the arrivals in place of λ(1 − λ), which the 4 σ leave room for.
  expect_share(delivered, throughput(n, per_slot), slots);
}

}  // namespace
}  // namespace hearsay
