// What a look is expected to tell, before it is taken: the fall of entropy, nats. Merino 2007,
// section 4.3.1 and eq. 4.21–4.24.
#pragma once

#include <span>

#include "filters/grid/beta.hpp"
#include "filters/grid/sensors.hpp"

namespace hearsay::grid {

/// Of one cell of a Bernoulli grid (eq. 4.22–4.23): h(l) − E[h after a look], ≥ 0.
double expected_gain(double log_odds, const Detector& detector);

/// What a look adds to a Beta cell: m if something is detected, n if not, both ≥ 0.
struct BetaCounts {
  double m = 1.0, n = 1.0;
};
/// Of one cell of a Beta grid, where a detection has probability α/(α + β): the fall of the
/// differential entropy. With m = n = 1, the likelihood that the filter assumes, it is ≥ 0; with
/// other counts it may be negative.
double expected_gain(const Beta& belief, const BetaCounts& counts = {});

/// Of a look at all these cells, judged one by one: the sum. A Beta cell without a distribution
/// adds nothing. @throws BrokenInvariant for cells that are not in the grid.
double expected_gain(const BernoulliGrid& grid, std::span<const CellInView> cells);
double expected_gain(const BetaGrid& grid, std::span<const CellInView> cells,
                     const BetaCounts& counts = {});

/// Somewhere to go.
struct Move {
  double gain;  ///< nats
  double cost;  ///< ≥ 0, in a unit of the caller's
};
/// α and β of eq. 4.24, ≥ 0.
struct MoveWeights {
  double gain = 1.0, cost = 0.0;
};
/// Number of the move of greatest α·gain − β·cost, the first of equal ones. @throws BrokenInvariant
/// if there are none.
int best_move(std::span<const Move> moves, const MoveWeights& weights);

}  // namespace hearsay::grid
