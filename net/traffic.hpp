// What became of all packets: counts a sender and a link, and the proof that nothing is missing.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "net/packet.hpp"
#include "net/transmission.hpp"
#include "sim/kernel/record.hpp"

namespace hearsay {

using FateCounts = std::array<std::uint64_t, fate_count>;

/// Sums over a run, for one sender. What most packets change comes first, in a line of the cache.
struct alignas(64) SenderCounts {
  std::uint64_t packets = 0;     ///< handed to the radio
  std::uint64_t begun = 0;       ///< packets of which sending began
  std::uint64_t frames = 0;      ///< frames of which sending began, repeated ones too
  std::uint64_t bytes_sent = 0;  ///< of these frames, with headers, and of acknowledgements
  std::uint64_t expected = 0;    ///< potential receivers of all packets, summed
  Duration air_time;             ///< time the transmitter was busy
  FateCounts fates{};
  Duration queue_delay;                ///< from hand-over to the first bit, summed over `begun`
  std::uint64_t acknowledgements = 0;  ///< sent for others
};

/// @throws BrokenInvariant, naming agent and numbers, unless the fates add up to what was expected.
void require_balance(AgentId sender, const SenderCounts& counts);

class Traffic {
 public:
  /// `record` outlives this.
  Traffic(Record& record, int agents, bool count_links);

  /// The fate of a packet at one of its hearers; `row` has all but receiver and fate. Nothing is
  /// counted for no_link. (In line wherever it is called: the row need not go through memory.)
  [[gnu::always_inline]] void settle(MessageRow& row, const Ear& ear, Fate fate) {
    const auto f = static_cast<std::size_t>(fate);
    row.receiver = ear.agent;
    row.fate = fate_names_[f];
    record_.message(row);
    ++senders_[static_cast<std::size_t>(row.sender)].fates[f];
    if (count_links_ && ear.link != no_link) count(ear.link, f);
  }
  SenderCounts& sender(AgentId agent) { return senders_[static_cast<std::size_t>(agent)]; }
  const SenderCounts& sender(AgentId agent) const {
    return senders_[static_cast<std::size_t>(agent)];
  }
  /// By number of the link; empty unless links are counted.
  const std::vector<FateCounts>& links() const { return links_; }

 private:
  void count(std::uint32_t link, std::size_t fate);
  Record& record_;
  std::array<NameId, fate_count> fate_names_{};
  std::vector<SenderCounts> senders_;
  std::vector<FateCounts> links_;
  bool count_links_;
};

}  // namespace hearsay
