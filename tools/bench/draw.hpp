// Draws of the benchmarks of the queue and of processes: Philox4x32-10 and the C library's
// logarithm, cheap and the same on both sides, so that what is measured is what happens between.
#pragma once

#include <Random123/philox.h>

#include <cmath>
#include <cstdint>

namespace hearsay::bench {

/// The first two words of draw `count` of generator `who`, as numbers in (0, 1].
struct Draw {
  double first;
  double second;
};
inline Draw draw(std::uint64_t count, std::uint32_t who) {
  const auto word = r123::Philox4x32()(
      {{static_cast<std::uint32_t>(count), static_cast<std::uint32_t>(count >> 32)}}, {{1, who}});
  return {(word[0] + 1.0) * 0x1p-32, (word[1] + 1.0) * 0x1p-32};
}

/// Exponential with mean 1 s, in ns.
inline std::int64_t exponential_ns(std::uint64_t count, std::uint32_t who) {
  return static_cast<std::int64_t>(-std::log(draw(count, who).first) * 1e9);
}

}  // namespace hearsay::bench
