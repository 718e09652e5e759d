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
  const double whole = std::floor(size);
  const double rest = (size - whole) * 1e9;
  const double down = std::floor(rest);
  const std::int64_t ns = static_cast<std::int64_t>(whole) * 1'000'000'000 +
                          static_cast<std::int64_t>(down) + (rest - down >= 0.5 ? 1 : 0);
  return Duration(s < 0 ? -ns : ns);
}

}  // namespace hearsay
