// A camera that looks down at targets on level ground, from a pose that its owner knows badly.
// Merino 2007, section 3.7.1.
//
// It hangs on a gimbal that keeps the target in the middle of its image. What is believed of
// position and attitude is off by noise; so is the pixel. From what is believed, and not from the
// truth, the target's position and its covariance are computed, and that is the measurement.
#pragma once

#include <array>
#include <optional>

#include "filters/gaussian/geolocation.hpp"
#include "sim/kernel/random.hpp"

namespace hearsay {

/// What an agent's cameras did in a run; sums over looks.
struct LookSums {
  int looks = 0;
  int missed = 0;                   ///< rays past the ground; what came out was no Gaussian
  double variance_along_m2 = 0.0;   ///< claimed, along the line of sight in the plane …
  double variance_across_m2 = 0.0;  ///< … and across it; of looks that did not miss
  int compared = 0;                 ///< looks with a reference
  double kl_nats = 0.0;             ///< D(reference ‖ claimed)
  double log_variance_ratio = 0.0;  ///< |log(claimed/reference variance along)|
  LookSums& operator+=(const LookSums& other);
};

class CameraSensor {
 public:
  /// How the uncertainty of pose and pixel becomes one of the ground position.
  enum class Propagation { unscented, linearised, monte_carlo };
  struct Options {
    std::array<double, 2> sensor_m{};  ///< where it hangs …
    double altitude_m = 40.0;          ///< … and how high over the ground, > 0
    std::array<double, 2> target_m{};  ///< the truth, on the ground
    gaussian::Intrinsics lens = gaussian::infrared_camera;
    gaussian::LookNoise noise;  ///< sigma_pixel > 0
    Propagation propagation = Propagation::unscented;
    double kappa = gaussian::usual_kappa(gaussian::look_dimension);  ///< > −8
    int draws = 1000;         ///< of "monte_carlo", 2 … draws_max
    int reference_draws = 0;  ///< of a reference for each look, 2 … draws_max; 0: none
  };
  static constexpr int draws_max = 16000;  ///< 8 numbers each, of a Stream's 131,072
  /// @throws BrokenInvariant for options beyond their range.
  explicit CameraSensor(const Options& options);

  // From elsewhere, or at something that is elsewhere now.
  void move_to(const std::array<double, 2>& sensor_m) { options_.sensor_m = sensor_m; }
  void look_towards(const std::array<double, 2>& target_m) { options_.target_m = target_m; }
  /// To the target, in the plane.
  double distance_m() const;

  /// One look as information about (x, y). Nothing if it missed. Noise is drawn first: position
  /// (3), attitude (3), pixel (2); then what "monte_carlo" needs.
  std::optional<gaussian::Belief> measure(Stream& draws);

  bool compares() const { return options_.reference_draws > 0; }
  /// Compares what the last look claims with a Monte Carlo estimate from the same pose and pixel.
  void compare(Stream& reference);

  const LookSums& sums() const { return sums_; }

 private:
  std::optional<gaussian::Look> look(Stream& draws) const;
  std::optional<gaussian::Moments> claimed(const gaussian::Look& look, Stream& draws) const;
  /// A covariance's variance along the line of sight, and across it.
  std::array<double, 2> by_sight(const gaussian::Matrix& covariance) const;

  Options options_;
  struct Last {
    gaussian::Look look;
    gaussian::Moments ground;
  };
  std::optional<Last> last_;  // unless it missed
  LookSums sums_;
};

}  // namespace hearsay
