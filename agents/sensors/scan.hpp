// A sensor that sees whatever is within its range, now and then not, and things that are not there.
// It does not know which plot belongs to what.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "filters/gaussian/belief.hpp"
#include "sim/kernel/ids.hpp"

namespace hearsay {

class ScanSensor {
 public:
  struct Options {
    double sigma_along_m = 1.0;   ///< noise of a position along the line of sight, > 0
    double sigma_across_m = 1.0;  ///< … and across it, > 0
    double range_max_m = std::numeric_limits<double>::infinity();  ///< > 0
    double detection_probability = 1.0;  ///< of a target within range, 0 … 1
    /// Mean number of false alarms in a scan, for each square kilometre within range; they are
    /// uniform there and Poisson in number. Above 0 only with a range, ≥ 0.
    double false_alarms_per_km2 = 0.0;
  };
  /// @throws BrokenInvariant outside these ranges.
  explicit ScanSensor(const Options& options);

  /// The `count`-th scan of `agent`, from `place_m`: plots from west to east. Every target has
  /// draws of its own, so what becomes of one changes nothing for another.
  std::vector<gaussian::PositionMeasurement> scan(const std::array<double, 2>& place_m,
                                                  std::span<const std::array<double, 2>> targets_m,
                                                  std::uint64_t seed, AgentId agent,
                                                  std::uint64_t count) const;

  const Options& options() const { return options_; }
  /// False if it is the same wherever it stands.
  bool has_place() const {
    return options_.range_max_m < std::numeric_limits<double>::infinity() ||
           options_.sigma_along_m != options_.sigma_across_m;
  }
  /// Mean number of false alarms in a scan.
  double false_alarms() const;

 private:
  using Place = std::array<double, 2>;
  /// What is said of something at `at_m`, off by so much along the line of sight and across it.
  gaussian::PositionMeasurement plot(const Place& from_m, const Place& at_m, double along_m,
                                     double across_m) const;
  Options options_;
};

}  // namespace hearsay
