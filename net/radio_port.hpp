// What an agent can ask of its radio, be it simulated here (net/radio) or in another process.
#pragma once

#include <cstddef>
#include <span>

#include "net/packet.hpp"
#include "sim/kernel/ids.hpp"
#include "sim/kernel/leg.hpp"

namespace hearsay {

/// Gets packets; called in Phase::update, with failures charged to the hearer. It may send, also
/// the very bytes that it got.
class Receiver {
 public:
  virtual ~Receiver() = default;
  virtual void on_packet(const Packet& packet) = 0;
  /// What became of a packet of its own that was to be acknowledged: whether it was, before the
  /// attempts ran out. (It may have arrived all the same.)
  virtual void on_outcome(const Packet& packet, bool acknowledged) {
    static_cast<void>(packet);
    static_cast<void>(acknowledged);
  }
  /// The last packet that waited in its transmitter's queue has left it: is being sent, or has
  /// expired. Called for who asked, RadioPort::tell_of_empty_queue(). It may send.
  virtual void on_queue_empty() {}
};

class RadioPort {
 public:
  virtual ~RadioPort() = default;

  /// Hands a packet to `sender`'s transmitter; Radio::send() says more.
  /// @return false if the packet was dropped: the queue was full, or the agent is down.
  virtual bool send(AgentId sender, const Outgoing& packet) = 0;
  /// From now on the agent's receiver is told when its queue is empty, Receiver::on_queue_empty().
  virtual void tell_of_empty_queue(AgentId agent) = 0;
  /// Packets in the agent's queue, without the one that is being sent.
  virtual std::size_t waiting(AgentId agent) const = 0;
  virtual bool up(AgentId agent) const = 0;
  /// Whom a broadcast of `agent` may reach now, by number. Valid until the next call.
  virtual std::span<const AgentId> neighbours(AgentId agent) = 0;
  /// True if they may change over time.
  virtual bool neighbours_change() const = 0;
  /// Where `agent` is now. @throws BrokenInvariant if nobody knows.
  virtual Point position(AgentId agent) const = 0;
};

}  // namespace hearsay
