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
    traffic_.settle(row, t.route.ear(0), Fate::delivered);
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
  const AgentId from = t.receiver;
  // Who fails, or sends something else just then, does not answer.
  const bool mute = !station(from).up || (receptions_ && receptions_->sends_until(from) > now);
  if (mute) worsen(t.answer, Fate::lost);
  if (t.answer == Fate::delivered) {
    t.answering = true;
    t.answer_start = now;
    t.answer_end = later(now, span);
    SenderCounts& counts = traffic_.sender(from);
    ++counts.acknowledgements;
    counts.bytes_sent += options_.acknowledgement.bytes;
    counts.air_time += t.answer_end - now;
    if (channel_.acknowledgement_lost(t)) t.answer = Fate::lost;
    if (receptions_) put_on_air(t, from, t.sender, t.answer, t.answer_end);
  }
  t.event = simulation_.schedule(later(now, span), Phase::update,
                                 [this, slot] { end_answer_on_air(slot); });
}

void Radio::end_answer_on_air(std::uint32_t slot) {
  Transmission& t = slots_[slot];
  const Time now = simulation_.now();
  if (t.answering) {
    t.answering = false;
    if (receptions_) take_off_air(t, t.receiver, t.sender, t.answer);
    if (!up_throughout(t.receiver, t.answer_start)) worsen(t.answer, Fate::sender_down);
  }
  t.event = simulation_.schedule(later(now, t.way + options_.latency), Phase::update,
                                 [this, slot] { end_answer(slot); });
}

void Radio::end_answer(std::uint32_t slot) {
  Transmission& t = slots_[slot];
  t.event = EventId();
  if (t.cut) return conclude(slot, false);
  if (t.answer == Fate::delivered) return conclude(slot, true);
  if (t.repetition + 1 >= options_.acknowledgement.attempts_max) return conclude(slot, false);
  ++t.repetition;
  t.frames_sent = 0;
  t.fates[0] = channel_.repeat(t);
  if (access_) return ask(t.sender, t.repetition);
  repeat(slot);
}

// Sends it again as soon as the sender has acknowledged what it got meanwhile.
void Radio::repeat(std::uint32_t slot) {
  Transmission& t = slots_[slot];
  t.event = EventId();
  if (t.cut) return conclude(slot, false);
  const Time free = receptions_ ? receptions_->sends_until(t.sender) : Time();
  if (free <= simulation_.now()) return begin_frames(slot);
  t.event = simulation_.schedule(free, Phase::update, [this, slot] { repeat(slot); });
}

void Radio::conclude(std::uint32_t slot, bool acknowledged) {
  Transmission& t = slots_[slot];
  const AgentId sender = t.sender;
  if (!t.done()) {
    t.settled = 1;
    MessageRow row = t.row(simulation_.now());
    const Fate fate = t.cut ? Fate::sender_down : t.fates[0];
    traffic_.settle(row, t.route.ear(0), fate);
  }
  let_go(sender);
  if (Receiver* const receiver = receivers_[static_cast<std::size_t>(sender)]) {
    simulation_.acting_for(sender);
    receiver->on_outcome(t.packet(t.receiver), acknowledged);
  }
  slots_.release(slot);
}

}  // namespace hearsay
