// Keeps a Places right while a run goes on: hands it leg after leg, and files agents anew in time.
#pragma once

#include <vector>

#include "net/path_source.hpp"
#include "net/places.hpp"
#include "net/steering.hpp"
#include "sim/kernel/simulation.hpp"

namespace hearsay {

/// One event an agent, in Phase::world, whenever its leg ends or its filing does; none for what
/// stands still for ever, until it is steered. So everybody is in place when others look, at any
/// instant.
class Movement final : public Steering {
 public:
  /// Sets all agents of `places` at the simulation's now(). Legs that are over by then are passed
  /// over. All three must outlive the simulation's run.
  /// @throws BrokenInvariant, there or in the run, for legs that do not follow each other in time.
  Movement(Simulation& simulation, Places& places, PathSource& paths);
  Movement(const Movement&) = delete;
  Movement& operator=(const Movement&) = delete;

  void steer(AgentId agent, const Leg& leg) override;

 private:
  struct Course {
    EventId next;          // the event at which it goes on
    bool steered = false;  // it has left its path
  };
  Leg leg_after(AgentId agent, const Leg& before);
  void go_on(AgentId agent);
  void wait(AgentId agent, Time until);

  Simulation& simulation_;
  Places& places_;
  PathSource& paths_;
  std::vector<Course> courses_;  // by agent
};

}  // namespace hearsay
