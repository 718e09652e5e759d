// An agent in another process that moves in lockstep with this world: it is told what happens to
// it, one thing after another, and the world waits until it has acted.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "agents/estimator_witness.hpp"
#include "agents/remote/distant_world.hpp"
#include "agents/remote/protocol.hpp"
#include "agents/remote/stand_in.hpp"

namespace hearsay::remote {

/// The way to an agent.
class Line {
 public:
  virtual ~Line() = default;
  /// Gives the order and waits for the answer. @return false if there is none: the agent's process
  /// is gone, or talks nonsense.
  virtual bool exchange(const Order& order, Answer& answer) = 0;
  /// Gives an order to which there is no answer.
  virtual void tell(const Order& order) = 0;
};

/// In a world: does what an agent elsewhere asks for, `question`, with its context or at its desk
/// (null: it has none), and writes the answer.
/// @throws BrokenInvariant for a question that is malformed, or asked by the wrong agent.
void serve(std::span<const std::byte> question, Context& context, Desk* desk,
           std::vector<std::byte>& answer);
/// The same for notes, one after another. `scratch` is room.
void take_notes(std::span<const std::byte> notes, Context& context, Desk* desk,
                std::vector<std::byte>& scratch);

/// What the agent of `context` can see, but for its neighbours. `knows_place`: the scenario says
/// where it is.
Surroundings surroundings_of(const Context& context, bool knows_place);

class RemoteAgent final : public StandIn {
 public:
  struct Options {
    bool knows_place = false;  ///< the scenario says where it is
    int subjects = 0;          ///< that it estimates
    int dimension = 0;         ///< n of each
    bool moving = false;       ///< they move
  };
  /// `world`: what it has there, beside its radio. All outlive this.
  RemoteAgent(Context& context, Line& line, const Belongings& world, const Options& options);

  void start() override;
  void on_measurement(const Measurement& measurement) override;
  void on_packet(const Packet& packet) override;
  void on_outcome(const Packet& packet, bool acknowledged) override;
  void on_queue_empty() override;
  void on_down() override;
  void on_up(bool forgets) override;
  void finish() override;
  Believer& believer() override { return believer_; }
  std::span<const std::byte> state() override;

  /// Its process is gone; nothing is asked of it until join(). What it believes nobody knows.
  bool silent() const { return silent_; }
  /// Another process has taken its place, whether or not it was seen to fall silent: it begins now,
  /// as one that lost its memory. (One that remembers says so itself.)
  void join();

 private:
  /// What it believes now; asked for when somebody wants to know.
  class Beliefs final : public Believer {
   public:
    explicit Beliefs(RemoteAgent& agent) : agent_(agent) {}
    void advance(std::int64_t now) override;
    const TrackedBelief& tracked(int subject) const override;
    const EstimatorCounts& counts() const override;

   private:
    RemoteAgent& agent_;
  };

  Order order(OrderKind kind);
  Order order_about(OrderKind kind, const Packet& packet);
  /// Lets the agent act on the order, and does what it asks for.
  void give(Order order);
  bool exchange(const Order& order);
  void take_plans();
  void take_rows();
  Order answer_call();
  bool send();
  void wake(std::uint64_t event);
  void fall_silent();
  /// Asks for its beliefs, unless nothing has happened since it was last asked.
  void refresh();

  Line& line_;
  EstimatorWitness* witness_;
  Desk* desk_;
  RiderCodec* riders_;
  Options options_;
  Beliefs believer_;
  Answer answer_;
  std::map<std::uint64_t, EventId> plans_;  // by the agent's own number
  std::vector<AgentId> told_neighbours_;
  std::vector<std::size_t> told_measurements_;  // by subject
  std::vector<TrackedBelief> beliefs_;          // by subject, as last reported
  EstimatorCounts counts_;
  std::vector<std::byte> state_;  // as last reported
  std::vector<std::byte> scratch_;
  std::int64_t stamp_ = 0;
  std::uint32_t lives_ = 0;
  bool begun_ = false;
  bool silent_ = false;
  Time asked_at_ = Time::never();  // state_ is as of then
  bool fresh_ = false;             // beliefs_ and state_ are those of now
};

}  // namespace hearsay::remote
