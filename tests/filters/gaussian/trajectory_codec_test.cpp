#include "filters/gaussian/trajectory_codec.hpp"

#include <gtest/gtest.h>

#include "filters/gaussian/codec.hpp"
#include "tests/filters/gaussian/samples.hpp"

namespace hearsay::gaussian {
namespace {

TrajectoryMessage message(Stream& random, int trajectories, int steps, int n, bool whole) {
  TrajectoryMessage m{3, 4, {}};
  for (int i = 0; i < trajectories; ++i) {
    TrajectoryEntry& entry = m.trajectories.emplace_back();
    entry.subject = static_cast<std::uint32_t>(i + 1);
    entry.first = 1'000'000'000 * Stamp{i};
    for (int k = 0; k < steps; ++k) {
      entry.steps.push_back({.stamp = entry.first + 500 * Stamp{k},
                             .information = random_belief(random, n),
                             .next = Matrix(0, 0)});
      if (whole && k + 1 < steps) entry.steps.back().next = random_matrix(random, n, n);
    }
  }
  return m;
}

void expect_same(const TrajectoryMessage& a, const TrajectoryMessage& b) {
  EXPECT_EQ(a.incarnation, b.incarnation);
  EXPECT_EQ(a.count, b.count);
  ASSERT_EQ(a.trajectories.size(), b.trajectories.size());
  for (std::size_t i = 0; i < a.trajectories.size(); ++i) {
    EXPECT_EQ(a.trajectories[i].subject, b.trajectories[i].subject);
    EXPECT_EQ(a.trajectories[i].first, b.trajectories[i].first);
    ASSERT_EQ(a.trajectories[i].steps.size(), b.trajectories[i].steps.size());
    for (std::size_t k = 0; k < a.trajectories[i].steps.size(); ++k) {
      const TrajectoryStep& x = a.trajectories[i].steps[k];
      const TrajectoryStep& y = b.trajectories[i].steps[k];
      EXPECT_EQ(x.stamp, y.stamp);
      EXPECT_EQ(x.information.omega, y.information.omega);
      EXPECT_EQ(x.information.xi, y.information.xi);
      ASSERT_EQ(x.next.size(), y.next.size());
      if (x.next.size() > 0) {
        EXPECT_EQ(x.next, y.next);
      }
    }
  }
}

TEST(TrajectoryCodec, EverySizeAndDimensionComesBack) {
  Stream random = stream("trajectory codec");
  std::vector<std::byte> bytes;
  TrajectoryMessage back;
  for (int n = 1; n <= dimension_max; ++n) {
    for (const bool whole : {false, true}) {
      for (const int steps : {0, 1, 2, 7}) {
        const TrajectoryMessage m = message(random, 3, steps, n, whole);
        encode(m, bytes);
        ASSERT_TRUE(decode(bytes, back));
        expect_same(m, back);
      }
    }
  }
}

// Merino 2007, p. 73: (6 + 21 + 36)·8 bytes a step and a stamp, about 10 kB for 20 s in 6-D.
TEST(TrajectoryCodec, TwentySecondsInSixDimensionsAreTenKilobytes) {
  Stream random = stream("trajectory codec");
  std::vector<std::byte> bytes;
  encode(message(random, 1, 20, 6, true), bytes);
  const std::size_t payload = 20 * (6 + 21 + 36) * 8 - 36 * 8;  // nothing follows the last step
  EXPECT_GT(bytes.size(), payload + 20 * 8);
  EXPECT_LT(bytes.size(), payload + 20 * 32 + 40);
  EXPECT_NEAR(static_cast<double>(bytes.size()), 10'000.0, 500.0);
}

TEST(TrajectoryCodec, EveryTruncationAndEveryTrailingByteIsRejected) {
  Stream random = stream("trajectory codec");
  std::vector<std::byte> bytes;
  TrajectoryMessage back;
  encode(message(random, 2, 3, 2, true), bytes);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(decode(std::span(bytes).first(size), back)) << size;
  }
  bytes.push_back(std::byte{0});
  EXPECT_FALSE(decode(bytes, back));
}

TEST(TrajectoryCodec, RandomBytesNeverCrash) {
  Stream random = stream("trajectory codec");
  std::vector<std::byte> bytes, changed;
  TrajectoryMessage back;
  encode(message(random, 2, 3, 4, true), bytes);
  for (int i = 0; i < 20'000; ++i) {
    changed = bytes;
    for (int k = 0; k < 3; ++k) {
      changed[random.below(changed.size())] = static_cast<std::byte>(random.below(256));
    }
    decode(changed, back);
  }
  // A length that promises more than can follow takes no storage.
  changed = bytes;
  for (std::size_t at = 12; at < 16; ++at) changed[at] = std::byte{0xff};
  EXPECT_FALSE(decode(changed, back));
}

TEST(StampedCodec, IsAMessageBehindAStamp) {
  Stream random = stream("trajectory codec");
  StampedMessage m{-5, {1, 2, {{7, random_belief(random, 3)}, {8, random_belief(random, 4)}}}};
  std::vector<std::byte> bytes, plain;
  encode(m, bytes);
  encode(m.message, plain);
  ASSERT_EQ(bytes.size(), plain.size() + 8);
  EXPECT_TRUE(std::equal(plain.begin() + 4, plain.end(), bytes.begin() + 12));
  StampedMessage back;
  ASSERT_TRUE(decode(bytes, back));
  EXPECT_EQ(back.stamp, -5);
  EXPECT_EQ(back.message.beliefs[1].belief.omega, m.message.beliefs[1].belief.omega);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(decode(std::span(bytes).first(size), back)) << size;
  }
}

}  // namespace
}  // namespace hearsay::gaussian
