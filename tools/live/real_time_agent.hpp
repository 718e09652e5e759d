// What stands in the world for an agent that keeps its own time.
#pragma once

#include <cstdint>
#include <vector>

#include "agents/remote/remote_agent.hpp"
#include "tools/live/air.hpp"
#include "tools/live/frame_line.hpp"
#include "tools/live/roster.hpp"

namespace hearsay::fleet {

class RealTimeAgent final : public remote::StandIn {
 public:
  struct Options {
    remote::RemoteAgent::Options what;
    remote::Desk* desk = nullptr;  ///< null: it asks for nothing. Not owned
    std::vector<Tongue> tongues;   ///< of each agent of the fleet
  };
  /// All outlive this.
  RealTimeAgent(Context& context, live::Port& port, Member& member, Reactor& reactor,
                Options options);

  void start() override;
  void on_measurement(const Measurement& measurement) override;
  void on_packet(const Packet& packet) override;
  void on_down() override { tell(order(remote::OrderKind::down)); }
  void on_up(bool forgets) override;
  void finish() override;
  Believer& believer() override { return believer_; }
  std::span<const std::byte> state() override;

  AgentId id() const { return context().id(); }
  /// Takes what came from the agent: packets go to its radio, reports into the record. Within an
  /// event. @return whether anything came.
  bool take();
  /// Its process shows no sign of life any more. (Another may start() in its place.)
  void fall_silent();
  bool silent() const { return silent_; }
  /// Whether it has shown no sign of life for a while.
  bool gone() { return presence_.gone(member_.alive()); }
  /// Tells it who hears it now, if that has changed.
  void tell_neighbours();
  void dismiss() { tell({.kind = remote::OrderKind::dismiss, .now = context().now()}); }

  /// Reports that did not come in time.
  std::uint64_t late_reports() const { return late_reports_; }
  /// Deadlines that it missed, as it says.
  std::uint64_t missed() const { return missed_; }
  /// Packets of it that were no sound beliefs, of or for somebody who is not there, or old.
  std::uint64_t dropped() const { return dropped_ + air_in_.dropped(); }

 private:
  class Beliefs final : public Believer {
   public:
    explicit Beliefs(RealTimeAgent& agent) : agent_(agent) {}
    void advance(std::int64_t now) override;
    const TrackedBelief& tracked(int subject) const override;
    const EstimatorCounts& counts() const override { return agent_.counts_; }

   private:
    RealTimeAgent& agent_;
  };

  remote::Order order(remote::OrderKind kind);
  void tell(const remote::Order& order);
  /// Takes what it asks and tells of its world. @return whether anything came.
  bool take_answers();
  void answer(const remote::Answer& question);
  bool can_be_sent(const live::Envelope& envelope) const;
  void say(const Parcel& parcel);
  bool take_report();
  void record(const live::Row& row);
  /// Asks one of ours for a report and waits for it, not for long.
  void ask(remote::OrderKind kind, double wait_s);

  Member& member_;
  Presence presence_{call_grace_s};
  Reactor& reactor_;
  Options options_;
  Beliefs believer_;
  FrameLine line_;
  AirOut air_out_;
  AirIn air_in_;
  Parcel parcel_;
  std::vector<std::byte> bytes_;
  std::vector<AgentId> told_neighbours_;
  std::vector<TrackedBelief> beliefs_;
  EstimatorCounts counts_;
  std::vector<std::byte> state_;  // as last told
  live::Frame frame_;
  remote::Answer answer_;
  std::vector<std::byte> scratch_;
  std::int64_t stamp_ = 0;
  Time asked_ = Time::never();  // when it was last asked what it believes
  std::uint64_t number_ = 0;    // of measurements and packets to it
  std::uint64_t heard_ = 0;     // number of the last packet from it
  std::uint32_t lives_ = 0;
  std::uint64_t late_reports_ = 0, missed_ = 0, dropped_ = 0;
  bool silent_ = false;
  bool state_told_ = false;  // since it was last asked
};

}  // namespace hearsay::fleet
