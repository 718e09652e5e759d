// Store-and-forward: bundles that go from agent to agent, delivered once wherever they get.
//
// A bundle is never delivered twice. Which ones were seen is remembered for each source in a window
// of its last 512; a bundle from before the window is refused as late. Bundles whose lifetime has
// ended are refused by the time that they carry, and need not be remembered.
#include <algorithm>
#include <tuple>

#include "net/gossip_shelf.hpp"
#include "net/gossip_store.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

using gossip::Bundle;
using gossip::Seen;

// So many incarnations of an agent are told apart; then its oldest bundles are given up.
constexpr std::size_t incarnations_max = 16;

auto age_order(const Bundle& b) { return std::tuple(b.written, b.source(), b.sequence); }

class BundleStore final : public GossipStore {
 public:
  BundleStore(AgentId me, int agents, const GossipOptions& options)
      : me_(me), agents_(agents), options_(options) {}

  const char* item_kind() const override { return "bundle"; }
  const char* summary_kind() const override { return "bundles seen"; }
  std::size_t held() const override { return by_age_.size(); }

  std::uint32_t write(const Outgoing& packet, Time now) override;
  Heard hear(const Packet& frame, Time now) override;
  Sendable send(std::uint32_t place, Time now, std::vector<std::byte>& frame) override;
  void not_sent(std::uint32_t place) override { shelf_[place].sent.reset(); }
  std::uint64_t summarize(Time now, std::vector<std::byte>& frame) override;
  std::span<const std::uint32_t> missing_in(std::span<const std::byte> summary, Time now) override;
  void forget() override;

 private:
  bool over(const Bundle& bundle, Time now) const {
    return options_.lifetime && now - bundle.written > *options_.lifetime;
  }
  SeenWindow* window(std::uint64_t source);
  SeenWindow* window_or_new(const Bundle& bundle);
  std::vector<std::uint32_t>::iterator at_age(const Bundle& bundle);
  std::uint32_t keep(const Bundle& bundle, std::span<const std::byte> payload,
                     const RiderPtr& rider);
  std::uint32_t hear_again(const Bundle& bundle);
  void drop_expired(Time now);
  void drop_source(std::vector<Seen>::iterator source);

  AgentId me_;
  int agents_;
  GossipOptions options_;
  std::uint32_t incarnation_ = 0;
  std::uint32_t next_sequence_ = 0;
  gossip::Shelf<Bundle> shelf_;
  std::vector<std::uint32_t> by_age_;  // places, who was written first first
  std::vector<Seen> sources_;          // ascending
  gossip::SummaryCursor cursor_;
  gossip::Summary<Seen> summary_;       // of another, while it is looked at
  std::vector<std::uint32_t> missing_;  // in it
};

std::uint32_t BundleStore::write(const Outgoing& packet, Time now) {
  drop_expired(now);
  require(next_sequence_ != UINT32_MAX, "store-and-forward: an agent wrote 2^32 - 1 bundles");
  const Bundle bundle{.written = now,
                      .origin = me_,
                      .incarnation = incarnation_,
                      .sequence = next_sequence_++,
                      .addressee = packet.receiver,
                      .kind = packet.kind,
                      .hops_left = options_.hops_max};
  window_or_new(bundle)->mark(bundle.sequence);
  ++counts.written;
  return keep(bundle, packet.bytes, packet.rider);
}

GossipStore::Heard BundleStore::hear(const Packet& frame, Time now) {
  Bundle bundle;
  std::span<const std::byte> payload;
  const bool sound = gossip::decode(frame.bytes, bundle, payload) && bundle.origin < agents_ &&
                     bundle.addressee < agents_ && bundle.written <= now &&
                     (bundle.origin != me_ || bundle.incarnation <= incarnation_);
  if (!sound) {
    ++counts.malformed;
    return {};
  }
  drop_expired(now);
  SeenWindow* const seen = window_or_new(bundle);
  const auto place = seen ? seen->place(bundle.sequence) : SeenWindow::Place::behind;
  if (place == SeenWindow::Place::seen) {
    ++counts.known;
    return {.news = {}, .place = hear_again(bundle)};
  }
  if (over(bundle, now)) {
    ++counts.expired;
    if (seen) seen->give_up_before(bundle.sequence + 1);
    return {};
  }
  if (place == SeenWindow::Place::behind) {
    ++counts.late;
    return {};
  }
  seen->mark(bundle.sequence);
  Heard heard;
  if (bundle.addressee == no_agent || bundle.addressee == me_) {
    heard.news = Packet{bundle.origin, me_, bundle.kind, payload, bundle.written, frame.rider};
  }
  const std::uint32_t kept = keep(bundle, payload, RiderPtr(frame.rider));
  if (bundle.hops_left > 0) heard.place = kept;
  return heard;
}

// One that is held may have come a shorter way. @return its place if it can go on only now.
std::uint32_t BundleStore::hear_again(const Bundle& bundle) {
  const auto at = at_age(bundle);
  if (at == by_age_.end()) return nowhere;
  Bundle& held = shelf_[*at].header;
  if (held.source() != bundle.source() || held.sequence != bundle.sequence) return nowhere;
  const bool stuck = held.hops_left == 0;
  held.hops_left = std::max(held.hops_left, bundle.hops_left);
  return stuck && held.hops_left > 0 ? *at : nowhere;
}

std::vector<std::uint32_t>::iterator BundleStore::at_age(const Bundle& bundle) {
  return std::lower_bound(by_age_.begin(), by_age_.end(), age_order(bundle),
                          [this](std::uint32_t place, const auto& order) {
                            return age_order(shelf_[place].header) < order;
                          });
}

// A full buffer gives up who was written first, be it this one.
std::uint32_t BundleStore::keep(const Bundle& bundle, std::span<const std::byte> payload,
                                const RiderPtr& rider) {
  if (by_age_.size() >= options_.buffer_packets_max) {
    ++counts.dropped;
    const std::uint32_t oldest = by_age_.front();
    if (bundle.written < shelf_[oldest].header.written) return nowhere;
    shelf_.take_out(oldest);
    by_age_.erase(by_age_.begin());
  }
  const std::uint32_t place = shelf_.put(bundle, payload, rider);
  by_age_.insert(at_age(bundle), place);
  return place;
}

// Whatever its source wrote before has expired, too.
void BundleStore::drop_expired(Time now) {
  auto end = by_age_.begin();
  for (; end != by_age_.end() && over(shelf_[*end].header, now); ++end) {
    const Bundle& bundle = shelf_[*end].header;
    if (SeenWindow* const seen = window(bundle.source())) {
      seen->give_up_before(bundle.sequence + 1);
    }
    ++counts.expired;
    shelf_.take_out(*end);
  }
  by_age_.erase(by_age_.begin(), end);
}

SeenWindow* BundleStore::window(std::uint64_t source) {
  const auto at = std::lower_bound(sources_.begin(), sources_.end(), source,
                                   [](const Seen& s, std::uint64_t n) { return s.source < n; });
  return at != sources_.end() && at->source == source ? &at->window : nullptr;
}

// Null if the source's agent has lost its memory too often since.
SeenWindow* BundleStore::window_or_new(const Bundle& bundle) {
  if (SeenWindow* const known = window(bundle.source())) return known;
  const std::uint64_t first = bundle.source() - bundle.incarnation;
  const auto before = [](const Seen& s, std::uint64_t n) { return s.source < n; };
  auto oldest = std::lower_bound(sources_.begin(), sources_.end(), first, before);
  const auto end =
      std::lower_bound(oldest, sources_.end(), first + (std::uint64_t{1} << 32), before);
  if (static_cast<std::size_t>(end - oldest) >= incarnations_max) {
    if (bundle.source() < oldest->source) return nullptr;
    drop_source(oldest);
  }
  const auto at = std::lower_bound(sources_.begin(), sources_.end(), bundle.source(), before);
  return &sources_.insert(at, {.source = bundle.source(), .window = {}})->window;
}

void BundleStore::drop_source(std::vector<Seen>::iterator source) {
  std::erase_if(by_age_, [&](std::uint32_t place) {
    if (shelf_[place].header.source() != source->source) return false;
    ++counts.dropped;
    shelf_.take_out(place);
    return true;
  });
  sources_.erase(source);
}

GossipStore::Sendable BundleStore::send(std::uint32_t place, Time now,
                                        std::vector<std::byte>& frame) {
  auto& item = shelf_[place];
  item.sent = now;
  Bundle onward = item.header;
  --onward.hops_left;
  gossip::encode(onward, item.payload, frame);
  return {item.rider, item.serial};
}

std::uint64_t BundleStore::summarize(Time now, std::vector<std::byte>& frame) {
  drop_expired(now);
  const auto part = cursor_.next(std::span<const Seen>(sources_), options_.summary_bytes_max,
                                 [](const Seen& entry) { return entry.source; });
  gossip::encode(part.range, part.entries, frame);
  return part.range.first;
}

std::span<const std::uint32_t> BundleStore::missing_in(std::span<const std::byte> summary,
                                                       Time now) {
  missing_.reserve(std::min<std::size_t>(options_.answers_max, by_age_.size()));
  missing_.clear();
  if (!gossip::decode(summary, summary_)) {
    ++counts.malformed;
    return missing_;
  }
  drop_expired(now);
  const auto& entries = summary_.entries;
  const auto lacks = [&](const Bundle& bundle) {
    const std::uint64_t source = bundle.source();
    if (source < summary_.range.first || source > summary_.range.last) return false;
    const auto at = std::lower_bound(entries.begin(), entries.end(), source,
                                     [](const Seen& s, std::uint64_t n) { return s.source < n; });
    return at == entries.end() || at->source != source ||
           at->window.place(bundle.sequence) == SeenWindow::Place::fresh;
  };
  for (const std::uint32_t place : by_age_) {
    if (missing_.size() == options_.answers_max) break;
    const auto& item = shelf_[place];
    if (item.header.hops_left == 0 || !lacks(item.header)) continue;
    if (gossip::rested(item, now, options_.summary_period)) missing_.push_back(place);
  }
  return missing_;
}

void BundleStore::forget() {
  for (const std::uint32_t place : by_age_) shelf_.take_out(place);
  by_age_.clear();
  sources_.clear();
  cursor_ = {};
  ++incarnation_;
  next_sequence_ = 0;
}

}  // namespace

std::unique_ptr<GossipStore> make_bundle_store(AgentId me, int agents,
                                               const GossipOptions& options) {
  return std::make_unique<BundleStore>(me, agents, options);
}

}  // namespace hearsay
