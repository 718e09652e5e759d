// Packets of agents on the topics of their kinds, one partition at a time.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "net/live/envelope.hpp"
#include "net/live/port.hpp"
#include "scenarios/run.hpp"

namespace hearsay::fleet {

/// What an agent may say: a kind of message, and what its beliefs are about.
struct Tongue {
  std::string kind;
  live::States states = live::States::still;
  // Of grids: cells, and numbers a cell.
  int cells = 0;
  std::size_t layers = 1;
  auto operator<=>(const Tongue&) const = default;
};
/// Of each agent of a scenario, by number: those who estimate speak the kinds of their rules; what
/// sources and agents of a user's own kinds say is known to themselves alone, and travels as
/// octets.
std::vector<Tongue> tongues_of(const PreparedScenario& prepared);
Tongue tongue_of(const PreparedScenario& prepared, AgentId id);

/// Whether a message can be taken in: it is well-formed, all numbers are finite, no belief in it is
/// indefinite, and a grid is of the area's shape. Of kinds that no codec knows nobody can say:
/// true.
bool is_sound(const Tongue& tongue, std::span<const std::byte> message);

/// Where an agent says what the world's radio is to carry.
std::string said_partition(const std::string& fleet, AgentId agent);

struct Parcel {
  live::Envelope envelope;
  std::string kind;
  std::vector<std::byte> message;
};

class AirOut {
 public:
  /// `port` outlives this.
  AirOut(live::Port& port, std::string partition);
  /// @return false if DDS would not take it.
  bool write(const Tongue& tongue, const Parcel& parcel);

 private:
  live::Port& port_;
  std::string partition_;
  std::map<std::string, live::Writer> writers_;  // by topic
  std::vector<std::byte> bytes_;
};

class AirIn {
 public:
  /// `tongues`: what is heard; one may stand there more than once.
  AirIn(live::Port& port, const std::string& partition, const std::vector<Tongue>& tongues);
  /// The next packet, whatever its kind; false if there is none now. What is unsound, or no packet
  /// at all, is passed over and counted.
  bool take(Parcel& parcel);
  std::uint64_t dropped() const;

 private:
  struct Ear {
    Tongue tongue;
    live::Reader reader;
  };
  bool hear(Ear& ear, Parcel& parcel);
  bool hear_octets(Ear& ear, Parcel& parcel);

  std::vector<Ear> ears_;
  std::vector<std::byte> bytes_;
  std::uint64_t dropped_ = 0;
};

}  // namespace hearsay::fleet
