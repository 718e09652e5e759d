#include "scenarios/network.hpp"

#include <limits>

namespace hearsay {

RadioOptions radio_options(const RadioSpec& spec) {
  return {.rate_bps = spec.rate_bps,
          .header_bytes = static_cast<std::uint32_t>(spec.header_bytes),
          .queue_packets_max = static_cast<std::uint32_t>(spec.queue_packets_max),
          .latency = Duration::seconds(spec.latency_s),
          .loss_probability = spec.loss.model == "bernoulli" ? spec.loss.probability : 0.0,
          .propagation_m_per_s =
              spec.propagation_m_per_s.value_or(std::numeric_limits<double>::infinity())};
}

}  // namespace hearsay
