// The radio network: every agent's transmitter and the medium between them.
//
// A transmitter is a FIFO: packets leave one after another at `rate_bps`, at most
// `queue_packets_max` wait or are being sent; a packet beyond is dropped (queue_full). What has
// left arrives `latency` later at every hearer, and later still by the way there at
// `propagation_m_per_s`, unless the channel loses it. Losses are keyed draws (seed, link, tick), so
// the same packets are lost under every fusion rule.
//
// A broadcast goes from hearer to hearer, by delay and then by number. Those of one delay are one
// event; it schedules the next delay's when its hearers have heard. Ties with other events are
// settled by that: what was in the queue by then comes first.
//
// Every packet ends in exactly one fate per potential receiver: the neighbours for a broadcast, the
// addressee for an addressed packet. Each fate is a row of the simulation's record (its bytes are
// the payload's) and is counted for the sender. finish() settles what is under way at the end and
// checks that fates and packets balance.
//
// Nothing is allocated a packet once pools and queues have grown to what the traffic needs.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "net/packet.hpp"
#include "net/topology.hpp"
#include "sim/kernel/simulation.hpp"

namespace hearsay {

struct RadioOptions {
  double rate_bps = 1e6;                 ///< bits a second, > 0, finite
  std::uint32_t header_bytes = 0;        ///< added to each packet's bytes
  std::uint32_t queue_packets_max = 64;  ///< waiting or being sent, ≥ 1
  Duration latency = {};                 ///< ≥ 0, from the last bit sent to arrival
  double loss_probability = 0.0;         ///< Bernoulli, a packet and link, in [0, 1]
  /// > 0; the way to a hearer takes link length / speed more, to the nearest nanosecond. Infinite:
  /// no time. A finite speed needs a topology with positions.
  double propagation_m_per_s = std::numeric_limits<double>::infinity();
};

/// Gets packets; called in Phase::update, with failures charged to the hearer. It may send, also
/// the very bytes that it got.
class Receiver {
 public:
  virtual ~Receiver() = default;
  virtual void on_packet(const Packet& packet) = 0;
};

/// Sums over a run, for one sender. Before Radio::finish(), bytes_sent and air_time include packets
/// that still wait.
struct SenderCounts {
  std::uint64_t packets = 0;     ///< handed to the radio
  std::uint64_t bytes_sent = 0;  ///< payload and header of packets whose sending began
  std::uint64_t expected = 0;    ///< potential receivers of these packets, summed
  std::array<std::uint64_t, fate_count> fates{};
  Duration air_time = {};  ///< time the transmitter was busy
};

/// @throws BrokenInvariant, naming agent and numbers, unless the fates add up to what was expected.
void require_balance(AgentId sender, const SenderCounts& counts);

class Radio {
 public:
  /// `simulation` must outlive the radio.
  /// @throws InputError for an option outside its range.
  Radio(Simulation& simulation, Topology topology, const RadioOptions& options);
  /// Takes back what is under way: no receiver is called any more, riders are released.
  ~Radio();
  Radio(const Radio&) = delete;
  Radio& operator=(const Radio&) = delete;

  /// Whoever is attached hears; an agent nobody attached is deaf, its packets count as delivered.
  /// `receiver` must outlive the radio.
  void attach(AgentId agent, Receiver& receiver);

  /// Hands a packet to `sender`'s transmitter. Sending takes the time of its bytes and the header
  /// at `rate_bps`, to the nearest nanosecond. An addressee that does not hear the sender makes the
  /// packet out_of_range once it is sent.
  /// @return false if the queue was full.
  /// @throws BrokenInvariant for a sender or addressee outside 0 … n−1, a tick of 2^48 or more, or
  /// 4 GiB or more of bytes.
  bool send(AgentId sender, const Outgoing& packet);

  const Topology& topology() const { return topology_; }
  /// Sums of `sender`, 0 … n−1. @throws BrokenInvariant for another.
  const SenderCounts& counts(AgentId sender) const;

  /// Settles packets under way as in_flight_at_end, in the order in which they were sent. To be
  /// called after the run, not by a receiver.
  /// @throws BrokenInvariant if a sender's fates do not add up to what was expected.
  void finish();

 private:
  struct Ear;
  struct Sender;
  struct Route;
  struct Transmission;
  std::size_t index(AgentId agent, const char* role) const;
  void order_arrivals();
  std::uint32_t take_slot();
  void reserve(std::vector<std::byte>* buffer, std::size_t bytes);
  void release_slot(std::uint32_t slot);
  Duration air_time(std::uint64_t bytes);
  Duration delay(std::size_t link) const;
  Route route(AgentId sender, const AgentId& receiver) const;
  void draw_losses(const Outgoing& packet, const Route& route, std::uint8_t* lost);
  void drop(AgentId sender, const Outgoing& packet);
  void schedule(std::uint32_t slot);
  void arrive(std::uint32_t slot);
  void settle(MessageRow* row, AgentId receiver, Fate fate);

  Simulation& simulation_;
  Topology topology_;
  RadioOptions options_;
  std::vector<Receiver*> receivers_;
  std::vector<Sender> senders_;
  // The neighbours of each sender in the order in which a broadcast arrives, rows as in the
  // topology. Empty if the way takes no time: then they hear at once.
  std::vector<Ear> ears_;
  // Pooled. Each stays where it is: a receiver may send, and so grow the pool, during a delivery.
  std::vector<std::unique_ptr<Transmission>> slots_;
  std::vector<std::uint32_t> free_slots_;
  std::vector<std::uint64_t> link_packets_;  // packets without tick so far, a link
  std::uint64_t transmissions_ = 0;
  std::size_t hearers_max_ = 1;       // of a broadcast of anybody; an addressed packet has one
  std::size_t packet_bytes_max_ = 0;  // so far
  std::uint64_t air_bytes_ = 0;       // what air_time_ is the time of
  Duration air_time_;
  std::array<NameId, fate_count> fate_names_{};
};

}  // namespace hearsay
