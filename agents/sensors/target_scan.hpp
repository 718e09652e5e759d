// What a scanning sensor gives its agent, and the sensor as it stands in the world: it knows the
// truth; the agent gets plots alone.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "agents/context.hpp"
#include "agents/sensors/scan.hpp"
#include "agents/target_truth.hpp"
#include "filters/tracking/tracker.hpp"

namespace hearsay {

struct Plots {
  std::vector<gaussian::PositionMeasurement> plots;  ///< from west to east
  tracking::Coverage coverage;
};

class PlotSource {
 public:
  virtual ~PlotSource() = default;
  /// The `count`-th scan, now, in place of what `out` held.
  virtual void scan(std::uint64_t count, Plots& out) = 0;
};

/// Of the agent of a context, from where it is.
class TargetScan final : public PlotSource {
 public:
  /// `context` and `targets` outlive this.
  TargetScan(Context& context, const ScanSensor::Options& sensor,
             std::span<const TargetTruth> targets);

  void scan(std::uint64_t count, Plots& out) override;

 private:
  Context& context_;
  ScanSensor sensor_;
  std::span<const TargetTruth> targets_;
  std::vector<std::array<double, 2>> targets_m_;
};

}  // namespace hearsay
