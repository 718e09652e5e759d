// Latency that differs from packet to packet: laws, order, and that nothing comes twice.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "net/random_graphs.hpp"
#include "tests/net/bed.hpp"
#include "tests/net/graphs.hpp"

namespace hearsay {
namespace {

using Law = JitterOptions::Law;
constexpr Duration latency = 5_ms, spread = 20_ms;

// When each packet arrived at each hearer, by link and by when it was sent; with fate and bytes.
struct Arrival {
  Time at;
  std::string fate;
};
using Link = std::pair<AgentId, AgentId>;
using Arrivals = std::map<Link, std::map<Time, Arrival>>;

struct Talk {
  JitterOptions jitter;
  bool acknowledged = false;
  std::uint64_t seed = 1;
  int packets = 3000;
  double loss = 0.2;
};

constexpr int agents = 5;

Arrivals run(const Talk& talk) {
  Bed bed(Topology::full(agents), {.radio = {.rate_bps = 8e9,  // a byte a ns
                                             .queue = {.packets_max = 100'000},
                                             .latency = latency,
                                             .jitter = talk.jitter,
                                             .loss = Loss::bernoulli(talk.loss)},
                                   .seed = talk.seed});
  Stream draw(talk.seed, Purpose("talk"), Entity{0});
  for (int n = 0; n < talk.packets; ++n) {
    const Duration at = 100_us * n;
    const auto from = static_cast<AgentId>(draw.below(agents));
    const auto to = static_cast<AgentId>(draw.below(2 * agents));
    const bool timed = draw.bernoulli(0.5);
    bed.at(at, [&bed, &talk, from, to, n, timed] {
      std::optional<std::uint64_t> tick;
      if (timed) tick = n;
      if (to >= agents || to == from) {
        bed.send(from, "x", no_agent, tick);
      } else if (talk.acknowledged) {
        bed.send_safely(from, "x", to, tick);
      } else {
        bed.send(from, "x", to, tick);
      }
    });
  }
  bed.run();
  Arrivals arrivals;
  std::size_t delivered = 0;
  for (const MessageRow& row : bed.simulation.record().messages()) {
    const auto [place, fresh] = arrivals[{row.sender, row.receiver}].emplace(
        row.sent, Arrival{row.arrived, bed.fate_of(row)});
    EXPECT_TRUE(fresh) << "a packet has two fates at a hearer";
    delivered += bed.fate_of(row) == "delivered" ? 1 : 0;
  }
  EXPECT_EQ(bed.heard.size(), delivered) << "a packet was heard twice, or not at all";
  std::map<Link, std::vector<std::int64_t>> heard_ns;
  for (const Heard& h : bed.heard) heard_ns[{h.sender, h.receiver}].push_back(h.at_ns);
  for (auto& [link, times] : arrivals) {
    std::vector<std::int64_t> expected;
    for (const auto& [sent, arrival] : times) {
      if (arrival.fate == "delivered") expected.push_back(arrival.at.nanoseconds());
    }
    std::sort(expected.begin(), expected.end());
    EXPECT_EQ(heard_ns[link], expected);
  }
  return arrivals;
}

TEST(RadioOrder, JitterNeitherDuplicatesNorLosesNorChangesWhatIsLost) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Arrivals plain = run({.seed = seed});
    for (const Law law : {Law::uniform, Law::exponential}) {
      for (const bool reordering : {true, false}) {
        const Arrivals late =
            run({.jitter = {.law = law, .spread = spread, .reordering = reordering}, .seed = seed});
        ASSERT_EQ(late.size(), plain.size());
        for (const auto& [link, times] : plain) {
          ASSERT_EQ(late.at(link).size(), times.size());
          for (const auto& [sent, arrival] : times) {
            EXPECT_EQ(late.at(link).at(sent).fate, arrival.fate);
            EXPECT_GE(late.at(link).at(sent).at, arrival.at);
          }
        }
      }
    }
  }
}

TEST(RadioOrder, AcknowledgedPacketsAreHeardOnceHoweverOftenTheyAreRepeated) {
  for (const Law law : {Law::none, Law::uniform, Law::exponential}) {
    for (const bool reordering : {true, false}) {
      const Arrivals arrivals =
          run({.jitter = {.law = law, .spread = spread, .reordering = reordering},
               .acknowledged = true,
               .packets = 1500,
               .loss = 0.4});
      EXPECT_EQ(arrivals.size(), static_cast<std::size_t>(agents * (agents - 1)));
    }
  }
}

TEST(RadioOrder, InOrderAPacketWaitsForThoseBeforeIt) {
  // The same draws with reordering say when each would arrive; in order, it waits until 1 ns after
  // the one before it on its link.
  for (const Law law : {Law::uniform, Law::exponential}) {
    const Arrivals own = run({.jitter = {.law = law, .spread = spread}});
    const Arrivals in_order = run({.jitter = {.law = law, .spread = spread, .reordering = false}});
    int waited = 0, overtaken = 0;
    for (const auto& [link, times] : own) {
      Time last = Time(), last_own;
      for (const auto& [sent, arrival] : times) {
        const Time expected = std::max(arrival.at, last + 1_ns);
        waited += expected > arrival.at ? 1 : 0;
        overtaken += arrival.at < last_own ? 1 : 0;
        EXPECT_EQ(in_order.at(link).at(sent).at, expected);
        last = expected;
        last_own = arrival.at;
      }
    }
    EXPECT_GT(waited, 3000);
    EXPECT_GT(overtaken, 1000) << "reordering is not put to the test";
  }
}

TEST(RadioOrder, DelaysHaveTheirLawOnEveryLink) {
  for (const Law law : {Law::uniform, Law::exponential}) {
    const Arrivals arrivals = run({.jitter = {.law = law, .spread = spread}, .packets = 20'000});
    for (const auto& [link, times] : arrivals) {
      Average delay_s, below;
      for (const auto& [sent, arrival] : times) {
        const double s = (arrival.at - sent).seconds() - latency.seconds() - 1e-9;
        EXPECT_GE(s, -2e-9);
        delay_s.add(s);
        below.add(s < spread.seconds() / 2 ? 1.0 : 0.0);
      }
      const bool even = law == Law::uniform;
      EXPECT_NEAR(delay_s.mean(), spread.seconds() * (even ? 0.5 : 1.0), 4.0 * delay_s.error());
      EXPECT_NEAR(below.mean(), even ? 0.5 : 1.0 - std::exp(-0.5), 4.0 * below.error());
    }
  }
}

TEST(RadioOrder, ALaterPacketOvertakesAsOftenAsTwoExponentialsSay) {
  // Of two packets Δ apart with exponential jitter of mean m the later comes first with ½e^−Δ/m.
  constexpr int pairs = 6000;
  for (const Duration gap : {2_ms, 20_ms}) {
    Bed bed(Topology::line(2),
            {.radio = {.rate_bps = 8e9, .jitter = {.law = Law::exponential, .spread = spread}}});
    for (int n = 0; n < pairs; ++n) {
      bed.at(2_s * n, [&bed] { bed.send(0, "a"); });
      bed.at(2_s * n + gap, [&bed] { bed.send(0, "b"); });
    }
    bed.simulation.record();
    bed.run();
    int overtaken = 0;
    // The end of the run cuts off what is later than it.
    const std::size_t heard = bed.heard.size() / 2;
    for (std::size_t n = 0; n < heard; ++n) overtaken += bed.heard[2 * n].text == "b" ? 1 : 0;
    const double share = 0.5 * std::exp(-gap.seconds() / spread.seconds());
    EXPECT_NEAR(overtaken / static_cast<double>(heard), share,
                tolerance(share, static_cast<int>(heard)));
    EXPECT_GE(heard, 499u);
  }
}

}  // namespace
}  // namespace hearsay
