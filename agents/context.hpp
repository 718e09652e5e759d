// What one agent can do in its world: tell the time, sleep, draw, talk, leave a trace in the
// record.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "net/gossip.hpp"
#include "net/radio_port.hpp"
#include "net/steering.hpp"
#include "sim/kernel/process.hpp"
#include "sim/kernel/simulation.hpp"

namespace hearsay {

class Context {
 public:
  struct Identity {
    AgentId id = 0;
    std::string name;
    std::string kind;
    std::map<std::string, double> parameters;  ///< [agents.parameters] of the scenario
  };
  /// How what it says travels; by default straight over the radio.
  struct Service {
    bool acknowledged = false;   ///< repeated until acknowledged
    Gossip* gossip = nullptr;    ///< instead, by store-and-forward or a blackboard; not owned
    Steering* steers = nullptr;  ///< what the agent is steered by, if it may be; not owned
  };
  /// `simulation`, `radio` and the service must outlive the context.
  Context(Simulation& simulation, RadioPort& radio, Identity identity, Service service);
  Context(Simulation& simulation, RadioPort& radio, Identity identity)
      : Context(simulation, radio, std::move(identity), Service()) {}

  AgentId id() const { return identity_.id; }
  const std::string& name() const { return identity_.name; }
  const std::string& kind() const { return identity_.kind; }
  /// A number from [agents.parameters], or `otherwise` if the scenario does not give it.
  double parameter(const std::string& name, double otherwise) const;

  Time now() const { return simulation_.now(); }
  /// When the run ends; events at this instant still happen.
  Time end() const { return simulation_.end(); }

  /// co_await context().sleep(5_s). A process that looks at the world uses Phase::measure, so that
  /// at one instant all look before anybody talks.
  Sleep sleep(Duration span, Phase phase = Phase::act) {
    return hearsay::sleep(simulation_, span, phase);
  }
  Sleep sleep_until(Time until, Phase phase = Phase::act) {
    return hearsay::sleep_until(simulation_, until, phase);
  }

  /// Draws of this agent's own for `purpose`; other agents and purposes are independent of it.
  Stream stream(std::string_view purpose) const;
  /// The draws that belong to the `count`-th thing of that name.
  Stream stream_at(std::string_view purpose, std::uint64_t count) const;

  /// Where the agent is, exact at any time. @throws BrokenInvariant if the scenario does not say.
  Point position() const { return radio_.position(id()); }
  /// True if the agent decides where it goes (agents.motion.kind = "steered").
  bool steered() const { return service_.steers != nullptr; }
  /// Turns straight to a place in the plane, at its altitude, and stays there, unless it is sent
  /// elsewhere before. Speed > 0 m/s. @return when it will be there: now, if it is there.
  /// @throws BrokenInvariant for one that is not steered, another speed, or a place beyond ±1e12 m.
  Time go_to(const std::array<double, 2>& place_m, double speed_m_per_s);
  /// Stops where it is.
  void stay();
  /// Moves along a leg, which begins now where it is; Steering::steer() says more.
  /// @throws BrokenInvariant for one that is not steered.
  void steer(const Leg& leg);
  /// False while the agent is down: it cannot look, talk or hear.
  bool up() const { return radio_.up(id()); }
  /// Whom a broadcast reaches now if nothing is lost, by number. Valid until anybody asks again.
  std::span<const AgentId> neighbours() { return radio_.neighbours(id()); }
  /// True if neighbours() may change over time.
  bool neighbours_change() const { return radio_.neighbours_change(); }
  /// Packets that wait in the queue of its radio, without the one that is being sent.
  std::size_t waiting() const { return radio_.waiting(id()); }
  /// From now on the agent's on_queue_empty() is called when the last of them has left the queue.
  void tell_of_empty_queue() { radio_.tell_of_empty_queue(id()); }
  /// True if packets may come from others than neighbours() at the start of the run.
  bool hears_strangers() const { return service_.gossip || radio_.neighbours_change(); }
  /// Says something by the agent's service (agents.talk.service). Store-and-forward: a bundle; a
  /// receiver is its addressee, however far. Blackboard: the slot of this kind and subject.
  /// Acknowledged: what has no receiver goes to each neighbour. Broadcast: a packet. One that asks
  /// for acknowledgement itself always goes over the radio.
  /// @return false if nothing of it was taken: the agent is down, its radio's queue or the
  /// blackboard is full, nobody is there to acknowledge it.
  bool send(const Outgoing& packet);
  /// The same, to everybody who can hear.
  bool broadcast(std::string_view kind, std::span<const std::byte> bytes);

  /// Keeps a value over time: a row of `series`.
  void record(std::string_view name, double value);
  /// Keeps a value of the whole run: a row of `scalar`.
  void record_final(std::string_view name, double value);
  /// Keeps an event: a row of `event`.
  void record_event(std::string_view kind, std::string_view detail);

  Simulation& simulation() { return simulation_; }

 private:
  bool send_to_each(Outgoing packet);

  Simulation& simulation_;
  RadioPort& radio_;
  Identity identity_;
  Service service_;
  std::vector<AgentId> listeners_;  // of what is being said
};

}  // namespace hearsay
