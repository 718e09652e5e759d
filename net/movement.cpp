#include "net/movement.hpp"

#include "sim/kernel/error.hpp"

namespace hearsay {

Movement::Movement(Simulation& simulation, Places& places, PathSource& paths)
    : simulation_(simulation),
      places_(places),
      paths_(paths),
      courses_(static_cast<std::size_t>(places.agents())) {
  const Time now = simulation.now();
  for (AgentId agent = 0; agent < places.agents(); ++agent) {
    Leg leg = paths_.next(agent, now);
    while (leg.end <= now) leg = leg_after(agent, leg);
    wait(agent, places_.set(agent, leg, now));
  }
}

void Movement::steer(AgentId agent, const Leg& leg) {
  constexpr double apart_max_m = 1e-3;
  const Time now = simulation_.now();
  require(leg.begin == now && leg.end > now &&
              squared_distance_m2(leg.from_m, places_.at(agent, now)) <= apart_max_m * apart_max_m,
          "an agent is steered from where it is now");
  Course& course = courses_[static_cast<std::size_t>(agent)];
  simulation_.cancel(course.next);
  course.steered = true;
  wait(agent, places_.set(agent, leg, now));
}

Leg Movement::leg_after(AgentId agent, const Leg& before) {
  if (courses_[static_cast<std::size_t>(agent)].steered) {
    return {.begin = before.end, .from_m = before.at(before.end)};
  }
  const Leg leg = paths_.next(agent, simulation_.now());
  require(leg.begin == before.end && leg.end > leg.begin,
          "the legs of a path do not follow each other");
  return leg;
}

void Movement::go_on(AgentId agent) {
  simulation_.acting_for(agent);
  const Time now = simulation_.now();
  const Leg& leg = places_.leg(agent);
  wait(agent, now < leg.end ? places_.refresh(agent, now)
                            : places_.set(agent, leg_after(agent, leg), now));
}

void Movement::wait(AgentId agent, Time until) {
  EventId& next = courses_[static_cast<std::size_t>(agent)].next;
  next = EventId();
  if (until > simulation_.end() || until == Time::never()) return;
  next = simulation_.schedule(until, Phase::world, [this, agent] { go_on(agent); });
}

}  // namespace hearsay
