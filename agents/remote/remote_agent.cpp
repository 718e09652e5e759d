#include "agents/remote/remote_agent.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "agents/remote/riders.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay::remote {
namespace {

/// Calls before an answer is done; more, and the agent is taken for mad.
constexpr int calls_max = 1'000'000;
/// Of who keeps its own time; faster things would be filed without end.
constexpr double steer_speed_max_m_per_s = 1e4;

// Who keeps its own time may be a little ahead of where the world has it: it then goes to the same
// place at the same speed.
void steer(Context& context, const Leg& leg) {
  const Point here = context.position();
  if (leg.begin == context.now() && leg.from_m == here) return context.steer(leg);
  const auto& v = leg.velocity_m_per_s;
  const double speed_m_per_s = std::sqrt(v[0] * v[0] + v[1] * v[1]);
  if (speed_m_per_s == 0.0 || leg.end == Time::never()) return context.stay();
  require(speed_m_per_s <= steer_speed_max_m_per_s, "an agent steers faster than anything moves");
  const Point there = leg.at(leg.end);
  context.go_to({there[0], there[1]}, speed_m_per_s);
}

}  // namespace

Surroundings surroundings_of(const Context& context, bool knows_place) {
  Surroundings around{.up = context.up(),
                      .hears_strangers = context.hears_strangers(),
                      .waiting = static_cast<std::uint32_t>(context.waiting())};
  if (knows_place) around.position_m = context.position();
  return around;
}

void serve(std::span<const std::byte> question, Context& context, Desk* desk,
           std::vector<std::byte>& answer) {
  answer.clear();
  Unpacker in(question);
  Packer out(answer);
  const std::uint8_t kind = in.u8();
  require(kind <= static_cast<std::uint8_t>(question_last), "an agent asks what nobody knows");
  if (static_cast<Question>(kind) == Question::steer) {
    const Leg leg = take_leg(in);
    require_whole(in);
    steer(context, leg);
  } else {
    require(desk != nullptr, "an agent that has no desk asks something");
    desk->answer(static_cast<Question>(kind), in, out);
  }
}

void take_notes(std::span<const std::byte> notes, Context& context, Desk* desk,
                std::vector<std::byte>& scratch) {
  for (Unpacker in(notes); !in.done();) {
    const std::span<const std::byte> note = in.bytes();
    require(in.good(), "notes of an agent are malformed");
    serve(note, context, desk, scratch);
  }
}

RemoteAgent::RemoteAgent(Context& context, Line& line, const Belongings& world,
                         const Options& options)
    : StandIn(context),
      line_(line),
      witness_(world.witness),
      desk_(world.desk),
      riders_(world.riders),
      options_(options),
      believer_(*this) {
  beliefs_.resize(static_cast<std::size_t>(options.subjects),
                  {gaussian::Belief::unknown(std::max(options.dimension, 1)), Ledger()});
  told_measurements_.resize(beliefs_.size(), 0);
}

Order RemoteAgent::order(OrderKind kind) {
  Order order{.kind = kind,
              .now = context().now(),
              .surroundings = surroundings_of(context(), options_.knows_place)};
  const std::span<const AgentId> now = context().neighbours();
  if (kind == OrderKind::start ||
      !std::equal(now.begin(), now.end(), told_neighbours_.begin(), told_neighbours_.end())) {
    told_neighbours_.assign(now.begin(), now.end());
    order.surroundings.neighbours = told_neighbours_;
  }
  if (!options_.moving || !witness_ || !witness_->ledgers()) return order;
  const auto& measured_at = witness_->workspace().measured_at;
  for (std::size_t s = 0; s < told_measurements_.size(); ++s) {
    const auto news = measured_at[s].begin() + static_cast<std::ptrdiff_t>(told_measurements_[s]);
    order.measured_at.emplace_back(news, measured_at[s].end());
    told_measurements_[s] = measured_at[s].size();
  }
  return order;
}

Order RemoteAgent::order_about(OrderKind kind, const Packet& packet) {
  Order about = order(kind);
  about.message_kind = context().simulation().record().text(packet.kind);
  about.sender = packet.sender;
  about.receiver = packet.receiver;
  about.sent = packet.sent;
  about.bytes.assign(packet.bytes.begin(), packet.bytes.end());
  if (packet.rider && riders_) riders_->write(*packet.rider, about.rider);
  return about;
}

void RemoteAgent::start() {
  Order begin = order(OrderKind::start);
  begin.lives = lives_++;
  begun_ = true;
  give(std::move(begin));
}

void RemoteAgent::on_measurement(const Measurement& measurement) {
  Order measured = order(OrderKind::measurement);
  measured.measurement = measurement;
  give(std::move(measured));
}

void RemoteAgent::on_packet(const Packet& packet) { give(order_about(OrderKind::packet, packet)); }

void RemoteAgent::on_outcome(const Packet& packet, bool acknowledged) {
  Order outcome = order_about(OrderKind::outcome, packet);
  outcome.yes = acknowledged;
  give(std::move(outcome));
}

void RemoteAgent::on_queue_empty() { give(order(OrderKind::queue_empty)); }

void RemoteAgent::on_down() { give(order(OrderKind::down)); }

void RemoteAgent::on_up(bool forgets) {
  Order up = order(OrderKind::up);
  up.yes = forgets;
  give(std::move(up));
}

void RemoteAgent::finish() { give(order(OrderKind::finish)); }

void RemoteAgent::wake(std::uint64_t event) {
  plans_.erase(event);
  context().simulation().acting_for(context().id());
  give(order(OrderKind::wake));
}

void RemoteAgent::join() {
  fall_silent();
  std::fill(told_measurements_.begin(), told_measurements_.end(), 0);
  silent_ = false;
  if (begun_) start();
}

void RemoteAgent::give(Order order) {
  if (silent_) return;
  fresh_ = false;
  if (!exchange(order)) return;
  for (int calls = 0; answer_.kind != AnswerKind::done; ++calls) {
    if (answer_.kind == AnswerKind::failed) throw std::runtime_error(answer_.failure);
    if (calls == calls_max) return fall_silent();
    if (!exchange(answer_call())) return;
  }
}

bool RemoteAgent::exchange(const Order& order) {
  if (!line_.exchange(order, answer_)) {
    fall_silent();
    return false;
  }
  take_notes(answer_.notes, context(), desk_, scratch_);
  take_rows();
  take_plans();
  return true;
}

void RemoteAgent::take_plans() {
  Simulation& simulation = context().simulation();
  for (const Plan& plan : answer_.plans) {
    if (plan.cancelled) {
      const auto found = plans_.find(plan.event);
      if (found == plans_.end()) continue;
      simulation.cancel(found->second);
      plans_.erase(found);
      continue;
    }
    const std::uint64_t event = plan.event;
    plans_[event] = simulation.schedule(plan.time, plan.phase, [this, event] { wake(event); });
  }
}

void RemoteAgent::take_rows() {
  Record& record = context().simulation().record();
  for (const Row& row : answer_.rows) {
    switch (row.kind) {
      case Row::Kind::scalar:
        record.scalar(context().id(), record.name(row.name), row.value);
        break;
      case Row::Kind::series:
        record.series(row.time, context().id(), record.name(row.text), record.name(row.name),
                      row.value);
        break;
      case Row::Kind::event:
        record.event(row.time, context().id(), row.name, row.text);
        break;
    }
  }
}

Order RemoteAgent::answer_call() {
  bool taken = false;
  double distance_m = 0.0;
  scratch_.clear();
  switch (answer_.kind) {
    case AnswerKind::send:
      taken = send();
      break;
    case AnswerKind::tell_of_empty_queue:
      context().tell_of_empty_queue();
      break;
    case AnswerKind::distance:
      require(witness_ && answer_.subject < options_.subjects,
              "a distance to nothing was asked for");
      distance_m = witness_->distance_error_m(answer_.subject, answer_.belief);
      break;
    case AnswerKind::ask:
      serve(answer_.content, context(), desk_, scratch_);
      break;
    case AnswerKind::done:
    case AnswerKind::failed:
      break;
  }
  Order go_on = order(OrderKind::go_on);
  go_on.content = scratch_;
  go_on.yes = taken;
  go_on.value = distance_m;
  return go_on;
}

bool RemoteAgent::send() {
  Outgoing packet;
  packet.kind = context().simulation().record().name(answer_.message_kind);
  packet.bytes = answer_.bytes;
  packet.receiver = answer_.receiver;
  packet.tick = answer_.tick;
  packet.subject = answer_.news_of;
  packet.acknowledged = answer_.acknowledged;
  if (!answer_.rider.empty() && riders_) packet.rider = riders_->read(answer_.rider);
  return context().send(packet);
}

void RemoteAgent::fall_silent() {
  if (silent_) return;
  silent_ = true;
  for (TrackedBelief& tracked : beliefs_) {
    tracked = {gaussian::Belief::unknown(tracked.belief.dimension()), Ledger()};
  }
  state_.clear();
  Simulation& simulation = context().simulation();
  for (const auto& [event, id] : plans_) simulation.cancel(id);
  plans_.clear();
  simulation.record().event(context().now(), context().id(), "silent", "its process is gone");
}

void RemoteAgent::refresh() {
  if (fresh_ || silent_ || (options_.subjects == 0 && !desk_)) return;
  Order report = order(OrderKind::report);
  report.stamp = stamp_;
  give(std::move(report));
  if (silent_) return;
  const auto fits = [this](const TrackedBelief& tracked) {
    return tracked.belief.dimension() == options_.dimension;
  };
  require(answer_.beliefs.size() == beliefs_.size() &&
              std::all_of(answer_.beliefs.begin(), answer_.beliefs.end(), fits),
          "an agent believes in something else than there is");
  beliefs_ = answer_.beliefs;
  counts_ = answer_.counts;
  state_ = answer_.content;
  fresh_ = true;
}

// What it knows may change as time goes by, whatever happens: a robot drives on.
std::span<const std::byte> RemoteAgent::state() {
  if (asked_at_ != context().now()) fresh_ = false;
  asked_at_ = context().now();
  refresh();
  return state_;
}

void RemoteAgent::Beliefs::advance(std::int64_t now) {
  if (now != agent_.stamp_) agent_.fresh_ = false;
  agent_.stamp_ = now;
  agent_.refresh();
}

const TrackedBelief& RemoteAgent::Beliefs::tracked(int subject) const {
  agent_.refresh();
  return agent_.beliefs_[static_cast<std::size_t>(subject)];
}

const EstimatorCounts& RemoteAgent::Beliefs::counts() const {
  agent_.refresh();
  return agent_.counts_;
}

}  // namespace hearsay::remote
