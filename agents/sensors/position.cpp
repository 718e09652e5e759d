#include "agents/sensors/position.hpp"

#include <cmath>

#include "sim/kernel/error.hpp"

namespace hearsay {

PositionSensor::PositionSensor(const Options& options) : options_(options) {
  require(!has_direction() || options.sensor_m != options.target_m,
          "a sensor with a line of sight stands on its target");
  aim();
}

void PositionSensor::aim() {
  const double a = options_.sigma_along_m * options_.sigma_along_m;
  const double c = options_.sigma_across_m * options_.sigma_across_m;
  const double distance = distance_m();
  along_ = {1.0, 0.0};
  if (has_direction() && distance > 0.0) {
    along_ = {(options_.target_m[0] - options_.sensor_m[0]) / distance,
              (options_.target_m[1] - options_.sensor_m[1]) / distance};
  }
  // S = a·ddᵀ + c·(I − ddᵀ) along the unit vector d; its inverse has 1/a and 1/c in their place.
  const auto fill = [this](double along, double across) {
    gaussian::Matrix m(2, 2);
    const double x = along_[0], y = along_[1];
    m(0, 0) = along * x * x + across * y * y;
    m(1, 1) = along * y * y + across * x * x;
    m(0, 1) = m(1, 0) = (along - across) * x * y;
    return m;
  };
  S_ = fill(a, c);
  information_ = fill(1.0 / a, 1.0 / c);
}

void PositionSensor::move_to(const std::array<double, 2>& sensor_m) {
  options_.sensor_m = sensor_m;
  if (has_direction()) aim();
}

void PositionSensor::look_towards(const std::array<double, 2>& target_m) {
  options_.target_m = target_m;
  if (has_direction()) aim();
}

double PositionSensor::distance_m() const {
  const double dx = options_.target_m[0] - options_.sensor_m[0];
  const double dy = options_.target_m[1] - options_.sensor_m[1];
  return std::sqrt(dx * dx + dy * dy);
}

gaussian::Belief PositionSensor::measure(Stream& draws) const {
  const double along = options_.sigma_along_m * draws.normal();
  const double across = options_.sigma_across_m * draws.normal();
  gaussian::Vector z(2);
  z(0) = options_.target_m[0] + along * along_[0] - across * along_[1];
  z(1) = options_.target_m[1] + along * along_[1] + across * along_[0];
  gaussian::Belief information = gaussian::Belief::unknown(2);
  information.omega = information_;
  information.xi = information_.lazyProduct(z);
  return information;
}

}  // namespace hearsay
