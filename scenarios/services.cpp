#include "scenarios/services.hpp"

#include <algorithm>
#include <utility>

namespace hearsay {

static_assert(gossip_header_bytes == std::max(gossip::bundle_bytes, gossip::slot_bytes));

namespace {

GossipOptions gossip_options(const GossipSpec& spec) {
  GossipOptions options{.summary_period = Duration::seconds(spec.summary_period_s),
                        .summary_bytes_max = static_cast<std::uint32_t>(spec.summary_bytes_max),
                        .answers_max = static_cast<std::uint32_t>(spec.answers_max),
                        .buffer_packets_max = static_cast<std::uint32_t>(spec.buffer_packets_max),
                        .hops_max = static_cast<std::uint8_t>(spec.hops_max),
                        .lifetime = {}};
  if (spec.lifetime_s) options.lifetime = Duration::seconds(*spec.lifetime_s);
  return options;
}

}  // namespace

std::unique_ptr<Gossip> make_gossip(const Scenario& scenario, const AgentSpec& spec, AgentId id,
                                    Simulation& simulation, Radio& radio) {
  if (!is_gossip(spec.talk.service)) return nullptr;
  const GossipOptions options = gossip_options(scenario.radio.gossip);
  const int agents = scenario.agent_count();
  auto store = spec.talk.service == "blackboard" ? make_slot_store(id, agents, options)
                                                 : make_bundle_store(id, agents, options);
  return std::make_unique<Gossip>(simulation, radio, id, std::move(store), options);
}

void record_gossip(Record& record, AgentId id, const GossipCounts& counts) {
  const auto scalar = [&](const char* name, double value) {
    record.scalar(id, record.name(name), value);
  };
  const auto count = [&](const char* name, std::uint64_t value) {
    scalar(name, static_cast<double>(value));
  };
  count("gossip_written", counts.written);
  count("gossip_delivered", counts.delivered);
  scalar("gossip_delay_mean_s", counts.delay.seconds() / static_cast<double>(counts.delivered));
  count("gossip_duplicates", counts.known);
  count("gossip_late", counts.late);
  count("gossip_expired", counts.expired);
  count("gossip_dropped", counts.dropped);
  count("gossip_replaced", counts.replaced);
  count("gossip_sent", counts.sent);
  count("gossip_summaries", counts.summaries);
  count("gossip_malformed", counts.malformed);
}

}  // namespace hearsay
