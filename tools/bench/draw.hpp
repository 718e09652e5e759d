// Draws of the benchmarks of the queue and of processes: Philox4x32-10 and the C library's
// logarithm, cheap and the same on both sides, so that what is measured is what happens between.
#pragma once

#include <Random123/philox.h>

#include <cmath>
#include <cstdint>

namespace hearsay::bench {

/// Two numbers in (0, 1] from block `count` of generator `who`.
struct Pair {
  double first;
  double second;
};
inline Pair draw(std::uint64_t count, std::uint32_t who) {
  const auto word = r123::Philox4x32()(
      {{static_cast<std::uint32_t>(count), static_cast<std::uint32_t>(count >> 32)}}, {{1, who}});
  const auto number = [](std::uint32_t high, std::uint32_t low) {
    return (static_cast<double>(((std::uint64_t{high} << 32) | low) >> 11) + 1.0) * 0x1p-53;
  };
  return {number(word[0], word[1]), number(word[2], word[3])};
}

/// Exponential with mean 1 s, in ns, from a number in (0, 1].
inline std::int64_t exponential_ns(double uniform) {
  return static_cast<std::int64_t>(-std::log(uniform) * 1e9);
}

/// One number after the other, two of each block.
class Draws {
 public:
  double next() {
    left_ = !left_;
    if (!left_) return pair_.second;
    pair_ = draw(count_++, 0);
    return pair_.first;
  }

 private:
  std::uint64_t count_ = 0;
  Pair pair_{};
  bool left_ = false;
};

}  // namespace hearsay::bench
