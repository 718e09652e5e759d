#include "scenarios/traffic.hpp"

#include "agents/source_agent.hpp"

namespace hearsay {

PacketSizes packet_sizes(const TrafficSpec& spec) {
  const auto law =
      spec.sizes == "exponential" ? PacketSizes::Law::exponential : PacketSizes::Law::fixed;
  return {law, static_cast<std::uint32_t>(spec.bytes)};
}

SourceTraffic traffic_of(const TrafficSpec& spec, AgentId agent, std::uint64_t seed) {
  using Arrivals = SourceTraffic::Arrivals;
  SourceTraffic traffic;
  traffic.arrivals = spec.arrivals == "periodic"  ? Arrivals::periodic
                     : spec.arrivals == "poisson" ? Arrivals::poisson
                                                  : Arrivals::saturated;
  traffic.period = Duration::seconds(spec.period_s.value_or(0.0));
  if (spec.phase_s) {
    traffic.phase = Duration::seconds(*spec.phase_s);
  } else if (traffic.arrivals == Arrivals::periodic) {
    const auto period = static_cast<std::uint64_t>(traffic.period.nanoseconds());
    Stream draws(seed, Purpose("traffic phase"), Entity::agent(agent));
    traffic.phase = Duration::nanoseconds(static_cast<std::int64_t>(draws.below(period)));
  }
  if (spec.packets_max) traffic.packets_max = static_cast<std::uint64_t>(*spec.packets_max);
  traffic.sizes = packet_sizes(spec);
  if (spec.receiver) traffic.receiver = static_cast<AgentId>(spec.receiver->number);
  traffic.acknowledged = spec.service == "acknowledged";
  return traffic;
}

}  // namespace hearsay
