#include "agents/traffic/packet_sizes.hpp"

#include <algorithm>

#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"

namespace hearsay {
namespace {

// No draw of an exponential is above 53 ln 2 = 36.7 times its mean: uniforms are multiples of
// 2^-53.
constexpr std::uint64_t means_max = 37;

}  // namespace

PacketSizes::PacketSizes(Law law, std::uint32_t mean_bytes) : law_(law), mean_bytes_(mean_bytes) {
  require(mean_bytes >= 1, "a packet needs a byte");
  if (mean_bytes == 1) law_ = Law::fixed;  // the geometric law with mean 1
  // P(size > k) = (1 − 1/mean)^k.
  if (law_ == Law::exponential) rate_ = -math::log1p(-1.0 / mean_bytes);
}

std::uint32_t PacketSizes::draw(Stream& draws) const {
  if (law_ == Law::fixed) return mean_bytes_;
  const auto size = static_cast<std::uint64_t>(draws.exponential(rate_)) + 1;
  return static_cast<std::uint32_t>(std::min(size, largest()));
}

std::uint64_t PacketSizes::largest() const {
  return law_ == Law::fixed ? mean_bytes_ : means_max * mean_bytes_;
}

}  // namespace hearsay
