#include "scenarios/run.hpp"

#include <algorithm>
#include <utility>

#include "agents/estimator_agent.hpp"
#include "agents/explorer_agent.hpp"
#include "agents/forager_agent.hpp"
#include "agents/localizer_agent.hpp"
#include "agents/source_agent.hpp"
#include "agents/tracker_agent.hpp"
#include "scenarios/channel.hpp"
#include "scenarios/estimators.hpp"
#include "scenarios/explorers.hpp"
#include "scenarios/foragers.hpp"
#include "scenarios/localizers.hpp"
#include "scenarios/logs.hpp"
#include "scenarios/network.hpp"
#include "scenarios/radio_record.hpp"
#include "scenarios/sensors.hpp"
#include "scenarios/talk.hpp"
#include "scenarios/targets.hpp"
#include "scenarios/trackers.hpp"
#include "scenarios/traffic.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

std::vector<Metric> metrics_of(const RecordSpec& record) {
  std::vector<Metric> wanted;
  for (int m = 0; m < series_metric_count; ++m) {
    const std::string_view name = metrics()[static_cast<std::size_t>(m)].name;
    if (std::find(record.series.begin(), record.series.end(), name) != record.series.end()) {
      wanted.push_back(static_cast<Metric>(m));
    }
  }
  return wanted;
}

void require_subjects(const PreparedScenario& prepared) {
  for (std::size_t i = 0; i < prepared.specs.size(); ++i) {
    if (prepared.specs[i]->kind != "estimator" || !prepared.subjects.empty()) continue;
    throw InputError(prepared.scenario.file, 0,
                     "agent '" + prepared.names[i] +
                         "' estimates, but there is nothing to estimate: give [world] targets or "
                         "[world.log]");
  }
}

std::optional<Agreement::Options> agreement_of(const RecordSpec& record) {
  if (!record.agreement) return std::nullopt;
  const AgreementSpec& spec = *record.agreement;
  return Agreement::Options{.from = Time::at(Duration::seconds(spec.from_s)),
                            .within_m = spec.within_m.value(),
                            .period = Duration::seconds(spec.period_s)};
}

}  // namespace

KnownNames known_names(const Catalog& catalog) {
  KnownNames names;
  for (const auto& [name, kind] : catalog.agents()) names.agent_kinds.push_back(name);
  for (const MetricInfo& metric : metrics()) names.metrics.emplace_back(metric.name);
  for (const Catalog::OwnMetric& metric : catalog.metrics()) names.metrics.push_back(metric.name);
  return names;
}

bool is_steered(const PreparedScenario& prepared, AgentId id) {
  const AgentSpec& spec = *prepared.specs[static_cast<std::size_t>(id)];
  return spec.kind == "forager" || (spec.motion && spec.motion->kind == "steered");
}

std::shared_ptr<const PreparedScenario> prepare(Scenario scenario, const Catalog&, LogCache& logs) {
  auto prepared = std::make_shared<PreparedScenario>();
  prepared->scenario = std::move(scenario);
  const Scenario& s = prepared->scenario;
  prepared->names = agent_names(s);
  prepared->places = agent_positions(s);
  for (const AgentSpec& spec : s.agents) {
    for (int i = 0; i < spec.count; ++i) prepared->specs.push_back(&spec);
  }
  const bool by_place =
      has_motion(s) && (s.radio.topology == "disk" || s.radio.topology == "by-position");
  if (!by_place && !is_drawn(s.radio))
    prepared->links = make_link_plan(s, prepared->places, s.seed);
  prepared->series = metrics_of(s.record);
  prepared->observations.resize(prepared->specs.size());
  for (const TargetSpec& target : s.world.targets) {
    prepared->subjects.push_back(
        {target.name, target.position_m.value_or(std::vector<double>{0.0, 0.0}), {}});
  }
  for (std::size_t i = 0; i < prepared->specs.size(); ++i) {
    prepared->sensors.push_back(sensors_of(*prepared->specs[i], s.world, prepared->places[i]));
  }
  prepared->motion = motion_model_of(s);
  if (s.duration_s) prepared->end = Time::at(Duration::seconds(*s.duration_s));
  if (s.world.log) prepare_log(*prepared, logs);
  require_subjects(*prepared);
  return prepared;
}

Run::Run(std::shared_ptr<const PreparedScenario> prepared, const Catalog& catalog,
         const Options& options)
    : prepared_(std::move(prepared)),
      elsewhere_(options.elsewhere),
      simulation_({.seed = options.seed,
                   .end = prepared_->end,
                   .events_max = prepared_->scenario.events_max,
                   .record = {.keep_messages = prepared_->scenario.record.messages == "all",
                              .digest = options.digest,
                              .ledger_digest = options.ledger_digest}}) {
  simulation_.name_of_agent = [this](AgentId id) {
    return id >= 0 ? prepared_->names[static_cast<std::size_t>(id)] : std::string("central");
  };
  robots_.assign(prepared_->specs.size(), -1);
  if (has_foragers(prepared_->scenario)) {
    robot_world_ = make_robot_world(prepared_->scenario, simulation_);
    for (std::size_t i = 0; i < robots_.size(); ++i) {
      if (prepared_->specs[i]->kind != "forager") continue;
      robots_[i] = robot_of(*prepared_, static_cast<AgentId>(i));
    }
  }
  build_radio(options.seed);
  build_agents(catalog);
}

Run::~Run() = default;

AgentPlaces Run::places_of_run() const {
  AgentPlaces places = prepared_->places;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (robots_[i] < 0) continue;
    const drive::Pose& pose = robot_world_->pose(robots_[i]);
    places[i] = {pose.x_m, pose.y_m};
  }
  return places;
}

void Run::build_radio(std::uint64_t seed) {
  const Scenario& scenario = prepared_->scenario;
  const RadioOptions options = radio_options(scenario);
  const auto agents = static_cast<int>(prepared_->specs.size());
  const AgentPlaces places = places_of_run();
  Reach reach{.topology = Topology::edges(agents, {}), .positions_m = positions_of(places)};
  if (has_motion(scenario)) {
    reach.by_place = scenario.radio.topology == "disk" || scenario.radio.topology == "by-position";
    // Where the graph says who hears whom, places are asked for one by one.
    const double reach_m = reach.by_place ? options.propagation.reach_m() : 1e6;
    paths_ = std::make_unique<AgentPaths>(scenario, places, seed);
    places_ = std::make_unique<Places>(agents, reach_m, 0.25 * reach_m);
    movement_ = std::make_unique<Movement>(simulation_, *places_, *paths_);
    reach.places = places_.get();
  }
  if (!reach.by_place) {
    LinkPlan plan = prepared_->links ? *prepared_->links : make_link_plan(scenario, places, seed);
    reach.topology = std::move(plan.topology);
    reach.changes = std::move(plan.changes);
  }
  radio_ = std::make_unique<Radio>(simulation_, std::move(reach), options);
}

void Run::build_agents(const Catalog& catalog) {
  const Scenario& scenario = prepared_->scenario;
  Record& record = simulation_.record();
  const bool watched = !prepared_->subjects.empty() &&
                       std::any_of(prepared_->specs.begin(), prepared_->specs.end(),
                                   [](const AgentSpec* spec) { return spec->kind == "estimator"; });
  if (watched) {
    record.agent(central_agent, "central", "central");
    subjects_ = prepared_->subjects;
    if (prepared_->motion && !prepared_->log) {
      put_in_motion(subjects_, scenario, *prepared_->motion, prepared_->end, simulation_.seed());
    }
    witness_ = std::make_unique<Witness>(
        simulation_,
        Witness::Options{.subjects = subjects_,
                         .motion = prepared_->motion,
                         .series = prepared_->series,
                         .series_period = Duration::seconds(scenario.record.series_period_s),
                         .ledger = scenario.record.ledger == "on",
                         .agreement = agreement_of(scenario.record),
                         .up = [this](AgentId id) { return radio_->up(id); }});
  }
  if (has_trackers(scenario)) {
    targets_ = target_truths_of(scenario, prepared_->end, simulation_.seed());
    track_witness_ = make_track_witness(scenario, simulation_, targets_);
  }
  if (has_explorers(scenario)) {
    record.agent(central_agent, "central", "central");
    grid_witness_ = make_grid_witness(scenario, simulation_,
                                      [this](AgentId id) { return radio_->position(id); });
  }
  if (robot_world_) {
    record.agent(central_agent, "central", "central");
    trail_witness_ = make_trail_witness(scenario, simulation_, *robot_world_,
                                        [this](AgentId id) { return radio_->up(id); });
  }
  if (has_localizers(scenario)) pose_witness_ = make_pose_witness(*prepared_, simulation_);
  for (std::size_t i = 0; i < prepared_->specs.size(); ++i) {
    const AgentSpec& spec = *prepared_->specs[i];
    const auto id = static_cast<AgentId>(i);
    record.agent(id, prepared_->names[i], spec.kind);
    gossips_.push_back(make_gossip(scenario, spec, id, simulation_, *radio_));
    contexts_.push_back(std::make_unique<Context>(
        simulation_, *radio_,
        Context::Identity{.id = id,
                          .name = prepared_->names[i],
                          .kind = spec.kind,
                          .parameters = spec.parameters},
        Context::Service{.acknowledged = spec.talk.service == "acknowledged",
                         .gossip = gossips_.back().get(),
                         .steers = is_steered(*prepared_, id) ? movement_.get() : nullptr}));
    lookouts_.emplace_back();
    equipment_.emplace_back();
    agents_.push_back(make_agent(id, catalog));
    if (gossips_.back()) {
      gossips_.back()->attach(*agents_.back());
    } else {
      radio_->attach(id, *agents_.back());
    }
  }
  Dropouts dropouts = dropouts_of(scenario, simulation_.seed(), prepared_->end);
  if (!dropouts.agents().empty()) {
    life_ = std::make_unique<Life>(simulation_, *radio_, agents_, gossips_, std::move(dropouts));
  }
}

std::unique_ptr<Agent> Run::make_agent(AgentId id, const Catalog& catalog) {
  const auto i = static_cast<std::size_t>(id);
  const AgentSpec& spec = *prepared_->specs[i];
  if (elsewhere_) return make_stand_in(id);
  const auto own = catalog.agents().find(spec.kind);
  if (own != catalog.agents().end()) return own->second.make(*contexts_[i]);
  if (spec.kind == "estimator") return make_estimator(id);
  if (spec.kind == "tracker") return make_tracker(id);
  if (spec.kind == "localizer") return make_localizer(id);
  if (spec.kind == "explorer") return make_explorer(id);
  if (spec.kind == "forager") return make_forager(id);
  std::optional<SourceTraffic> traffic;
  if (spec.traffic) traffic = traffic_of(*spec.traffic, id, simulation_.seed());
  return std::make_unique<SourceAgent>(*contexts_[i], traffic);
}

std::unique_ptr<Agent> Run::make_estimator(AgentId id) {
  Context& context = *contexts_[static_cast<std::size_t>(id)];
  auto agent = std::make_unique<EstimatorAgent>(
      context, *witness_, estimator_options(*prepared_, id, simulation_.seed()));
  lookouts_.back() = make_lookout(*prepared_, id, context, *witness_, *agent, subjects_);
  return agent;
}

PlotSource* Run::equip_with_scan(AgentId id) {
  const auto i = static_cast<std::size_t>(id);
  const auto sensor = scan_sensor_of(*prepared_->specs[i]);
  if (!sensor) return nullptr;
  equipment_[i].scan = std::make_unique<TargetScan>(*contexts_[i], *sensor, targets_);
  return equipment_[i].scan.get();
}

LookSource* Run::equip_with_looks(AgentId id) {
  const auto i = static_cast<std::size_t>(id);
  const WorldSpec& world = prepared_->scenario.world;
  const auto sensor = grid_sensor_of(*prepared_->specs[i], world);
  if (!sensor) return nullptr;
  equipment_[i].looks =
      std::make_unique<AreaLook>(*contexts_[i], *grid_witness_, *sensor, area_of(world));
  return equipment_[i].looks.get();
}

RobotBody& Run::equip_with_body(AgentId id) {
  const auto i = static_cast<std::size_t>(id);
  equipment_[i].body =
      std::make_unique<FloorBody>(*contexts_[i], *robot_world_, body_options(*prepared_, id));
  return *equipment_[i].body;
}

std::unique_ptr<Agent> Run::make_tracker(AgentId id) {
  auto agent = std::make_unique<TrackerAgent>(
      *contexts_[static_cast<std::size_t>(id)],
      tracker_options(*prepared_, id, simulation_.seed(), equip_with_scan(id)));
  track_witness_->watch(id, *agent);
  return agent;
}

std::unique_ptr<Agent> Run::make_localizer(AgentId id) {
  auto agent =
      std::make_unique<LocalizerAgent>(*contexts_[static_cast<std::size_t>(id)], *pose_witness_,
                                       localizer_options(*prepared_, id, simulation_.seed()));
  pose_witness_->watch(id, *agent);
  return agent;
}

std::unique_ptr<Agent> Run::make_explorer(AgentId id) {
  auto agent = std::make_unique<ExplorerAgent>(
      *contexts_[static_cast<std::size_t>(id)], grid_witness_->riders(),
      explorer_options(*prepared_, id, simulation_.seed(), equip_with_looks(id)));
  grid_witness_->watch(id, agent->estimator());
  return agent;
}

std::unique_ptr<Agent> Run::make_forager(AgentId id) {
  const auto i = static_cast<std::size_t>(id);
  auto agent = std::make_unique<ForagerAgent>(*contexts_[i], equip_with_body(id), *trail_witness_,
                                              forager_options(*prepared_, id, simulation_.seed()));
  trail_witness_->watch(id, robots_[i], *agent);
  return agent;
}

RunEnd Run::run() {
  start();
  return finish(simulation_.run());
}

void Run::start() {
  try {
    if (witness_) witness_->start();
    if (track_witness_) track_witness_->start();
    if (pose_witness_) pose_witness_->start();
    if (grid_witness_) grid_witness_->start();
    if (robot_world_) robot_world_->start();
    if (trail_witness_) trail_witness_->start();
    if (life_) life_->start();
    for (std::size_t i = 0; i < agents_.size(); ++i) {
      simulation_.acting_for(static_cast<AgentId>(i));
      if (gossips_[i]) gossips_[i]->start();
      if (lookouts_[i]) lookouts_[i]->start();
      agents_[i]->start();
    }
  } catch (...) {
    simulation_.fail(no_agent, std::current_exception());
  }
}

RunEnd Run::finish(RunEnd end) {
  if (end.ok()) {
    try {
      leave_final_values();
    } catch (const std::exception& error) {
      end.reason = EndReason::agent_failed;
      end.message = std::string("the run failed at its end: ") + error.what();
    }
  }
  simulation_.record().finish();
  return end;
}

void Run::keep_record_only() {
  life_.reset();
  lookouts_.clear();
  agents_.clear();
  equipment_.clear();
  contexts_.clear();
  gossips_.clear();
  radio_.reset();
  movement_.reset();
  witness_.reset();
  track_witness_.reset();
  pose_witness_.reset();
  grid_witness_.reset();
  trail_witness_.reset();
  robot_world_.reset();
}

void Run::leave_final_values() {
  for (std::size_t i = 0; i < agents_.size(); ++i) {
    agents_[i]->finish();
    if (lookouts_[i]) lookouts_[i]->finish();
  }
  if (witness_) witness_->finish();
  if (track_witness_) track_witness_->finish();
  if (pose_witness_) pose_witness_->finish();
  if (grid_witness_) grid_witness_->finish();
  if (trail_witness_) trail_witness_->finish();
  radio_->finish();
  record_radio(simulation_.record(), *radio_, gossips_);
  if (prepared_->log) record_log(*prepared_, simulation_.record());
}

}  // namespace hearsay
