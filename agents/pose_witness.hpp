// The omniscient witness of a run with localizers: it sees every sighting and everybody's odometry,
// keeps the central filter of all poses, and compares what robots think of themselves with the
// truth. No agent can ask it anything.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "agents/journey.hpp"
#include "agents/metrics.hpp"
#include "agents/pose_mind.hpp"
#include "sim/kernel/simulation.hpp"

namespace hearsay {

class PoseWitness final : public SightingAccount {
 public:
  struct Options {
    std::vector<std::string> names;             ///< of the robots, by number
    std::span<const Journey> journeys;          ///< by number; they outlive the witness
    localization::PoseFilter::Options central;  ///< of all robots
    std::vector<Metric> series;                 ///< kept over time
    Duration series_period;                     ///< > 0: samples at 0, period, … and at the end
  };
  /// `simulation` must outlive the witness.
  PoseWitness(Simulation& simulation, Options options);

  /// From now on the pose that `mind` believes in is sampled. Agents in ascending number. `mind` is
  /// there until finish() is over.
  void watch(AgentId agent, PoseMind& mind);

  void saw_place(AgentId agent, const Eigen::Vector2d& place_m,
                 const localization::RelativeSighting& seen) override;
  void saw_robot(AgentId agent, AgentId other, const localization::RelativeSighting& seen) override;

  /// Schedules the samples up to the end of the run, which it has. Once, before it starts.
  void start();
  /// Leaves final values: means over samples.
  void finish();

 private:
  /// Sums over samples, and over the robots of the last one.
  struct Sums {
    int samples = 0;
    double distance_m = 0.0, heading_rad2 = 0.0, nees = 0.0;
    int last = 0;
    double last_distance_m = 0.0, last_variance_m2 = 0.0;
    void begin_sample() { last = 0, last_distance_m = last_variance_m2 = 0.0; }
  };
  struct Watched {
    AgentId agent;
    PoseMind* mind;
    Sums sums;
  };
  void schedule_sample(Time at);
  void sample();
  void sample(AgentId agent, std::size_t robot, const localization::Pose& pose,
              const Eigen::Matrix3d& covariance, Sums& sums);
  /// Where a robot is now; nothing after the end of its truth.
  std::optional<localization::Pose> truth(std::size_t robot) const;
  void advance(std::size_t robot);
  void leave(AgentId agent, const Sums& sums);

  Simulation& simulation_;
  Options options_;
  localization::PoseFilter central_;
  std::vector<Odometer> odometers_;
  std::vector<Watched> watched_;
  std::vector<NameId> names_;  // of the robots
  Sums central_sums_;
};

}  // namespace hearsay
