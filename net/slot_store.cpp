// The blackboard: slots of which everybody holds a copy; the last version wins.
#include <algorithm>

#include "net/gossip_shelf.hpp"
#include "net/gossip_store.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

using gossip::Slot;
using gossip::Version;

class SlotStore final : public GossipStore {
 public:
  SlotStore(AgentId me, int agents, const GossipOptions& options)
      : me_(me), agents_(agents), options_(options) {}

  const char* item_kind() const override { return "slot"; }
  const char* summary_kind() const override { return "slots held"; }
  std::size_t held() const override { return by_key_.size(); }

  std::uint32_t write(const Outgoing& packet, Time now) override;
  Heard hear(const Packet& frame, Time now) override;
  Sendable send(std::uint32_t place, Time now, std::vector<std::byte>& frame) override;
  void not_sent(std::uint32_t place) override { shelf_[place].sent.reset(); }
  std::uint64_t summarize(Time now, std::vector<std::byte>& frame) override;
  std::span<const std::uint32_t> missing_in(std::span<const std::byte> summary, Time now) override;
  void forget() override;

 private:
  std::vector<std::uint32_t>::iterator at_key(std::uint64_t key);
  bool is(std::vector<std::uint32_t>::iterator at, std::uint64_t key) const {
    return at != by_key_.end() && shelf_[*at].header.key == key;
  }
  std::uint32_t put(std::vector<std::uint32_t>::iterator at, const Slot& slot,
                    std::span<const std::byte> payload, RiderPtr rider);

  AgentId me_;
  int agents_;
  GossipOptions options_;
  gossip::Shelf<Slot> shelf_;
  std::vector<std::uint32_t> by_key_;  // places, ascending
  gossip::SummaryCursor cursor_;
  std::vector<Slot> listed_;            // for a summary
  gossip::Summary<Slot> summary_;       // of another, while it is looked at
  std::vector<std::uint32_t> missing_;  // in it
};

std::vector<std::uint32_t>::iterator SlotStore::at_key(std::uint64_t key) {
  return std::lower_bound(
      by_key_.begin(), by_key_.end(), key,
      [this](std::uint32_t place, std::uint64_t k) { return shelf_[place].header.key < k; });
}

// Versions are told apart by time, not by a count: who has lost its memory has lost the count, and
// what it wrote anew would be taken for old. A writer never stays behind what it has seen.
std::uint32_t SlotStore::write(const Outgoing& packet, Time now) {
  require(packet.receiver == no_agent, "blackboard: a slot is for everybody");
  require(packet.subject < gossip::subjects_max, "blackboard: a subject must be below 2^48");
  const std::uint64_t key = Slot::key_of(packet.kind, packet.subject);
  const auto at = at_key(key);
  Version version{.written = now, .writer = me_};
  if (is(at, key)) {
    const Time last = shelf_[*at].header.version.written;
    version.written = std::max(now, last + Duration::nanoseconds(1));
  }
  const std::uint32_t place = put(at, {key, version}, packet.bytes, packet.rider);
  if (place != nowhere) ++counts.written;
  return place;
}

GossipStore::Heard SlotStore::hear(const Packet& frame, Time) {
  Slot slot;
  std::span<const std::byte> payload;
  if (!gossip::decode(frame.bytes, slot, payload) || slot.version.writer >= agents_) {
    ++counts.malformed;
    return {};
  }
  const auto at = at_key(slot.key);
  if (is(at, slot.key)) {
    const Version& held = shelf_[*at].header.version;
    if (slot.version <= held) {
      ++(slot.version == held ? counts.known : counts.late);
      return {};
    }
    ++counts.replaced;
  }
  const std::uint32_t place = put(at, slot, payload, RiderPtr(frame.rider));
  if (place == nowhere) return {};
  return {.news = Packet{slot.version.writer, frame.receiver, slot.kind(), payload,
                         slot.version.written, frame.rider},
          .place = place};
}

std::uint32_t SlotStore::put(std::vector<std::uint32_t>::iterator at, const Slot& slot,
                             std::span<const std::byte> payload, RiderPtr rider) {
  if (is(at, slot.key)) {
    shelf_.fill(*at, slot, payload, std::move(rider));
    return *at;
  }
  if (by_key_.size() >= options_.buffer_packets_max) {
    ++counts.dropped;
    return nowhere;
  }
  const std::uint32_t place = shelf_.put(slot, payload, std::move(rider));
  by_key_.insert(at, place);
  return place;
}

GossipStore::Sendable SlotStore::send(std::uint32_t place, Time now,
                                      std::vector<std::byte>& frame) {
  auto& item = shelf_[place];
  item.sent = now;
  gossip::encode(item.header, item.payload, frame);
  return {item.rider, item.header.key};
}

std::uint64_t SlotStore::summarize(Time, std::vector<std::byte>& frame) {
  listed_.clear();
  for (const std::uint32_t place : by_key_) listed_.push_back(shelf_[place].header);
  const auto part = cursor_.next(std::span<const Slot>(listed_), options_.summary_bytes_max,
                                 [](const Slot& slot) { return slot.key; });
  gossip::encode(part.range, part.entries, frame);
  return part.range.first;
}

std::span<const std::uint32_t> SlotStore::missing_in(std::span<const std::byte> summary, Time now) {
  missing_.reserve(std::min<std::size_t>(options_.answers_max, by_key_.size()));
  missing_.clear();
  if (!gossip::decode(summary, summary_)) {
    ++counts.malformed;
    return missing_;
  }
  auto entry = summary_.entries.begin();
  for (const std::uint32_t place : by_key_) {
    if (missing_.size() == options_.answers_max) break;
    const auto& item = shelf_[place];
    const std::uint64_t key = item.header.key;
    if (key < summary_.range.first || key > summary_.range.last) continue;
    while (entry != summary_.entries.end() && entry->key < key) ++entry;
    const bool named = entry != summary_.entries.end() && entry->key == key;
    if (named && entry->version >= item.header.version) continue;
    if (gossip::rested(item, now, options_.summary_period)) missing_.push_back(place);
  }
  return missing_;
}

void SlotStore::forget() {
  for (const std::uint32_t place : by_key_) shelf_.take_out(place);
  by_key_.clear();
  cursor_ = {};
}

}  // namespace

std::unique_ptr<GossipStore> make_slot_store(AgentId me, int agents, const GossipOptions& options) {
  return std::make_unique<SlotStore>(me, agents, options);
}

}  // namespace hearsay
