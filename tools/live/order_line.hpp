// Between an agent that keeps its own time and its world: orders, what the agent asks, and what it
// tells of itself.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <span>
#include <vector>

#include "agents/remote/distant_world.hpp"
#include "agents/remote/protocol.hpp"
#include "net/live/messages.hpp"
#include "net/live/port.hpp"
#include "tools/live/presence.hpp"
#include "tools/live/reactor.hpp"

namespace hearsay::fleet {

class OrderLine {
 public:
  /// Orders that wait while an answer is waited for: with more, the world is given up.
  static constexpr std::size_t orders_max = 10'000;

  /// `orders` and `answers` of agent `id`; they and the reactor outlive this. `seen` is told of
  /// each order when it comes, though it may have to wait.
  OrderLine(live::Reader& orders, live::Writer& answers, Reactor& reactor, AgentId id,
            std::function<void(const remote::Order&)> seen);

  /// The next order; false if there is none now.
  bool take(remote::Order& order);
  /// Asks, and waits for the order to go on, which is valid until anything else is asked.
  /// @throws remote::WorldGone if none will come: gone(), or life_over().
  const remote::Order& ask(std::span<const std::byte> question);
  /// Tells something, by and by: with the next question, or tell().
  void note(std::span<const std::byte> note) { Packer(answer_.notes).bytes(note); }
  /// What a Reporter is to write into, before tell().
  std::vector<std::byte>& report() { return answer_.content; }
  /// Tells what there is to tell: notes, and a report.
  void tell();

  /// Whether the world shows no sign of life any more. To be asked every now and then.
  bool gone();
  /// Whether the next order is to start anew, or none comes after it: the agent that asked is not
  /// answered.
  bool life_over() const { return life_over_; }
  /// How many questions were asked. (While one waits for the answer, other news may have come.)
  std::uint64_t asked() const { return asked_; }

 private:
  bool receive(remote::Order& order);
  void send(remote::AnswerKind kind);

  live::Reader& orders_;
  live::Writer& answers_;
  Reactor& reactor_;
  std::function<void(const remote::Order&)> seen_;
  Presence presence_{world_grace_s};
  live::Frame frame_;
  std::vector<std::byte> bytes_;
  remote::Answer answer_;
  remote::Order go_on_;
  std::deque<remote::Order> waiting_;
  std::uint64_t asked_ = 0;
  bool gone_ = false;
  bool life_over_ = false;
};

}  // namespace hearsay::fleet
