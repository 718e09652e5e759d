// Where a target is, for sensors and for those who judge.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "sim/kernel/time.hpp"

namespace hearsay {

struct TargetTruth {
  std::string name;
  /// x, y in m, a row a stamp: at 0, period, 2·period, …; one that stands still has a single row.
  std::vector<std::array<double, 2>> positions_m;
  Duration period;  ///< > 0 if there is more than one row

  /// Between stamps on the straight line; beyond the last one it stands there.
  std::array<double, 2> at(Time time) const {
    if (positions_m.size() == 1) return positions_m.front();
    const std::int64_t now = time.nanoseconds(), step = period.nanoseconds();
    const auto k = static_cast<std::size_t>(now / step);
    if (k + 1 >= positions_m.size()) return positions_m.back();
    const double part = static_cast<double>(now % step) / static_cast<double>(step);
    const auto& a = positions_m[k];
    const auto& b = positions_m[k + 1];
    return {a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1])};
  }
};

}  // namespace hearsay
