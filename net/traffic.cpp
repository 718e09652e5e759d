#include "net/traffic.hpp"

#include <bit>
#include <string>

#include "sim/kernel/error.hpp"

namespace hearsay {

Traffic::Traffic(Record& record, int agents, bool count_links)
    : record_(record), senders_(static_cast<std::size_t>(agents)), count_links_(count_links) {
  for (int fate = 0; fate < fate_count; ++fate) {
    fate_names_[static_cast<std::size_t>(fate)] = record_.name(to_string(static_cast<Fate>(fate)));
  }
}

void Traffic::count(std::uint32_t link, std::size_t fate) {
  if (links_.size() <= link) links_.resize(std::bit_ceil(std::size_t{link} + 1));
  ++links_[link][fate];
}

void require_balance(AgentId sender, const SenderCounts& counts) {
  std::uint64_t settled = 0;
  for (const std::uint64_t fates : counts.fates) settled += fates;
  if (settled == counts.expected) return;
  throw BrokenInvariant("radio: agent " + std::to_string(sender) + " sent " +
                        std::to_string(counts.packets) + " packets to " +
                        std::to_string(counts.expected) + " potential receivers, but " +
                        std::to_string(settled) + " fates are known");
}

}  // namespace hearsay
