// The source agent: makes traffic, and counts what it hears of others'. It believes nothing; it is
// there to measure radios.
//
// Packets are numbered from 0, and their numbers are ticks: the n-th packet of a source meets the
// same channel on a link, whatever became of those before it.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "agents/agent.hpp"
#include "agents/traffic/packet_sizes.hpp"

namespace hearsay {

struct SourceTraffic {
  enum class Arrivals : std::uint8_t {
    periodic,   ///< every `period`, from `phase` on
    poisson,    ///< with exponential times between them, `period` on average
    saturated,  ///< the next packet waits as soon as its predecessor leaves the queue
  };
  Arrivals arrivals = Arrivals::poisson;
  Duration period;  ///< > 0 unless saturated
  Duration phase;   ///< periodic: instant of packet 0, ≥ 0
  std::uint64_t packets_max = std::numeric_limits<std::uint64_t>::max();  ///< then it is silent
  PacketSizes sizes{PacketSizes::Law::fixed, 100};
  AgentId receiver = no_agent;  ///< no_agent: everybody who hears
  bool acknowledged = false;    ///< needs a receiver
};

class SourceAgent final : public Agent {
 public:
  /// Without traffic it listens only. Saturated traffic needs a queue with room for a packet behind
  /// the one that is being sent, and packets that take time.
  SourceAgent(Context& context, const std::optional<SourceTraffic>& traffic);

  void start() override;
  void on_packet(const Packet& packet) override;
  void on_up(bool forgets) override;
  void on_queue_empty() override { fill(); }
  /// Leaves heard_packets, delay_mean_s, goodput_bps.
  void finish() override;

 private:
  Process offer();
  Time after(Time arrival);
  void fill();
  void hand_over(bool up);

  std::optional<SourceTraffic> traffic_;
  NameId message_kind_;
  Stream gaps_, sizes_;
  std::vector<std::byte> payload_;  // zeros, as many as the largest packet so far had
  std::uint64_t made_ = 0;
  std::uint64_t heard_packets_ = 0;
  std::uint64_t heard_bytes_ = 0;
  Duration delay_;  // from hand-over to arrival, summed over heard_packets_
};

}  // namespace hearsay
