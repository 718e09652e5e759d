// An agent that keeps its own time, by the clock on the wall: what it plans happens when it is due,
// what comes from the world or from others counts when it arrives.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "agents/catalog.hpp"
#include "agents/remote/remote_world.hpp"
#include "net/live/messages.hpp"
#include "scenarios/motion.hpp"
#include "scenarios/solo.hpp"
#include "tools/live/air.hpp"
#include "tools/live/options.hpp"
#include "tools/live/order_line.hpp"
#include "tools/live/reactor.hpp"

namespace hearsay::fleet {

class OwnTime final : private remote::DistantWorld, private RecordTap {
 public:
  /// All outlive this.
  OwnTime(std::shared_ptr<const PreparedScenario> prepared, const AgentOptions& options,
          const live::Welcome& welcome, live::Port& port, Reactor& reactor, live::Reader& orders,
          live::Writer& answers, remote::MemoryStore* memory);
  ~OwnTime() override;

  /// Until it is dismissed or asked to stop. @return what went wrong, or nothing.
  std::string serve(const Catalog& catalog, const std::function<void(const std::string&)>& status);

 private:
  bool send(AgentId sender, const Outgoing& packet) override;
  void tell_of_empty_queue(AgentId) override {}
  std::size_t waiting(AgentId) const override { return 0; }
  bool up(AgentId) const override { return around_.up; }
  std::span<const AgentId> neighbours(AgentId) override { return neighbours_; }
  bool neighbours_change() const override { return around_.hears_strangers; }
  Point position(AgentId) const override;
  void steer(AgentId, const Leg& leg) override;
  std::span<const std::byte> ask(std::span<const std::byte> question) override;
  void note(std::span<const std::byte> note) override { line_.note(note); }
  void watch(AgentId, Believer& believer) override { believer_ = &believer; }
  double distance_error_m(int subject, const gaussian::Belief& belief) override;
  LedgerPool* ledgers() override { return nullptr; }
  EstimatorWorkspace& workspace() override { return workspace_; }
  void on_scalar(const ScalarRow& row, Origin origin) override;
  void on_series(const SeriesRow& row, Origin origin) override;
  void on_event(Time time, AgentId agent, std::string_view kind, std::string_view detail) override;

  Time now();
  void set_clock(std::int64_t now_ns);
  void look_around(const remote::Order& order);
  void begin(const Catalog& catalog, const remote::Order& order);
  /// Where its path goes, by its own clock.
  void set_out();
  /// @return false once it is dismissed.
  bool obey(const Catalog& catalog, const remote::Order& order);
  bool take_orders(const Catalog& catalog);
  void take_measurements();
  void take_packets();
  void hear(const Parcel& parcel);
  void catch_up();
  /// Lets something happen to the agent now; what it throws ends its life.
  void at_once(const std::function<void()>& happening);
  std::int64_t stamp_now();
  void report(bool last);
  std::string failure() const;
  std::string status_text();

  std::shared_ptr<const PreparedScenario> prepared_;
  const AgentOptions& options_;
  live::Welcome welcome_;
  Reactor& reactor_;
  OrderLine line_;
  remote::MemoryStore* memory_;  // null: it has none
  Tongue tongue_;
  AirOut air_out_;
  AirIn air_in_;
  live::Reader measurements_;
  live::Reader clock_;
  live::Writer reports_;
  std::unique_ptr<Solo> solo_;  // from the order to start on
  Believer* believer_ = nullptr;
  remote::Surroundings around_;
  std::unique_ptr<Motion> motion_;  // null for who is steered, or where nobody moves
  mutable std::optional<Leg> leg_;  // the one it moves along
  remote::Asking asking_{*this};
  std::vector<AgentId> neighbours_;
  EstimatorWorkspace workspace_;
  live::Report report_;
  std::map<std::uint32_t, std::uint64_t> heard_;  // direct: number of the last packet, by sender
  std::vector<std::byte> bytes_;
  WallTime begin_;          // when this object was made
  Time began_;              // the agent's life, by the fleet's time
  double ahead_s_ = -1e18;  // fleet's time less wall time since begin_ × speed
  std::uint64_t number_ = 0;
  std::uint64_t old_ = 0;  // packets that were heard before
  std::uint64_t missed_ = 0;
  WallTime clock_heard_;
};

}  // namespace hearsay::fleet
