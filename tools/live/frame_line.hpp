// Orders and answers of lockstep as frames on the topics of one agent, at both ends.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "agents/remote/remote_agent.hpp"
#include "agents/remote/remote_world.hpp"
#include "net/live/messages.hpp"
#include "tools/live/presence.hpp"
#include "tools/live/reactor.hpp"
#include "tools/live/roster.hpp"

namespace hearsay::fleet {

/// From the world to an agent.
class FrameLine final : public remote::Line {
 public:
  /// All outlive this.
  FrameLine(Member& member, Reactor& reactor, AgentId id);

  bool exchange(const remote::Order& order, remote::Answer& answer) override;
  void tell(const remote::Order& order) override { write(order); }

 private:
  bool write(const remote::Order& order);

  Member& member_;
  Reactor& reactor_;
  Presence presence_{agent_grace_s};
  live::Frame out_, in_;
  std::vector<std::byte> bytes_;
};

/// From an agent to the world.
class FrameSuperior final : public remote::Superior {
 public:
  /// `orders` and `answers` of this agent. `progress` is told of each order, for who shows where
  /// the run is; may be empty. All outlive this.
  FrameSuperior(live::Reader& orders, live::Writer& answers, Reactor& reactor, AgentId id,
                std::function<void(const remote::Order&)> progress);

  /// Waits for the first order. @return false if none will come.
  bool wait(remote::Order& order);
  bool exchange(const remote::Answer& answer, remote::Order& order) override;

 private:
  live::Reader& orders_;
  live::Writer& answers_;
  Reactor& reactor_;
  std::function<void(const remote::Order&)> progress_;
  Presence presence_{world_grace_s};
  live::Frame out_, in_;
  std::vector<std::byte> bytes_;
};

}  // namespace hearsay::fleet
