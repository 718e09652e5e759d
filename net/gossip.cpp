#include "net/gossip.hpp"

#include <string>
#include <utility>

#include "sim/kernel/error.hpp"

namespace hearsay {

void check(const GossipOptions& options) {
  const auto expect = [](bool sound, const char* why) {
    if (!sound) throw InputError(std::string("gossip: ") + why);
  };
  expect(options.summary_period > Duration(), "summary_period must be above 0 s");
  expect(options.summary_bytes_max >= 128, "summary_bytes_max must be at least 128");
  expect(options.answers_max >= 1, "answers_max must be at least 1");
  expect(options.buffer_packets_max >= 1, "buffer_packets_max must be at least 1");
  expect(options.hops_max >= 1, "hops_max must be 1 to 255");
  expect(!options.lifetime || *options.lifetime > Duration(), "lifetime must be above 0 s");
}

static_assert(gossip::range_bytes + gossip::entry_bytes_max <= 128);

Gossip::Gossip(Simulation& simulation, Radio& radio, AgentId me, std::unique_ptr<GossipStore> store,
               const GossipOptions& options)
    : simulation_(simulation),
      radio_(radio),
      me_(me),
      store_(std::move(store)),
      period_(options.summary_period),
      item_kind_(simulation.record().name(store_->item_kind())),
      summary_kind_(simulation.record().name(store_->summary_kind())) {
  check(options);
  frame_.reserve(options.summary_bytes_max);
  radio_.attach(me, *this);
}

Gossip::~Gossip() { simulation_.cancel(next_); }

void Gossip::start() {
  Stream draws = simulation_.stream(Purpose("gossip phase"), Entity::agent(me_));
  const auto phase = draws.below(static_cast<std::uint64_t>(period_.nanoseconds()));
  await(Time::at(Duration::nanoseconds(static_cast<std::int64_t>(phase))));
}

void Gossip::await(Time time) {
  next_ = simulation_.schedule(time, Phase::act, [this] { say_what_is_held(); });
}

void Gossip::say_what_is_held() {
  simulation_.acting_for(me_);
  const Time now = simulation_.now();
  if (radio_.up(me_)) {
    const std::uint64_t part = store_->summarize(now, frame_);
    const bool sent = radio_.send(me_, {.kind = summary_kind_, .bytes = frame_, .subject = part});
    if (sent) ++store_->counts.summaries;
  }
  next_ = EventId();
  const Time then = simulation_.after(period_);
  if (then <= simulation_.end()) await(then);
}

bool Gossip::write(const Outgoing& packet) {
  if (!radio_.up(me_)) return false;
  const std::uint32_t place = store_->write(packet, simulation_.now());
  if (place == GossipStore::nowhere) return false;
  send(place);
  return true;
}

// What finds no room in the radio's queue is held all the same, to be sent in answer to a summary.
void Gossip::send(std::uint32_t place) {
  const GossipStore::Sendable item = store_->send(place, simulation_.now(), frame_);
  const bool sent = radio_.send(
      me_, {.kind = item_kind_, .bytes = frame_, .rider = item.rider, .subject = item.subject});
  if (sent) {
    ++store_->counts.sent;
  } else {
    store_->not_sent(place);
  }
}

void Gossip::on_packet(const Packet& packet) {
  if (packet.kind == item_kind_) {
    hear(packet);
  } else if (packet.kind == summary_kind_) {
    answer(packet);
  } else if (up_) {
    up_->on_packet(packet);
  }
}

void Gossip::on_outcome(const Packet& packet, bool acknowledged) {
  if (up_) up_->on_outcome(packet, acknowledged);
}

void Gossip::hear(const Packet& packet) {
  const GossipStore::Heard heard = store_->hear(packet, simulation_.now());
  if (heard.place != GossipStore::nowhere) send(heard.place);
  if (!heard.news) return;
  GossipCounts& counts = store_->counts;
  ++counts.delivered;
  counts.delay += simulation_.now() - heard.news->sent;
  if (up_) up_->on_packet(*heard.news);
}

void Gossip::answer(const Packet& packet) {
  for (const std::uint32_t place : store_->missing_in(packet.bytes, simulation_.now())) {
    send(place);
  }
}

}  // namespace hearsay
