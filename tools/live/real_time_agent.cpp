#include "tools/live/real_time_agent.hpp"

#include <algorithm>
#include <utility>

#include "sim/kernel/error.hpp"

namespace hearsay::fleet {
namespace {

using namespace std::chrono_literals;
using remote::Order;
using remote::OrderKind;

/// How long the world stands still for what an agent believes, or leaves at the end.
constexpr double report_wait_s = 0.05, last_wait_s = 2.0;
/// What a radio takes.
constexpr std::int64_t ticks_max = std::int64_t{1} << 48;

}  // namespace

RealTimeAgent::RealTimeAgent(Context& context, live::Port& port, Member& member, Reactor& reactor,
                             Options options)
    : StandIn(context),
      member_(member),
      reactor_(reactor),
      options_(std::move(options)),
      believer_(*this),
      line_(member, reactor, context.id()),
      air_out_(port, live::agent_partition(port.fleet(), static_cast<std::uint32_t>(context.id()))),
      air_in_(port, said_partition(port.fleet(), context.id()),
              {options_.tongues[static_cast<std::size_t>(context.id())]}) {
  beliefs_.resize(static_cast<std::size_t>(options_.what.subjects),
                  {gaussian::Belief::unknown(std::max(options_.what.dimension, 1)), Ledger()});
}

Order RealTimeAgent::order(OrderKind kind) {
  Order order{.kind = kind,
              .now = context().now(),
              .surroundings = remote::surroundings_of(context(), options_.what.knows_place)};
  const std::span<const AgentId> now = context().neighbours();
  told_neighbours_.assign(now.begin(), now.end());
  order.surroundings.neighbours = told_neighbours_;
  return order;
}

void RealTimeAgent::tell(const Order& order) {
  if (!silent_ && member_.ours) line_.tell(order);
}

void RealTimeAgent::start() {
  silent_ = false;
  heard_ = 0;
  Order begin = order(OrderKind::start);
  begin.lives = lives_++;
  tell(begin);
}

void RealTimeAgent::tell_neighbours() {
  const std::span<const AgentId> now = context().neighbours();
  if (std::equal(now.begin(), now.end(), told_neighbours_.begin(), told_neighbours_.end())) return;
  tell(order(OrderKind::go_on));
}

void RealTimeAgent::on_measurement(const Measurement& measurement) {
  if (silent_) return;
  live::encode(live::Measurement{.agent = static_cast<std::uint32_t>(context().id()),
                                 .subject = static_cast<std::uint32_t>(measurement.subject),
                                 .number = ++number_,
                                 .now_ns = context().now().nanoseconds(),
                                 .information = measurement.information},
               bytes_);
  member_.measurements.write(bytes_);
}

void RealTimeAgent::on_packet(const Packet& packet) {
  if (silent_) return;
  parcel_.envelope = {.sender = static_cast<std::uint32_t>(packet.sender),
                      .receiver = static_cast<std::uint32_t>(packet.receiver),
                      .number = ++number_,
                      .sent_ns = packet.sent.nanoseconds()};
  parcel_.kind = context().simulation().record().text(packet.kind);
  parcel_.message.assign(packet.bytes.begin(), packet.bytes.end());
  air_out_.write(options_.tongues[static_cast<std::size_t>(packet.sender)], parcel_);
}

void RealTimeAgent::on_up(bool forgets) {
  Order up = order(OrderKind::up);
  up.yes = forgets;
  tell(up);
}

void RealTimeAgent::finish() { ask(OrderKind::finish, last_wait_s); }

bool RealTimeAgent::take() {
  bool any = take_answers();
  while (take_report()) any = true;
  while (air_in_.take(parcel_)) {
    any = true;
    const live::Envelope& envelope = parcel_.envelope;
    if (!can_be_sent(envelope) || envelope.number <= heard_) {
      ++dropped_;
      continue;
    }
    heard_ = parcel_.envelope.number;
    say(parcel_);
  }
  return any;
}

bool RealTimeAgent::take_answers() {
  bool any = false;
  while (member_.answers.take(bytes_)) {
    if (!live::decode(bytes_, frame_) || !remote::unpack(frame_.content, answer_)) {
      ++dropped_;
      continue;
    }
    any = true;
    if (silent_ || !member_.ours) continue;
    answer(answer_);
  }
  return any;
}

// What it does by its own time, it does in the world when the world hears of it. Whoever is on the
// network can write here: what makes no sense is dropped, and answered by nothing.
void RealTimeAgent::answer(const remote::Answer& question) {
  const auto try_to = [this](const auto& what) {
    try {
      what();
    } catch (const BrokenInvariant&) {
      ++dropped_;
      scratch_.clear();
    }
  };
  try_to([&] { remote::take_notes(question.notes, context(), options_.desk, scratch_); });
  if (question.kind == remote::AnswerKind::done) {
    if (question.content.empty()) return;
    state_told_ = true;
    if (options_.desk && options_.desk->is_sound(question.content)) {
      state_ = question.content;
    } else {
      ++dropped_;
    }
    return;
  }
  if (question.kind != remote::AnswerKind::ask) return;
  try_to([&] { remote::serve(question.content, context(), options_.desk, scratch_); });
  Order go_on = order(OrderKind::go_on);
  go_on.number = question.number;
  go_on.content = scratch_;
  tell(go_on);
}

std::span<const std::byte> RealTimeAgent::state() {
  believer_.advance(stamp_);
  return state_;
}

bool RealTimeAgent::can_be_sent(const live::Envelope& envelope) const {
  const auto me = static_cast<std::uint32_t>(context().id());
  const bool somebody = envelope.receiver < options_.tongues.size() && envelope.receiver != me;
  return envelope.sender == me && (somebody || envelope.receiver == live::everybody) &&
         envelope.tick < ticks_max;
}

void RealTimeAgent::say(const Parcel& parcel) {
  Outgoing packet;
  packet.kind = context().simulation().record().name(parcel.kind);
  packet.bytes = parcel.message;
  if (parcel.envelope.receiver != live::everybody) {
    packet.receiver = static_cast<AgentId>(parcel.envelope.receiver);
  }
  if (parcel.envelope.tick >= 0) packet.tick = static_cast<std::uint64_t>(parcel.envelope.tick);
  packet.subject = parcel.envelope.subject;
  if (member_.ours) {
    context().send(packet);
    return;
  }
  // Another's program may say more than its radio can ever take; that is not the run's fault.
  try {
    context().send(packet);
  } catch (const InputError&) {
    ++dropped_;
  } catch (const BrokenInvariant&) {
    ++dropped_;
  }
}

bool RealTimeAgent::take_report() {
  if (!member_.reports.take(bytes_)) return false;
  live::Report report;
  if (!live::decode(bytes_, report) || report.agent != static_cast<std::uint32_t>(context().id())) {
    ++dropped_;
    return true;
  }
  for (TrackedBelief& tracked : beliefs_) {
    tracked.belief = gaussian::Belief::unknown(tracked.belief.dimension());
  }
  for (const gaussian::BeliefEntry& entry : report.beliefs) {
    if (entry.subject >= beliefs_.size() || entry.belief.dimension() != options_.what.dimension) {
      ++dropped_;
      continue;
    }
    beliefs_[entry.subject].belief = entry.belief;
  }
  counts_ = {.measurements = report.counts.measurements,
             .fusions = report.counts.fusions,
             .skipped = report.counts.skipped,
             .refused = report.counts.refused,
             .late = report.counts.late,
             .fusion_gain_max = report.counts.fusion_gain_max};
  missed_ = report.missed;
  for (const live::Row& row : report.rows) record(row);
  return true;
}

void RealTimeAgent::record(const live::Row& row) {
  Record& record = context().simulation().record();
  const Time time =
      std::clamp(Time::nanoseconds(row.now_ns), Time::nanoseconds(0), context().now());
  switch (row.kind) {
    case live::Row::Kind::scalar:
      return record.scalar(context().id(), record.name(row.name), row.value);
    case live::Row::Kind::series:
      return record.series(time, context().id(), record.name(row.text), record.name(row.name),
                           row.value);
    case live::Row::Kind::event:
      return record.event(time, context().id(), row.name, row.text);
  }
}

void RealTimeAgent::fall_silent() {
  if (silent_) return;
  silent_ = true;
  member_.here = false;
  for (TrackedBelief& tracked : beliefs_) {
    tracked.belief = gaussian::Belief::unknown(tracked.belief.dimension());
  }
  state_.clear();
  context().record_event("silent", "its process is gone");
}

void RealTimeAgent::ask(OrderKind kind, double wait_s) {
  if (silent_ || !member_.ours) return;
  while (take_report()) {
  }
  Order report = order(kind);
  report.stamp = stamp_;
  tell(report);
  state_told_ = options_.desk == nullptr;
  const WallTime until = WallClock::now() + wall(wait_s);
  for (bool reported = false;;) {
    take_answers();  // it may wait for an answer before it can report
    reported = take_report() || reported;
    if (reported && state_told_) return;
    if (WallClock::now() >= until || reactor_.stopped() || !member_.alive()) {
      ++late_reports_;
      return;
    }
    reactor_.wait(until);
  }
}

void RealTimeAgent::Beliefs::advance(std::int64_t now) {
  agent_.stamp_ = now;
  if (agent_.asked_ == agent_.context().now()) return;
  agent_.asked_ = agent_.context().now();
  agent_.ask(OrderKind::report, report_wait_s);
}

const TrackedBelief& RealTimeAgent::Beliefs::tracked(int subject) const {
  return agent_.beliefs_[static_cast<std::size_t>(subject)];
}

}  // namespace hearsay::fleet
