// A world by the clock on the wall: agents keep their own time, and what they do counts when it
// arrives.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "scenarios/run.hpp"
#include "tools/live/real_time_agent.hpp"

namespace hearsay::fleet {

class RealTimeWorld {
 public:
  /// All outlive this.
  RealTimeWorld(const PreparedScenario& prepared, live::Port& port, Roster& roster,
                Reactor& reactor, live::Writer& clock, const WorldOptions& options);

  /// For Run::Options::elsewhere.
  std::unique_ptr<remote::StandIn> stand_in(Context& context, const remote::Belongings& world);
  /// Lets the run happen, from its start to its end or until the process is asked to stop.
  RunEnd drive(Run& run, const std::function<void(const std::string&)>& status);
  void dismiss();

  /// Events that began more than deadline_s after their time, here and at agents.
  std::uint64_t late() const { return late_; }
  std::uint64_t silent() const { return late_reports_; }
  std::uint64_t dropped() const { return dropped_; }

 private:
  /// By the clock on the wall; not beyond the end.
  Time now() const;
  void catch_up(Simulation& simulation, Time until);
  void take(Run& run);
  void look_after(Run& run);
  void tell_clock(const Simulation& simulation);
  void tell_truth(Run& run);

  const PreparedScenario& prepared_;
  live::Port& port_;
  Roster& roster_;
  Reactor& reactor_;
  live::Writer& clock_;
  live::Writer truth_;
  const WorldOptions& options_;
  std::vector<RealTimeAgent*> agents_;
  std::vector<std::byte> bytes_;
  WallTime begin_;
  std::uint64_t late_ = 0, late_reports_ = 0, dropped_ = 0;
};

}  // namespace hearsay::fleet
