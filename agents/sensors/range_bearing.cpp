#include "agents/sensors/range_bearing.hpp"

#include "sim/math/functions.hpp"

namespace hearsay {

double RangeBearingSensor::distance_m() const {
  return math::hypot(options_.target_m[0] - options_.sensor_m[0],
                     options_.target_m[1] - options_.sensor_m[1]);
}

std::optional<gaussian::Belief> RangeBearingSensor::measure(Stream& draws) const {
  const gaussian::RangeBearingNoise& noise = options_.noise;
  const double dx = options_.target_m[0] - options_.sensor_m[0];
  const double dy = options_.target_m[1] - options_.sensor_m[1];
  const double range_m = math::hypot(dx, dy) + noise.sigma_range_m * draws.normal();
  const double bearing_rad = (dx == 0.0 && dy == 0.0 ? 0.0 : math::atan2(dy, dx)) +
                             noise.sigma_bearing_rad * draws.normal();
  gaussian::Pose believed{};  // its true heading is along x
  believed.heading_rad = noise.sigma_heading_rad * draws.normal();
  believed.x_m = options_.sensor_m[0] + noise.sigma_position_m * draws.normal();
  believed.y_m = options_.sensor_m[1] + noise.sigma_position_m * draws.normal();
  if (!(range_m > 0.0)) return std::nullopt;
  const gaussian::PositionMeasurement measured =
      gaussian::range_bearing_to_position(believed, range_m, bearing_rad, noise);
  return gaussian::measurement_information(gaussian::Matrix::Identity(2, 2), measured.S,
                                           measured.z);
}

}  // namespace hearsay
