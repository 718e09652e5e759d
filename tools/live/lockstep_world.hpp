// A world that waits for each of its agents.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "scenarios/run.hpp"
#include "tools/live/frame_line.hpp"

namespace hearsay::fleet {

class LockstepWorld {
 public:
  /// All outlive this.
  LockstepWorld(const PreparedScenario& prepared, Roster& roster, Reactor& reactor);

  /// For Run::Options::elsewhere.
  std::unique_ptr<remote::StandIn> stand_in(Context& context, const remote::Belongings& world);

  /// Lets the run happen, from its start to its end or until the process is asked to stop. Agents
  /// that went away may come back meanwhile. @return how far it came.
  RunEnd drive(Run& run, const std::function<void(const std::string&)>& status);
  void dismiss();

 private:
  void let_join(Run& run);
  void switch_off(Run& run);

  const PreparedScenario& prepared_;
  Roster& roster_;
  Reactor& reactor_;
  std::vector<std::unique_ptr<FrameLine>> lines_;  // by agent
  std::vector<remote::RemoteAgent*> agents_;       // the same
  std::vector<bool> off_;                          // radios of those who are silent
};

}  // namespace hearsay::fleet
