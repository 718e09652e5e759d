// A sensor that measures range and bearing to a target, from a pose that its owner knows badly.
#pragma once

#include <array>
#include <optional>

#include "filters/gaussian/belief.hpp"
#include "sim/kernel/random.hpp"

namespace hearsay {

class RangeBearingSensor {
 public:
  struct Options {
    std::array<double, 2> sensor_m{};     ///< where it stands
    std::array<double, 2> target_m{};     ///< the truth
    gaussian::RangeBearingNoise noise{};  ///< of range and bearing > 0, of the pose ≥ 0
  };
  explicit RangeBearingSensor(const Options& options) : options_(options) {}

  // From elsewhere, or at something that is elsewhere now.
  void move_to(const std::array<double, 2>& sensor_m) { options_.sensor_m = sensor_m; }
  void look_towards(const std::array<double, 2>& target_m) { options_.target_m = target_m; }
  /// To the target.
  double distance_m() const;

  /// One sighting as information about (x, y), to first order at what was measured and is believed
  /// of the pose (range_bearing_to_position). That ellipse turns with the noise of the bearing:
  /// where it is much longer than wide, many of them together claim to know more than they do.
  /// Nothing if noise makes the range zero or less. Five normal draws: range, bearing, heading,
  /// position (2).
  std::optional<gaussian::Belief> measure(Stream& draws) const;

 private:
  Options options_;
};

}  // namespace hearsay
