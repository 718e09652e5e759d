// The radio network of a scenario as typed data: who hears whom, how packets leave and get lost.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/channel_spec.hpp"

namespace hearsay {

struct RadioSpec {
  /// "line" | "ring" | "star" | "full" | "edges" | "disk" | "by-position"
  std::string topology = "full";
  std::vector<std::array<int, 2>> edges;  ///< for "edges"; agents by number
  double range_m = 0.0;                   ///< for "disk", > 0
  double rate_bps = 1e6;                  ///< > 0
  int header_bytes = 0;                   ///< 0 … 65535
  int queue_packets_max = 64;             ///< 1 … 1e6
  double latency_s = 0.0;                 ///< ≥ 0
  /// > 0, for "disk" and "by-position": the way to a hearer takes distance / speed; none: no time
  std::optional<double> propagation_m_per_s;
  LossSpec loss;
  std::optional<PropagationSpec> propagation;  ///< for "by-position", which needs it
  std::vector<JammerSpec> jammers;
};

}  // namespace hearsay
