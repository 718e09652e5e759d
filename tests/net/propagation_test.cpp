// Closed forms are computed here with the C library's functions. Bounds on shares and moments are 4
// standard errors; seeds are fixed.
#include "net/propagation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

constexpr double sigmas = 4.0;

PacketOnLink packet(std::uint64_t index, AgentId from = 3, AgentId to = 8) {
  return {.seed = 5, .from = from, .to = to, .index = index};
}

// Everybody at 1 m has this SNR.
Propagation with_snr(double snr_db) {
  return Propagation::log_distance(
      {.reference_loss_db = 0.0, .transmit_dbm = snr_db, .noise_dbm = 0.0, .range_m = 1e6});
}
double success_at(double snr_db, std::uint32_t bytes) {
  return frame_success(with_snr(snr_db).quality(1.0), bytes);
}
double closed_success(double snr_db, double bytes) {
  const double ber = 0.5 * std::exp(-std::pow(10.0, snr_db / 10.0) / 1.28);
  return std::pow(1.0 - ber, 8.0 * bytes);
}

// The share of `n` packets that are heard.
template <class Heard>
double share(int n, Heard heard) {
  int count = 0;
  for (int i = 0; i < n; ++i) count += heard(static_cast<std::uint64_t>(i)) ? 1 : 0;
  return static_cast<double>(count) / n;
}
double deviation(double p, int n) { return std::sqrt(p * (1.0 - p) / n); }

template <class Call>
std::string error_of(Call call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(FrameSuccess, IsThatOfTheTableFor50Bytes) {
  const std::vector<std::pair<double, double>> table = {
      {7, 0.018}, {8, 0.235}, {9, 0.668}, {10, 0.922}, {11, 0.989}};
  for (const auto& [snr_db, success] : table) {
    EXPECT_NEAR(success_at(snr_db, 50), success, 0.0005) << snr_db << " dB";
  }
}

TEST(FrameSuccess, IsItsClosedForm) {
  for (double snr_db = -20.0; snr_db <= 16.0; snr_db += 0.5) {
    for (const std::uint32_t bytes : {0u, 1u, 8u, 50u, 1500u}) {
      const double expected = closed_success(snr_db, bytes);
      EXPECT_NEAR(success_at(snr_db, bytes), expected, 1e-11 * expected + 1e-300)
          << snr_db << " dB, " << bytes << " bytes";
    }
  }
}

TEST(FrameSuccess, NeverGrowsWithDistanceOrLengthAndNeverFallsWithPower) {
  for (int i = 1; i < 200; ++i) {
    const auto at = [](double distance_m, double power_dbm, std::uint32_t bytes) {
      const auto model = Propagation::log_distance({.transmit_dbm = power_dbm, .range_m = 1e4});
      return frame_success(model.quality(distance_m), bytes);
    };
    const auto bytes = static_cast<std::uint32_t>(i);
    EXPECT_GE(at(i * 0.5, 0.0, 40), at(i * 0.5 + 0.5, 0.0, 40));
    EXPECT_GE(at(40.0, 0.0, bytes), at(40.0, 0.0, bytes + 1));
    EXPECT_LE(at(60.0, i * 0.1, 40), at(60.0, i * 0.1 + 0.1, 40));
  }
}

TEST(FrameSuccess, OfAStrongSignalIsExactlyOneAndOfNoneExactlyZero) {
  EXPECT_EQ(success_at(40.0, 1500), 1.0);
  EXPECT_EQ(success_at(-150.0, 1500), 0.0);
  EXPECT_EQ(success_at(-150.0, 0), 1.0);
}

TEST(Disk, IsHeardWithinItsRangeAndByNobodyBeyond) {
  const Propagation disk = Propagation::disk(30.0);
  EXPECT_TRUE(disk.certain());
  EXPECT_EQ(disk.reach_m(), 30.0);
  for (const std::uint32_t bytes : {1u, 100000u}) {
    EXPECT_EQ(frame_success(disk.quality(0.0), bytes), 1.0);
    EXPECT_EQ(frame_success(disk.quality(30.0), bytes), 1.0);
    EXPECT_EQ(frame_success(disk.quality(30.0000001), bytes), 0.0);
  }
  EXPECT_TRUE(Propagation().certain());
  EXPECT_EQ(frame_success(Propagation().quality(1e300), 9), 1.0);
}

TEST(GreyZone, FallsLinearlyBetweenItsRadii) {
  const Propagation zone = Propagation::grey_zone({.inner_m = 20.0, .outer_m = 60.0});
  EXPECT_FALSE(zone.certain());
  EXPECT_EQ(zone.reach_m(), 60.0);
  for (const auto& [distance_m, expected] : {std::pair{0.0, 1.0},
                                             {20.0, 1.0},
                                             {30.0, 0.75},
                                             {40.0, 0.5},
                                             {55.0, 0.125},
                                             {60.0, 0.0},
                                             {61.0, 0.0},
                                             {1e9, 0.0}}) {
    EXPECT_DOUBLE_EQ(frame_success(zone.quality(distance_m), 10), expected) << distance_m << " m";
  }
  // Without a zone between them it is a disk.
  const Propagation sharp = Propagation::grey_zone({.inner_m = 50.0, .outer_m = 50.0});
  EXPECT_EQ(frame_success(sharp.quality(50.0), 10), 1.0);
  EXPECT_EQ(frame_success(sharp.quality(50.1), 10), 0.0);
}

TEST(GreyZone, DeliversItsShare) {
  constexpr int n = 20'000;
  const Propagation zone = Propagation::grey_zone({.inner_m = 20.0, .outer_m = 60.0});
  for (const double distance_m : {22.0, 35.0, 50.0, 59.0}) {
    const double expected = (60.0 - distance_m) / 40.0;
    const LinkQuality quality = zone.quality(distance_m);
    EXPECT_NEAR(share(n, [&](auto i) { return frame_heard(quality, packet(i), 0, 10); }), expected,
                sigmas * deviation(expected, n));
  }
}

TEST(LogDistance, LosesItsPathLossAndNoMoreBelowTheReference) {
  const Propagation model = Propagation::log_distance({.exponent = 2.4,
                                                       .reference_loss_db = 40.0,
                                                       .reference_m = 2.0,
                                                       .transmit_dbm = 10.0,
                                                       .noise_dbm = -95.0});
  for (const double distance_m : {2.0, 3.0, 40.0, 700.0}) {
    const double received = 10.0 - 40.0 - 24.0 * std::log10(distance_m / 2.0);
    EXPECT_NEAR(model.received_dbm(distance_m), received, 1e-12);
    EXPECT_NEAR(model.received_dbm(distance_m, 5.5), received - 5.5, 1e-12);
    EXPECT_NEAR(model.quality(distance_m, -3.0).snr_db, received + 3.0 + 95.0, 1e-12);
  }
  EXPECT_EQ(model.received_dbm(0.0), model.received_dbm(2.0));
  EXPECT_EQ(model.quality(0.1).snr_db, model.quality(2.0).snr_db);
}

TEST(LogDistance, ReachesToWhereALuckyLinkHearsOneShortFrameInAHundred) {
  for (const double sigma_db : {0.0, 4.0}) {
    const Propagation model = Propagation::log_distance({.shadowing_sigma_db = sigma_db});
    const double reach_m = model.reach_m();
    const double lucky_db = -3.0 * sigma_db;
    EXPECT_NEAR(frame_success(model.quality(reach_m, lucky_db), 8), 0.01, 1e-6);
    EXPECT_EQ(frame_success(model.quality(reach_m * 1.000001, lucky_db), 8), 0.0);
  }
  const Propagation cut = Propagation::log_distance({.range_m = 12.0});
  EXPECT_EQ(cut.reach_m(), 12.0);
  EXPECT_EQ(frame_success(cut.quality(12.0), 10), 1.0);
  EXPECT_EQ(frame_success(cut.quality(12.1), 10), 0.0);
}

TEST(LogDistance, InterferenceComesOnTopOfTheNoise) {
  const Propagation model = Propagation::log_distance({.noise_dbm = -100.0, .range_m = 1e4});
  const double quiet = model.quality(50.0).snr_db;
  EXPECT_NEAR(model.quality(50.0, 0.0, mw_of_dbm(-100.0)).snr_db, quiet - 10.0 * std::log10(2.0),
              1e-9);
  EXPECT_NEAR(model.quality(50.0, 0.0, mw_of_dbm(-80.0)).snr_db, quiet - 10.0 * std::log10(101.0),
              1e-9);
}

TEST(Shadowing, IsTheSameBothWaysAndTheNamedDrawOfItsPair) {
  const Propagation model = Propagation::log_distance({.shadowing_sigma_db = 4.0});
  for (AgentId a = 0; a < 40; ++a) {
    for (AgentId b = 0; b < a; ++b) {
      const double db = model.shadowing_db(5, a, b);
      EXPECT_EQ(db, model.shadowing_db(5, b, a));
      EXPECT_EQ(db, 4.0 * Stream(5, Purpose("shadowing"), Entity::link(b, a)).normal());
      EXPECT_NE(db, model.shadowing_db(6, a, b));
    }
  }
  EXPECT_EQ(Propagation::log_distance({}).shadowing_db(5, 0, 1), 0.0);
  EXPECT_EQ(Propagation::disk(3.0).shadowing_db(5, 0, 1), 0.0);
}

TEST(Shadowing, IsNormalOverPairs) {
  constexpr double sigma_db = 5.0;
  constexpr AgentId agents = 250;
  const Propagation model = Propagation::log_distance({.shadowing_sigma_db = sigma_db});
  double n = 0.0, sum = 0.0, squares = 0.0, fourths = 0.0;
  for (AgentId a = 0; a < agents; ++a) {
    for (AgentId b = 0; b < a; ++b) {
      const double x = model.shadowing_db(5, a, b) / sigma_db;
      n += 1.0;
      sum += x;
      squares += x * x;
      fourths += x * x * x * x;
    }
  }
  EXPECT_NEAR(sum / n, 0.0, sigmas / std::sqrt(n));
  EXPECT_NEAR(squares / n, 1.0, sigmas * std::sqrt(2.0 / n));
  EXPECT_NEAR(fourths / n, 3.0, sigmas * std::sqrt(96.0 / n));
}

// The success of a frame over a distance, averaged over the shadowing of many links: the integral
// of the normal density times the success, by Simpson's rule.
double average_success(const LogDistance& path, double distance_m, double bytes) {
  const double mean_snr_db = path.transmit_dbm - path.noise_dbm - path.reference_loss_db -
                             10.0 * path.exponent * std::log10(distance_m / path.reference_m);
  constexpr int steps = 4000;
  const double h = 16.0 / steps;
  double sum = 0.0;
  for (int i = 0; i <= steps; ++i) {
    const double x = -8.0 + h * i;
    const double weight = i == 0 || i == steps ? 1.0 : i % 2 ? 4.0 : 2.0;
    sum += weight * std::exp(-0.5 * x * x) *
           closed_success(mean_snr_db - path.shadowing_sigma_db * x, bytes);
  }
  return sum * h / 3.0 / std::sqrt(2.0 * std::acos(-1.0));
}

TEST(LogDistance, DeliversItsShareOverManyLinks) {
  constexpr int n = 20'000;
  const LogDistance path{.exponent = 2.6, .shadowing_sigma_db = 4.0};
  const Propagation model = Propagation::log_distance(path);
  for (const double distance_m : {20.0, 50.0, 80.0, 130.0, 200.0}) {
    ASSERT_LT(distance_m, model.reach_m());
    const double expected = average_success(path, distance_m, 50);
    const double found = share(n, [&](std::uint64_t i) {
      const auto to = static_cast<AgentId>(i + 1);
      const LinkQuality quality = model.quality(distance_m, model.shadowing_db(5, 0, to));
      return frame_heard(quality, packet(7, 0, to), 0, 50);
    });
    EXPECT_NEAR(found, expected, sigmas * deviation(expected, n)) << distance_m << " m";
  }
}

TEST(FrameHeard, IsTheNamedDrawOfItsLinkIndexAndFrame) {
  LinkQuality quality;
  quality.success = 0.6;
  for (const Numbering numbering : {Numbering::tick, Numbering::packet}) {
    const Purpose purpose(numbering == Numbering::tick ? "reception of a tick"
                                                       : "reception of a packet");
    for (std::uint64_t i = 0; i < 200; ++i) {
      PacketOnLink asked = packet(i);
      asked.numbering = numbering;
      Stream draws = Stream::at(5, purpose, Entity::link(3, 8), i);
      for (std::uint32_t f = 0; f < 5; ++f) {
        EXPECT_EQ(frame_heard(quality, asked, f, 20), draws.uniform() < 0.6);
      }
    }
  }
}

TEST(PacketHeard, IsWhenEveryFrameIs) {
  const FrameSizes sizes{.frames = 5, .frame_bytes = 60, .last_bytes = 20};
  for (const double snr_db : {9.0, 10.0, 40.0, -40.0}) {
    const LinkQuality quality = with_snr(snr_db).quality(1.0);
    for (std::uint64_t i = 0; i < 300; ++i) {
      bool all = true;
      for (std::uint32_t f = 0; f < sizes.frames; ++f) {
        all &= frame_heard(quality, packet(i), f, sizes.bytes(f));
      }
      EXPECT_EQ(packet_heard(quality, packet(i), sizes), all);
    }
  }
  EXPECT_EQ(packet_heard(with_snr(10.0).quality(1.0), packet(3), {.last_bytes = 60}),
            frame_heard(with_snr(10.0).quality(1.0), packet(3), 0, 60));
}

TEST(PacketHeard, HasTheProductOfItsFramesSuccesses) {
  constexpr int n = 20'000;
  const FrameSizes sizes{.frames = 4, .frame_bytes = 50, .last_bytes = 10};
  const double expected = std::pow(closed_success(10.0, 50), 3) * closed_success(10.0, 10);
  const LinkQuality quality = with_snr(10.0).quality(1.0);
  EXPECT_NEAR(share(n, [&](auto i) { return packet_heard(quality, packet(i), sizes); }), expected,
              sigmas * deviation(expected, n));
}

TEST(PacketHeard, ALongerPacketIsHeardOnlyWhereAShorterOneIs) {
  const LinkQuality quality = with_snr(9.5).quality(1.0);
  for (std::uint64_t i = 0; i < 2000; ++i) {
    bool shorter = true;
    for (const FrameSizes& sizes :
         {FrameSizes{.last_bytes = 10}, {.last_bytes = 50}, {2, 50, 10}, {2, 50, 50}, {6, 50, 1}}) {
      const bool heard = packet_heard(quality, packet(i), sizes);
      EXPECT_LE(heard, shorter);
      shorter = heard;
    }
  }
}

TEST(ReceivedPower, HasItsMeaningInDifferences) {
  for (const Propagation& model :
       {Propagation::disk(50.0), Propagation::grey_zone({.inner_m = 10.0, .outer_m = 50.0})}) {
    EXPECT_FALSE(model.has_powers());
    EXPECT_NEAR(model.received_dbm(5.0) - model.received_dbm(10.0), 20.0 * std::log10(2.0), 1e-12);
    EXPECT_EQ(model.received_dbm(0.0), model.received_dbm(1.0));
  }
  EXPECT_TRUE(Propagation::log_distance({}).has_powers());
}

TEST(Propagation, RefusesWhatCannotBe) {
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(error_of([] { Propagation::disk(0.0); }),
            "disk: range_m must be positive and finite, not 0");
  EXPECT_EQ(error_of([&] { Propagation::disk(inf); }),
            "disk: range_m must be positive and finite, not inf");
  const auto zone = [](double inner_m, double outer_m) {
    return error_of([&] { Propagation::grey_zone({inner_m, outer_m}); });
  };
  EXPECT_EQ(zone(-1.0, 5.0), "grey zone: inner_m must be at least 0 and finite, not -1");
  EXPECT_EQ(zone(0.0, 0.0), "grey zone: outer_m must be positive and finite, not 0");
  EXPECT_EQ(zone(0.0, inf), "grey zone: outer_m must be positive and finite, not inf");
  EXPECT_EQ(zone(6.0, 5.0), "grey zone: outer_m must be at least inner_m, not 5");
  const auto path = [](const LogDistance& of) {
    return error_of([&] { Propagation::log_distance(of); });
  };
  EXPECT_EQ(path({}), "no error");
  EXPECT_EQ(path({.exponent = 0.5}), "log-distance: exponent must be between 1 and 10, not 0.5");
  EXPECT_EQ(path({.reference_loss_db = 300.0}),
            "log-distance: reference_loss_db must be between -200 and 200, not 300");
  EXPECT_EQ(path({.reference_m = 0.0}),
            "log-distance: reference_m must be positive and finite, not 0");
  EXPECT_EQ(path({.shadowing_sigma_db = -1.0}),
            "log-distance: shadowing_sigma_db must be between 0 and 30, not -1");
  EXPECT_EQ(path({.transmit_dbm = inf}),
            "log-distance: transmit_dbm must be between -200 and 200, not inf");
  EXPECT_EQ(path({.noise_dbm = -300.0}),
            "log-distance: noise_dbm must be between -200 and 200, not -300");
  EXPECT_EQ(path({.range_m = 0.0}), "log-distance: range_m must be positive and finite, not 0");
  EXPECT_EQ(path({.transmit_dbm = -80.0}),
            "log-distance: nobody would hear: even at reference_m the signal is -126.678 dBm "
            "against a noise of -105 dBm; raise transmit_dbm or lower reference_loss_db");
}

TEST(Propagation, RefusesMoreFramesThanANameHasDraws) {
  EXPECT_THROW(packet_heard({}, packet(0), {.frames = frames_max + 1}), BrokenInvariant);
  EXPECT_THROW(frame_heard({}, packet(0), frames_max, 1), BrokenInvariant);
}

}  // namespace
}  // namespace hearsay
