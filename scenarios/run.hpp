// From a scenario to a run: builds world, radio, agents and witness, and lets them go.
//
//   const auto prepared = prepare(load_scenario(file, {}, known_names(catalog)), catalog, logs);
//   Run run(prepared, catalog, {.seed = 7});
//   const RunEnd end = run.run();
//   ... run.record() ...
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "agents/catalog.hpp"
#include "agents/grids/area_look.hpp"
#include "agents/grids/grid_witness.hpp"
#include "agents/journey.hpp"
#include "agents/lookout.hpp"
#include "agents/pose_witness.hpp"
#include "agents/remote/distant_world.hpp"
#include "agents/remote/riders.hpp"
#include "agents/remote/stand_in.hpp"
#include "agents/robots/floor_body.hpp"
#include "agents/sensors/target_scan.hpp"
#include "agents/target_truth.hpp"
#include "agents/track_witness.hpp"
#include "agents/trails/trail_witness.hpp"
#include "agents/witness.hpp"
#include "net/movement.hpp"
#include "scenarios/life.hpp"
#include "scenarios/links.hpp"
#include "scenarios/loader.hpp"
#include "scenarios/log_cache.hpp"
#include "scenarios/motion.hpp"
#include "scenarios/scenario.hpp"
#include "scenarios/services.hpp"
#include "sim/world/mrclam.hpp"

namespace hearsay {

/// What scenario and study files may name, given the agents of `catalog`.
KnownNames known_names(const Catalog& catalog);

/// A scenario with everything worked out that is the same in each of its runs. Never changes; any
/// number of runs and threads share one.
struct PreparedScenario {
  Scenario scenario;
  Time end;
  std::vector<std::string> names;            ///< of agents
  std::vector<const AgentSpec*> specs;       ///< of each agent, into `scenario`
  AgentPlaces places;                        ///< of agents
  std::optional<LinkPlan> links;             ///< unless the graph is drawn anew in each run
  std::vector<Subject> subjects;             ///< empty: nothing for the witness to watch
  std::optional<MotionModel> motion;         ///< of subjects that move
  std::vector<std::vector<Sensor>> sensors;  ///< of each agent
  std::vector<std::vector<Observation>> observations;  ///< of each agent, from a log
  std::shared_ptr<const mrclam::Dataset> log;
  std::vector<Journey> journeys;           ///< of each agent, for localizers, from a log
  std::vector<Eigen::Vector2d> landmarks;  ///< the same
  std::vector<Metric> series;
};

/// @throws InputError for what only shows when the pieces meet: a log that cannot be read, a log
/// sensor without a robot in the log.
std::shared_ptr<const PreparedScenario> prepare(Scenario scenario, const Catalog& catalog,
                                                LogCache& logs);

/// Whether an agent decides where it goes.
bool is_steered(const PreparedScenario& prepared, AgentId id);

class Run {
 public:
  struct Options {
    std::uint64_t seed = 1;
    DigestSink* digest = nullptr;         ///< not owned
    DigestSink* ledger_digest = nullptr;  ///< not owned
    /// Makes what stands in for agents that live in other processes: all of them. Empty: all live
    /// here.
    std::function<std::unique_ptr<remote::StandIn>(Context&, const remote::Belongings&)> elsewhere =
        {};
  };
  /// `catalog` must outlive the run.
  Run(std::shared_ptr<const PreparedScenario> prepared, const Catalog& catalog,
      const Options& options);
  ~Run();

  /// Once. A run that failed has a record, too: up to the failure.
  RunEnd run();
  const Record& record() const { return simulation_.record(); }
  // In place of run(), for who drives the simulation step by step:
  void start();
  Simulation& simulation() { return simulation_; }
  /// Leaves final values and closes the record. @return how it ended: also this may fail.
  RunEnd finish(RunEnd end);
  /// What is estimated, with the truth of this run.
  const std::vector<Subject>& subjects() const { return subjects_; }
  /// The agent's process is gone, or there is another: its radio is off, or on.
  void set_reachable(AgentId id, bool reachable) { radio_->set_up(id, reachable); }

  /// After run(): gives up agents, radio and witness, where they were made; the record stays.
  void keep_record_only();

 private:
  /// What an agent has in the world beside its radio.
  struct Equipment {
    std::unique_ptr<PlotSource> scan;   // of trackers
    std::unique_ptr<LookSource> looks;  // of explorers
    std::unique_ptr<RobotBody> body;    // of foragers
    // Of agents elsewhere that need them.
    std::unique_ptr<remote::Desk> desk;
    std::unique_ptr<remote::RiderCodec> riders;
  };
  void build_radio(std::uint64_t seed);
  void build_agents(const Catalog& catalog);
  std::unique_ptr<Agent> make_agent(AgentId id, const Catalog& catalog);
  std::unique_ptr<Agent> make_estimator(AgentId id);
  std::unique_ptr<Agent> make_stand_in(AgentId id);
  std::unique_ptr<Agent> make_estimator_elsewhere(AgentId id);
  std::unique_ptr<Agent> make_tracker_elsewhere(AgentId id);
  std::unique_ptr<Agent> make_localizer_elsewhere(AgentId id);
  std::unique_ptr<Agent> make_explorer_elsewhere(AgentId id);
  std::unique_ptr<Agent> make_forager_elsewhere(AgentId id);
  /// Who stands in for an agent that asks at this desk.
  std::unique_ptr<Agent> at_desk(AgentId id, std::unique_ptr<remote::Desk> desk);
  /// Null if it has no sensor. Kept in its equipment, as the next two.
  PlotSource* equip_with_scan(AgentId id);
  LookSource* equip_with_looks(AgentId id);
  RobotBody& equip_with_body(AgentId id);
  std::unique_ptr<Agent> make_tracker(AgentId id);
  std::unique_ptr<Agent> make_localizer(AgentId id);
  std::unique_ptr<Agent> make_explorer(AgentId id);
  std::unique_ptr<Agent> make_forager(AgentId id);
  /// Where agents begin in this run; robots are on the floor.
  AgentPlaces places_of_run() const;
  void leave_final_values();

  // The order matters: what is below is destroyed first and may use what is above.
  std::shared_ptr<const PreparedScenario> prepared_;
  std::function<std::unique_ptr<remote::StandIn>(Context&, const remote::Belongings&)> elsewhere_;
  Simulation simulation_;
  std::vector<Subject> subjects_;                // with the truth of this run
  std::vector<TargetTruth> targets_;             // of this run, for trackers
  std::unique_ptr<TrackWitness> track_witness_;  // null without trackers
  std::unique_ptr<PoseWitness> pose_witness_;    // null without localizers
  std::unique_ptr<GridWitness> grid_witness_;    // null without explorers
  std::unique_ptr<RobotWorld> robot_world_;      // null without foragers, and so the next two
  std::unique_ptr<TrailWitness> trail_witness_;
  std::vector<int> robots_;            // by agent: its number on the floor, or −1
  std::unique_ptr<Witness> witness_;   // owns the riders of packets in flight
  std::unique_ptr<AgentPaths> paths_;  // null if nobody moves, and so the next two
  std::unique_ptr<Places> places_;
  std::unique_ptr<Movement> movement_;
  std::unique_ptr<Radio> radio_;
  std::vector<std::unique_ptr<Gossip>> gossips_;  // by agent; null: it talks over the radio alone
  std::vector<std::unique_ptr<Context>> contexts_;
  std::vector<Equipment> equipment_;  // by agent
  std::vector<std::unique_ptr<Agent>> agents_;
  std::vector<std::unique_ptr<Lookout>> lookouts_;  // by agent; null for those who look themselves
  std::unique_ptr<Life> life_;
};

}  // namespace hearsay
