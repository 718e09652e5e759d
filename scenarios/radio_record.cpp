#include "scenarios/radio_record.hpp"

#include <string>

#include "scenarios/services.hpp"

namespace hearsay {
namespace {

void record_sender(Record& record, AgentId id, const SenderCounts& counts) {
  const auto scalar = [&](const std::string& name, double value) {
    record.scalar(id, record.name(name), value);
  };
  scalar("packets", static_cast<double>(counts.packets));
  scalar("bytes_sent", static_cast<double>(counts.bytes_sent));
  scalar("air_time_s", counts.air_time.seconds());
  scalar("queue_delay_mean_s", counts.queue_delay.seconds() / static_cast<double>(counts.begun));
  scalar("delivery_ratio",
         static_cast<double>(counts.fates[0]) / static_cast<double>(counts.expected));
  scalar("frames", static_cast<double>(counts.frames));
  scalar("acknowledgements", static_cast<double>(counts.acknowledgements));
  for (int f = 0; f < fate_count; ++f) {
    scalar(std::string("packets_") + to_string(static_cast<Fate>(f)),
           static_cast<double>(counts.fates[static_cast<std::size_t>(f)]));
  }
}

}  // namespace

void record_radio(Record& record, Radio& radio,
                  const std::vector<std::unique_ptr<Gossip>>& gossips) {
  for (std::size_t i = 0; i < gossips.size(); ++i) {
    const auto id = static_cast<AgentId>(i);
    record_sender(record, id, radio.counts(id));
    if (gossips[i]) record_gossip(record, id, gossips[i]->counts());
  }
  radio.visit_links([&](AgentId from, AgentId to, const FateCounts& counts) {
    for (int f = 0; f < fate_count; ++f) {
      const std::uint64_t packets = counts[static_cast<std::size_t>(f)];
      if (packets == 0) continue;
      record.link({from, to, record.name(to_string(static_cast<Fate>(f))), packets});
    }
  });
}

}  // namespace hearsay
