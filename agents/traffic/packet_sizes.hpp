// Sizes of the packets of a source, in bytes.
#pragma once

#include <cstdint>

#include "sim/kernel/random.hpp"

namespace hearsay {

class PacketSizes {
 public:
  enum class Law : std::uint8_t {
    fixed,
    /// Exponential, rounded up to whole bytes: geometric on 1, 2, …, with the very mean.
    exponential,
  };
  /// `mean_bytes` ≥ 1.
  PacketSizes(Law law, std::uint32_t mean_bytes);

  /// Takes one draw, or none where all are the same. At least 1, at most largest().
  std::uint32_t draw(Stream& draws) const;
  std::uint64_t largest() const;

 private:
  Law law_;
  std::uint32_t mean_bytes_;
  double rate_ = 0.0;  // of the exponential that is rounded up, a byte
};

}  // namespace hearsay
