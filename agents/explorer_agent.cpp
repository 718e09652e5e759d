#include "agents/explorer_agent.hpp"

#include <cmath>

#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"

namespace hearsay {

ExplorerAgent::ExplorerAgent(Context& context, RiderPool<GridRider>* riders, const Options& options)
    : Agent(context),
      options_(options),
      estimator_(options.area, options.estimator, riders),
      message_kind_(context.simulation().record().name("grid")) {
  if (options_.exploration) {
    if (options_.sensor) sensor_.emplace(*options_.sensor, options_.area);
    require(context.steered(), "ExplorerAgent: only who is steered explores");
    exploration_.emplace(*options_.exploration, options_.area);
  }
}

void ExplorerAgent::start() {
  last_place_ = context().position();
  if (options_.looks) spawn(look());
  if (exploration_) spawn(explore());
  if (options_.talk && options_.estimator.rule != grid::Rule::none) spawn(talk());
}

void ExplorerAgent::turn_to(const Point& place) {
  const double dx = place[0] - (*last_place_)[0], dy = place[1] - (*last_place_)[1];
  last_place_ = place;
  if (dx == 0.0 && dy == 0.0) return;
  flown_m_ += std::sqrt(dx * dx + dy * dy);
  if (!exploration_) heading_rad_ = math::atan2(dy, dx);
}

Process ExplorerAgent::look() {
  const Time start = options_.sensor_start;
  const Duration period = options_.sensor_period;
  for (std::uint64_t count = instants_before(context().now(), start, period);; ++count) {
    const Time next = start + period * static_cast<std::int64_t>(count);
    if (next > options_.sensor_end) co_return;
    co_await context().sleep_until(next, Phase::measure);
    turn_to(context().position());
    if (context().up()) {
      const Looks seen = options_.looks->look(heading_rad_, count);
      estimator_.looked(seen.looks, seen.indices);
    }
  }
}

double ExplorerAgent::gain_at(const Exploration::State& state) {
  if (!sensor_) return 0.0;
  const double height_m = context().position()[2];
  const auto cells =
      sensor_->view({state.place_m.x_m, state.place_m.y_m, height_m}, state.heading_rad);
  return estimator_.belief().expected_gain(cells);
}

Process ExplorerAgent::explore() {
  const double stride_s = options_.area.cell_m() / options_.speed_m_per_s;
  Stream draws = context().stream("exploration");
  const auto gain = [this](const Exploration::State& state) { return gain_at(state); };
  for (;;) {
    const Point here = context().position();
    Exploration::State state{{here[0], here[1]}, heading_rad_};
    Time arrival = context().now() + Duration::seconds(stride_s);
    if (context().up()) {
      state = exploration_->next(state, gain, draws);
      heading_rad_ = state.heading_rad;
      const bool stays = state.place_m.x_m == here[0] && state.place_m.y_m == here[1];
      if (!stays) {
        arrival = context().go_to({state.place_m.x_m, state.place_m.y_m}, options_.speed_m_per_s);
      }
    }
    co_await context().sleep_until(arrival);
  }
}

Process ExplorerAgent::talk() {
  for (std::uint64_t tick = options_.talk->next_tick(context().now());; ++tick) {
    co_await context().sleep_until(options_.talk->tick(tick));
    if (!context().up()) continue;
    const std::span<const AgentId> now = context().neighbours();
    listeners_.assign(now.begin(), now.end());
    if (!estimator_.addresses()) {
      say(no_agent, tick);
      continue;
    }
    for (const AgentId neighbour : listeners_) say(neighbour, tick);
  }
}

void ExplorerAgent::say(AgentId receiver, std::uint64_t talk) {
  const auto packets = estimator_.speech(receiver, talk);
  for (std::size_t part = 0; part < packets.size(); ++part) {
    Outgoing packet;
    packet.kind = message_kind_;
    packet.bytes = packets[part];
    packet.receiver = receiver;
    packet.rider = estimator_.rider();
    // Each packet has channel draws of its own.
    packet.tick = talk * packets_a_talk_max + part;
    // News of the same part of the area takes the place of what still waits. What changed is told
    // once, and is of other cells each time.
    const bool anew = options_.estimator.form == grid::Form::changed;
    packet.subject = anew ? *packet.tick : part;
    if (!context().send(packet)) continue;
    estimator_.sent(receiver, packets[part], listeners_);
  }
}

void ExplorerAgent::on_packet(const Packet& packet) {
  if (packet.kind == message_kind_) {
    estimator_.heard(packet.sender, packet.bytes, packet.rider);
  }
}

void ExplorerAgent::on_up(bool forgets) {
  if (forgets) estimator_.forget();
}

void ExplorerAgent::finish() {
  const GridEstimator::Counts& counts = estimator_.counts();
  context().record_final("measurements", static_cast<double>(counts.looks));
  context().record_final("fusions", static_cast<double>(counts.fusions));
  context().record_final("messages_refused", static_cast<double>(counts.refused));
  context().record_final("distance_flown_m", flown_m_);
}

}  // namespace hearsay
