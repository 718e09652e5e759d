// The radio network: every agent's transmitter and the channel between them.
//
// A transmitter sends packets one after another at `rate_bps`, cut into frames of at most
// `mtu_bytes`; the rest waits in a bounded queue. Where the channel is shared, each frame first
// needs the air (net/access) and may be spoilt there (net/receptions). What has left arrives
// `latency` later at every hearer, and later still by the way there, unless the channel
// (net/channel) or a fault spoils it.
//
// A broadcast goes from hearer to hearer, by delay and then by number. Those of one delay are one
// event; it schedules the next delay's when its hearers have heard. Ties with other events are
// settled by that: what was in the queue by then comes first.
//
// Every packet ends in exactly one fate per potential receiver: whoever may hear a broadcast, the
// addressee of an addressed packet. Each fate is a row of the simulation's record (its bytes are
// the payload's) and is counted for the sender. finish() settles what is under way at the end and
// checks that fates and packets balance.
//
// Nothing is allocated a packet once pools and queues have grown to what the traffic needs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "net/channel.hpp"
#include "net/packet.hpp"
#include "net/radio_options.hpp"
#include "net/radio_port.hpp"
#include "net/receptions.hpp"
#include "net/send_queue.hpp"
#include "net/topology.hpp"
#include "net/traffic.hpp"
#include "net/transmission.hpp"
#include "sim/kernel/simulation.hpp"

namespace hearsay {

class Radio final : public RadioPort, private AccessUser {
 public:
  /// `simulation` must outlive the radio.
  /// @throws InputError for an option outside its range, or that does not fit the topology.
  Radio(Simulation& simulation, Reach reach, const RadioOptions& options);
  /// A graph that does not change.
  Radio(Simulation& simulation, Topology topology, const RadioOptions& options)
      : Radio(simulation, Reach{.topology = std::move(topology)}, options) {}
  /// Takes back what is under way: no receiver is called any more, riders are released.
  ~Radio() override;
  Radio(const Radio&) = delete;
  Radio& operator=(const Radio&) = delete;

  /// Whoever is attached hears; an agent nobody attached is deaf, its packets count as delivered.
  /// `receiver` must outlive the radio.
  void attach(AgentId agent, Receiver& receiver);

  /// Sending takes the time of its bytes and a header a
  /// frame at `rate_bps`, to the nearest nanosecond. An addressee that does not hear the sender
  /// makes the packet out_of_range once it is sent.
  /// @throws BrokenInvariant for a sender or addressee outside 0 … n−1, a tick of 2^48 or more,
  /// 4 GiB or more of bytes, more than frames_max frames, or a broadcast to be acknowledged.
  /// @throws InputError for a packet that an empty queue has no room for, or of which a frame takes
  /// longer than the slot that it must fit into (slotted ALOHA, TDMA).
  bool send(AgentId sender, const Outgoing& packet) override;

  void tell_of_empty_queue(AgentId agent) override {
    stations_[index(agent, "agent")].tells = true;
  }
  std::size_t waiting(AgentId agent) const override {
    return stations_[index(agent, "agent")].waiting.size();
  }

  /// The agent fails, or is back. While it is down it hears nothing; its packets that wait or are
  /// on the air are lost (sender_down), and so is what was on its way to it (receiver_down).
  void set_up(AgentId agent, bool up);
  bool up(AgentId agent) const override { return stations_[index(agent, "agent")].up; }

  std::span<const AgentId> neighbours(AgentId agent) override { return channel_.neighbours(agent); }
  bool neighbours_change() const override { return channel_.neighbours_change(); }
  Point position(AgentId agent) const override { return channel_.position(agent); }
  const Topology& topology() const { return channel_.topology(); }
  /// Sums of `sender`, 0 … n−1. @throws BrokenInvariant for another.
  const SenderCounts& counts(AgentId sender) const {
    index(sender, "sender");
    return traffic_.sender(sender);
  }
  /// Calls visit(sender, receiver, fates) for each link, by sender and receiver; for none unless
  /// links are counted.
  template <class Visit>
  void visit_links(Visit visit) const {
    if (traffic_.links().empty()) return;
    channel_.visit_links([&](AgentId from, AgentId to, std::uint32_t link) {
      if (link < traffic_.links().size()) visit(from, to, traffic_.links()[link]);
    });
  }

  /// Settles packets under way as in_flight_at_end, in the order in which they were sent. To be
  /// called after the run, not by a receiver.
  /// @throws BrokenInvariant if a sender's fates do not add up to what was expected.
  void finish();

 private:
  /// What belongs to a transmitter, together in memory.
  struct alignas(64) Station {
    SendQueue waiting;
    Time free_at;              // when the last bit of what is on the air will have left
    EventId next;              // takes the next from the queue
    std::uint32_t on_air = 0;  // the last packet of which sending began, if held or before free_at
    bool held = false;         // by on_air: more frames of it, or an acknowledgement, are to come
    bool asked = false;        // for the air
    bool up = true;
    bool tells = false;  // its receiver wants to know when nothing waits any more
    bool sends(Time now) const { return held || free_at > now; }
  };
  // True if the transmitter is busy, be it with somebody else's acknowledgement.
  bool busy(AgentId agent, Time now) const {
    return stations_[static_cast<std::size_t>(agent)].sends(now) ||
           (receptions_ && receptions_->sends_until(agent) > now);
  }
  bool up_throughout(AgentId agent, Time since) const {
    const auto a = static_cast<std::size_t>(agent);
    return up_since_.empty() || (stations_[a].up && up_since_[a] <= since);
  }
  Station& station(AgentId agent) { return stations_[static_cast<std::size_t>(agent)]; }
  std::size_t index(AgentId agent, const char* role) const {
    if (agent < 0 || agent >= channel_.agents()) refuse(agent, role);
    return static_cast<std::size_t>(agent);
  }
  [[noreturn]] void refuse(AgentId agent, const char* role) const;
  std::uint64_t air_bytes(std::uint64_t bytes) const;
  std::uint32_t frames_of(std::uint64_t bytes) const;
  Duration air_time(std::uint64_t bytes);

  // Hand-over and arrival (radio.cpp).
  void require_sound(AgentId sender, const Outgoing& packet) const;
  void require_fits_slot(std::uint64_t bytes);
  std::uint32_t take(AgentId sender, const Outgoing& packet);
  void aim(Transmission& t, bool draws);
  bool admit(AgentId sender, std::uint32_t slot);
  bool replace_waiting(AgentId sender, std::uint32_t slot);
  void settle_rest(std::uint32_t slot, Fate fate);
  void schedule(std::uint32_t slot);
  void arrive(std::uint32_t slot);
  // What the fate of a packet is at the i-th hearer, whom it reaches now.
  Fate fate_now(const Transmission& t, std::size_t i) const {
    return channel_.quiet() && up_since_.empty() ? t.fates[i] : fate_on_arrival(t, i);
  }
  Fate fate_on_arrival(const Transmission& t, std::size_t i) const;
  void deliver(const Packet& packet);
  // Sending (radio_air.cpp).
  void wake(AgentId sender);
  void ask(AgentId sender, int repetition);
  void granted(AgentId sender) override;
  void take_next(AgentId sender);
  void drop_expired(AgentId sender);
  void tell_if_empty(AgentId sender);
  void begin(std::uint32_t slot);
  void begin_frames(std::uint32_t slot);
  void end_frames(std::uint32_t slot);
  void put_broadcast_on_air(Transmission& t);
  void take_broadcast_off_air(Transmission& t);
  void put_on_air(Transmission& t, AgentId from, AgentId to, Fate& fate, Time end);
  void take_off_air(Transmission& t, AgentId from, AgentId to, const Fate& fate);
  void let_go(AgentId sender);
  void cut_off(AgentId sender);
  // Acknowledgement (radio_acknowledgement.cpp).
  void arrive_acknowledged(std::uint32_t slot);
  void answer(std::uint32_t slot);
  void end_answer(std::uint32_t slot);
  void end_answer_on_air(std::uint32_t slot);
  void repeat(std::uint32_t slot);
  void conclude(std::uint32_t slot, bool acknowledged);

  Simulation& simulation_;
  RadioOptions options_;
  Channel channel_;
  Traffic traffic_;
  std::vector<Receiver*> receivers_;
  std::vector<Station> stations_;
  TransmissionPool slots_;
  std::unique_ptr<Access> access_;          // null: everybody sends at will
  std::unique_ptr<Receptions> receptions_;  // null: frames do not meet
  std::vector<Time> up_since_;              // if it is up; empty as long as nobody was down
  std::uint64_t air_bytes_ = 0;             // what air_time_ is the time of
  Duration air_time_;
};

}  // namespace hearsay
