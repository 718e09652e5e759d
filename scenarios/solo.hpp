// One agent of a scenario by itself: its own clock and queue, and the same code as within a run.
// Its radio, its witness and what else it has of its world are somebody else's.
#pragma once

#include <cstdint>
#include <memory>

#include "agents/agent.hpp"
#include "agents/catalog.hpp"
#include "agents/grids/area_look.hpp"
#include "agents/measurement.hpp"
#include "agents/pose_mind.hpp"
#include "agents/remote/distant_world.hpp"
#include "agents/remote/remote_agent.hpp"
#include "agents/remote/riders.hpp"
#include "agents/robots/robot_body.hpp"
#include "agents/sensors/target_scan.hpp"
#include "agents/trails/trail_account.hpp"
#include "scenarios/run.hpp"

namespace hearsay {

/// What a world needs to know of an agent that lives elsewhere.
remote::RemoteAgent::Options remote_options(const PreparedScenario& prepared, AgentId id);

class Solo {
 public:
  struct Options {
    AgentId id = 0;
    std::uint64_t seed = 1;
    Time now;                        ///< when it begins
    RecordTap* tap = nullptr;        ///< gets what it records; nullptr: nobody. Not owned
    ScheduleWatch* plans = nullptr;  ///< is told what it plans. Not owned
  };
  /// `world` and what the options refer to outlive this.
  /// @throws remote::WorldGone if it has something to ask, and nobody answers.
  Solo(std::shared_ptr<const PreparedScenario> prepared, const Catalog& catalog,
       remote::DistantWorld& world, const Options& options);

  Simulation& simulation() { return simulation_; }
  Agent& agent() { return *agent_; }
  /// Null if it has no use for measurements.
  MeasurementReceiver* receiver() { return receiver_; }
  /// Null if it tells nothing of itself but its beliefs.
  remote::Reporter* reporter() { return reporter_.get(); }
  /// Null if its packets have no riders.
  remote::RiderCodec* riders() { return riders_.get(); }

 private:
  std::unique_ptr<Agent> make_agent(const Catalog& catalog, remote::DistantWorld& world,
                                    const Options& options);
  std::unique_ptr<Agent> make_estimator(remote::DistantWorld& world, const Options& options);
  std::unique_ptr<Agent> make_tracker(remote::DistantWorld& world, const Options& options);
  std::unique_ptr<Agent> make_localizer(remote::DistantWorld& world, const Options& options);
  std::unique_ptr<Agent> make_explorer(remote::DistantWorld& world, const Options& options);
  std::unique_ptr<Agent> make_forager(remote::DistantWorld& world, const Options& options);

  std::shared_ptr<const PreparedScenario> prepared_;
  Simulation simulation_;
  std::unique_ptr<Context> context_;
  // What it has of its world; each null for who needs none.
  RiderPool<GridRider> grid_riders_;
  std::unique_ptr<remote::RiderCodec> riders_;
  std::unique_ptr<PlotSource> plots_;
  std::unique_ptr<SightingAccount> sightings_;
  std::unique_ptr<LookSource> looks_;
  std::unique_ptr<RobotBody> body_;
  std::unique_ptr<TrailAccount> account_;
  std::unique_ptr<Agent> agent_;
  std::unique_ptr<remote::Reporter> reporter_;
  MeasurementReceiver* receiver_ = nullptr;
};

}  // namespace hearsay
