// Acknowledged packets over links that lose both ways, against closed forms.
//
// With the probability q that an attempt arrives and b that its acknowledgement comes back, an
// attempt succeeds with s = qb, independently of all others. Of at most K attempts:
//   P(k attempts) = (1 − s)^(k−1) s for k < K, and the rest for K;
//   P(acknowledged) = 1 − (1 − s)^K,   P(delivered) = 1 − (1 − q)^K,
// and their difference is what arrived while its sender believes that it did not.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "tests/net/bed.hpp"

namespace hearsay {
namespace {

constexpr int packets = 6000;
constexpr std::size_t packet_bytes = 30;
constexpr std::uint32_t header_bytes = 5, answer_bytes = 8;

struct Case {
  double loss_there, loss_back;
  int attempts_max;
  std::uint32_t frames;
  bool half_duplex;
};

void expect_share(double count, double share, double trials) {
  EXPECT_NEAR(count, share * trials, 4.0 * std::sqrt(share * (1.0 - share) * trials) + 1e-9)
      << "of " << trials;
}

void expect_closed_forms(const Case& c) {
  const std::vector<LinkLoss> losses = {{0, 1, c.loss_there}, {1, 0, c.loss_back}};
  Bed bed(
      Topology::line(2),
      {.radio = {.rate_bps = 8e6,  // a byte a µs
                 .header_bytes = header_bytes,
                 .mtu_bytes = static_cast<std::uint32_t>(packet_bytes) / c.frames,
                 .queue = {.packets_max = packets},
                 .half_duplex = c.half_duplex,
                 .latency = 3_us,
                 .loss = Loss::bernoulli(0.0, losses),
                 .acknowledgement = {
                     .bytes = answer_bytes, .interframe = 2_us, .attempts_max = c.attempts_max}}});
  for (int n = 0; n < packets; ++n) bed.send_safely(0, std::string(packet_bytes, 'x'), 1);
  bed.run();

  // One packet after another, each attempt of the same length.
  const auto air_bytes = packet_bytes + c.frames * header_bytes;
  const Duration attempt = 1_us * static_cast<std::int64_t>(air_bytes) + 3_us + 2_us +
                           1_us * static_cast<std::int64_t>(answer_bytes) + 3_us;
  ASSERT_EQ(bed.outcomes.size(), static_cast<std::size_t>(packets));
  std::map<std::int64_t, double> of_so_many;
  double acknowledged = 0.0;
  std::int64_t before_ns = 0, attempts = 0;
  for (const Outcome& o : bed.outcomes) {
    ASSERT_EQ((o.at_ns - before_ns) % attempt.nanoseconds(), 0);
    const std::int64_t k = (o.at_ns - before_ns) / attempt.nanoseconds();
    ++of_so_many[k];
    attempts += k;
    before_ns = o.at_ns;
    acknowledged += o.acknowledged ? 1 : 0;
    EXPECT_TRUE(o.acknowledged || k == c.attempts_max);
  }
  const double q = std::pow(1.0 - c.loss_there, c.frames), s = q * (1.0 - c.loss_back);
  for (int k = 1; k <= c.attempts_max; ++k) {
    expect_share(of_so_many[k], std::pow(1.0 - s, k - 1) * (k < c.attempts_max ? s : 1.0), packets);
  }
  EXPECT_LE(of_so_many.rbegin()->first, c.attempts_max);

  const auto delivered = static_cast<double>(bed.count(0, Fate::delivered));
  expect_share(acknowledged, 1.0 - std::pow(1.0 - s, c.attempts_max), packets);
  expect_share(delivered, 1.0 - std::pow(1.0 - q, c.attempts_max), packets);
  expect_share(delivered - acknowledged,
               std::pow(1.0 - s, c.attempts_max) - std::pow(1.0 - q, c.attempts_max), packets);
  EXPECT_EQ(static_cast<double>(bed.count(0, Fate::lost)), packets - delivered);
  EXPECT_EQ(static_cast<double>(bed.heard.size()), delivered) << "each packet is heard once";

  // What is on the air: all attempts, and an acknowledgement of each that arrives (Wald).
  const SenderCounts &sender = bed.radio->counts(0), &answerer = bed.radio->counts(1);
  const auto frames = static_cast<std::uint64_t>(attempts) * c.frames;
  EXPECT_EQ(sender.frames, frames);
  EXPECT_EQ(sender.bytes_sent, static_cast<std::uint64_t>(attempts) * air_bytes);
  EXPECT_EQ(sender.air_time, 1_us * static_cast<std::int64_t>(sender.bytes_sent));
  expect_share(static_cast<double>(answerer.acknowledgements), q, static_cast<double>(attempts));
  EXPECT_EQ(answerer.bytes_sent, answerer.acknowledgements * answer_bytes);
  EXPECT_EQ(answerer.air_time, 1_us * static_cast<std::int64_t>(answerer.bytes_sent));
  EXPECT_EQ(answerer.packets, 0u);
}

TEST(RadioAcknowledgement, AttemptsAreGeometricAndTruncated) {
  for (const bool half_duplex : {false, true}) {
    for (const Case& c : {Case{0.3, 0.2, 7, 1, half_duplex}, Case{0.1, 0.6, 3, 1, half_duplex},
                          Case{0.5, 0.0, 1, 1, half_duplex}, Case{0.2, 0.3, 4, 3, half_duplex}}) {
      SCOPED_TRACE(testing::Message() << c.loss_there << ", " << c.loss_back << ", at most "
                                      << c.attempts_max << " of " << c.frames << " frames");
      expect_closed_forms(c);
    }
  }
}

TEST(RadioAcknowledgement, WithoutLossEachPacketNeedsOneAttempt) {
  expect_closed_forms({0.0, 0.0, 7, 2, true});
}

TEST(RadioAcknowledgement, WhenNothingComesBackAllIsDeliveredAndNothingBelieved) {
  expect_closed_forms({0.0, 1.0, 5, 1, false});
}

}  // namespace
}  // namespace hearsay
