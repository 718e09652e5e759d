#include "agents/sensors/position.hpp"

#include <cmath>

#include "sim/kernel/error.hpp"

namespace hearsay {

PositionSensor::PositionSensor(const Options& options) : options_(options) {
  const double a = options.sigma_along_m * options.sigma_along_m;
  const double c = options.sigma_across_m * options.sigma_across_m;
  if (a != c) {
    const double dx = options.target_m[0] - options.sensor_m[0];
    const double dy = options.target_m[1] - options.sensor_m[1];
    const double distance = std::sqrt(dx * dx + dy * dy);
    require(distance > 0.0, "a sensor with a line of sight stands on its target");
    along_ = {dx / distance, dy / distance};
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

PositionSensor PositionSensor::moved_to(const std::array<double, 2>& sensor_m) const {
  Options options = options_;
  options.sensor_m = sensor_m;
  if (sensor_m == options.target_m) options.sensor_m[0] -= 1.0;
  return PositionSensor(options);
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
