// Trackers that tell each other what they have.
#include <gtest/gtest.h>

#include <cmath>

#include "filters/tracking/score.hpp"
#include "filters/tracking/tracker.hpp"
#include "tests/filters/gaussian/samples.hpp"

namespace hearsay::tracking {
namespace {

using gaussian::Belief;
using gaussian::Matrix;
using gaussian::PositionMeasurement;
using gaussian::Rule;
using gaussian::vector;

constexpr gaussian::Stamp second = 1'000'000'000;
constexpr std::uint32_t peer = 1;

PositionMeasurement plot(double x, double y, double sigma = 1.0) {
  return {vector({x, y}), Matrix(sigma * sigma * Matrix::Identity(2, 2))};
}

/// Confirms at once, so that a scan makes tracks.
Tracker::Options eager(Rule rule, double q = 0.1) {
  return {.q = q, .birth_speed_sigma = 5, .confirm_hits = 1, .confirm_scans = 1, .rule = rule};
}

TEST(TrackerFusion, WhatIsHeardAndUnknownBecomesATrackOfMyOwn) {
  Tracker a(eager(Rule::ci_det), 0), b(eager(Rule::ci_det), 0);
  a.scan(0, std::vector{plot(500, 0), plot(0, 0)});
  b.scan(0, std::vector{plot(0.5, 0)});
  ASSERT_TRUE(b.heard(peer, 0, a.reports()));
  ASSERT_EQ(b.tracks().size(), 2u);
  EXPECT_TRUE(b.tracks()[0].seen);
  EXPECT_FALSE(b.tracks()[1].seen);
  EXPECT_TRUE(b.tracks()[1].confirmed);
  EXPECT_EQ(b.labels().mine_of(peer, 0), 1u);  // a's first is b's second
  EXPECT_EQ(b.labels().mine_of(peer, 1), 0u);
  EXPECT_EQ(b.counts().born_of_hearsay, 1u);
  EXPECT_EQ(b.counts().fusions, 1u);
}

// The same two beliefs by the rule itself, moved on to the same instant.
TEST(TrackerFusion, FusesByTheRuleAtTheHearersInstant) {
  for (const Rule rule :
       {Rule::naive, Rule::ci_det, Rule::ci_trace, Rule::ci_half, Rule::ci_niehsen,
        Rule::ci_franken_huepper, Rule::most_certain, Rule::inverse_ci, Rule::ellipsoidal}) {
    Tracker a(eager(rule), 0), b(eager(rule), 0);
    a.scan(1 * second, std::vector{plot(0, 0, 0.5)});
    b.scan(0, std::vector{plot(0, 0)});
    b.scan(1 * second, std::vector{plot(0.5, 0.2)});
    b.predict_to(3 * second);
    const Belief own = b.tracks()[0].belief;
    const Belief told =
        gaussian::predict(a.tracks()[0].belief, gaussian::white_noise_acceleration(2, 2.0, 0.1));
    const Belief expected = gaussian::fused(rule, own, told, Belief::unknown(4));
    ASSERT_TRUE(b.heard(peer, a.stamp(), a.reports()));
    EXPECT_EQ(b.tracks()[0].belief.omega, expected.omega) << gaussian::info(rule).name;
    EXPECT_EQ(b.tracks()[0].belief.xi, expected.xi);
  }
}

TEST(TrackerFusion, WithoutARuleNothingIsHeard) {
  Tracker a(eager(Rule::none), 0), b(eager(Rule::none), 0);
  a.scan(0, std::vector{plot(0, 0)});
  b.heard(peer, 0, a.reports());
  EXPECT_TRUE(b.tracks().empty());
}

TEST(TrackerFusion, RefusesWhatCannotBeATrack) {
  Tracker a(eager(Rule::naive), 0), b(eager(Rule::naive), 0);
  a.scan(0, std::vector{plot(0, 0)});
  const Belief good = a.tracks()[0].belief;
  Belief indefinite = good, broken = good, vague = good;
  indefinite.omega(0, 0) = -1.0;
  broken.xi(0) = std::nan("");
  vague.omega *= 1e-9;
  Belief lopsided = good;
  lopsided.xi = vector({1, 2});
  const std::vector<Report> reports{{0, Belief::unknown(4)},
                                    {1, Belief::unknown(2)},
                                    {2, indefinite},
                                    {3, broken},
                                    {4, vague},
                                    {5, lopsided},
                                    {6, good},
                                    {6, good}};
  ASSERT_TRUE(b.heard(peer, 0, reports));
  EXPECT_EQ(b.counts().refused, 7u);
  ASSERT_EQ(b.tracks().size(), 1u);
  EXPECT_EQ(b.labels().mine_of(peer, 6), 0u);
}

TEST(TrackerFusion, RefusesTheFutureAndTheEndOfTime) {
  Tracker a(eager(Rule::naive), 0), b(eager(Rule::naive), 0);
  a.scan(0, std::vector{plot(0, 0)});
  EXPECT_FALSE(b.heard(peer, 1, a.reports()));
  EXPECT_TRUE(b.heard(peer, -second, a.reports()));
  b.predict_to(second);
  EXPECT_FALSE(b.heard(peer, std::numeric_limits<gaussian::Stamp>::min(), a.reports()));
  EXPECT_TRUE(b.heard(peer, std::numeric_limits<gaussian::Stamp>::min() + second + 2, a.reports()));
  EXPECT_EQ(b.tracks().size(), 1u);  // that of one second ago; the other is too vague by now
}

// a sees an object that b would see too if it were there.
TEST(TrackerFusion, WhatIMissedTooOftenIsNotBroughtBackByOthers) {
  auto options = eager(Rule::ci_det, 0.0);
  options.misses_max = 2;
  Tracker a(options, 0), b(options, 0);
  a.scan(0, std::vector{plot(0, 0)});
  for (int k = 0; k < 6; ++k) {
    b.scan(k * second, {});
    b.heard(peer, 0, a.reports());
    EXPECT_EQ(b.tracks().size(), k < 2 ? 1u : 0u);
  }
  EXPECT_EQ(b.counts().born_of_hearsay, 1u);
  EXPECT_EQ(b.counts().buried, 4u);
  // But when b sees it after all, it is a's again.
  b.scan(6 * second, std::vector{plot(0, 0)});
  b.heard(peer, 0, a.reports());
  EXPECT_EQ(b.labels().mine_of(peer, 0), 1u);
}

// Two that saw an object once and tell each other for ever. Intersection lets the uncertainty grow
// with the motion; the naive rule takes an echo for news.
TEST(TrackerFusion, RumoursDieByIntersectionAndLiveByAddition) {
  for (const Rule rule : {Rule::ci_det, Rule::naive}) {
    auto options = eager(rule, 1.0);
    options.sigma_max = 50.0;
    Tracker a(options, 0), b(options, 0);
    a.scan(0, std::vector{plot(0, 0)});
    b.scan(0, std::vector{plot(0, 0)});
    for (int k = 1; k <= 120; ++k) {
      const gaussian::Stamp now = k * second;
      a.predict_to(now);
      b.predict_to(now);
      const auto from_a = a.reports();
      a.heard(2, now, b.reports());
      b.heard(1, now, from_a);
    }
    EXPECT_EQ(a.tracks().empty(), rule == Rule::ci_det) << gaussian::info(rule).name;
  }
}

/// Three trackers, each of which sees one third of a road along which two objects go. Returns who
/// had tracks of both, in how many of all scans, and whose labels stayed with their objects.
struct Outcome {
  int both = 0, samples = 0;
  std::uint64_t swaps = 0, merged = 0;
};
Outcome relay(Rule rule) {
  Stream random = gaussian::stream("relay");
  std::vector<Tracker> trackers(
      3, Tracker({.q = 0.02, .birth_speed_sigma = 8, .sigma_max = 40, .rule = rule}, 0));
  std::vector<TrackScore> scores(3, TrackScore({.cutoff_m = 20}));
  Outcome outcome;
  for (int k = 0; k < 90; ++k) {
    const gaussian::Stamp now = k * second;
    const std::vector<Placed> truths{{0, vector({5.0 + 3.0 * k, 0.0})},
                                     {1, vector({265.0 - 2.0 * k, 60.0})}};
    for (std::size_t i = 0; i < 3; ++i) {
      const Coverage coverage{vector({50.0 + 90.0 * static_cast<double>(i), 30.0}), 65.0};
      std::vector<PositionMeasurement> plots;
      for (const Placed& truth : truths) {
        if ((truth.position - coverage.centre).norm() > coverage.range) continue;
        if (!random.bernoulli(0.9)) continue;
        plots.push_back(
            plot(truth.position(0) + random.normal(), truth.position(1) + random.normal()));
      }
      trackers[i].scan(now, plots, coverage);
    }
    for (std::size_t from = 0; from < 3; ++from) {
      const auto reports = trackers[from].reports();
      for (std::size_t to = 0; to < 3; ++to) {
        if (to != from) trackers[to].heard(static_cast<std::uint32_t>(from), now, reports);
      }
    }
    for (std::size_t i = 0; i < 3; ++i) {
      std::vector<Placed> tracks;
      for (const Report& report : trackers[i].reports()) {
        tracks.push_back(
            {report.label, trackers[i].position_of_state() * *gaussian::state(report.belief)});
      }
      const auto sample = scores[i].sample(truths, tracks);
      if (k < 10) continue;
      ++outcome.samples;
      outcome.both += sample.missed == 0 ? 1 : 0;
    }
  }
  for (const TrackScore& score : scores) {
    outcome.swaps += score.counts().label_swaps;
    outcome.merged += score.counts().merged_tracks;
  }
  return outcome;
}

TEST(TrackerFusion, WhoSeesAThirdOfTheRoadTracksAllOfIt) {
  const Outcome alone = relay(Rule::none), together = relay(Rule::ci_det);
  EXPECT_LT(alone.both, alone.samples / 2);
  EXPECT_GT(together.both, together.samples * 95 / 100);
  EXPECT_EQ(together.swaps, 0u);
  EXPECT_EQ(together.merged, 0u);
}

}  // namespace
}  // namespace hearsay::tracking
