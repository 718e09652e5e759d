// The sensors that an estimator may have. Each can move_to() a place, look_towards() a target, say
// its distance_m(), and measure(): information about the target's (x, y), or nothing.
#pragma once

#include <variant>

#include "agents/sensors/camera.hpp"
#include "agents/sensors/position.hpp"
#include "agents/sensors/range_bearing.hpp"

namespace hearsay {

using Sensor = std::variant<PositionSensor, RangeBearingSensor, CameraSensor>;

}  // namespace hearsay
