// What an explorer knows of its area, for who looks into its mind: the witness of its run.
#pragma once

#include "agents/grids/grid_belief.hpp"
#include "filters/grid/ledger.hpp"

namespace hearsay {

class GridMind {
 public:
  virtual ~GridMind() = default;
  virtual const GridBelief& belief() const = 0;
  /// How often each look is counted in the belief; of no look if ledgers are off.
  virtual const grid::LookLedger& ledger() const = 0;
};

}  // namespace hearsay
