// The part of describe.hpp about areas, and agents that explore them.
#pragma once

#include <string>
#include <vector>

#include "filters/grid/area.hpp"
#include "filters/grid/fusion.hpp"
#include "filters/grid/sensors.hpp"
#include "scenarios/explorer_spec.hpp"
#include "scenarios/reading.hpp"

namespace hearsay {

inline std::vector<std::string> grid_fusion_names() {
  std::vector<std::string> names;
  for (const auto& rule : grid::rules()) names.emplace_back(rule.name);
  return names;
}

inline std::vector<std::string> detector_names() {
  std::vector<std::string> names;
  for (const auto& named : grid::detectors()) names.emplace_back(named.name);
  return names;
}

template <class V>
void describe(V& v, AreaSpec& s) {
  v.field("columns", s.columns, between(1, grid::Area::side_max), "cells along x");
  v.field("rows", s.rows, between(1, grid::Area::side_max), "cells along y");
  v.field("cell_m", s.cell_m, greater_than_zero(), "side of a cell");
  v.field("origin_m", s.origin_m, anything(), "the corner of least x and y: 2 coordinates");
  v.field("heights", s.heights, anything(),
          "CSV with x0,x1,…: the height of each cell over z = 0, m, the row of greatest y first; "
          "relative to the scenario file, or with --set as given; default: level");
}

template <class V>
void describe(V& v, GridSpec& s) {
  v.field("belief", s.belief, one_of({"bernoulli", "beta"}),
          "of each cell: that there is something, or how often something is seen");
  v.field("fusion", s.fusion, one_of(grid_fusion_names()),
          "how a grid that was heard is taken in: hearsay list rules");
  v.field("omega", s.omega, between(0.0, 1.0),
          "rules that weigh: weight of the own belief; default 0.5");
  v.field("prior", s.prior, between(1e-6, 1.0 - 1e-6), "\"bernoulli\": of each cell; default 0.5");
  v.field("prior_alpha", s.prior_alpha, between(1e-6, 1e6), "\"beta\": of each cell; default 1");
  v.field("prior_beta", s.prior_beta, between(1e-6, 1e6), "\"beta\": of each cell; default 1");
  v.field("log_odds_max", s.log_odds_max, above_zero_to(64.0),
          "\"bernoulli\": no cell is believed in more firmly, nats; default 20");
  v.field("message", s.message, one_of({"whole", "changed", "runs"}),
          "every cell, cells that changed since they were told, or equal neighbours told once");
  v.field("whole_every", s.whole_every, between(1, 1e6),
          "\"changed\": every so many talks it tells every cell, so that what was lost is told "
          "again; default: never");
  v.field("packet_bytes_max", s.packet_bytes_max, between(64, 65000),
          "messages are cut into packets of at most so many bytes, without the radio's header");
}

template <class V>
void describe(V& v, ExplorationSpec& s) {
  v.field("choice", s.choice, one_of({"gain", "random-walk"}),
          "where a look is expected to tell most, or anywhere");
  v.field("vehicle", s.vehicle, one_of({"holonomic", "constant-speed"}),
          "goes to one of eight neighbour cells or stays, or goes on after a turn");
  v.field("speed_m_per_s", s.speed_m_per_s, greater_than_zero(), "how fast it flies");
  v.field("turn_max_rad", s.turn_max_rad, between(1e-3, 3.14),
          "\"constant-speed\": sharpest turn a cell; default π/4");
  v.field("headings", s.headings, between(3, 63),
          "\"constant-speed\": how many turns it chooses from, odd; default 5");
  v.field("horizon_cells", s.horizon_cells, between(1, grid::Area::side_max),
          "\"gain\": how far ahead a move is judged; default 1");
  v.field("gain_weight", s.gain_weight, between(0.0, 1e9), "\"gain\": of a nat; default 1");
  v.field("cost_weight", s.cost_weight, between(0.0, 1e9),
          "\"gain\": of a cell of way, or half a turn; default 0");
}

template <class V>
void describe(V& v, AlarmSpec& s) {
  v.field("thresholds", s.thresholds, between(1e-9, 1.0 - 1e-9),
          "cells of more probability raise an alarm; the first counts for alarms_found_s");
  v.field("gate_m", s.gate_m, greater_than_zero(),
          "an alarm farther from all targets is false; default: two cells");
}

}  // namespace hearsay
