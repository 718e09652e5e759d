// An agent of a fleet as a process.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "agents/catalog.hpp"
#include "scenarios/run.hpp"
#include "tools/live/options.hpp"

namespace hearsay::fleet {

/// Joins the fleet's world and lives until that dismisses it. `status` gets a line now and then.
/// @return what went wrong: refused, nobody there, the world is gone; empty if nothing did, or the
/// process was asked to stop. @throws InputError for an agent that is not in the scenario.
std::string run_agent(const std::shared_ptr<const PreparedScenario>& prepared,
                      const Catalog& catalog, const AgentOptions& options,
                      const std::function<void(const std::string&)>& status);

}  // namespace hearsay::fleet
