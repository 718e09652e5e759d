// What the channel does to packets, in whole runs: bursts of Gilbert–Elliott, frames lost one by
// one, frame success over a distance.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "tests/net/bed.hpp"
#include "tests/net/graphs.hpp"

namespace hearsay {
namespace {

// Fates of n packets over one link, a tick each: true if lost.
std::vector<bool> losses(const RadioOptions& options, int n, std::size_t bytes,
                         const Topology& graph = Topology::line(2)) {
  Bed bed(graph, {.radio = options, .seed = 6});
  for (int k = 0; k < n; ++k) {
    bed.at(10_ms * k, [&bed, k, bytes] {
      bed.send(0, std::string(bytes, 'x'), no_agent, static_cast<std::uint64_t>(k));
    });
  }
  bed.run();
  std::vector<bool> lost;
  for (const MessageRow& row : bed.simulation.record().messages()) {
    EXPECT_TRUE(bed.fate_of(row) == "lost" || bed.fate_of(row) == "delivered");
    lost.push_back(bed.fate_of(row) == "lost");
  }
  EXPECT_EQ(lost.size(), static_cast<std::size_t>(n));
  return lost;
}

double share(const std::vector<bool>& lost) {
  return static_cast<double>(std::count(lost.begin(), lost.end(), true)) /
         static_cast<double>(lost.size());
}

TEST(RadioChannelTheory, BurstsHaveTheirRateAndMeanLength) {
  constexpr int n = 40'000;
  for (const double rate : {0.1, 0.4}) {
    for (const double burst : {2.0, 8.0}) {
      SCOPED_TRACE(testing::Message() << rate << ", bursts of " << burst);
      const GilbertElliott chain = chain_of({.loss_rate = rate, .mean_burst = burst});
      const auto lost = losses({.loss = Loss::gilbert_elliott(chain)}, n, 10);
      // States k steps apart correlate as (1 − p − r)^k, which multiplies the variance of the mean.
      const double memory = 1.0 - chain.good_to_bad - chain.bad_to_good;
      const double sigma = std::sqrt(rate * (1.0 - rate) / n * (1.0 + memory) / (1.0 - memory));
      EXPECT_NEAR(share(lost), rate, 4.0 * sigma);
      Average runs;
      int run = 0;
      for (const bool l : lost) {
        if (!l && run > 0) runs.add(run);
        run = l ? run + 1 : 0;
      }
      EXPECT_NEAR(runs.mean(), burst, 4.0 * runs.error());
      EXPECT_LT(runs.error(), 0.05 * burst) << "the test is too weak";
    }
  }
}

TEST(RadioChannelTheory, APacketIsLostWithAnyOfItsFrames) {
  constexpr int n = 10'000;
  constexpr double p = 0.08;
  const GilbertElliott chain{
      .good_to_bad = 0.2, .bad_to_good = 0.3, .loss_good = 0.02, .loss_bad = 0.4};
  for (const int frames : {1, 2, 5}) {
    SCOPED_TRACE(frames);
    const auto bytes = static_cast<std::size_t>(frames * 10);
    const double some = 1.0 - std::pow(1.0 - p, frames);
    EXPECT_NEAR(share(losses({.mtu_bytes = 10, .loss = Loss::bernoulli(p)}, n, bytes)), some,
                tolerance(some, n));
    // All frames of a packet meet one state.
    const double bad = chain.share_bad();
    const double any = bad * (1.0 - std::pow(1.0 - chain.loss_bad, frames)) +
                       (1.0 - bad) * (1.0 - std::pow(1.0 - chain.loss_good, frames));
    // Correlated through the state alone, with memory ½: at most thrice the variance.
    EXPECT_NEAR(share(losses({.mtu_bytes = 10, .loss = Loss::gilbert_elliott(chain)}, n, bytes)),
                any, std::sqrt(3.0) * tolerance(any, n));
  }
}

TEST(RadioChannelTheory, FramesOf50BytesSucceedAsTheTableSays) {
  constexpr int n = 4000;
  constexpr double table[] = {0.018, 0.235, 0.668, 0.922, 0.989};  // at 7 … 11 dB
  for (int k = 0; k < 5; ++k) {
    const double snr_db = 7.0 + k;
    SCOPED_TRACE(testing::Message() << snr_db << " dB");
    const LogDistance path;  // 0 dBm, 46.6777 dB at 1 m, exponent 3, −105 dBm of noise
    const double distance_m =
        std::pow(10.0, (path.noise_dbm * -1.0 - path.reference_loss_db - snr_db) / 30.0);
    const std::vector<std::array<double, 3>> places = {{0, 0, 0}, {distance_m, 0, 0}};
    const Propagation propagation = Propagation::log_distance(path);
    const auto graph = Topology::disk(places, propagation.reach_m());
    const auto lost = losses({.header_bytes = 8, .propagation = propagation}, n, 42, graph);
    EXPECT_NEAR(1.0 - share(lost), table[k], tolerance(table[k], n) + 5e-4);
    // Two frames of 50 bytes are two chances to fail.
    const auto two =
        losses({.header_bytes = 8, .mtu_bytes = 42, .propagation = propagation}, n, 84, graph);
    const double both = table[k] * table[k];
    EXPECT_NEAR(1.0 - share(two), both, tolerance(both, n) + 2e-3);
  }
}

TEST(RadioChannelTheory, AGreyZoneDeliversWhatItsLinearFallSays) {
  constexpr int n = 4000;
  for (const double distance_m : {50.0, 80.0, 110.0, 140.0, 149.0}) {
    const std::vector<std::array<double, 3>> places = {{0, 0, 0}, {0, distance_m, 0}};
    const Propagation propagation = Propagation::grey_zone({.inner_m = 50.0, .outer_m = 150.0});
    const auto graph = Topology::disk(places, propagation.reach_m());
    const double success = (150.0 - distance_m) / 100.0;
    EXPECT_NEAR(1.0 - share(losses({.propagation = propagation}, n, 10, graph)), success,
                tolerance(success, n));
  }
}

}  // namespace
}  // namespace hearsay
