// The sensors that an estimator may have, one kind or another.
#pragma once

#include <array>
#include <optional>
#include <variant>

#include "agents/sensors/camera.hpp"
#include "agents/sensors/position.hpp"
#include "agents/sensors/range_bearing.hpp"

namespace hearsay {

using Sensor = std::variant<PositionSensor, RangeBearingSensor, CameraSensor>;

// From elsewhere, or at something that is elsewhere now.
inline void move_to(Sensor& sensor, const std::array<double, 2>& sensor_m) {
  std::visit([&](auto& kind) { kind.move_to(sensor_m); }, sensor);
}
inline void look_towards(Sensor& sensor, const std::array<double, 2>& target_m) {
  std::visit([&](auto& kind) { kind.look_towards(target_m); }, sensor);
}
/// To the target, in the plane.
inline double distance_m(const Sensor& sensor) {
  return std::visit([](const auto& kind) { return kind.distance_m(); }, sensor);
}
/// True if what it measures depends on where it is.
inline bool has_direction(const Sensor& sensor) {
  const PositionSensor* const position = std::get_if<PositionSensor>(&sensor);
  return position == nullptr || position->has_direction();
}
/// Information about the target's (x, y); nothing if the look missed it.
inline std::optional<gaussian::Belief> measure(Sensor& sensor, Stream& draws) {
  return std::visit(
      [&](auto& kind) -> std::optional<gaussian::Belief> { return kind.measure(draws); }, sensor);
}

}  // namespace hearsay
