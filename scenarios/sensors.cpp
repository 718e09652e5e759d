#include "scenarios/sensors.hpp"

#include <string>

#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

/// Where agent and target stand. Of what moves, or is drawn anew in each run, and so is looked up
/// when it is looked at: any place with a line of sight.
struct Site {
  std::array<double, 2> sensor_m, target_m;
};

Site site_of(const AgentSpec& spec, const TargetSpec& target,
             const std::optional<std::array<double, 2>>& place) {
  Site site{place.value_or(std::array{0.0, 0.0}), {}};
  site.target_m = {site.sensor_m[0] + 1.0, site.sensor_m[1]};
  if (!target.motion && target.position_m) {
    site.target_m = {target.position_m->at(0), target.position_m->at(1)};
  }
  if (spec.motion) site.sensor_m = {site.target_m[0] - 1.0, site.target_m[1]};
  return site;
}

PositionSensor position_sensor(const SensorSpec& sensor, const TargetSpec& target,
                               const Site& site) {
  const double along = sensor.sigma_m.value_or(sensor.sigma_along_m.value_or(1.0));
  const double across = sensor.sigma_m.value_or(sensor.sigma_across_m.value_or(1.0));
  if (along != across && site.sensor_m == site.target_m) {
    throw InputError("agent at the place of target '" + target.name +
                     "' has no line of sight to it; move it or give sensor.sigma_m");
  }
  return PositionSensor({.sensor_m = site.sensor_m,
                         .target_m = site.target_m,
                         .sigma_along_m = along,
                         .sigma_across_m = across});
}

CameraSensor camera_sensor(const AgentSpec& spec, const Site& site) {
  const SensorSpec& sensor = spec.sensor;
  CameraSensor::Options camera;
  camera.sensor_m = site.sensor_m;
  camera.target_m = site.target_m;
  camera.altitude_m = spec.motion->altitude_m;
  camera.lens = {.focal_u = sensor.focal_px[0],
                 .focal_v = sensor.focal_px[1],
                 .center_u = sensor.center_px[0],
                 .center_v = sensor.center_px[1]};
  camera.noise = {.sigma_position_m = sensor.sigma_position_m,
                  .sigma_attitude_rad = sensor.sigma_attitude_rad,
                  .sigma_pixel = sensor.sigma_pixel};
  camera.propagation = sensor.propagation == "linearised" ? CameraSensor::Propagation::linearised
                       : sensor.propagation == "monte-carlo"
                           ? CameraSensor::Propagation::monte_carlo
                           : CameraSensor::Propagation::unscented;
  if (sensor.kappa) camera.kappa = *sensor.kappa;
  camera.draws = sensor.draws;
  camera.reference_draws = sensor.reference_draws.value_or(0);
  return CameraSensor(camera);
}

}  // namespace

gaussian::RangeBearingNoise range_bearing_noise_of(const SensorSpec& spec) {
  return {.sigma_range_m = spec.sigma_range_m,
          .sigma_bearing_rad = spec.sigma_bearing_rad,
          .sigma_heading_rad = spec.sigma_heading_rad,
          .sigma_position_m = spec.sigma_position_m};
}

std::vector<Sensor> sensors_of(const AgentSpec& spec, const WorldSpec& world,
                               const std::optional<std::array<double, 2>>& place) {
  const std::string& kind = spec.sensor.kind;
  std::vector<Sensor> sensors;
  if (kind != "position" && kind != "camera" && kind != "range-bearing") return sensors;
  for (const TargetSpec& target : world.targets) {
    const Site site = site_of(spec, target, place);
    if (kind == "position") sensors.emplace_back(position_sensor(spec.sensor, target, site));
    if (kind == "camera") sensors.emplace_back(camera_sensor(spec, site));
    if (kind == "range-bearing") {
      sensors.emplace_back(RangeBearingSensor({.sensor_m = site.sensor_m,
                                               .target_m = site.target_m,
                                               .noise = range_bearing_noise_of(spec.sensor)}));
    }
  }
  return sensors;
}

}  // namespace hearsay
