// Acknowledged packets: stop and wait, with bounded repetition. The acknowledgement is a frame of
// its own, sent without asking for the air; it follows closer than others may begin.
#include "net/radio.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay {

// An attempt has reached the addressee, or should have.
void Radio::arrive_acknowledged(std::uint32_t slot) {
  Transmission& t = slots_[slot];
  t.fates[0] = fate_now(t, 0);
  t.answer = t.fates[0];
  if (t.fates[0] == Fate::delivered && !t.done()) {
    t.settled = 1;
    MessageRow row = t.row(simulation_.now());
    traffic_.settle(row, t.receiver, t.route.link(0), Fate::delivered);
    deliver(t.packet(t.receiver));
  }
  const Time time = later(simulation_.now(), options_.acknowledgement.interframe);
  t.event = EventId();
  if (time == Time::never()) return;
  t.event = simulation_.schedule(time, Phase::update, [this, slot] { answer(slot); });
}

// The acknowledgement, or the time that it would take.
void Radio::answer(std::uint32_t slot) {
  Transmission& t = slots_[slot];
  const Time now = simulation_.now();
  const Duration span = air_time(options_.acknowledgement.bytes);
  if (t.answer == Fate::delivered) {
    Station& from = station(t.receiver);
    const bool mute = !from.up || (receptions_ && receptions_->sending(t.receiver));
    if (mute) {
      t.answer = Fate::lost;
    } else {
      SenderCounts& counts = traffic_.sender(t.receiver);
      ++counts.acknowledgements;
      counts.bytes_sent += options_.acknowledgement.bytes;
      counts.air_time += span;
      if (channel_.acknowledgement_lost(t)) t.answer = Fate::lost;
      if (receptions_) {
        from.free_at = std::max(from.free_at, later(now, span));
        t.answering = true;
        put_on_air(t, t.receiver, t.sender, t.answer);
      }
    }
  }
  const Duration way = t.route.delay(0) + options_.latency;
  t.event = simulation_.schedule(later(now, span), Phase::update, [this, slot, way] {
    Transmission& answered = slots_[slot];
    if (answered.answering) {
      answered.answering = false;
      take_off_air(answered, answered.receiver, answered.sender, answered.answer);
    }
    answered.event = simulation_.schedule(later(simulation_.now(), way), Phase::update,
                                          [this, slot] { end_answer(slot); });
  });
}

void Radio::end_answer(std::uint32_t slot) {
  Transmission& t = slots_[slot];
  const Station& from = station(t.sender);
  t.event = EventId();
  if (from.up && t.answer == Fate::delivered) return conclude(slot, true);
  if (!from.up || t.repetition + 1 >= options_.acknowledgement.attempts_max) {
    return conclude(slot, false);
  }
  ++t.repetition;
  t.frames_sent = 0;
  t.fates[0] = channel_.repeat(t);
  if (access_) return ask(t.sender, t.repetition);
  begin_frames(slot);
}

void Radio::conclude(std::uint32_t slot, bool acknowledged) {
  Transmission& t = slots_[slot];
  const AgentId sender = t.sender;
  if (!t.done()) {
    t.settled = 1;
    MessageRow row = t.row(simulation_.now());
    const Fate fate = station(sender).up ? t.fates[0] : Fate::sender_down;
    traffic_.settle(row, t.receiver, t.route.link(0), fate);
  }
  let_go(sender);
  if (Receiver* const receiver = receivers_[static_cast<std::size_t>(sender)]) {
    simulation_.acting_for(sender);
    receiver->on_outcome(t.packet(t.receiver), acknowledged);
  }
  slots_.release(slot);
}

}  // namespace hearsay
