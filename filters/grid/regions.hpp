// Alarms: regions of cells over a threshold, as positions with covariances, and how they compare
// with the truth. Merino 2007, section 4.2.2.
#pragma once

#include <span>
#include <vector>

#include "filters/gaussian/belief.hpp"
#include "filters/grid/bernoulli.hpp"
#include "filters/grid/beta.hpp"

namespace hearsay::grid {

/// Cells over the threshold that hang together by sides or corners, weighed by probability p
/// (eq. 4.20): position Σ p·r/Σp, covariance Σ p(r − position)(r − position)ᵀ/Σp, m². These are of
/// cell centres: a region in one row or of one cell has a singular covariance. cell²/12 an axis
/// adds the extent of the cells.
struct Region {
  int first_cell = 0;  ///< of least number
  int cells = 0;
  double mean_probability = 0.0;
  Point position;
  double xx_m2 = 0.0, xy_m2 = 0.0, yy_m2 = 0.0;
};

/// Finds regions; its storage is reused (no allocation once warm).
class RegionFinder {
 public:
  /// The regions of cells with p > threshold, by their first cells, valid until the next call.
  /// Probabilities of Beta grids are means. O(cells). @throws BrokenInvariant for a threshold
  /// outside [0, 1].
  std::span<const Region> find(const BernoulliGrid& grid, double threshold);
  std::span<const Region> find(const BetaGrid& grid, double threshold);

 private:
  template <typename Probability>
  void collect(const Area& area, const Probability& probability);
  void flood(const Area& area, int first);

  std::vector<unsigned char> marks_;  ///< over the threshold, in no region yet
  std::vector<int> members_;          ///< of the region at hand, in the order of discovery
  std::vector<Region> regions_;
};

/// Regions beside true places.
struct Match {
  int detected = 0;               ///< places with a region
  int missed = 0;                 ///< places without
  int false_alarms = 0;           ///< regions without a place
  double position_error_m = 0.0;  ///< root mean square over the detected; 0 if none is
  std::vector<int> place_of;      ///< of each region, or −1
};
/// Pairs regions with places nearer than `gate_m` > 0, each with one at most, so that Σ distance +
/// ½·gate·(missed + false alarms) is least: GOSPA of order 1 (filters/tracking/ospa.hpp).
/// @throws BrokenInvariant for another gate.
Match match(std::span<const Region> regions, std::span<const Point> places, double gate_m);

/// Alarms cell by cell, for an operating curve: P_D = hits/true_cells,
/// P_F = false_alarms/empty_cells.
struct CellRates {
  int hits = 0, true_cells = 0;
  int false_alarms = 0, empty_cells = 0;
};
/// `marks`: from mark_above(); `truth`: 1 where there is something, 0 elsewhere. @throws
/// BrokenInvariant unless they are of one length.
CellRates cell_rates(std::span<const unsigned char> marks, std::span<const unsigned char> truth);

}  // namespace hearsay::grid
