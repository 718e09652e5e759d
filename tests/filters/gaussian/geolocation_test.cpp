#include "filters/gaussian/geolocation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "sim/kernel/error.hpp"
#include "tests/filters/gaussian/samples.hpp"

namespace hearsay::gaussian {
namespace {

constexpr double pi = 3.14159265358979323846;
const Ground plane = Plane{0.0};

/// 40 m over the plane, the object in the middle of the image, `off_nadir_rad` from straight down.
Look look_at_angle(double off_nadir_rad, const LookNoise& noise) {
  return {infrared_camera, looking({0, 0, 40}, 0.0, pi / 2 - off_nadir_rad),
          vector({infrared_camera.center_u, infrared_camera.center_v}), look_covariance(noise)};
}

Ground slope() {
  Terrain::Options options{
      .x_m = -50, .y_m = -50, .spacing_m = 10, .columns = 21, .rows = 11, .heights_m = {}};
  for (int j = 0; j < 11; ++j) {
    for (int i = 0; i < 21; ++i) options.heights_m.push_back(0.1 * (10 * i) - 0.2 * (10 * j));
  }
  return Terrain(std::move(options));
}

TEST(Geolocation, PixelToGroundToPixelIsARoundTrip) {
  Stream random = stream("round trip");
  int hits = 0;
  for (int i = 0; i < 200; ++i) {
    const Ground ground = i % 2 == 0 ? plane : slope();
    const Look look{infrared_camera,
                    looking({random.normal(0, 10), random.normal(0, 10), random.uniform(30, 60)},
                            random.uniform(-pi, pi), random.uniform(0.3, pi / 2), random.normal()),
                    vector({random.uniform(0, 240), random.uniform(0, 320)}), look_covariance({})};
    const auto xy = ground_position(look, ground, Vector::Zero(8));
    if (!xy) continue;
    ++hits;
    const double z = i % 2 == 0 ? 0.0 : *std::get<Terrain>(ground).height_m((*xy)(0), (*xy)(1));
    const auto pixel = project(infrared_camera, look.pose, {(*xy)(0), (*xy)(1), z});
    ASSERT_TRUE(pixel);
    EXPECT_LT((*pixel - look.pixel).norm(), 1e-8) << i;
  }
  EXPECT_GT(hits, 100);
}

TEST(Geolocation, StraightDownTheSpreadsAddUp) {
  // σ_position², (height·σ_attitude)² and (height·σ_pixel/focal length)², on each axis.
  const LookNoise noise{0.5, 0.02, 2.0};
  const auto first = geolocate_linearised(look_at_angle(0.0, noise), plane);
  ASSERT_TRUE(first);
  const double common = 0.25 + 0.64;
  // Heading x: up in the image is +x, so that u goes along y and v along x.
  EXPECT_NEAR(first->covariance(0, 0), common + std::pow(40 * 2 / 345.876, 2), 1e-12);
  EXPECT_NEAR(first->covariance(1, 1), common + std::pow(40 * 2 / 347.881, 2), 1e-12);
  EXPECT_NEAR(first->covariance(0, 1), 0.0, 1e-12);
  EXPECT_LT(first->mean.norm(), 1e-13);
}

TEST(Geolocation, AtASlantTheSpreadGrowsAsTheGeometrySays) {
  // Attitude alone, at angle θ off nadir: h·σ/cos²θ along the sight, h·σ/cos θ across it.
  for (const double theta : {0.3, 0.8, 1.2}) {
    const auto first = geolocate_linearised(look_at_angle(theta, {0.0, 0.01, 0.0}), plane);
    ASSERT_TRUE(first);
    const double c = std::cos(theta);
    EXPECT_NEAR(first->mean(0), 40 * std::tan(theta), 1e-10);
    EXPECT_NEAR(std::sqrt(first->covariance(0, 0)), 0.4 / (c * c), 1e-10);
    EXPECT_NEAR(std::sqrt(first->covariance(1, 1)), 0.4 / c, 1e-10);
  }
}

TEST(Geolocation, DerivativesEqualCentralDifferencesOnPlaneAndSlope) {
  Stream random = stream("derivatives");
  const Intrinsics skewed{350, 340, 120, 160, 2.5};
  int tried = 0;
  for (int i = 0; i < 60; ++i) {
    const Ground ground = i % 2 == 0 ? plane : slope();
    const Look look{skewed,
                    looking({random.normal(0, 10), random.normal(0, 10), random.uniform(30, 60)},
                            random.uniform(-pi, pi), random.uniform(0.8, pi / 2), random.normal()),
                    vector({random.uniform(100, 140), random.uniform(140, 180)}),
                    look_covariance({})};
    const auto at = ground_derivative(look, ground);
    if (!at) continue;
    ++tried;
    EXPECT_LT((at->position_m - *ground_position(look, ground, Vector::Zero(8))).norm(), 1e-12);
    for (int k = 0; k < 8; ++k) {
      const double step = 1e-5;
      const Vector e = step * Vector::Unit(8, k);
      const auto up = ground_position(look, ground, e), down = ground_position(look, ground, -e);
      ASSERT_TRUE(up && down);
      EXPECT_LT((at->jacobian.col(k) - (*up - *down) / (2 * step)).norm(),
                1e-6 * (1 + at->jacobian.col(k).norm()))
          << i << " " << k;
    }
  }
  EXPECT_GT(tried, 40);
}

/// Entry (i, j) of a sampled covariance has this standard error, if the values are near Gaussian.
double error_of(const Matrix& S, int i, int j, int draws) {
  return std::sqrt((S(i, i) * S(j, j) + S(i, j) * S(i, j)) / draws);
}

TEST(Geolocation, ForSmallErrorsAllThreeWaysAgreeWithinTheErrorOfMonteCarlo) {
  constexpr int draws = 20000;
  Stream random = stream("small errors");
  for (const Ground& ground : {plane, slope()}) {
    const Look look = look_at_angle(0.6, {0.1, 0.002, 0.5});
    const Sampled reference =
        geolocate_sampled(look, ground, draws, [&] { return random.normal(); });
    const auto first = geolocate_linearised(look, ground);
    const auto unscented = geolocate_unscented(look, ground);
    ASSERT_TRUE(reference.y && first && unscented);
    EXPECT_EQ(reference.misses, 0);
    const Matrix& S = reference.y->covariance;
    for (const Moments& way : {*first, *unscented}) {
      for (int i = 0; i < 2; ++i) {
        EXPECT_NEAR(way.mean(i), reference.y->mean(i), 4 * std::sqrt(S(i, i) / draws));
        for (int j = 0; j < 2; ++j) {
          EXPECT_NEAR(way.covariance(i, j), S(i, j), 4 * error_of(S, i, j, draws));
        }
      }
    }
  }
}

TEST(Geolocation, AtAGrazingSlantTheUnscentedTransformIsNearerToMonteCarlo) {
  constexpr int draws = 20000;
  Stream random = stream("grazing");
  for (const double degrees : {60.0, 70.0}) {
    const Look look = look_at_angle(degrees * pi / 180, {0.5, 0.03, 1.0});
    const Sampled reference =
        geolocate_sampled(look, plane, draws, [&] { return random.normal(); });
    const auto first = geolocate_linearised(look, plane);
    const auto unscented = geolocate_unscented(look, plane);
    ASSERT_TRUE(reference.y && first && unscented);
    const auto kl = [&](const Moments& way) {
      return *kl_divergence_nats(Belief::from_moments(reference.y->mean, reference.y->covariance),
                                 Belief::from_moments(way.mean, way.covariance));
    };
    // The bias of the mean along the sight, h·tan″/2·σ², is what linearisation cannot see.
    const double bias = reference.y->mean(0) - first->mean(0);
    EXPECT_GT(bias, 4 * std::sqrt(reference.y->covariance(0, 0) / draws)) << degrees;
    EXPECT_LT(std::fabs(reference.y->mean(0) - unscented->mean(0)), 0.2 * bias) << degrees;
    EXPECT_LT(kl(*unscented), 0.5 * kl(*first)) << degrees;
  }
}

TEST(Geolocation, TurningTheWholeSceneTurnsTheResult) {
  const LookNoise noise{0.5, 0.02, 1.0};
  const double turn = 1.3;
  Look look = look_at_angle(1.0, noise);
  const auto before = geolocate_unscented(look, plane);
  look.pose = looking({0, 0, 40}, turn, pi / 2 - 1.0);
  const auto after = geolocate_unscented(look, plane);
  ASSERT_TRUE(before && after);
  const Matrix T = matrix({{std::cos(turn), -std::sin(turn)}, {std::sin(turn), std::cos(turn)}});
  EXPECT_LT(relative(after->mean, T * before->mean), 1e-12);
  // Position errors along the world's axes are another set of points: equal but for their
  // curvature.
  EXPECT_LT(relative(after->covariance, T * before->covariance * T.transpose()), 1e-3);
}

TEST(Geolocation, LooksThatMissTheGroundAreValues) {
  const LookNoise noise{0.5, 0.02, 1.0};
  const Look level = look_at_angle(pi / 2, noise);
  EXPECT_FALSE(ground_derivative(level, plane));
  EXPECT_FALSE(geolocate_linearised(level, plane));
  EXPECT_FALSE(geolocate_unscented(level, plane));
  const Look up = look_at_angle(2.0, noise);
  Stream random = stream("misses");
  const Sampled none = geolocate_sampled(up, plane, 100, [&] { return random.normal(); });
  EXPECT_FALSE(none.y);
  EXPECT_EQ(none.misses, 100);
  // One standard deviation below the horizon the middle hits and a sigma point does not.
  const Look grazing = look_at_angle(pi / 2 - 0.02, noise);
  EXPECT_TRUE(geolocate_linearised(grazing, plane));
  EXPECT_FALSE(geolocate_unscented(grazing, plane));
}

TEST(Geolocation, ACertainLookIsCertain) {
  const Look sure = look_at_angle(0.5, {});
  const auto unscented = geolocate_unscented(sure, plane);
  ASSERT_TRUE(unscented);
  EXPECT_NEAR(unscented->mean(0), 40 * std::tan(0.5), 1e-12);
  EXPECT_EQ(unscented->covariance.norm(), 0.0);
}

TEST(Geolocation, ShapesAndSigmasThatAreNoneAreRefused) {
  EXPECT_THROW(look_covariance({-1.0, 0.0, 0.0}), BrokenInvariant);
  EXPECT_THROW(look_covariance({0.0, std::nan(""), 0.0}), BrokenInvariant);
  Look look = look_at_angle(0.5, {});
  EXPECT_THROW(ground_position(look, plane, Vector::Zero(7)), BrokenInvariant);
  look.covariance = Matrix::Zero(2, 2);
  EXPECT_THROW(geolocate_linearised(look, plane), BrokenInvariant);
  Look indefinite = look_at_angle(0.5, {});
  indefinite.covariance(3, 3) = -1.0;
  EXPECT_FALSE(geolocate_unscented(indefinite, plane));
}

}  // namespace
}  // namespace hearsay::gaussian
