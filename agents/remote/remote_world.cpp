#include "agents/remote/remote_world.hpp"

#include <exception>
#include <utility>

#include "sim/kernel/error.hpp"
#include "sim/kernel/what_of.hpp"

namespace hearsay::remote {
void begin_life(Agent& agent, MemoryStore* memory, std::uint32_t lives) {
  agent.start();
  if (memory && memory->recall(agent)) return;
  for (std::uint32_t life = 0; life < lives; ++life) agent.on_up(true);
}

RemoteWorld::RemoteWorld(Superior& superior, const Order& first, const Options& options)
    : superior_(superior), options_(options), order_(first) {
  require(first.kind == OrderKind::start, "the first order is another than to start");
  workspace_.measured_at.resize(static_cast<std::size_t>(options.subjects));
  look_around();
}

bool RemoteWorld::serve(const Parts& parts) {
  parts_ = &parts;
  struct AtEnd {
    RemoteWorld& world;
    ~AtEnd() {
      world.rider_ = RiderPtr();  // it may be of a pool of the agent's
      world.parts_ = nullptr;
    }
  } at_end{*this};
  return serve_until_dismissed(parts);
}

bool RemoteWorld::serve_until_dismissed(const Parts& parts) {
  for (bool begun = false;; begun = true) {
    std::exception_ptr error;
    try {
      if (begun) {
        obey();
      } else {
        parts.simulation.advance(order_.now);
        begin_life(parts.agent, options_.memory, order_.lives);
      }
    } catch (...) {
      error = std::current_exception();
    }
    if (gone_) return dismissed_;
    if (parts.simulation.failed()) error = parts.simulation.failure();
    if (error) answer_.failure = what_of(error);
    if (options_.memory && !error) options_.memory->save(parts.agent);
    if (!answer(error ? AnswerKind::failed : AnswerKind::done)) return dismissed_;
  }
}

void RemoteWorld::look_around() {
  if (order_.surroundings.neighbours) neighbours_ = *order_.surroundings.neighbours;
  around_ = order_.surroundings;
  for (std::size_t s = 0; s < order_.measured_at.size() && s < workspace_.measured_at.size(); ++s) {
    workspace_.measured_at[s].insert(workspace_.measured_at[s].end(), order_.measured_at[s].begin(),
                                     order_.measured_at[s].end());
  }
}

void RemoteWorld::obey() {
  const auto& [simulation, agent, receiver, reporter, riders] = *parts_;
  if (order_.kind == OrderKind::wake) {
    require(simulation.next_time() == order_.now, "it is not the time of what was planned");
    simulation.happen();
    return;
  }
  simulation.advance(order_.now);
  switch (order_.kind) {
    case OrderKind::measurement:
      require(receiver, "a measurement for an agent without sensors");
      return receiver->on_measurement(order_.measurement);
    case OrderKind::packet:
      return agent.on_packet(packet());
    case OrderKind::outcome:
      return agent.on_outcome(packet(), order_.yes);
    case OrderKind::queue_empty:
      return agent.on_queue_empty();
    case OrderKind::down:
      return agent.on_down();
    case OrderKind::up:
      return agent.on_up(order_.yes);
    case OrderKind::report:
      return report();
    case OrderKind::finish:
      return agent.finish();
    case OrderKind::start:
    case OrderKind::wake:
    case OrderKind::go_on:
    case OrderKind::dismiss:
      break;
  }
  throw BrokenInvariant("an order at the wrong time");
}

Packet RemoteWorld::packet() {
  rider_ = RiderPtr();
  if (!order_.rider.empty() && parts_->riders) rider_ = parts_->riders->read(order_.rider);
  return {.sender = order_.sender,
          .receiver = order_.receiver,
          .kind = parts_->simulation.record().name(order_.message_kind),
          .bytes = order_.bytes,
          .sent = order_.sent,
          .rider = rider_.get()};
}

void RemoteWorld::report() {
  if (parts_->reporter) {
    Packer out(answer_.content);
    parts_->reporter->report(out);
  }
  if (!believer_) return;
  believer_->advance(order_.stamp);
  for (int s = 0; s < options_.subjects; ++s) answer_.beliefs.push_back(believer_->tracked(s));
  answer_.counts = believer_->counts();
}

bool RemoteWorld::answer(AnswerKind kind) {
  answer_.kind = kind;
  const bool goes_on = superior_.exchange(answer_, order_);
  answer_ = {};
  anew_ = goes_on && order_.kind == OrderKind::start;
  dismissed_ = goes_on && order_.kind == OrderKind::dismiss;
  gone_ = !goes_on || anew_ || dismissed_;
  if (!gone_) look_around();
  return !gone_;
}

void RemoteWorld::call(AnswerKind kind) {
  // What it hears is in order_, which the answer overwrites.
  std::vector<std::byte> heard = std::move(order_.bytes);
  if (!answer(kind)) throw WorldGone();
  order_.bytes = std::move(heard);
  require(order_.kind == OrderKind::go_on, "an order came while the agent waited for an answer");
}

bool RemoteWorld::send(AgentId, const Outgoing& packet) {
  answer_.message_kind = parts_->simulation.record().text(packet.kind);
  answer_.receiver = packet.receiver;
  answer_.tick = packet.tick;
  answer_.news_of = packet.subject;
  answer_.acknowledged = packet.acknowledged;
  answer_.bytes.assign(packet.bytes.begin(), packet.bytes.end());
  if (packet.rider.get() && parts_->riders) {
    parts_->riders->write(*packet.rider.get(), answer_.rider);
  }
  call(AnswerKind::send);
  return order_.yes;
}

void RemoteWorld::tell_of_empty_queue(AgentId) { call(AnswerKind::tell_of_empty_queue); }

Point RemoteWorld::position(AgentId) const {
  require(around_.position_m.has_value(), "radio: nobody knows where agents stand");
  return *around_.position_m;
}

double RemoteWorld::distance_error_m(int subject, const gaussian::Belief& belief) {
  answer_.subject = subject;
  answer_.belief = belief;
  call(AnswerKind::distance);
  return order_.value;
}

void RemoteWorld::steer(AgentId, const Leg& leg) {
  Packer out = asking_.begin(Question::steer);
  put(out, leg);
  asking_.note();
}

std::span<const std::byte> RemoteWorld::ask(std::span<const std::byte> question) {
  answer_.content.assign(question.begin(), question.end());
  call(AnswerKind::ask);
  return order_.content;
}

void RemoteWorld::note(std::span<const std::byte> note) { Packer(answer_.notes).bytes(note); }

void RemoteWorld::on_scalar(const ScalarRow& row, Origin) {
  require(parts_ != nullptr, "an agent recorded something before it began");
  answer_.rows.push_back({.kind = Row::Kind::scalar,
                          .name = parts_->simulation.record().text(row.name),
                          .value = row.value});
}

void RemoteWorld::on_series(const SeriesRow& row, Origin) {
  require(parts_ != nullptr, "an agent recorded something before it began");
  const Record& record = parts_->simulation.record();
  answer_.rows.push_back({.kind = Row::Kind::series,
                          .time = row.time,
                          .name = record.text(row.name),
                          .text = record.text(row.subject),
                          .value = row.value});
}

void RemoteWorld::on_event(Time time, AgentId, std::string_view kind, std::string_view detail) {
  answer_.rows.push_back({.kind = Row::Kind::event,
                          .time = time,
                          .name = std::string(kind),
                          .text = std::string(detail)});
}

void RemoteWorld::scheduled(EventId id, Time time, Phase phase) {
  answer_.plans.push_back({.event = id.name, .time = time, .phase = phase});
}

void RemoteWorld::cancelled(EventId id) {
  answer_.plans.push_back({.event = id.name, .cancelled = true});
}

}  // namespace hearsay::remote
