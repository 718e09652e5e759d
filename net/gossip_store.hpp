// What an agent holds of what the fleet writes, and what it makes of a frame it hears: the part in
// which store-and-forward and the blackboard differ.
//
// Bundles (store-and-forward) are all different: each is delivered once wherever it gets. A slot
// (blackboard) has one content: a later version takes the place of an earlier one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "net/gossip_frame.hpp"
#include "net/packet.hpp"
#include "sim/kernel/time.hpp"

namespace hearsay {

struct GossipOptions {
  /// > 0: an agent says so often what it holds. The first time is drawn (purpose "gossip phase").
  Duration summary_period = Duration::nanoseconds(1'000'000'000);
  std::uint32_t summary_bytes_max = 1024;  ///< ≥ 128; what does not fit is in the next summary
  std::uint32_t answers_max = 16;          ///< items sent in answer to one summary, ≥ 1
  std::uint32_t buffer_packets_max = 256;  ///< bundles or slots that an agent holds, ≥ 1
  std::uint8_t hops_max = 255;             ///< bundles: from agent to agent at most so often, ≥ 1
  std::optional<Duration> lifetime;        ///< bundles: > 0, then they are of no use any more
};
/// @throws InputError for an option outside its range; the message names it.
void check(const GossipOptions& options);

/// Sums over a run, for one agent.
struct GossipCounts {
  std::uint64_t written = 0;    ///< bundles, or versions of slots, that it wrote
  std::uint64_t delivered = 0;  ///< that were new to it and meant for it
  std::uint64_t known = 0;      ///< heard again
  std::uint64_t late = 0;       ///< versions older than its own; bundles too far behind to tell
  std::uint64_t expired = 0;    ///< bundles whose lifetime ended, held or on their way here
  std::uint64_t dropped = 0;    ///< bundles that made room for others; slots there was no room for
  std::uint64_t replaced = 0;   ///< versions that a later one from elsewhere took the place of
  std::uint64_t sent = 0;       ///< frames with an item: its own, passed on or in answer
  std::uint64_t summaries = 0;  ///< frames with a summary
  std::uint64_t malformed = 0;  ///< frames that could not be read
  Duration delay;               ///< from writing to delivery, summed over `delivered`
};

class GossipStore {
 public:
  static constexpr std::uint32_t nowhere = UINT32_MAX;
  /// What there is to do about an item that was heard. Its parts are valid as long as the frame.
  struct Heard {
    std::optional<Packet> news;     ///< to be handed up
    std::uint32_t place = nowhere;  ///< of what is to be passed on
  };
  /// How an item goes over the air.
  struct Sendable {
    RiderPtr rider;
    std::uint64_t subject;  ///< for queues that replace
  };

  virtual ~GossipStore() = default;
  /// Kinds of the frames with items and with summaries.
  virtual const char* item_kind() const = 0;
  virtual const char* summary_kind() const = 0;

  /// Takes what the agent itself says. @return its place; nowhere: there is no room.
  virtual std::uint32_t write(const Outgoing& packet, Time now) = 0;
  /// Takes an item from another agent.
  virtual Heard hear(const Packet& frame, Time now) = 0;
  /// Writes what is held there as a frame, as if sent now.
  virtual Sendable send(std::uint32_t place, Time now, std::vector<std::byte>& frame) = 0;
  /// Tells that what was written last by send() was not taken by the radio.
  virtual void not_sent(std::uint32_t place) = 0;
  /// Writes a summary of what is held. @return a number of the part of which it speaks.
  virtual std::uint64_t summarize(Time now, std::vector<std::byte>& frame) = 0;
  /// Finds what is held and missing in another's summary, at most `answers_max`, without what was
  /// sent less than a summary period ago.
  virtual std::span<const std::uint32_t> missing_in(std::span<const std::byte> summary,
                                                    Time now) = 0;
  /// Loses all; what is written from now on is new.
  virtual void forget() = 0;
  /// Bundles or slots held now.
  virtual std::size_t held() const = 0;

  GossipCounts counts;
};

/// Bundles of agent `me`, one of `agents`.
std::unique_ptr<GossipStore> make_bundle_store(AgentId me, int agents,
                                               const GossipOptions& options);
std::unique_ptr<GossipStore> make_slot_store(AgentId me, int agents, const GossipOptions& options);

}  // namespace hearsay
