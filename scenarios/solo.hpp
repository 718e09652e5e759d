// One agent of a scenario by itself: its own clock and queue, and the same code as within a run.
// Its radio and its witness are somebody else's.
#pragma once

#include <cstdint>
#include <memory>

#include "agents/agent.hpp"
#include "agents/catalog.hpp"
#include "agents/estimator_witness.hpp"
#include "agents/measurement.hpp"
#include "agents/remote/remote_agent.hpp"
#include "net/radio_port.hpp"
#include "scenarios/run.hpp"

namespace hearsay {

/// What a world needs to know of an agent that lives elsewhere.
remote::RemoteAgent::Options remote_options(const PreparedScenario& prepared, AgentId id);

class Solo {
 public:
  struct Options {
    AgentId id = 0;
    std::uint64_t seed = 1;
    Time now;                        ///< when it begins
    RecordTap* tap = nullptr;        ///< gets what it records; nullptr: nobody. Not owned
    ScheduleWatch* plans = nullptr;  ///< is told what it plans. Not owned
  };
  /// `radio`, `witness` and what the options refer to outlive this. require_can_live_elsewhere().
  Solo(std::shared_ptr<const PreparedScenario> prepared, const Catalog& catalog, RadioPort& radio,
       EstimatorWitness& witness, const Options& options);

  Simulation& simulation() { return simulation_; }
  Agent& agent() { return *agent_; }
  /// Null if it has no use for measurements.
  MeasurementReceiver* receiver() { return receiver_; }

 private:
  std::shared_ptr<const PreparedScenario> prepared_;
  Simulation simulation_;
  std::unique_ptr<Context> context_;
  std::unique_ptr<Agent> agent_;
  MeasurementReceiver* receiver_ = nullptr;
};

}  // namespace hearsay
