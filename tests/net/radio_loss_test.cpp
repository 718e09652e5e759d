#include <gtest/gtest.h>

#include <cmath>

#include "tests/net/bed.hpp"

namespace hearsay {
namespace {

constexpr double p = 0.3;

// One sender's packets, 10 ms apart, and which of them arrive.
struct Talk {
  std::uint64_t seed = 1;
  int packets = 400;
  int bytes = 10;
  AgentId sender = 0;
  AgentId to = no_agent;
  bool timed = true;
  std::uint64_t first_tick = 0;
  double loss_probability = p;
};

// Fates at `hearer`, in order of sending: '.' delivered, 'x' lost, 'q' dropped by the sender.
std::string pattern(const Bed& bed, AgentId sender, AgentId hearer) {
  std::map<Time, char> marks;
  for (const MessageRow& row : bed.simulation.record().messages()) {
    if (row.sender != sender || row.receiver != hearer) continue;
    const std::string& fate = bed.fate_of(row);
    marks[row.sent] = fate == "delivered" ? '.' : fate == "lost" ? 'x' : 'q';
  }
  std::string text;
  for (const auto& [time, mark] : marks) text += mark;
  return text;
}

std::string pattern(const Talk& talk, AgentId hearer) {
  Bed bed(Topology::full(3),
          {.radio = {.loss = Loss::bernoulli(talk.loss_probability)}, .seed = talk.seed});
  for (int n = 0; n < talk.packets; ++n) {
    bed.at(10_ms * n, [&bed, &talk, n] {
      std::optional<std::uint64_t> tick;
      if (talk.timed) tick = talk.first_tick + static_cast<std::uint64_t>(n);
      bed.send(talk.sender, std::string(static_cast<std::size_t>(talk.bytes), 'x'), talk.to, tick);
    });
  }
  bed.run();
  const std::string marks = pattern(bed, talk.sender, hearer);
  EXPECT_EQ(marks.size(), static_cast<std::size_t>(talk.packets));
  return marks;
}

TEST(RadioLoss, IsTheNamedDrawOfItsLinkAndTick) {
  for (const bool timed : {true, false}) {
    std::string expected;
    for (std::uint64_t n = 0; n < 400; ++n) {
      const Purpose purpose(timed ? "loss of a tick" : "loss of a packet");
      expected += Stream::at(9, purpose, Entity::link(2, 1), n).bernoulli(p) ? 'x' : '.';
    }
    EXPECT_EQ(pattern({.seed = 9, .sender = 2, .timed = timed}, 1), expected);
  }
}

TEST(RadioLoss, HasItsProbabilityOnEveryLink) {
  constexpr int packets = 5000;
  const double sigma = std::sqrt(packets * p * (1 - p));
  for (const bool timed : {true, false}) {
    for (const AgentId hearer : {1, 2}) {
      const std::string marks = pattern({.packets = packets, .timed = timed}, hearer);
      const auto lost = static_cast<double>(std::count(marks.begin(), marks.end(), 'x'));
      EXPECT_NEAR(lost, packets * p, 4.0 * sigma);
    }
  }
}

TEST(RadioLoss, ProbabilityZeroLosesNothingAndOneEverything) {
  EXPECT_EQ(pattern({.packets = 100, .loss_probability = 0.0}, 1), std::string(100, '.'));
  EXPECT_EQ(pattern({.packets = 100, .loss_probability = 1.0}, 1), std::string(100, 'x'));
}

TEST(RadioLoss, DoesNotDependOnTheSizeOfMessages) {
  EXPECT_EQ(pattern({.bytes = 0}, 1), pattern({.bytes = 900}, 1));
  EXPECT_EQ(pattern({.bytes = 0, .timed = false}, 1), pattern({.bytes = 900, .timed = false}, 1));
}

TEST(RadioLoss, IsTheSameForABroadcastAndAnAddressedPacket) {
  EXPECT_EQ(pattern({}, 2), pattern({.to = 2}, 2));
  EXPECT_EQ(pattern({.timed = false}, 2), pattern({.to = 2, .timed = false}, 2));
}

TEST(RadioLoss, FollowsTheTickAndNotTheCount) {
  const std::string all = pattern({.packets = 400}, 1);
  EXPECT_EQ(pattern({.packets = 300, .first_tick = 100}, 1), all.substr(100));
}

TEST(RadioLoss, DiffersBetweenSeedsLinksAndDirections) {
  const std::string base = pattern({}, 1);
  EXPECT_NE(base, pattern({.seed = 2}, 1));
  EXPECT_NE(base, pattern({}, 2));
  EXPECT_NE(base, pattern({.sender = 1}, 0));
  EXPECT_NE(base, pattern({.sender = 2}, 1));
}

TEST(RadioLoss, TheNthPacketDoesNotShareTheDrawOfTickN) {
  EXPECT_NE(pattern({.timed = true}, 1), pattern({.timed = false}, 1));
}

TEST(RadioLoss, PacketsOfOneTickShareTheirFateOnALink) {
  Bed bed(Topology::full(3), {.radio = {.rate_bps = 8e6, .loss = Loss::bernoulli(p)}});
  for (int n = 0; n < 200; ++n) {
    for (int part = 0; part < 3; ++part) {
      bed.at(10_ms * n + 1_ms * part,
             [&bed, n] { bed.send(0, "part", no_agent, static_cast<std::uint64_t>(n)); });
    }
  }
  bed.run();
  const std::string marks = pattern(bed, 0, 1);
  ASSERT_EQ(marks.size(), 600u);
  for (std::size_t n = 0; n < 600; n += 3) {
    EXPECT_EQ(marks[n], marks[n + 1]);
    EXPECT_EQ(marks[n], marks[n + 2]);
  }
}

TEST(RadioLoss, TimedPacketsDoNotShiftTheOthers) {
  const std::string alone = pattern({.timed = false}, 1);
  Bed bed(Topology::full(3), {.radio = {.rate_bps = 8e6, .loss = Loss::bernoulli(p)}});
  for (int n = 0; n < 400; ++n) {
    bed.at(10_ms * n, [&bed] { bed.send(0, "x"); });
    bed.at(10_ms * n + 5_ms, [&bed, n] { bed.send(0, "timed", 1, static_cast<std::uint64_t>(n)); });
  }
  bed.run();
  const std::string both = pattern(bed, 0, 1);
  ASSERT_EQ(both.size(), 800u);
  std::string untimed;
  for (std::size_t n = 0; n < 800; n += 2) untimed += both[n];
  EXPECT_EQ(untimed, alone);
}

TEST(RadioLoss, PacketsToOthersDoNotShiftALink) {
  const std::string alone = pattern({.timed = false}, 1);
  Bed bed(Topology::full(3), {.radio = {.rate_bps = 8e6, .loss = Loss::bernoulli(p)}});
  for (int n = 0; n < 400; ++n) {
    bed.at(10_ms * n, [&bed] { bed.send(0, "to the other", 2); });
    bed.at(10_ms * n + 5_ms, [&bed, n] { bed.send(0, "x", n % 2 ? no_agent : 1); });
  }
  bed.run();
  EXPECT_EQ(pattern(bed, 0, 1), alone);
}

TEST(RadioLoss, ADroppedPacketUsesUpItsDraw) {
  const std::string alone = pattern({.timed = false}, 1);
  // Two packets every 20 ms into a queue of one that takes 15 ms: every second one is dropped.
  Bed bed(Topology::full(3),
          {.radio = {.rate_bps = 8000.0, .queue = {.packets_max = 1}, .loss = Loss::bernoulli(p)}});
  for (int n = 0; n < 400; ++n) {
    bed.at(10_ms * n, [&bed] { bed.send(0, "fifteen bytes ."); });
  }
  bed.run();
  const std::string marks = pattern(bed, 0, 1);
  ASSERT_EQ(marks.size(), 400u);
  for (std::size_t n = 0; n < 400; ++n) EXPECT_EQ(marks[n], n % 2 ? 'q' : alone[n]) << n;
}

}  // namespace
}  // namespace hearsay
