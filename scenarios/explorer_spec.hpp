// What a scenario says about areas, and agents that explore them with certainty grids.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "filters/grid/relief.hpp"

namespace hearsay {

/// Numbers in a list, of any length.
struct NumberList {
  std::vector<double> values;
  bool operator==(const NumberList&) const = default;
};

/// The part of the plane that grids are about.
struct AreaSpec {
  int columns = 20;                            ///< 1 … 4096
  int rows = 20;                               ///< 1 … 4096
  double cell_m = 1.0;                         ///< > 0
  std::vector<double> origin_m = {0.0, 0.0};   ///< the corner of least x and y
  std::optional<std::string> heights;          ///< of cells, a CSV file; none: level
  std::shared_ptr<const grid::Relief> relief;  ///< what is in the file; the checks read it
};

/// What an explorer believes, and how it tells of it.
struct GridSpec {
  std::string belief = "bernoulli";    ///< | "beta"
  std::string fusion = "none";         ///< a name of grid::rules() that goes with the belief
  std::optional<double> omega;         ///< rules that weigh: of the own belief, 0 … 1; none: ½
  std::optional<double> prior;         ///< "bernoulli": of each cell, in (0, 1); none: ½
  std::optional<double> prior_alpha;   ///< "beta": > 0; none: 1
  std::optional<double> prior_beta;    ///< "beta": > 0; none: 1
  std::optional<double> log_odds_max;  ///< "bernoulli": > 0, at most 64; none: 20
  std::string message = "whole";       ///< | "changed" | "runs"
  std::optional<int> whole_every;      ///< "changed": every so many talks a whole one, ≥ 1
  int packet_bytes_max = 1400;         ///< 64 … 65000
  bool operator==(const GridSpec&) const = default;
};

/// Where a steered explorer goes.
struct ExplorationSpec {
  std::string choice = "gain";         ///< | "random-walk"
  std::string vehicle = "holonomic";   ///< | "constant-speed"
  double speed_m_per_s = 1.0;          ///< > 0
  std::optional<double> turn_max_rad;  ///< "constant-speed": > 0, below π; none: π/4
  std::optional<int> headings;         ///< "constant-speed": odd, 3 … 63; none: 5
  std::optional<int> horizon_cells;    ///< "gain": 1 … 4096; none: 1
  std::optional<double> gain_weight;   ///< "gain": 0 … 1e9; none: 1
  std::optional<double> cost_weight;   ///< "gain": 0 … 1e9; none: 0
  bool operator==(const ExplorationSpec&) const = default;
};

/// How alarms of explorers are judged.
struct AlarmSpec {
  NumberList thresholds{{0.8}};  ///< rising, each in (0, 1); at least one
  std::optional<double> gate_m;  ///< > 0; none: two cells
  bool operator==(const AlarmSpec&) const = default;
};

}  // namespace hearsay
