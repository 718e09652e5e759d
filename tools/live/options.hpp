// What the processes of a fleet are told when they start.
#pragma once

#include <cstdint>
#include <string>

#include "sim/kernel/ids.hpp"

namespace hearsay::fleet {

/// How they find each other; the same for the world and its agents.
struct FleetOptions {
  std::string fleet = "hearsay";  ///< live::is_fleet_name()
  std::string interface;          ///< of the network; empty: this machine alone
  std::uint32_t domain = 77;
};

struct WorldOptions {
  FleetOptions fleet;
  std::uint64_t seed = 1;
  bool lockstep = false;
  double speed = 1.0;        ///< real time: simulated seconds a second, > 0
  bool direct = false;       ///< real time: agents hear each other without the world's radio
  double patience_s = 30.0;  ///< how long it waits for all agents to come
  std::string scenario_hash;
  std::string version;
};

struct AgentOptions {
  FleetOptions fleet;
  AgentId id = 0;
  bool direct = false;
  double patience_s = 30.0;  ///< how long it waits for a world
  std::string memory;        ///< file that keeps what it remembers; empty: none
  std::string scenario_hash;
  std::string version;
};

/// Real time: what begins later than this, by the clock on the wall, has missed its deadline.
inline constexpr double deadline_s = 0.010;

}  // namespace hearsay::fleet
