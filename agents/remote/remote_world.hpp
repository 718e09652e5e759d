// The world as an agent sees it from another process, in lockstep: its radio, the witness and the
// record are calls to the world; what it plans, the world keeps in mind.
#pragma once

#include <string>
#include <vector>

#include "agents/agent.hpp"
#include "agents/measurement.hpp"
#include "agents/remote/distant_world.hpp"
#include "agents/remote/protocol.hpp"
#include "agents/remote/riders.hpp"

namespace hearsay::remote {

/// Where an agent's memory outlives its process.
class MemoryStore {
 public:
  virtual ~MemoryStore() = default;
  /// Lets the agent, which has started, recall what is there. @return false if nothing is there.
  virtual bool recall(Agent& agent) = 0;
  /// Keeps what the agent remembers now.
  virtual void save(const Agent& agent) = 0;
};

/// The agent starts, for the `lives`-th time in this run, counted from 0. Whoever started before
/// has lost its memory, unless it was kept, and others know it. `memory` may be null.
void begin_life(Agent& agent, MemoryStore* memory, std::uint32_t lives);

/// Where orders come from.
class Superior {
 public:
  virtual ~Superior() = default;
  /// Gives the answer and waits for the next order. @return false if none will come: the world is
  /// gone.
  virtual bool exchange(const Answer& answer, Order& order) = 0;
};

class RemoteWorld final : public DistantWorld, private RecordTap, private ScheduleWatch {
 public:
  struct Options {
    bool ledgers = false;
    int subjects = 0;               ///< that the agent estimates
    MemoryStore* memory = nullptr;  ///< null: it has none. Not owned
  };
  /// `first`: the order to start. `superior` outlives this.
  RemoteWorld(Superior& superior, const Order& first, const Options& options);

  /// For the agent's simulation, of which this then is the record and the plan.
  RecordTap& tap() { return *this; }
  ScheduleWatch& plans() { return *this; }

  struct Parts {
    Simulation& simulation;
    Agent& agent;
    MeasurementReceiver* receiver = nullptr;  ///< null: it has no sensors
    Reporter* reporter = nullptr;             ///< null: it tells of its beliefs alone
    RiderCodec* riders = nullptr;             ///< of its packets; null: there are none
  };
  /// Obeys until it is dismissed. @return false if the world went away before, or took it for gone
  /// and lets it begin anew.
  bool serve(const Parts& parts);
  /// Nothing comes any more, and that is as it should be.
  bool dismissed() const { return dismissed_; }
  /// The order to start once more: this life is over, the agent needs another world.
  const Order* next_life() const { return anew_ ? &order_ : nullptr; }

  bool send(AgentId sender, const Outgoing& packet) override;
  void tell_of_empty_queue(AgentId agent) override;
  std::size_t waiting(AgentId) const override { return around_.waiting; }
  bool up(AgentId) const override { return around_.up; }
  std::span<const AgentId> neighbours(AgentId) override { return neighbours_; }
  bool neighbours_change() const override { return around_.hears_strangers; }
  Point position(AgentId agent) const override;

  void watch(AgentId, Believer& believer) override { believer_ = &believer; }
  double distance_error_m(int subject, const gaussian::Belief& belief) override;
  LedgerPool* ledgers() override { return options_.ledgers ? &pool_ : nullptr; }
  EstimatorWorkspace& workspace() override { return workspace_; }

  void steer(AgentId, const Leg& leg) override;
  std::span<const std::byte> ask(std::span<const std::byte> question) override;
  void note(std::span<const std::byte> note) override;

 private:
  void on_scalar(const ScalarRow& row, Origin origin) override;
  void on_series(const SeriesRow& row, Origin origin) override;
  void on_event(Time time, AgentId agent, std::string_view kind, std::string_view detail) override;
  void scheduled(EventId id, Time time, Phase phase) override;
  void cancelled(EventId id) override;

  bool serve_until_dismissed(const Parts& parts);
  void look_around();
  void obey();
  Packet packet();
  void report();
  void call(AnswerKind kind);
  /// Gives the answer; the next order is in order_ then.
  bool answer(AnswerKind kind);

  Superior& superior_;
  Options options_;
  const Parts* parts_ = nullptr;
  Believer* believer_ = nullptr;
  Order order_;
  Answer answer_;
  Surroundings around_;
  std::vector<AgentId> neighbours_;
  Asking asking_{*this};
  LedgerPool pool_;
  EstimatorWorkspace workspace_;
  RiderPtr rider_;  // of the packet that is being heard
  bool gone_ = false;
  bool dismissed_ = false;
  bool anew_ = false;
};

}  // namespace hearsay::remote
