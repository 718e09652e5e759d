// Who sends is deaf: how often, in closed form and by brute force.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "tests/net/bed.hpp"

namespace hearsay {
namespace {

constexpr double rate_bps = 8e6;  // a byte a µs

// Frames of `sender` at Poisson times.
void talk(Bed& bed, AgentId sender, Duration frame, double load, Duration end) {
  Stream draw(4, Purpose("arrivals"), Entity::agent(sender));
  const std::string text(static_cast<std::size_t>(frame / (1_us)), 'x');
  Duration at;
  while (at < end) {
    at = at + Duration::seconds(draw.exponential(load / frame.seconds()));
    bed.at(at, [&bed, text, sender] { bed.send(sender, text); });
  }
}

TEST(RadioHalfDuplex, APoissonSenderIsDeafAsOftenAsItsQueueSays) {
  // The hearer is an M/D/1 queue of load ρ and rate λ, independent of what it hears. It is silent
  // at a given instant with probability 1 − ρ, and begins nothing for a time T with e^−λT.
  constexpr Duration end = 20_s, own = 1_ms;
  for (const double load : {0.2, 0.6}) {
    for (const Duration frame : {200_us, 1_ms, 2_ms}) {
      for (const bool half_duplex : {true, false}) {
        SCOPED_TRACE(testing::Message() << load << ", " << frame.seconds() << " s");
        Bed bed(Topology::line(2), {.radio = {.rate_bps = rate_bps,
                                              .queue = {.packets_max = 1'000'000},
                                              .half_duplex = half_duplex},
                                    .keep_messages = false});
        talk(bed, 0, frame, 0.1, end);
        talk(bed, 1, own, load, end);
        bed.run();
        const auto sent = static_cast<double>(bed.radio->counts(0).begun);
        const auto heard = static_cast<double>(bed.count(0, Fate::delivered));
        EXPECT_EQ(heard + static_cast<double>(bed.count(0, Fate::half_duplex)), sent);
        if (!half_duplex) {
          EXPECT_EQ(heard, sent);
          continue;
        }
        const double share = (1.0 - load) * std::exp(-load / own.seconds() * frame.seconds());
        // Frames that meet one busy time of the hearer share their fate: at 10 % load of the sender
        // and 60 % of the hearer that doubles the variance at most.
        EXPECT_NEAR(heard / sent, share, 6.0 * std::sqrt(share * (1.0 - share) / sent));
      }
    }
  }
}

TEST(RadioHalfDuplex, AFrameIsMissedByWhoSendsAtAnyTimeOfIt) {
  // Random frames of four radios, of whole µs, many of which touch: frame by frame.
  struct Sent {
    AgentId sender;
    Time begin, end;
  };
  int deaf = 0, touching = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    Bed bed(Topology::full(4),
            {.radio = {.rate_bps = rate_bps, .half_duplex = true}, .seed = seed});
    Stream draw(seed, Purpose("frames"), Entity{0});
    for (int k = 0; k < 60; ++k) {
      const Duration at = 1_us * static_cast<std::int64_t>(draw.below(400));
      const auto sender = static_cast<AgentId>(draw.below(4));
      const std::string text(1 + draw.below(9), 'x');
      bed.at(at, [&bed, sender, text] { bed.send(sender, text); });
    }
    bed.run();
    std::map<std::pair<AgentId, Time>, Sent> frames;  // by their end
    for (const MessageRow& row : bed.simulation.record().messages()) {
      const Time begin = row.arrived - 1_us * static_cast<std::int64_t>(row.bytes);
      ASSERT_GE(begin, row.sent);
      frames[{row.sender, row.arrived}] = {row.sender, begin, row.arrived};
    }
    for (const MessageRow& row : bed.simulation.record().messages()) {
      const Sent& mine = frames.at({row.sender, row.arrived});
      bool meets = false;
      for (const auto& [key, other] : frames) {
        if (other.sender != row.receiver) continue;
        meets = meets || (other.begin < mine.end && mine.begin < other.end);
        touching += other.begin == mine.end || mine.begin == other.end ? 1 : 0;
      }
      EXPECT_EQ(bed.fate_of(row), meets ? "half_duplex" : "delivered");
      deaf += meets ? 1 : 0;
    }
  }
  EXPECT_GT(deaf, 500);
  EXPECT_GT(touching, 300);
}

}  // namespace
}  // namespace hearsay
