// One tracker on its own, against Kalman filters, closed forms and counted cases.
#include "filters/tracking/tracker.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "filters/tracking/score.hpp"
#include "sim/kernel/error.hpp"
#include "tests/filters/gaussian/samples.hpp"

namespace hearsay::tracking {
namespace {

using gaussian::Belief;
using gaussian::Matrix;
using gaussian::PositionMeasurement;
using gaussian::stream;
using gaussian::Vector;
using gaussian::vector;

constexpr gaussian::Stamp second = 1'000'000'000;

PositionMeasurement plot(double x, double y, double sigma = 1.0) {
  return {vector({x, y}), Matrix(sigma * sigma * Matrix::Identity(2, 2))};
}

/// A Kalman filter in covariance form, written as in any textbook.
struct Kalman {
  Eigen::VectorXd x;
  Eigen::MatrixXd P;
  void predict(double dt, double q) {
    Eigen::Matrix4d F = Eigen::Matrix4d::Identity(), Q = Eigen::Matrix4d::Zero();
    F(0, 2) = F(1, 3) = dt;
    for (int i = 0; i < 2; ++i) {
      Q(i, i) = q * dt * dt * dt / 3;
      Q(i, i + 2) = Q(i + 2, i) = q * dt * dt / 2;
      Q(i + 2, i + 2) = q * dt;
    }
    x = F * x;
    P = F * P * F.transpose() + Q;
  }
  void update(const PositionMeasurement& m) {
    Eigen::Matrix<double, 2, 4> H = Eigen::Matrix<double, 2, 4>::Zero();
    H(0, 0) = H(1, 1) = 1;
    const Eigen::Matrix2d S = H * P * H.transpose() + Eigen::Matrix2d(m.S);
    const Eigen::Matrix<double, 4, 2> K = P * H.transpose() * S.inverse();
    x += K * (Eigen::Vector2d(m.z) - H * x);
    P = (Eigen::Matrix4d::Identity() - K * H) * P;
  }
};

TEST(Tracker, WithPerfectDetectionIsOneKalmanFilterATarget) {
  Stream random = stream("kalman");
  const int targets = 5;
  const double q = 0.3, speed = 5.0;
  // No right plot lies outside this gate, and no wrong one inside.
  Tracker tracker({.q = q, .birth_speed_sigma = speed, .gate = 1000.0}, 0);
  std::vector<Kalman> filters;
  gaussian::Stamp now = 0;
  for (int step = 0; step < 60; ++step) {
    const double dt = step == 0 ? 0.0 : 0.25 * static_cast<double>(1 + random.below(8));
    now += static_cast<gaussian::Stamp>(dt * second);
    std::vector<PositionMeasurement> plots;
    for (int i = 0; i < targets; ++i) {
      plots.push_back({vector({1000.0 * i + random.normal(), 3.0 * random.normal()}),
                       gaussian::random_information(random, 2, 0.5)});
      if (step == 0) {
        Kalman filter{Eigen::VectorXd::Zero(4), Eigen::MatrixXd::Zero(4, 4)};
        filter.x.head(2) = plots.back().z;
        filter.P.topLeftCorner(2, 2) = plots.back().S;
        filter.P(2, 2) = filter.P(3, 3) = speed * speed;
        filters.push_back(filter);
      } else {
        filters[static_cast<std::size_t>(i)].predict(dt, q);
        filters[static_cast<std::size_t>(i)].update(plots.back());
      }
    }
    // The order of plots in a scan says nothing; only in the first one it gives labels.
    if (step > 0) std::rotate(plots.begin(), plots.begin() + step % targets, plots.end());
    ASSERT_TRUE(tracker.scan(now, plots));
  }
  ASSERT_EQ(tracker.tracks().size(), static_cast<std::size_t>(targets));
  for (std::size_t i = 0; i < filters.size(); ++i) {
    const Track& track = tracker.tracks()[i];
    EXPECT_EQ(track.label, i);
    EXPECT_TRUE(track.confirmed);
    EXPECT_LE(gaussian::relative(*gaussian::state(track.belief), filters[i].x), 1e-12);
    EXPECT_LE(gaussian::relative(*gaussian::covariance(track.belief), filters[i].P), 1e-12);
  }
}

TEST(Tracker, ConfirmsByMHitsOutOfNScans) {
  // Hits (1) and misses (0) in the scans after the first, and after which of all the track is
  // confirmed or ends; m = 3, n = 4.
  struct Case {
    std::vector<int> hits;
    std::size_t confirmed_after, ended_after;
  };
  const std::vector<Case> cases = {
      {{1, 1}, 3, 0}, {{1, 0, 1}, 4, 0}, {{0, 1, 1}, 4, 0},
      {{0, 0}, 0, 3}, {{1, 0, 0}, 0, 4}, {{0, 1, 0}, 0, 4},
  };
  for (const Case& c : cases) {
    Tracker tracker({.confirm_hits = 3, .confirm_scans = 4}, 0);
    tracker.scan(0, std::vector{plot(0, 0)});
    for (std::size_t k = 0; k < c.hits.size(); ++k) {
      std::vector<PositionMeasurement> plots;
      if (c.hits[k] == 1) plots.push_back(plot(0, 0));
      tracker.scan(static_cast<gaussian::Stamp>(k + 1) * second, plots);
      const bool ended = k + 2 == c.ended_after;
      ASSERT_EQ(tracker.tracks().size(), ended ? 0u : 1u);
      if (ended) continue;
      EXPECT_EQ(tracker.tracks()[0].confirmed, k + 2 == c.confirmed_after);
    }
    EXPECT_EQ(tracker.counts().ended_unconfirmed, c.ended_after > 0 ? 1u : 0u);
  }
}

/// A tracker with one confirmed track at the origin, at stamp 0.
Tracker with_one_track(Tracker::Options options) {
  options.confirm_hits = options.confirm_scans = 1;
  Tracker tracker(options, 0);
  tracker.scan(0, std::vector{plot(0, 0)});
  return tracker;
}

TEST(Tracker, AConfirmedTrackEndsAfterSoManyMissesInARow) {
  Tracker tracker = with_one_track({.misses_max = 3});
  tracker.scan(1 * second, {});
  tracker.scan(2 * second, {});
  tracker.scan(3 * second, std::vector{plot(0, 0)});  // seen in time: counts anew
  tracker.scan(4 * second, {});
  tracker.scan(5 * second, {});
  ASSERT_EQ(tracker.tracks().size(), 1u);
  EXPECT_EQ(tracker.tracks()[0].misses, 2);
  tracker.scan(6 * second, {});
  EXPECT_TRUE(tracker.tracks().empty());
  EXPECT_EQ(tracker.counts().ended_missed, 1u);
}

TEST(Tracker, WhatAScanCouldNotSeeIsNotMissed) {
  Tracker tracker = with_one_track({.misses_max = 1});
  for (int k = 1; k < 5; ++k) tracker.scan(k * second, {}, {vector({100, 0}), 99.0});
  EXPECT_EQ(tracker.tracks().size(), 1u);
  tracker.scan(5 * second, {}, {vector({100, 0}), 101.0});
  EXPECT_TRUE(tracker.tracks().empty());
}

// After a birth with σ = 1 m and 2 m/s an axis the position's variance is 1 + 4t² + qt³/3.
TEST(Tracker, ATrackEndsWhereItsPositionIsTooUncertain) {
  const double t = 7.0, variance = 1 + 4 * t * t + 0.1 * t * t * t / 3;
  for (const double factor : {0.999, 1.001}) {
    Tracker tracker = with_one_track(
        {.q = 0.1, .birth_speed_sigma = 2.0, .sigma_max = factor * std::sqrt(variance)});
    tracker.predict_to(7 * second);
    EXPECT_EQ(tracker.tracks().size(), factor > 1 ? 1u : 0u);
    EXPECT_EQ(tracker.counts().ended_uncertain, factor > 1 ? 0u : 1u);
  }
}

TEST(Tracker, RefusesThePastAndKeepsItsBounds) {
  Tracker tracker({.tracks_max = 3}, 5 * second);
  EXPECT_FALSE(tracker.predict_to(4 * second));
  EXPECT_FALSE(tracker.scan(4 * second, std::vector{plot(0, 0)}));
  EXPECT_EQ(tracker.counts().late, 1u);
  std::vector<PositionMeasurement> plots;
  for (int i = 0; i < 5; ++i) plots.push_back(plot(1000.0 * i, 0));
  tracker.scan(5 * second, plots);
  EXPECT_EQ(tracker.tracks().size(), 3u);
  EXPECT_EQ(tracker.counts().no_room, 2u);
  EXPECT_TRUE(tracker.reports().empty());  // none is confirmed
}

TEST(Tracker, RefusesOptionsOutOfRange) {
  EXPECT_THROW(Tracker({.axes = 5}, 0), BrokenInvariant);
  EXPECT_THROW(Tracker({.confirm_hits = 5, .confirm_scans = 4}, 0), BrokenInvariant);
  EXPECT_THROW(Tracker({.rule = gaussian::Rule::channel}, 0), BrokenInvariant);
  EXPECT_THROW(Tracker({.rule = gaussian::Rule::local_update}, 0), BrokenInvariant);
}

// Two objects that cross at x = 0, one unit of noise, seen in nine of ten scans.
TrackScore::Counts cross(std::uint64_t seed, Pairing pairing, double speed_across) {
  Stream random(seed, Purpose("crossing"), Entity::agent(0));
  Tracker tracker({.q = 0.01, .birth_speed_sigma = 10, .pairing = pairing}, 0);
  TrackScore score({.cutoff_m = 8});
  for (int k = 0; k <= 40; ++k) {
    const double x = 10.0 * (k - 20), y = speed_across * (k - 20);
    std::vector<PositionMeasurement> plots;
    for (const double side : {1.0, -1.0}) {
      if (!random.bernoulli(0.9)) continue;
      plots.push_back(plot(x + random.normal(), side * y + random.normal()));
    }
    tracker.scan(k * second, plots);
    std::vector<Placed> tracks;
    for (const Report& report : tracker.reports()) {
      tracks.push_back(
          {report.label, tracker.position_of_state() * *gaussian::state(report.belief)});
    }
    score.sample(std::vector<Placed>{{0, vector({x, y})}, {1, vector({x, -y})}}, tracks);
  }
  return score.counts();
}

// Once a velocity is known to σ ≈ 0.2 m/s, objects that part at 8 m/s are told apart; at 0.5 m/s
// they are not always.
TEST(Tracker, KeepsTheLabelsOfObjectsThatCross) {
  for (const Pairing pairing : {Pairing::nearest, Pairing::optimal}) {
    std::uint64_t fast = 0, slow = 0;
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
      fast += cross(seed, pairing, 4.0).label_swaps;
      slow += cross(seed, pairing, 0.25).label_swaps;
    }
    EXPECT_EQ(fast, 0u);
    EXPECT_GT(slow, 0u);
  }
}

// Clutter alone, at rate λ, on objects that stand still. After h hits the innovation has covariance
// σ²(1 + 1/h)I and the gate an area of 9πσ²(1 + 1/h), where clutter falls with probability
// p_h = 1 − exp(−λ·area). So a plot begins a track that is confirmed (3 out of 4) with probability
// at most P = p₁p₂(1 + (1 − p₂) + (1 − p₁)): it competes for plots with others, and loses its
// gate's part outside the field.
TEST(Tracker, ConfirmsNoMoreFalseTracksThanComputed) {
  Stream random = stream("clutter");
  const double rate = 5e-6, side = 2000.0, sigma = 10.0;
  const auto p = [&](double hits) {
    return 1.0 - std::exp(-rate * 9.0 * std::acos(-1.0) * sigma * sigma * (1 + 1 / hits));
  };
  const double P = p(1) * p(2) * (1 + (1 - p(2)) + (1 - p(1)));
  Tracker tracker({.q = 0.0, .confirm_hits = 3, .confirm_scans = 4, .misses_max = 2}, 0);
  for (int k = 0; k < 4000; ++k) {
    std::vector<PositionMeasurement> plots(random.poisson(rate * side * side));
    for (PositionMeasurement& one : plots) {
      const double x = random.uniform(0, side);
      one = plot(x, random.uniform(0, side), sigma);
    }
    tracker.scan(k * second, plots);
  }
  const double bound = static_cast<double>(tracker.counts().plots) * P;
  const auto confirmed = static_cast<double>(tracker.counts().confirmed);
  EXPECT_LE(confirmed, bound + 4 * std::sqrt(bound));
  EXPECT_GE(confirmed, 0.8 * bound);
}

// Three objects, nine detections of ten, clutter: after the first scans all three are tracked.
TEST(Tracker, FindsWhatIsThereAmongClutter) {
  Stream random = stream("field");
  Tracker tracker({.q = 0.05, .birth_speed_sigma = 5, .sigma_max = 30}, 0);
  TrackScore score({.cutoff_m = 10});
  int missed = 0, invented = 0;
  const int scans = 300;
  for (int k = 0; k < scans; ++k) {
    std::vector<PositionMeasurement> plots(random.poisson(1e-6 * 1000 * 1000));
    for (PositionMeasurement& one : plots) {
      const double x = random.uniform(0, 1000);
      one = plot(x, random.uniform(0, 1000));
    }
    std::vector<Placed> truths, tracks;
    for (std::uint32_t i = 0; i < 3; ++i) {
      truths.push_back({i, vector({100.0 + 2.0 * k, 200.0 + 300.0 * i})});
      if (!random.bernoulli(0.9)) continue;
      plots.push_back(plot(truths.back().position(0) + random.normal(),
                           truths.back().position(1) + random.normal()));
    }
    tracker.scan(k * second, plots);
    for (const Report& report : tracker.reports()) {
      tracks.push_back(
          {report.label, tracker.position_of_state() * *gaussian::state(report.belief)});
    }
    const auto sample = score.sample(truths, tracks);
    if (k < 10) continue;
    missed += sample.missed;
    invented += sample.false_tracks;
  }
  EXPECT_LE(missed, 9);  // 1 % of 3·290
  EXPECT_LE(invented, 9);
  EXPECT_EQ(score.counts().label_swaps, 0u);
}

}  // namespace
}  // namespace hearsay::tracking
