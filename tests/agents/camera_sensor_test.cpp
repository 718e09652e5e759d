#include "agents/sensors/camera.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

using Propagation = CameraSensor::Propagation;

CameraSensor::Options options(double distance_m, Propagation propagation) {
  return {.sensor_m = {10.0, 20.0},
          .altitude_m = 40.0,
          .target_m = {10.0 + 0.6 * distance_m, 20.0 - 0.8 * distance_m},
          .noise = {.sigma_position_m = 0.5, .sigma_attitude_rad = 0.02, .sigma_pixel = 1.0},
          .propagation = propagation};
}

Stream draws_of(std::uint64_t count) {
  return Stream::at(5, Purpose("camera test"), Entity::agent(0), count);
}

TEST(CameraSensor, ItsErrorsAreWhatItClaimsHoweverTheyArePropagated) {
  // From 40 m high and 40 m off, the believed pose differs from look to look, and so does what is
  // claimed: NEES has mean 2 and variance 4, and over n looks a standard error of 2/√n.
  constexpr int looks = 2000;
  for (const Propagation propagation :
       {Propagation::unscented, Propagation::linearised, Propagation::monte_carlo}) {
    CameraSensor::Options how = options(40.0, propagation);
    how.draws = 100;
    CameraSensor camera(how);
    const gaussian::Vector truth =
        (gaussian::Vector(2) << how.target_m[0], how.target_m[1]).finished();
    double nees = 0;
    for (int i = 0; i < looks; ++i) {
      Stream draws = draws_of(static_cast<std::uint64_t>(i));
      const auto told = camera.measure(draws);
      ASSERT_TRUE(told);
      nees += *gaussian::nees(*told, truth) / looks;
    }
    // 100 draws for a covariance: E of the inverse is larger by 99/96. The claim moves with the
    // pose (a few per cent): allow as much.
    EXPECT_NEAR(nees, 2.0, 4 * 2 / std::sqrt(looks) + 0.1) << static_cast<int>(propagation);
    EXPECT_EQ(camera.sums().looks, looks);
    EXPECT_EQ(camera.sums().missed, 0);
  }
}

TEST(CameraSensor, ClaimsAlongAndAcrossTheSightWhatTheGeometrySays) {
  // Attitude alone: h·σ/cos²θ along, h·σ/cos θ across, at tan θ = 40/40.
  CameraSensor::Options how = options(40.0, Propagation::linearised);
  how.noise = {.sigma_position_m = 0.0, .sigma_attitude_rad = 1e-3, .sigma_pixel = 1e-6};
  CameraSensor camera(how);
  Stream draws = draws_of(0);
  ASSERT_TRUE(camera.measure(draws));
  EXPECT_NEAR(std::sqrt(camera.sums().variance_along_m2), 0.08, 8e-4);
  EXPECT_NEAR(std::sqrt(camera.sums().variance_across_m2), 0.04 * std::sqrt(2.0), 4e-4);
}

TEST(CameraSensor, TheSameDrawsGiveTheSameNoiseUnderEveryPropagation) {
  // Of small errors all ways make the same; so what differs is not the noise.
  gaussian::Vector first;
  for (const Propagation propagation :
       {Propagation::unscented, Propagation::linearised, Propagation::monte_carlo}) {
    CameraSensor::Options how = options(30.0, propagation);
    how.noise = {.sigma_position_m = 0.5, .sigma_attitude_rad = 1e-3, .sigma_pixel = 1.0};
    how.draws = CameraSensor::draws_max;
    CameraSensor camera(how);
    Stream draws = draws_of(7);
    const gaussian::Vector z = *gaussian::state(*camera.measure(draws));
    if (first.size() == 0) first = z;
    EXPECT_LT((z - first).norm(), 0.02);  // errors of the mean: 0.5 m/√16000
  }
}

TEST(CameraSensor, ComparesWithAReferenceFromTheSamePose) {
  CameraSensor::Options how = options(40.0, Propagation::linearised);
  how.reference_draws = 8000;
  CameraSensor camera(how);
  Stream draws = draws_of(0), reference = draws_of(1);
  ASSERT_TRUE(camera.measure(draws));
  camera.compare(reference);
  EXPECT_EQ(camera.sums().compared, 1);
  EXPECT_GT(camera.sums().kl_nats, 0.0);
  EXPECT_LT(camera.sums().kl_nats, 0.02);
  EXPECT_LT(camera.sums().log_variance_ratio, 4 * std::sqrt(2.0 / 8000) + 0.01);
}

TEST(CameraSensor, PastTheHorizonALookIsAMissAndTellsNothing) {
  CameraSensor::Options how = options(1e6, Propagation::unscented);  // 2.3 minutes of arc below it
  how.reference_draws = 100;
  CameraSensor camera(how);
  for (std::uint64_t i = 0; i < 20; ++i) {
    Stream draws = draws_of(i), reference = draws_of(i);
    EXPECT_FALSE(camera.measure(draws));
    camera.compare(reference);
  }
  EXPECT_EQ(camera.sums().missed, 20);
  EXPECT_EQ(camera.sums().compared, 0);
  LookSums both = camera.sums();
  both += camera.sums();
  EXPECT_EQ(both.missed, 40);
}

TEST(CameraSensor, GoesWithItsAgentAndFollowsItsTarget) {
  CameraSensor moved(options(0.0, Propagation::unscented));
  moved.move_to({0.0, 0.0});
  moved.look_towards({30.0, 40.0});
  EXPECT_DOUBLE_EQ(moved.distance_m(), 50.0);
  CameraSensor::Options there = options(0.0, Propagation::unscented);
  there.sensor_m = {0.0, 0.0};
  there.target_m = {30.0, 40.0};
  CameraSensor built(there);
  Stream a = draws_of(3), b = draws_of(3);
  EXPECT_EQ(moved.measure(a)->xi, built.measure(b)->xi);
}

TEST(CameraSensor, OptionsBeyondTheirRangeAreRefused) {
  const auto bad = [](auto change) {
    CameraSensor::Options how = options(40.0, Propagation::unscented);
    change(how);
    EXPECT_THROW(CameraSensor{how}, BrokenInvariant);
  };
  bad([](auto& o) { o.altitude_m = 0.0; });
  bad([](auto& o) { o.noise.sigma_pixel = 0.0; });
  bad([](auto& o) { o.kappa = -8.0; });
  bad([](auto& o) { o.draws = 1; });
  bad([](auto& o) { o.reference_draws = CameraSensor::draws_max + 1; });
}

}  // namespace
}  // namespace hearsay
