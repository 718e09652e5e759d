#include "agents/sensors/scan.hpp"

#include <algorithm>
#include <cmath>

#include "sim/kernel/error.hpp"
#include "sim/kernel/random.hpp"
#include "sim/math/functions.hpp"

namespace hearsay {

ScanSensor::ScanSensor(const Options& options) : options_(options) {
  require(options.sigma_along_m > 0.0 && options.sigma_across_m > 0.0 && options.range_max_m > 0.0,
          "ScanSensor: sigmas and range must be positive");
  require(options.detection_probability >= 0.0 && options.detection_probability <= 1.0,
          "ScanSensor: the detection probability must be 0 to 1");
  require(options.false_alarms_per_km2 == 0.0 ||
              (options.false_alarms_per_km2 > 0.0 && std::isfinite(options.range_max_m)),
          "ScanSensor: false alarms need a range");
}

double ScanSensor::false_alarms() const {
  if (options_.false_alarms_per_km2 == 0.0) return 0.0;
  const double range_km = 1e-3 * options_.range_max_m;
  return options_.false_alarms_per_km2 * math::pi * range_km * range_km;
}

gaussian::PositionMeasurement ScanSensor::plot(const Place& from_m, const Place& at_m,
                                               double along_m, double across_m) const {
  const double dx = at_m[0] - from_m[0], dy = at_m[1] - from_m[1];
  const double distance = std::sqrt(dx * dx + dy * dy);
  // Of what is just where the sensor stands it takes the line of sight along x.
  const double x = distance > 0.0 ? dx / distance : 1.0;
  const double y = distance > 0.0 ? dy / distance : 0.0;
  const double along = options_.sigma_along_m * options_.sigma_along_m;
  const double across = options_.sigma_across_m * options_.sigma_across_m;
  gaussian::PositionMeasurement plot{gaussian::Vector(2), gaussian::Matrix(2, 2)};
  plot.z << at_m[0] + along_m * x - across_m * y, at_m[1] + along_m * y + across_m * x;
  plot.S(0, 0) = along * x * x + across * y * y;
  plot.S(1, 1) = along * y * y + across * x * x;
  plot.S(0, 1) = plot.S(1, 0) = (along - across) * x * y;
  return plot;
}

std::vector<gaussian::PositionMeasurement> ScanSensor::scan(
    const std::array<double, 2>& place_m, std::span<const std::array<double, 2>> targets_m,
    std::uint64_t seed, AgentId agent, std::uint64_t count) const {
  std::vector<gaussian::PositionMeasurement> plots;
  for (std::size_t i = 0; i < targets_m.size(); ++i) {
    const Entity entity = Entity::sensor(agent, static_cast<std::uint32_t>(i));
    const double dx = targets_m[i][0] - place_m[0], dy = targets_m[i][1] - place_m[1];
    if (std::sqrt(dx * dx + dy * dy) > options_.range_max_m) continue;
    const double draw = Stream::uniform_at(seed, Purpose("detection"), entity, count);
    if (!(draw < options_.detection_probability)) continue;
    Stream noise = Stream::at(seed, Purpose("sensor noise"), entity, count);
    const double along_m = options_.sigma_along_m * noise.normal();
    const double across_m = options_.sigma_across_m * noise.normal();
    plots.push_back(plot(place_m, targets_m[i], along_m, across_m));
  }
  if (options_.false_alarms_per_km2 > 0.0) {
    Stream draws = Stream::at(seed, Purpose("false alarms"), Entity::agent(agent), count);
    for (std::uint64_t left = draws.poisson(false_alarms()); left > 0; --left) {
      const double radius_m = options_.range_max_m * std::sqrt(draws.uniform());
      const double angle_rad = draws.uniform(0.0, 2.0 * math::pi);
      const Place at_m{place_m[0] + radius_m * math::cos(angle_rad),
                       place_m[1] + radius_m * math::sin(angle_rad)};
      plots.push_back(plot(place_m, at_m, 0.0, 0.0));
    }
  }
  // The order of plots tells nothing about where they come from.
  std::sort(plots.begin(), plots.end(), [](const auto& a, const auto& b) {
    return a.z(0) < b.z(0) || (a.z(0) == b.z(0) && a.z(1) < b.z(1));
  });
  return plots;
}

}  // namespace hearsay
