// A sensor that measures a target's position in the plane, with different noise along and across
// the line of sight.
#pragma once

#include <array>

#include "filters/gaussian/belief.hpp"
#include "sim/kernel/random.hpp"

namespace hearsay {

class PositionSensor {
 public:
  struct Options {
    std::array<double, 2> sensor_m{};  ///< where it stands
    std::array<double, 2> target_m{};  ///< the truth
    double sigma_along_m = 1.0;        ///< along the line of sight, > 0
    double sigma_across_m = 1.0;       ///< across it, > 0; equal sigmas need no line of sight
  };
  /// @throws BrokenInvariant if the sigmas differ and the sensor stands on the target.
  explicit PositionSensor(const Options& options);

  /// One measurement as information (z = x + v, v ~ N(0, S); eq. 3.34–3.35 with M = I), from two
  /// normal draws of `draws`.
  gaussian::Belief measure(Stream& draws) const;
  /// True if the noise depends on the line of sight.
  bool has_direction() const { return options_.sigma_along_m != options_.sigma_across_m; }

  // From elsewhere, or at something that is elsewhere now. Just on the target, where there is no
  // line of sight, it looks along x.
  void move_to(const std::array<double, 2>& sensor_m);
  void look_towards(const std::array<double, 2>& target_m);

  /// To the target.
  double distance_m() const;

  /// S (2×2), m².
  const gaussian::Matrix& covariance() const { return S_; }

 private:
  void aim();
  Options options_;
  std::array<double, 2> along_{1.0, 0.0};  // unit vector of the line of sight
  gaussian::Matrix S_;
  gaussian::Matrix information_;  // S⁻¹
};

}  // namespace hearsay
