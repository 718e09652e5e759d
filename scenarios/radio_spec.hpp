// The radio network of a scenario as typed data: who hears whom, how packets leave and get lost.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "net/link_plan.hpp"
#include "scenarios/channel_spec.hpp"
#include "scenarios/link_spec.hpp"

namespace hearsay {

struct JitterSpec {
  std::string law = "none";          ///< "none" | "uniform" | "exponential"
  double spread_s = 0.0;             ///< ≥ 0; uniform: the most, exponential: the mean
  std::string order = "reordering";  ///< "reordering" | "in-order"
};

/// How radios share the channel.
struct SharingSpec {
  std::string model = "none";        ///< "none" | "slotted-aloha" | "carrier-sense" | "tdma"
  double slot_s = 0.0;               ///< > 0 unless "none"
  double send_probability = 1.0;     ///< slotted-aloha, [0.001, 1]
  int slots = 0;                     ///< tdma: in a cycle; 0: one an agent
  double interframe_s = 0.0;         ///< carrier-sense, ≥ 0
  int window_min = 16;               ///< carrier-sense: slots, 1 … 65536
  int window_max = 1024;             ///< carrier-sense: slots, window_min … 65536
  std::optional<double> capture_db;  ///< ≥ 0; none: no frame survives an overlap
};

struct AcknowledgementSpec {
  int bytes = 14;             ///< 1 … 65535
  double interframe_s = 0.0;  ///< ≥ 0
  int attempts_max = 7;       ///< 1 … 1000
};

/// For the services store-and-forward and blackboard.
struct GossipSpec {
  double summary_period_s = 1.0;     ///< > 0
  int summary_bytes_max = 1024;      ///< 128 … 65535
  int answers_max = 16;              ///< 1 … 65535
  int buffer_packets_max = 256;      ///< 1 … 1e6
  int hops_max = 255;                ///< 1 … 255
  std::optional<double> lifetime_s;  ///< > 0; none: no end
};

/// True for the services that these are for.
inline bool is_gossip(const std::string& service) {
  return service == "store-and-forward" || service == "blackboard";
}
/// The most that they put before a message, in bytes.
inline constexpr std::size_t gossip_header_bytes = 28;

struct RadioSpec {
  /// "line" | "ring" | "star" | "full" | "binary-tree" | "grid" | "erdos-renyi" | "small-world" |
  /// "random-geometric" | "edges" | "contacts" | "disk" | "by-position"
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
  double rate_bps = 1e6;                   ///< > 0
  int header_bytes = 0;                    ///< 0 … 65535
  std::optional<int> mtu_bytes;            ///< 1 … 1e9; none: a packet is one frame
  int queue_packets_max = 64;              ///< 1 … 1e6
  std::optional<int> queue_bytes_max;      ///< with headers, 1 … 1e9
  std::string queue_policy = "drop-new";   ///< "drop-new" | "drop-oldest" | "replace"
  std::optional<double> queue_wait_max_s;  ///< > 0
  std::optional<std::string> half_duplex;  ///< "on" | "off"; default: on if the channel is shared
  SharingSpec sharing;
  AcknowledgementSpec acknowledgement;
  GossipSpec gossip;
  double latency_s = 0.0;  ///< ≥ 0
  JitterSpec jitter;
  /// > 0, where links have lengths: the way to a hearer takes length / speed; none: no time
  std::optional<double> propagation_m_per_s;
  LossSpec loss;
  std::optional<PropagationSpec> propagation;  ///< for "by-position", which needs it
  std::vector<JammerSpec> jammers;
};

}  // namespace hearsay
