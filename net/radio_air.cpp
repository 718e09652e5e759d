// How packets leave: from the queue to the air.
#include <algorithm>
#include <utility>

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
  Time time = std::max(simulation_.now(), from.free_at);
  if (receptions_) time = std::max(time, receptions_->sends_until(sender));
  from.next = simulation_.schedule(time, Phase::update, [this, sender] { take_next(sender); });
}

void Radio::take_next(AgentId sender) {
  Station& from = station(sender);
  from.next = EventId();
  drop_expired(sender);
  if (!from.waiting.empty() && !busy(sender, simulation_.now())) begin(from.waiting.pop());
  if (!from.waiting.empty()) wake(sender);
  tell_if_empty(sender);
}

void Radio::tell_if_empty(AgentId sender) {
  const Station& from = station(sender);
  if (!from.tells || !from.waiting.empty()) return;
  Receiver* const receiver = receivers_[static_cast<std::size_t>(sender)];
  if (!receiver) return;
  simulation_.acting_for(sender);
  receiver->on_queue_empty();
}

void Radio::ask(AgentId sender, int repetition) {
  station(sender).asked = true;
  access_->request(sender, repetition, receptions_->sends_until(sender));
}

void Radio::granted(AgentId sender) {
  Station& from = station(sender);
  if (receptions_->sends_until(sender) > simulation_.now()) {  // an acknowledgement came between
    return ask(sender, from.held ? slots_[from.on_air].repetition : 0);
  }
  from.asked = false;
  if (from.held) return begin_frames(from.on_air);
  drop_expired(sender);
  if (!from.waiting.empty()) begin(from.waiting.pop());
  tell_if_empty(sender);
}

void Radio::drop_expired(AgentId sender) {
  if (!options_.queue.wait_max) return;
  SendQueue& waiting = station(sender).waiting;
  const auto expired = [&](std::uint32_t slot) {
    return simulation_.now() - slots_[slot].sent > *options_.queue.wait_max;
  };
  if (options_.queue.policy == QueuePolicy::replace) {  // the first need not be the oldest
    return waiting.take_out([&](std::uint32_t slot) {
      const bool goes = expired(slot);
      if (goes) settle_rest(slot, Fate::expired);
      return goes;
    });
  }
  while (!waiting.empty() && expired(waiting[0])) settle_rest(waiting.pop(), Fate::expired);
}

void Radio::begin(std::uint32_t slot) {
  Transmission& t = slots_[slot];
  Station& from = station(t.sender);
  if (!t.aimed) aim(t, true);
  SenderCounts& counts = traffic_.sender(t.sender);
  ++counts.begun;
  if (simulation_.now() > t.sent) counts.queue_delay += simulation_.now() - t.sent;
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
    put_broadcast_on_air(t);
  } else {
    put_on_air(t, t.sender, t.receiver, t.fates[0], t.end);
  }
  if (t.end == Time::never()) return;
  t.event = simulation_.schedule(t.end, Phase::update, [this, slot] { end_frames(slot); });
}

void Radio::end_frames(std::uint32_t slot) {
  Transmission& t = slots_[slot];
  const AgentId sender = t.sender;
  t.event = EventId();
  if (t.receiver == no_agent) {
    take_broadcast_off_air(t);
  } else {
    take_off_air(t, sender, t.receiver, t.fates[0]);
  }
  if (t.frames_sent < t.frames && !t.cut) return ask(sender, t.repetition);
  channel_.launch(t);
  schedule(slot);
  if (!t.acknowledged) let_go(sender);
}

// Where links come and go, a frame is not on the air where its link is down: `overheard` keeps who
// that is.
void Radio::put_broadcast_on_air(Transmission& t) {
  const OnAir span{simulation_.now(), t.end};
  const bool some_down = channel_.links_change();
  if (some_down) t.overheard.assign(t.route.size, Fate::out_of_range);
  receptions_->begin_sending(t.sender, span);
  for (std::size_t i = 0; i < t.route.size; ++i) {
    if (some_down) {
      if (!channel_.link_up(t, i)) continue;
      t.overheard[i] = Fate::delivered;
    }
    receptions_->begin(t.route.hearer(i), t.fates[i], channel_.power_dbm(t, i), span);
  }
}

void Radio::take_broadcast_off_air(Transmission& t) {
  const bool some_down = channel_.links_change();
  for (std::size_t i = 0; i < t.route.size; ++i) {
    if (some_down && t.overheard[i] == Fate::out_of_range) continue;
    receptions_->end(t.route.hearer(i), t.fates[i]);
  }
  receptions_->end_sending(t.sender);
}

// A frame for one is heard by all in range of `from`.
void Radio::put_on_air(Transmission& t, AgentId from, AgentId to, Fate& fate, Time end) {
  const OnAir span{simulation_.now(), end};
  const std::span<const AgentId> hearers = channel_.neighbours(from);
  t.overhearers.assign(hearers.begin(), hearers.end());
  t.overheard.assign(hearers.size(), Fate::delivered);
  receptions_->begin_sending(from, span);
  for (std::size_t i = 0; i < t.overhearers.size(); ++i) {
    const AgentId hearer = t.overhearers[i];
    receptions_->begin(hearer, hearer == to ? fate : t.overheard[i],
                       channel_.power_dbm(from, hearer), span);
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

// What an agent was sending when it failed. A frame on the air still fills it to its end; what has
// left arrives.
void Radio::cut_off(AgentId sender) {
  Station& from = station(sender);
  const bool asked = std::exchange(from.asked, false);
  if (!from.sends(simulation_.now())) return;
  const std::uint32_t slot = from.on_air;
  Transmission& t = slots_[slot];
  t.cut = true;
  if (t.frames_sent < t.frames || t.end > simulation_.now()) {
    for (std::size_t i = t.settled; i < t.route.size; ++i) worsen(t.fates[i], Fate::sender_down);
  }
  if (!asked) return;
  if (t.acknowledged) return conclude(slot, false);
  settle_rest(slot, Fate::sender_down);
  let_go(sender);
}

}  // namespace hearsay
