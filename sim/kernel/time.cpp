#include "sim/kernel/time.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

namespace hearsay {

Duration Duration::seconds(double s) {
  const double size = std::fabs(s);
  if (!(size <= 9e9)) {
    throw std::out_of_range("a span of " + std::to_string(s) +
                            " s is not within ±9e9 s and cannot be simulated");
  }
  // Whole and fraction apart, so that the product with 1e9 rounds at most the last nanosecond.
  const auto whole = static_cast<std::int64_t>(size);
  const double rest = (size - static_cast<double>(whole)) * 1e9;
  const auto down = static_cast<std::int64_t>(rest);
  const std::int64_t ns =
      whole * 1'000'000'000 + down + (rest - static_cast<double>(down) >= 0.5 ? 1 : 0);
  return Duration(s < 0 ? -ns : ns);
}

}  // namespace hearsay
