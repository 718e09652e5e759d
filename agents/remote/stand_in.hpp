// What stands in a world for an agent of which the code runs in another process.
#pragma once

#include <cstddef>
#include <span>

#include "agents/agent.hpp"
#include "agents/estimator_witness.hpp"
#include "agents/measurement.hpp"

namespace hearsay::remote {

class Desk;
class RiderCodec;

/// What an agent elsewhere has in its world, beside its radio.
struct Belongings {
  EstimatorWitness* witness = nullptr;  ///< null if there is nothing to estimate
  Desk* desk = nullptr;                 ///< null if it asks for nothing
  RiderCodec* riders = nullptr;         ///< of its packets; null if they have none
};

class StandIn : public Agent, public MeasurementReceiver {
 public:
  using Agent::Agent;
  /// What the agent believes, for the witness of the world.
  virtual Believer& believer() = 0;
  /// What the agent tells of itself now, as its Reporter wrote it; empty if nobody knows. Valid
  /// until anything else happens.
  virtual std::span<const std::byte> state() = 0;
};

}  // namespace hearsay::remote
