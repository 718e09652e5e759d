// The omniscient witness of a run with foragers: it counts trips, knows where each crumb was truly
// laid, and now and then compares what robots believe of trails with the truth. No agent can ask it
// anything but whether all have arrived once (tasks that begin together), and none is changed by
// being looked at.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "agents/robots/robot_world.hpp"
#include "agents/trails/trail_account.hpp"
#include "filters/trails/identity_table.hpp"
#include "sim/kernel/simulation.hpp"

namespace hearsay {

class TrailWitness final : public TrailAccount {
 public:
  struct Options {
    Duration period;                  ///< > 0: samples at 0, period, … and at the end
    std::vector<std::string> series;  ///< names of metrics kept over time; others are ignored
    bool crumbs = false;              ///< an event for each crumb laid
    double wrong_m = 1.0;             ///< crumbs with more error are wrong, > 0
    std::function<bool(AgentId)> up;  ///< whether an agent is; none: all always are
  };
  /// Trips of which each is a subject of its own, at most.
  static constexpr std::uint64_t iterations_max = 1000;
  /// Trips an hour are those of this time before, s.
  static constexpr double window_s = 600.0;

  /// Both outlive the witness.
  TrailWitness(Simulation& simulation, const RobotWorld& world, Options options);

  /// From now on the robot of an agent, and what it knows, are looked at. Robots in ascending
  /// number of agents, 0 … n − 1 of the floor. `mind` is there until finish() is over.
  void watch(AgentId agent, int robot, const TrailMind& mind);

  void sets_off(int robot) override;
  void drove(int robot, double length_m, bool blocked, Doing doing, double dt_s) override;
  bool arrived(int robot, trails::EventId event) override;
  void dropped(int robot) override;
  void told(int robot, std::span<const trails::Crumb> crumbs) override;
  void gave_up(int robot) override { robots_[index(robot)].dropped.clear(); }
  void learned(int robot, trails::RobotId from, std::span<const trails::Identity> crumbs) override;
  bool all_arrived() override;

  /// Schedules the samples up to the end of the run. Once, before it starts.
  void start();
  /// Takes the last sample (unless it was due at this very instant) and leaves final values.
  void finish();

 private:
  struct Trip {
    double length_m, duration_s;
  };
  struct Robot {
    AgentId agent;
    int robot;
    const TrailMind* mind;
    double distance_m = 0.0;
    std::array<double, doings> spent_s{};
    double blocked_s = 0.0;
    std::optional<Time> set_off;
    double set_off_m = 0.0;
    std::vector<Trip> trips;
    std::optional<Time> first_arrival;
    std::optional<Time> recovered_from;  ///< the change that it has recovered from
    double recovery_s = 0.0;
    std::vector<drive::Pose> dropped;  ///< not told yet
    std::vector<std::uint8_t> hops;    ///< by number of crumb in the book
  };
  struct Wanted {
    bool pose, trips, trips_an_hour, crumbs, error, hops;
    bool trip_length, trip_duration;
  };
  std::size_t index(int robot) const;
  std::uint8_t hops_of(int robot, std::uint32_t number) const;
  void keep(AgentId agent, const char* name, double value);
  void schedule_sample(Time at);
  void sample();
  void sample_crumbs(const Robot& robot);
  void leave(const Robot& robot);
  void leave_team();

  Simulation& simulation_;
  const RobotWorld& world_;
  Options options_;
  Wanted wanted_;
  std::vector<Robot> robots_;
  trails::IdentityTable book_;      // numbers of crumbs
  std::vector<plan::Point> truth_;  // where each was laid
  std::vector<Time> team_trips_;
  std::optional<Time> last_sample_;
};

}  // namespace hearsay
