#include "agents/sensors/camera.hpp"

#include <cmath>

#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"

namespace hearsay {
namespace {

constexpr gaussian::Plane ground;

}  // namespace

LookSums& LookSums::operator+=(const LookSums& other) {
  looks += other.looks;
  missed += other.missed;
  variance_along_m2 += other.variance_along_m2;
  variance_across_m2 += other.variance_across_m2;
  compared += other.compared;
  kl_nats += other.kl_nats;
  log_variance_ratio += other.log_variance_ratio;
  return *this;
}

CameraSensor::CameraSensor(const Options& options) : options_(options) {
  const auto in_range = [](int draws) { return draws >= 2 && draws <= draws_max; };
  require(options.altitude_m > 0.0 && options.noise.sigma_pixel > 0.0,
          "a camera hangs over the ground and has pixels that are uncertain");
  require(options.kappa > -gaussian::look_dimension, "a camera's κ must be greater than −8");
  require(in_range(options.draws) &&
              (options.reference_draws == 0 || in_range(options.reference_draws)),
          "a camera's draws are 2 to 16000");
}

double CameraSensor::distance_m() const {
  return math::hypot(options_.target_m[0] - options_.sensor_m[0],
                     options_.target_m[1] - options_.sensor_m[1]);
}

std::optional<gaussian::Look> CameraSensor::look(Stream& draws) const {
  const gaussian::Vector3 place(options_.sensor_m[0], options_.sensor_m[1], options_.altitude_m);
  const auto truth = gaussian::looking_at(place, {options_.target_m[0], options_.target_m[1], 0.0});
  if (!truth) return std::nullopt;
  double noise[gaussian::look_dimension];
  for (double& n : noise) n = draws.normal();
  const gaussian::LookNoise& sigma = options_.noise;
  const double turn = sigma.sigma_attitude_rad, shift = sigma.sigma_position_m;
  gaussian::CameraPose believed =
      truth->turned({turn * noise[3], turn * noise[4], turn * noise[5]});
  believed.position_m += shift * gaussian::Vector3(noise[0], noise[1], noise[2]);
  gaussian::Vector pixel(2);
  pixel << options_.lens.center_u + sigma.sigma_pixel * noise[6],
      options_.lens.center_v + sigma.sigma_pixel * noise[7];
  return gaussian::Look{options_.lens, believed, pixel, gaussian::look_covariance(sigma)};
}

std::optional<gaussian::Moments> CameraSensor::claimed(const gaussian::Look& look,
                                                       Stream& draws) const {
  switch (options_.propagation) {
    case Propagation::linearised:
      return gaussian::geolocate_linearised(look, ground);
    case Propagation::monte_carlo:
      return gaussian::geolocate_sampled(look, ground, options_.draws,
                                         [&] { return draws.normal(); })
          .y;
    case Propagation::unscented:
      break;
  }
  return gaussian::geolocate_unscented(look, ground, options_.kappa);
}

std::array<double, 2> CameraSensor::by_sight(const gaussian::Matrix& covariance) const {
  const double distance = distance_m();
  const double x = distance > 0.0 ? (options_.target_m[0] - options_.sensor_m[0]) / distance : 1.0;
  const double y = distance > 0.0 ? (options_.target_m[1] - options_.sensor_m[1]) / distance : 0.0;
  const double xx = covariance(0, 0), xy = covariance(0, 1), yy = covariance(1, 1);
  return {x * x * xx + 2.0 * x * y * xy + y * y * yy, y * y * xx - 2.0 * x * y * xy + x * x * yy};
}

std::optional<gaussian::Belief> CameraSensor::measure(Stream& draws) {
  ++sums_.looks;
  last_.reset();
  if (const auto seen = look(draws)) {
    const auto moments = claimed(*seen, draws);
    if (moments && gaussian::log_determinant(moments->covariance)) last_ = Last{*seen, *moments};
  }
  if (!last_) {
    ++sums_.missed;
    return std::nullopt;
  }
  const auto [along, across] = by_sight(last_->ground.covariance);
  sums_.variance_along_m2 += along;
  sums_.variance_across_m2 += across;
  return gaussian::Belief::from_moments(last_->ground.mean, last_->ground.covariance);
}

void CameraSensor::compare(Stream& reference) {
  if (!last_) return;
  const auto sampled = gaussian::geolocate_sampled(last_->look, ground, options_.reference_draws,
                                                   [&] { return reference.normal(); });
  if (!sampled.y || !gaussian::log_determinant(sampled.y->covariance)) return;
  const auto kl = gaussian::kl_divergence_nats(
      gaussian::Belief::from_moments(sampled.y->mean, sampled.y->covariance),
      gaussian::Belief::from_moments(last_->ground.mean, last_->ground.covariance));
  if (!kl) return;
  ++sums_.compared;
  sums_.kl_nats += *kl;
  sums_.log_variance_ratio += std::fabs(
      math::log(by_sight(last_->ground.covariance)[0] / by_sight(sampled.y->covariance)[0]));
}

}  // namespace hearsay
