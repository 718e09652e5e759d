// The world of a fleet as a process: truth, sensors, radio, witness and record. Agents are
// elsewhere.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "agents/catalog.hpp"
#include "scenarios/run.hpp"
#include "tools/live/options.hpp"

namespace hearsay::fleet {

struct WorldResult {
  std::unique_ptr<Run> run;  ///< null if it did not begin
  RunEnd end;
  std::string digest;
  double wall_s = 0.0;
  std::string trouble;       ///< why it did not begin, or was broken off; empty: it came to its end
  std::uint64_t late = 0;    ///< real time: events that missed their deadline
  std::uint64_t silent = 0;  ///< real time: reports that did not come in time
  std::uint64_t dropped = 0;  ///< packets that were no sound beliefs, or old
};

/// Waits for the agents, lets the run happen, dismisses them. `status` gets a line now and then, of
/// how far it is.
WorldResult run_world(const std::shared_ptr<const PreparedScenario>& prepared,
                      const Catalog& catalog, const WorldOptions& options,
                      const std::function<void(const std::string&)>& status);

}  // namespace hearsay::fleet
