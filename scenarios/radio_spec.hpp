// The radio network of a scenario as typed data: who hears whom, how packets leave and get lost.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "net/link_plan.hpp"
#include "scenarios/link_spec.hpp"

namespace hearsay {

struct LossSpec {
  std::string model = "none";  ///< "none" | "bernoulli"
  double probability = 0.0;    ///< [0, 1]
};

struct RadioSpec {
  /// "line" | "ring" | "star" | "full" | "binary-tree" | "grid" | "erdos-renyi" | "small-world" |
  /// "random-geometric" | "edges" | "disk" | "contacts"
  std::string topology = "full";
  std::vector<std::array<int, 2>> edges;     ///< for "edges"; agents by number
  double range_m = 0.0;                      ///< for "disk" and "random-geometric", > 0
  std::optional<int> columns;                ///< for "grid", 1 … agents
  std::optional<double> link_probability;    ///< for "erdos-renyi", [0, 1]
  std::optional<int> mean_degree;            ///< for "small-world", even, 2 … agents − 1
  std::optional<double> rewire_probability;  ///< for "small-world", [0, 1]
  std::optional<double> side_m;              ///< for "random-geometric", > 0
  std::string contacts;                      ///< for "contacts": a CSV file
  /// What was read from `contacts`; shared by copies of the scenario.
  std::shared_ptr<const std::vector<LinkChange>> contact_trace;
  std::vector<OutageSpec> outages;
  std::vector<PartitionSpec> partitions;
  std::optional<RotationSpec> rotation;
  double rate_bps = 1e6;       ///< > 0
  int header_bytes = 0;        ///< 0 … 65535
  int queue_packets_max = 64;  ///< 1 … 1e6
  double latency_s = 0.0;      ///< ≥ 0
  /// > 0, for "disk" and "random-geometric": the way to a hearer takes distance / speed; none: no
  /// time
  std::optional<double> propagation_m_per_s;
  LossSpec loss;
};

}  // namespace hearsay
