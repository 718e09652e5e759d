// Closed forms are those of a chain of two states with λ = 1 − p − r: stationary share p/(p + r),
// geometric bursts, autocorrelation λ^lag. Bounds are 4 standard errors; seeds are fixed.
#include "net/loss.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

constexpr double sigmas = 4.0;

PacketOnLink packet(std::uint64_t index, AgentId from = 2, AgentId to = 1) {
  return {.seed = 9, .from = from, .to = to, .index = index};
}

std::vector<int> series(const Loss& loss, std::uint64_t length, const PacketOnLink& of = packet(0),
                        std::uint32_t frames = 1) {
  std::vector<int> lost(length);
  PacketOnLink asked = of;
  for (std::uint64_t i = 0; i < length; ++i) {
    asked.index = i;
    lost[i] = loss.lost(asked, frames) ? 1 : 0;
  }
  return lost;
}

double mean(const std::vector<int>& values) {
  double sum = 0.0;
  for (const int value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

template <class Call>
std::string error_of(Call call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

// Chains of every character: bursty, nearly independent, alternating, rarely bad, never bad.
const std::vector<GilbertElliott> chains = {
    {.good_to_bad = 0.02, .bad_to_good = 0.1},
    {.good_to_bad = 0.3, .bad_to_good = 0.7},
    {.good_to_bad = 0.9, .bad_to_good = 0.8},
    {.good_to_bad = 0.001, .bad_to_good = 0.5},
    {.good_to_bad = 0.0, .bad_to_good = 0.25},
    {.good_to_bad = 1.0, .bad_to_good = 0.25},
    {.good_to_bad = 0.1, .bad_to_good = 1.0},
    {.good_to_bad = 0.05, .bad_to_good = 0.2, .loss_good = 0.1, .loss_bad = 0.6},
};

TEST(Loss, NothingIsLostWithoutAModel) {
  EXPECT_TRUE(Loss().never());
  EXPECT_TRUE(Loss::bernoulli(0.0).never());
  EXPECT_FALSE(Loss::bernoulli(0.1).never());
  EXPECT_EQ(mean(series(Loss(), 100, packet(0), 5)), 0.0);
}

TEST(BernoulliLoss, OfOneFrameIsTheNamedDrawOfItsLinkAndIndex) {
  const Loss loss = Loss::bernoulli(0.3);
  for (const Numbering numbering : {Numbering::tick, Numbering::packet}) {
    const Purpose purpose(numbering == Numbering::tick ? "loss of a tick" : "loss of a packet");
    for (std::uint64_t i = 0; i < 500; ++i) {
      PacketOnLink asked = packet(i);
      asked.numbering = numbering;
      EXPECT_EQ(loss.lost(asked), Stream::uniform_at(9, purpose, Entity::link(2, 1), i) < 0.3);
    }
  }
}

TEST(BernoulliLoss, OfAPacketIsThatOfAnyOfItsFrames) {
  constexpr int n = 20'000;
  constexpr double p = 0.15;
  const Loss loss = Loss::bernoulli(p);
  for (const std::uint32_t frames : {0u, 1u, 2u, 3u, 7u}) {
    const double expected = 1.0 - std::pow(1.0 - p, frames);
    EXPECT_NEAR(mean(series(loss, n, packet(0), frames)), expected,
                sigmas * std::sqrt(expected * (1.0 - expected) / n))
        << frames << " frames";
  }
}

TEST(BernoulliLoss, FrameFMeetsTheFthUniformOfThePacket) {
  const Loss loss = Loss::bernoulli(0.1);
  for (std::uint64_t i = 0; i < 300; ++i) {
    Stream draws = Stream::at(9, Purpose("loss of a tick"), Entity::link(2, 1), i);
    bool any = false;
    for (std::uint32_t frames = 1; frames <= 9; ++frames) {
      any |= draws.uniform() < 0.1;
      EXPECT_EQ(loss.lost(packet(i), frames), any);
    }
  }
}

TEST(BernoulliLoss, ProbabilityOneLosesEverything) {
  EXPECT_EQ(mean(series(Loss::bernoulli(1.0), 100)), 1.0);
}

TEST(BernoulliLoss, ALinkOfTheTableHasItsOwnProbabilityInItsDirection) {
  const Loss loss = Loss::bernoulli(0.2, {{3, 1, 1.0}, {0, 1, 0.7}, {0, 2, 0.0}, {2, 0, 0.5}});
  const auto same_as = [](double p, AgentId from, AgentId to) {
    return series(Loss::bernoulli(p), 400, packet(0, from, to));
  };
  for (AgentId from = 0; from < 5; ++from) {
    for (AgentId to = 0; to < 5; ++to) {
      double p = 0.2;
      if (from == 3 && to == 1) p = 1.0;
      if (from == 0 && to == 1) p = 0.7;
      if (from == 0 && to == 2) p = 0.0;
      if (from == 2 && to == 0) p = 0.5;
      EXPECT_EQ(series(loss, 400, packet(0, from, to)), same_as(p, from, to)) << from << "→" << to;
    }
  }
  EXPECT_FALSE(Loss::bernoulli(0.0, {{0, 1, 0.5}}).never());
}

TEST(GilbertElliottLoss, IsTheChainWalkedForwardStateByState) {
  for (const GilbertElliott& chain : chains) {
    for (const Numbering numbering : {Numbering::tick, Numbering::packet}) {
      const bool tick = numbering == Numbering::tick;
      const Purpose steps(tick ? "state of the channel at a tick"
                               : "state of the channel at a packet");
      const Purpose frames(tick ? "loss of a tick" : "loss of a packet");
      const Entity link = Entity::link(2, 1);
      const Loss loss = Loss::gilbert_elliott(chain);
      bool bad = false;
      for (std::uint64_t i = 0; i < 3000; ++i) {
        const double u = Stream::uniform_at(9, steps, link, i);
        const double p = chain.good_to_bad;
        const double r = chain.bad_to_good;
        bad = u < (i == 0 ? p / (p + r) : bad ? 1.0 - r : p);
        PacketOnLink asked = packet(i);
        asked.numbering = numbering;
        ASSERT_EQ(loss.bad(asked), bad) << "index " << i << ", p " << p << ", r " << r;
        const double v = Stream::uniform_at(9, frames, link, i);
        ASSERT_EQ(loss.lost(asked), v < (bad ? chain.loss_bad : chain.loss_good)) << i;
      }
    }
  }
}

TEST(GilbertElliottLoss, HasItsStationaryRate) {
  constexpr int n = 40'000;
  for (const GilbertElliott& chain : chains) {
    // Of a sum: the variance of one term, and twice the covariances of its lags.
    const double b = chain.share_bad();
    const double lambda = 1.0 - chain.good_to_bad - chain.bad_to_good;
    const double gap = chain.loss_bad - chain.loss_good;
    const double rate = chain.loss_rate();
    const double variance =
        rate * (1.0 - rate) + gap * gap * b * (1.0 - b) * 2.0 * lambda / (1.0 - lambda);
    EXPECT_NEAR(mean(series(Loss::gilbert_elliott(chain), n)), rate,
                sigmas * std::sqrt(variance / n) + 1e-12)
        << "p " << chain.good_to_bad << ", r " << chain.bad_to_good;
  }
}

TEST(GilbertElliottLoss, IsStationaryFromTheFirstIndexOn) {
  constexpr int links = 5000;
  const GilbertElliott chain{.good_to_bad = 0.1, .bad_to_good = 0.3};
  const Loss loss = Loss::gilbert_elliott(chain);
  for (const std::uint64_t index : {0u, 1u, 2u, 50u}) {
    int bad = 0;
    for (AgentId to = 0; to < links; ++to) bad += loss.bad(packet(index, -5, to)) ? 1 : 0;
    EXPECT_NEAR(bad, links * 0.25, sigmas * std::sqrt(links * 0.25 * 0.75)) << "index " << index;
  }
}

TEST(GilbertElliottLoss, HasGeometricBurstsAndGaps) {
  constexpr std::uint64_t n = 100'000;
  for (const auto& [p, r] : {std::pair{0.02, 0.1}, {0.3, 0.7}, {0.8, 0.6}}) {
    const auto lost = series(Loss::gilbert_elliott({.good_to_bad = p, .bad_to_good = r}), n);
    for (const int state : {1, 0}) {
      const double leaves = state == 1 ? r : p;
      std::vector<int> lengths;  // of runs of `state` that began and ended
      int length = -1;
      for (std::size_t i = 1; i < n; ++i) {
        if (lost[i] == state && lost[i - 1] != state) length = 0;
        if (length >= 0 && lost[i] == state) ++length;
        if (length > 0 && lost[i] != state) lengths.push_back(std::exchange(length, -1));
      }
      const auto runs = static_cast<double>(lengths.size());
      EXPECT_NEAR(mean(lengths), 1.0 / leaves,
                  sigmas * std::sqrt(1.0 - leaves) / leaves / std::sqrt(runs));
      for (int k = 1; k <= 12; ++k) {
        const double expected = std::pow(1.0 - leaves, k);
        double longer = 0.0;
        for (const int l : lengths) longer += l > k ? 1.0 : 0.0;
        EXPECT_NEAR(longer / runs, expected,
                    sigmas * std::sqrt(expected * (1.0 - expected) / runs) + 1.0 / runs)
            << "P(run > " << k << "), p " << p << ", r " << r;
      }
    }
  }
}

TEST(GilbertElliottLoss, GivesRateAndBurstThatWereAskedFor) {
  for (const double rate : {0.0, 0.05, 0.3, 0.6}) {
    for (const double burst : {2.0, 5.0, 40.0}) {
      const GilbertElliott chain = chain_of({.loss_rate = rate, .mean_burst = burst});
      EXPECT_NEAR(chain.loss_rate(), rate, 1e-15);
      EXPECT_NEAR(1.0 / chain.bad_to_good, burst, 1e-12);
    }
  }
  const GilbertElliott mixed =
      chain_of({.loss_rate = 0.3, .mean_burst = 4.0, .loss_good = 0.1, .loss_bad = 0.5});
  EXPECT_NEAR(mixed.share_bad(), 0.5, 1e-15);
  EXPECT_NEAR(mixed.loss_rate(), 0.3, 1e-15);
  // p = 1: the shortest bursts that lose so much.
  EXPECT_NEAR(chain_of({.loss_rate = 0.75, .mean_burst = 3.0}).good_to_bad, 1.0, 1e-15);
  EXPECT_EQ(chain_of({.loss_rate = 0.9, .mean_burst = 9.0}).good_to_bad, 1.0);
}

TEST(GilbertElliottLoss, WithOneLossForBothStatesIsBernoulli) {
  const GilbertElliott chain{
      .good_to_bad = 0.1, .bad_to_good = 0.2, .loss_good = 0.3, .loss_bad = 0.3};
  EXPECT_EQ(series(Loss::gilbert_elliott(chain), 500, packet(0), 2),
            series(Loss::bernoulli(0.3), 500, packet(0), 2));
}

TEST(GilbertElliottLoss, ALargerRateLosesASupersetWithinTheSameBursts) {
  std::vector<int> before(4000, 0);
  for (const double rate : {0.05, 0.2, 0.4, 0.6}) {
    const auto lost =
        series(Loss::gilbert_elliott(chain_of({.loss_rate = rate, .mean_burst = 5.0})), 4000);
    for (std::size_t i = 0; i < lost.size(); ++i) EXPECT_LE(before[i], lost[i]) << i;
    before = lost;
  }
}

TEST(AnyLoss, MoreFramesLoseASuperset) {
  const GilbertElliott chain{
      .good_to_bad = 0.1, .bad_to_good = 0.3, .loss_good = 0.05, .loss_bad = 0.5};
  for (const Loss& loss : {Loss::bernoulli(0.1), Loss::gilbert_elliott(chain)}) {
    auto before = series(loss, 2000, packet(0), 1);
    for (const std::uint32_t frames : {2u, 4u, 9u}) {
      const auto lost = series(loss, 2000, packet(0), frames);
      for (std::size_t i = 0; i < lost.size(); ++i) EXPECT_LE(before[i], lost[i]);
      EXPECT_GT(mean(lost), mean(before));
      before = lost;
    }
  }
}

TEST(AnyLoss, DoesNotDependOnWhichIndicesAreAskedAndInWhichOrder) {
  for (const GilbertElliott& chain : chains) {
    const Loss loss = Loss::gilbert_elliott(chain);
    const auto all = series(loss, 600);
    for (std::uint64_t i = 600; i-- > 0;) {
      if (i % 7 != 3) continue;
      EXPECT_EQ(Loss::gilbert_elliott(chain).lost(packet(i)) ? 1 : 0, all[i]);
    }
  }
}

TEST(AnyLoss, IsIndependentOnOtherLinksNumberingsAndSeeds) {
  constexpr std::uint64_t n = 30'000;
  const GilbertElliott chain{.good_to_bad = 0.1, .bad_to_good = 0.3};
  const double b = chain.share_bad();
  const double lambda = 0.6;
  const Loss loss = Loss::gilbert_elliott(chain);
  const auto base = series(loss, n);
  PacketOnLink numbered = packet(0);
  numbered.numbering = Numbering::packet;
  PacketOnLink reseeded = packet(0);
  reseeded.seed = 10;
  for (const PacketOnLink& other :
       {packet(0, 1, 2), packet(0, 2, 3), packet(0, 3, 1), numbered, reseeded}) {
    const auto lost = series(loss, n, other);
    double covariance = 0.0;
    for (std::size_t i = 0; i < n; ++i) covariance += (base[i] - b) * (lost[i] - b);
    // Two independent series, each with autocorrelation λ^lag: their product has λ^(2·lag).
    const double deviation =
        b * (1.0 - b) * std::sqrt((1.0 + lambda * lambda) / (1.0 - lambda * lambda) / n);
    EXPECT_NEAR(covariance / n, 0.0, sigmas * deviation);
  }
}

TEST(AnyLoss, RefusesWhatIsNoProbability) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(error_of([] { Loss::bernoulli(1.5); }), "loss: probability must be in [0, 1], not 1.5");
  EXPECT_EQ(error_of([&] { Loss::bernoulli(nan); }),
            "loss: probability must be in [0, 1], not nan");
  EXPECT_EQ(error_of([] {
              Loss::bernoulli(0.1, {{0, 1, -0.5}});
            }),
            "loss: probability of link 0 → 1 must be in [0, 1], not -0.5");
  EXPECT_EQ(error_of([] {
              Loss::bernoulli(0.1, {{0, 1, 0.5}, {1, 0, 0.5}, {0, 1, 0.2}});
            }),
            "loss: link 0 → 1 is listed twice");
  const auto chain = [](const GilbertElliott& of) {
    return error_of([&] { Loss::gilbert_elliott(of); });
  };
  EXPECT_EQ(chain({.good_to_bad = -0.1}), "loss: good_to_bad must be in [0, 1], not -0.1");
  EXPECT_EQ(chain({.good_to_bad = 0.1, .bad_to_good = 0.0}),
            "loss: bad_to_good must be in (0, 1], not 0");
  EXPECT_EQ(chain({.good_to_bad = 1.0, .bad_to_good = 1.0}),
            "loss: good_to_bad + bad_to_good must be between 1e-06 and 2 − 1e-06, not 1 + 1");
  EXPECT_EQ(chain({.good_to_bad = 0.0, .bad_to_good = 1e-7}),
            "loss: good_to_bad + bad_to_good must be between 1e-06 and 2 − 1e-06, not 0 + 1e-07");
  EXPECT_EQ(chain({.good_to_bad = 0.1, .loss_good = 2.0}),
            "loss: loss_good must be in [0, 1], not 2");
  EXPECT_EQ(chain({.good_to_bad = 0.1, .loss_bad = -1.0}),
            "loss: loss_bad must be in [0, 1], not -1");
}

TEST(AnyLoss, RefusesBurstsThatCannotBe) {
  const auto burst = [](const BurstLoss& of) { return error_of([&] { chain_of(of); }); };
  EXPECT_EQ(burst({.loss_rate = 0.9, .mean_burst = 5.0}),
            "loss: a loss rate of 0.9 needs a mean_burst of at least 9 packets, not 5");
  EXPECT_EQ(burst({.loss_rate = 1.0, .mean_burst = 5.0}),
            "loss: the loss rate must be at least loss_good (0) and below loss_bad (1), not 1");
  EXPECT_EQ(burst({.loss_rate = 0.1, .mean_burst = 5.0, .loss_good = 0.2}),
            "loss: the loss rate must be at least loss_good (0.2) and below loss_bad (1), not 0.1");
  EXPECT_EQ(burst({.loss_rate = 0.1, .mean_burst = 0.5}),
            "loss: mean_burst must be between 1 and 1e+06 packets, not 0.5");
  EXPECT_EQ(burst({.loss_rate = 0.1, .mean_burst = 2e6}),
            "loss: mean_burst must be between 1 and 1e+06 packets, not 2e+06");
  EXPECT_EQ(burst({.loss_rate = 0.1, .mean_burst = 2.0, .loss_good = 0.5, .loss_bad = 0.5}),
            "loss: loss_good must be below loss_bad (0.5), not 0.5");
  EXPECT_EQ(burst({.loss_rate = 0.5, .mean_burst = 1.0}),
            "loss: good_to_bad + bad_to_good must be between 1e-06 and 2 − 1e-06, not 1 + 1");
}

TEST(AnyLoss, RefusesMoreFramesThanANameHasDraws) {
  EXPECT_THROW(Loss::bernoulli(0.1).lost(packet(0), frames_max + 1), BrokenInvariant);
  EXPECT_THROW(Loss::bernoulli(0.1).lost(packet(std::uint64_t{1} << 48)), BrokenInvariant);
}

}  // namespace
}  // namespace hearsay
