// How packets leave: from the queue to the air.
#include "net/radio.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay {

// Something waits: sees to it that its turn comes.
void Radio::wake(AgentId sender) {
  Station& from = station(sender);
  if (from.held) return;  // whoever lets go looks at the queue
  if (access_) {
    if (!from.asked) ask(sender, 0);
    return;
  }
  if (from.next != EventId() || from.free_at == Time::never()) return;
  from.next = simulation_.schedule(std::max(simulation_.now(), from.free_at), Phase::update,
                                   [this, sender] { take_next(sender); });
}

void Radio::take_next(AgentId sender) {
  Station& from = station(sender);
  from.next = EventId();
  drop_expired(sender);
  if (from.waiting.empty()) return;
  if (!from.sends(simulation_.now())) begin(from.waiting.pop());
  if (!from.waiting.empty()) wake(sender);
}

void Radio::ask(AgentId sender, int repetition) {
  station(sender).asked = true;
  access_->request(sender, repetition);
}

void Radio::granted(AgentId sender) {
  Station& from = station(sender);
  from.asked = false;
  if (from.held) return begin_frames(from.on_air);
  drop_expired(sender);
  if (!from.waiting.empty()) begin(from.waiting.pop());
}

void Radio::drop_expired(AgentId sender) {
  if (!options_.queue.wait_max) return;
  SendQueue& waiting = station(sender).waiting;
  while (!waiting.empty() &&
         simulation_.now() - slots_[waiting[0]].sent > *options_.queue.wait_max) {
    settle_rest(waiting.pop(), Fate::expired);
  }
}

void Radio::begin(std::uint32_t slot) {
  Transmission& t = slots_[slot];
  Station& from = station(t.sender);
  if (!t.aimed) aim(t, true);
  SenderCounts& counts = traffic_.sender(t.sender);
  ++counts.begun;
  counts.queue_delay += simulation_.now() - t.sent;
  from.on_air = slot;
  from.held = receptions_ || t.acknowledged;
  begin_frames(slot);
}

// Sends a frame; all of the packet's in a row if nobody need ask for the air.
void Radio::begin_frames(std::uint32_t slot) {
  Transmission& t = slots_[slot];
  const Time now = simulation_.now();
  if (t.frames_sent == 0) t.start = now;
  std::uint64_t payload = t.bytes.size();
  std::uint32_t frames = t.frames;
  if (access_ && t.frames > 1) {
    frames = 1;
    const std::uint64_t mtu = *options_.mtu_bytes;
    payload = t.frames_sent + 1 < t.frames ? mtu : payload - (t.frames - 1) * mtu;
  }
  const std::uint64_t bytes = payload + std::uint64_t{frames} * options_.header_bytes;
  t.frames_sent += frames;
  t.end = later(now, air_time(bytes));
  station(t.sender).free_at = t.end;
  SenderCounts& counts = traffic_.sender(t.sender);
  counts.frames += frames;
  counts.bytes_sent += bytes;
  counts.air_time += t.end - now;
  if (!receptions_) {
    channel_.launch(t);
    return schedule(slot);
  }
  if (t.receiver == no_agent) {
    receptions_->begin_sending(t.sender);
    for (std::size_t i = 0; i < t.route.size; ++i) {
      receptions_->begin(t.route.hearer(i), t.fates[i], channel_.power_dbm(t, i));
    }
  } else {
    put_on_air(t, t.sender, t.receiver, t.fates[0]);
  }
  if (t.end == Time::never()) return;
  t.event = simulation_.schedule(t.end, Phase::update, [this, slot] { end_frames(slot); });
}

void Radio::end_frames(std::uint32_t slot) {
  Transmission& t = slots_[slot];
  const AgentId sender = t.sender;
  t.event = EventId();
  if (t.receiver == no_agent) {
    for (std::size_t i = 0; i < t.route.size; ++i) {
      receptions_->end(t.route.hearer(i), t.fates[i]);
    }
    receptions_->end_sending(sender);
  } else {
    take_off_air(t, sender, t.receiver, t.fates[0]);
  }
  if (t.frames_sent < t.frames && station(sender).up) return ask(sender, t.repetition);
  channel_.launch(t);
  schedule(slot);
  if (!t.acknowledged) let_go(sender);
}

// A frame for one is heard by all in range of `from`.
void Radio::put_on_air(Transmission& t, AgentId from, AgentId to, Fate& fate) {
  const std::span<const AgentId> hearers = channel_.neighbours(from);
  t.overhearers.assign(hearers.begin(), hearers.end());
  t.overheard.assign(hearers.size(), Fate::delivered);
  receptions_->begin_sending(from);
  for (std::size_t i = 0; i < t.overhearers.size(); ++i) {
    const AgentId hearer = t.overhearers[i];
    receptions_->begin(hearer, hearer == to ? fate : t.overheard[i],
                       channel_.power_dbm(from, hearer));
  }
}

void Radio::take_off_air(Transmission& t, AgentId from, AgentId to, const Fate& fate) {
  for (std::size_t i = 0; i < t.overhearers.size(); ++i) {
    const AgentId hearer = t.overhearers[i];
    receptions_->end(hearer, hearer == to ? fate : t.overheard[i]);
  }
  receptions_->end_sending(from);
}

void Radio::let_go(AgentId sender) {
  station(sender).held = false;
  if (!station(sender).waiting.empty()) wake(sender);
}

// What an agent was sending when it failed. A frame on the air still fills it to its end.
void Radio::spoil_sending(AgentId sender) {
  Station& from = station(sender);
  if (!from.sends(simulation_.now())) return;
  const std::uint32_t slot = from.on_air;
  Transmission& t = slots_[slot];
  for (std::size_t i = t.settled; i < t.route.size; ++i) worsen(t.fates[i], Fate::sender_down);
  if (!from.asked) return;
  from.asked = false;
  if (t.acknowledged) return conclude(slot, false);
  settle_rest(slot, Fate::sender_down);
  let_go(sender);
}

}  // namespace hearsay
