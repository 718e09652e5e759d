// What stands in a world for an agent of which the code runs in another process.
#pragma once

#include "agents/agent.hpp"
#include "agents/estimator.hpp"
#include "agents/measurement.hpp"

namespace hearsay::remote {

class StandIn : public Agent, public MeasurementReceiver {
 public:
  using Agent::Agent;
  /// What the agent believes, for the witness of the world.
  virtual Believer& believer() = 0;
};

}  // namespace hearsay::remote
