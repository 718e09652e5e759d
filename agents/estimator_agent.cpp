#include "agents/estimator_agent.hpp"

#include <utility>

namespace hearsay {

EstimatorAgent::EstimatorAgent(Context& context, Witness& witness, Options options)
    : Agent(context),
      witness_(witness),
      options_(std::move(options)),
      estimator_({.rule = options_.rule,
                  .subjects = options_.subjects,
                  .dimension = options_.dimension,
                  .ledgers = witness.ledgers(),
                  .workspace = &witness.workspace(),
                  .strangers = context.hears_strangers()},
                 context.neighbours()),
      message_kind_(context.simulation().record().name("gaussian")) {
  witness_.watch(context.id(), estimator_);
}

void EstimatorAgent::start() {
  if (!options_.sensors.empty()) spawn(look());
  if (!options_.observations.empty()) spawn(replay());
  const bool speaks = gaussian::info(options_.rule).sends != gaussian::Sends::nothing;
  if (options_.talk && speaks) spawn(talk());
}

void EstimatorAgent::on_packet(const Packet& packet) {
  if (packet.kind == message_kind_) estimator_.heard(packet.sender, packet.bytes, packet.rider);
}

void EstimatorAgent::on_up(bool forgets) {
  if (forgets) estimator_.forget();
}

Process EstimatorAgent::look() {
  Time next = options_.sensor_start;
  for (std::uint64_t count = 0; next <= options_.sensor_end; ++count) {
    co_await context().sleep_until(next, Phase::measure);
    for (std::size_t s = 0; s < options_.sensors.size() && context().up(); ++s) {
      Stream draws = context().simulation().stream_at(
          Purpose("sensor noise"), Entity::sensor(context().id(), static_cast<std::uint32_t>(s)),
          count);
      const gaussian::Belief information = look_at(options_.sensors[s], draws);
      const int subject = static_cast<int>(s);
      estimator_.measured(subject, information, witness_.measured(subject, information));
    }
    next = next + options_.sensor_period;
  }
}

gaussian::Belief EstimatorAgent::look_at(const PositionSensor& sensor, Stream& draws) {
  if (!options_.moves || !sensor.has_direction()) return sensor.measure(draws);
  const Point place_m = context().position();
  return sensor.moved_to({place_m[0], place_m[1]}).measure(draws);
}

Process EstimatorAgent::replay() {
  for (const Observation& observation : options_.observations) {
    if (observation.time > context().now()) {
      co_await context().sleep_until(observation.time, Phase::measure);
    }
    if (!context().up()) continue;
    estimator_.measured(observation.subject, observation.information,
                        witness_.measured(observation.subject, observation.information));
  }
}

Process EstimatorAgent::talk() {
  for (std::uint64_t tick = 0;; ++tick) {
    const Time when = options_.talk->tick(tick);
    co_await context().sleep_until(when);
    say(tick);
  }
}

void EstimatorAgent::say(std::uint64_t tick) {
  if (!context().up()) return;
  if (gaussian::info(options_.rule).sends != gaussian::Sends::belief_less_heard) {
    return say_to(no_agent, tick);
  }
  const std::span<const AgentId> now = context().neighbours();
  listeners_.assign(now.begin(), now.end());
  for (const AgentId neighbour : listeners_) say_to(neighbour, tick);
}

void EstimatorAgent::say_to(AgentId receiver, std::uint64_t tick) {
  const StaticGaussianEstimator::Speech speech = estimator_.speech(receiver);
  if (speech.bytes.empty()) return;
  Outgoing packet;
  packet.kind = message_kind_;
  packet.bytes = speech.bytes;
  packet.receiver = receiver;
  packet.tick = tick;
  packet.rider = speech.rider;
  // A belief is news of the one before. An update is not: it has what the one before has not.
  const bool update = gaussian::info(options_.rule).sends == gaussian::Sends::local_update;
  packet.subject = update ? tick : static_cast<std::uint64_t>(context().id());
  if (context().send(packet)) estimator_.sent(receiver);
}

}  // namespace hearsay
