#include "net/movement.hpp"

#include "sim/kernel/error.hpp"

namespace hearsay {

Movement::Movement(Simulation& simulation, Places& places, PathSource& paths)
    : simulation_(simulation), places_(places), paths_(paths) {
  const Time now = simulation.now();
  for (AgentId agent = 0; agent < places.agents(); ++agent) {
    Leg leg = paths_.next(agent, now);
    while (leg.end <= now) leg = leg_after(agent, leg);
    wait(agent, places_.set(agent, leg, now));
  }
}

Leg Movement::leg_after(AgentId agent, const Leg& before) {
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
  if (until > simulation_.end() || until == Time::never()) return;
  simulation_.schedule(until, Phase::world, [this, agent] { go_on(agent); });
}

}  // namespace hearsay
