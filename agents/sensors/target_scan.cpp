#include "agents/sensors/target_scan.hpp"

#include <limits>

namespace hearsay {

TargetScan::TargetScan(Context& context, const ScanSensor::Options& sensor,
                       std::span<const TargetTruth> targets)
    : context_(context), sensor_(sensor), targets_(targets) {}

void TargetScan::scan(std::uint64_t count, Plots& out) {
  std::array<double, 2> place_m{0.0, 0.0};
  out.coverage.centre.resize(0);
  out.coverage.range = std::numeric_limits<double>::infinity();
  if (sensor_.has_place()) {
    const Point here = context_.position();
    place_m = {here[0], here[1]};
    out.coverage.centre.resize(2);
    out.coverage.centre << place_m[0], place_m[1];
    out.coverage.range = sensor_.options().range_max_m;
  }
  targets_m_.clear();
  for (const TargetTruth& target : targets_) targets_m_.push_back(target.at(context_.now()));
  out.plots = sensor_.scan(place_m, targets_m_, context_.simulation().seed(), context_.id(), count);
}

}  // namespace hearsay
