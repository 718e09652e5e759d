#include "scenarios/network.hpp"

#include <limits>

#include "scenarios/channel.hpp"

namespace hearsay {

namespace {

AccessOptions access_options(const SharingSpec& spec, const AcknowledgementSpec& acknowledgement,
                             double rate_bps) {
  AccessOptions options;
  if (spec.model == "none") return options;
  options.sharing = spec.model == "slotted-aloha"   ? Sharing::slotted_aloha
                    : spec.model == "carrier-sense" ? Sharing::carrier_sense
                                                    : Sharing::tdma;
  options.slot = Duration::seconds(spec.slot_s);
  options.send_probability = spec.send_probability;
  options.slots = spec.slots;
  options.interframe = Duration::seconds(spec.interframe_s);
  options.interframe_garbled =
      Duration::seconds(acknowledgement.interframe_s + 8.0 * acknowledgement.bytes / rate_bps);
  options.window_min = spec.window_min;
  options.window_max = spec.window_max;
  return options;
}

QueueOptions queue_options(const RadioSpec& spec) {
  QueueOptions options;
  options.packets_max = static_cast<std::uint32_t>(spec.queue_packets_max);
  if (spec.queue_bytes_max) options.bytes_max = static_cast<std::uint64_t>(*spec.queue_bytes_max);
  if (spec.queue_policy == "drop-oldest") options.policy = QueuePolicy::drop_oldest;
  if (spec.queue_policy == "replace") options.policy = QueuePolicy::replace;
  if (spec.queue_wait_max_s) options.wait_max = Duration::seconds(*spec.queue_wait_max_s);
  return options;
}

JitterOptions jitter_options(const JitterSpec& spec) {
  using Law = JitterOptions::Law;
  return {.law = spec.law == "uniform"       ? Law::uniform
                 : spec.law == "exponential" ? Law::exponential
                                             : Law::none,
          .spread = Duration::seconds(spec.spread_s),
          .reordering = spec.order == "reordering"};
}

}  // namespace

RadioOptions radio_options(const Scenario& scenario) {
  const RadioSpec& spec = scenario.radio;
  const double infinity = std::numeric_limits<double>::infinity();
  const bool shared = spec.sharing.model != "none";
  RadioOptions options;
  options.rate_bps = spec.rate_bps;
  options.count_links = scenario.record.links == "on";
  options.header_bytes = static_cast<std::uint32_t>(spec.header_bytes);
  if (spec.mtu_bytes) options.mtu_bytes = static_cast<std::uint32_t>(*spec.mtu_bytes);
  options.queue = queue_options(spec);
  options.half_duplex = spec.half_duplex.value_or(shared ? "on" : "off") == "on";
  options.access = access_options(spec.sharing, spec.acknowledgement, spec.rate_bps);
  options.capture_db = spec.sharing.capture_db.value_or(infinity);
  options.latency = Duration::seconds(spec.latency_s);
  options.jitter = jitter_options(spec.jitter);
  options.loss = loss_of(spec.loss);
  options.propagation = propagation_of(spec);
  for (const JammerSpec& jammer : spec.jammers) options.jammers.push_back(jammer_of(jammer));
  options.propagation_m_per_s = spec.propagation_m_per_s.value_or(infinity);
  options.acknowledgement = {.bytes = static_cast<std::uint32_t>(spec.acknowledgement.bytes),
                             .interframe = Duration::seconds(spec.acknowledgement.interframe_s),
                             .attempts_max = spec.acknowledgement.attempts_max};
  return options;
}

}  // namespace hearsay
