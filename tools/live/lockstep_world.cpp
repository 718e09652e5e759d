#include "tools/live/lockstep_world.hpp"

#include <fmt/core.h>

#include "scenarios/solo.hpp"

namespace hearsay::fleet {

using namespace std::chrono_literals;

LockstepWorld::LockstepWorld(const PreparedScenario& prepared, Roster& roster, Reactor& reactor)
    : prepared_(prepared), roster_(roster), reactor_(reactor) {
  for (int agent = 0; agent < roster.size(); ++agent) {
    lines_.push_back(std::make_unique<FrameLine>(roster.member(agent), reactor, agent));
  }
  agents_.resize(lines_.size(), nullptr);
  off_.resize(lines_.size(), false);
}

std::unique_ptr<remote::StandIn> LockstepWorld::stand_in(Context& context,
                                                         const remote::Belongings& world) {
  const auto i = static_cast<std::size_t>(context.id());
  auto agent = std::make_unique<remote::RemoteAgent>(context, *lines_[i], world,
                                                     remote_options(prepared_, context.id()));
  agents_[i] = agent.get();
  return agent;
}

RunEnd LockstepWorld::drive(Run& run, const std::function<void(const std::string&)>& status) {
  Simulation& simulation = run.simulation();
  run.start();
  WallTime next_status = WallClock::now();
  std::uint64_t events = 0;
  EndReason reason = EndReason::time_reached;
  while (!simulation.failed() && !reactor_.stopped()) {
    simulation.advance(simulation.now());  // whatever was the last event, it is over
    switch_off(run);
    let_join(run);
    const Time next = simulation.next_time();
    if (next == Time::never() && simulation.end() == Time::never()) {
      reason = EndReason::nothing_left;
      break;
    }
    if (next > simulation.end()) {
      simulation.advance(simulation.end());
      break;
    }
    if (++events > prepared_.scenario.events_max) {
      reason = EndReason::event_budget;
      break;
    }
    simulation.happen();
    if (events % 64 == 0 && WallClock::now() >= next_status) {
      next_status = WallClock::now() + 500ms;
      status(fmt::format("{:.1f} s of {:g} s, in lockstep", simulation.now().seconds(),
                         simulation.end().seconds()));
    }
  }
  return simulation.end_now(reason);
}

void LockstepWorld::dismiss() {
  for (const auto& line : lines_) line->tell({.kind = remote::OrderKind::dismiss});
}

void LockstepWorld::switch_off(Run& run) {
  for (std::size_t i = 0; i < agents_.size(); ++i) {
    if (!agents_[i]->silent() || off_[i]) continue;
    off_[i] = true;
    roster_.member(static_cast<AgentId>(i)).here = false;
    run.set_reachable(static_cast<AgentId>(i), false);
  }
}

void LockstepWorld::let_join(Run& run) {
  for (const AgentId id : roster_.update(run.simulation().now().nanoseconds())) {
    const auto i = static_cast<std::size_t>(id);
    off_[i] = false;
    run.set_reachable(id, true);
    Simulation& simulation = run.simulation();
    simulation.record().event(simulation.now(), id, "joined again",
                              roster_.member(id).remembers ? "with its memory" : "without memory");
    simulation.schedule(simulation.now(), Phase::world, [&simulation, id, agent = agents_[i]] {
      simulation.acting_for(id);
      agent->join();
    });
  }
}

}  // namespace hearsay::fleet
