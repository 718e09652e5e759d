// What a scenario says about robots that localize themselves.
#pragma once

#include <optional>
#include <string>

namespace hearsay {

struct LocalizerSpec {
  std::string fusion = "none";  ///< a name of gaussian::rules() that weighs and needs no memory
  std::optional<int> landmarks_known;    ///< the first of the log, 0 … 1e6; none: all
  double start_sigma_m = 0.05;           ///< an axis, 1e-6 … 1e6
  double start_sigma_rad = 0.02;         ///< > 0
  double forward_m_per_sqrt_s = 0.02;    ///< noise of the odometry, ≥ 0
  double sideways_m_per_sqrt_s = 0.005;  ///< ≥ 0
  double turn_rad_per_sqrt_s = 0.05;     ///< > 0
  double gate = 13.8;                    ///< of squared distances, > 0
  double companion_speed_m_per_s = 0.1;  ///< ≥ 0
  double memory_s = 60.0;                ///< > 0, up to an hour
  bool operator==(const LocalizerSpec&) const = default;
};

}  // namespace hearsay
