// What an estimator agent needs of the witness of its run: of this process (agents/witness), or of
// the world's (agents/remote).
#pragma once

#include "agents/estimator.hpp"
#include "sim/kernel/ids.hpp"

namespace hearsay {

class EstimatorWitness {
 public:
  virtual ~EstimatorWitness() = default;

  /// From now on `agent`'s beliefs are sampled. Agents in ascending number.
  virtual void watch(AgentId agent, Believer& believer) = 0;
  /// Distance from the mean of a belief about a subject to the truth now, m; NaN without a mean.
  /// For what an agent leaves in the record.
  virtual double distance_error_m(int subject, const gaussian::Belief& belief) = 0;
  /// Where the agent's ledgers come from; nullptr if ledgers are off.
  virtual LedgerPool* ledgers() = 0;
  virtual EstimatorWorkspace& workspace() = 0;
};

}  // namespace hearsay
