#include "scenarios/foragers.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "filters/trails/parameters.hpp"
#include "scenarios/run.hpp"
#include "scenarios/talk.hpp"
#include "scenarios/trails_checks.hpp"
#include "sim/kernel/error.hpp"
#include "sim/kernel/random.hpp"

namespace hearsay {
namespace {

bool forages(const AgentSpec& spec) { return spec.kind == "forager"; }

plan::Point point_of(const std::vector<double>& at_m) { return {at_m.at(0), at_m.at(1)}; }

RobotWorld::Source source_of(const Scenario& scenario, const std::string& name) {
  const plan::Plan& plan = *scenario.world.plan->plan;
  RobotWorld::Source source{.name = name, .at = plan.place(name), .units = {}, .moves = {}};
  const auto& sources = scenario.world.sources;
  const auto spec = std::find_if(sources.begin(), sources.end(),
                                 [&](const SourceSpec& s) { return s.name == name; });
  if (spec == sources.end()) return source;
  if (spec->units) source.units = static_cast<std::uint64_t>(*spec->units);
  source.radius_m = spec->event_radius_m.value_or(source.radius_m);
  for (const SourceMoveSpec& move : spec->moves) {
    source.moves.push_back(
        {Time::at(Duration::seconds(move.at_s.value())), plan.place(move.place), move.place});
  }
  return source;
}

std::vector<RobotWorld::Barrier> barriers_of(const PlanSpec& plan) {
  std::vector<RobotWorld::Barrier> barriers;
  for (const BarrierSpec& spec : plan.barriers) {
    const plan::Point a = point_of(spec.corner_m.value()), b = point_of(spec.opposite_m.value());
    RobotWorld::Barrier barrier{.area = {{std::min(a.x_m, b.x_m), std::min(a.y_m, b.y_m)},
                                         {std::max(a.x_m, b.x_m), std::max(a.y_m, b.y_m)}},
                                .from = Time::at(Duration::seconds(spec.from_s))};
    if (spec.until_s) barrier.until = Time::at(Duration::seconds(*spec.until_s));
    barriers.push_back(barrier);
  }
  return barriers;
}

RobotWorld::Start start_of(const RobotSpec& robot, const plan::Plan& plan) {
  RobotWorld::Start start{.at = {}, .scatter_m = robot.scatter_m, .heading_rad = robot.heading_rad};
  if (robot.start != "anywhere") start.at = plan.place(robot.start);
  return start;
}

const trails::ParameterSet& parameters_of(const TrailsSpec& spec) {
  return *trails::parameter_set(spec.parameters);
}

double sense_radius_of(const TrailsSpec& spec) {
  return spec.sense_radius_m.value_or(parameters_of(spec).sense_radius_m.value_or(1.0));
}

TrailFollower::Options follower_of(const TrailsSpec& spec) {
  const trails::ParameterSet& set = parameters_of(spec);
  TrailFollower::Options options;
  options.sense_radius_m = sense_radius_of(spec);
  options.field_rad = spec.field_rad;
  options.trail_end_s = spec.trail_end_s ? spec.trail_end_s : set.trail_end;
  using End = TrailFollower::TrailEnd;
  options.trail_end = spec.trail_end == "search" ? End::search
                      : spec.trail_end == "none" ? End::none
                                                 : End::explore;
  using Lanes = TrailFollower::Lanes;
  options.lanes = spec.lanes == "so-lost"   ? Lanes::so_lost
                  : spec.lanes == "highway" ? Lanes::highway
                                            : Lanes::none;
  if (set.local_search) options.fading = set.local_search->fading;
  options.random_chance = spec.random_chance.value_or(0.0);
  options.random_falls_by = spec.random_falls_by.value_or(
      set.local_search && spec.random_chance ? set.local_search->falls_by : 0.0);
  return options;
}

TrailEstimator::Options estimator_of(const TrailsSpec& spec, const Scenario& scenario, int robot) {
  const trails::ParameterSet& set = parameters_of(spec);
  TrailEstimator::Options options;
  options.store.robot = static_cast<trails::RobotId>(robot);
  options.store.crumbs_max = static_cast<std::size_t>(spec.crumbs_max);
  options.store.events_max = std::max<std::size_t>(events_of(scenario).size(), 1);
  const double forever = std::numeric_limits<double>::infinity();
  options.store.age_max_s = spec.age_max_s.value_or(set.age_max_s.value_or(forever));
  options.store.life_arrivals = spec.life_arrivals.value_or(set.life_arrivals.value_or(0));
  // Clocks may differ by twice the largest offset.
  for (const AgentSpec& agent : scenario.agents) {
    if (!forages(agent)) continue;
    options.store.ahead_max_s =
        std::max(options.store.ahead_max_s, 2.0 * agent.robot->clock_offset_s);
  }
  options.cell_m = std::clamp(sense_radius_of(spec), 0.01, 1e6);
  options.laying = laying_of(spec);
  options.interval_s = spec.interval_s.value_or(set.interval_s.value_or(1.0));
  options.trail_crumbs_max = spec.trail_crumbs_max
                                 ? static_cast<std::size_t>(*spec.trail_crumbs_max)
                                 : set.crumbs_max.value_or(options.trail_crumbs_max);
  options.names_goal = spec.lanes != "none";
  options.relay = spec.relay;
  options.as_is = spec.transform == "as-is";
  options.align.optimistic = spec.transform == "optimistic";
  options.align.scale = spec.scale;
  options.packet_bytes = static_cast<std::size_t>(spec.packet_bytes_max);
  return options;
}

ForagerAgent::Telling telling_of(const std::string& policy) {
  using Telling = ForagerAgent::Telling;
  if (policy == "at-once") return Telling::at_once;
  if (policy == "at-event") return Telling::at_event;
  return policy == "periodic" ? Telling::periodic : Telling::never;
}

Pilot::Options pilot_of(const AgentSpec& spec) {
  const RobotSpec& robot = spec.robot.value();
  Pilot::Options options;
  options.radius_m = robot.radius_m;
  options.speed_m_per_s = robot.speed_m_per_s;
  options.turn_rad_per_s = robot.turn_rad_per_s;
  options.range_m = robot.range_m;
  const std::string& exploration = spec.trails->exploration;
  using Exploring = Pilot::Exploring;
  options.exploring = exploration == "wall"       ? Exploring::wall
                      : exploration == "corridor" ? Exploring::corridor
                                                  : Exploring::roam;
  return options;
}

}  // namespace

bool has_foragers(const Scenario& scenario) {
  return std::any_of(scenario.agents.begin(), scenario.agents.end(), forages);
}

std::vector<std::string> events_of(const Scenario& scenario) {
  std::vector<std::string> names;
  for (const SourceSpec& source : scenario.world.sources) names.push_back(source.name);
  for (const AgentSpec& agent : scenario.agents) {
    if (!agent.task) continue;
    for (const std::string& event : agent.task->events) {
      if (std::find(names.begin(), names.end(), event) == names.end()) names.push_back(event);
    }
  }
  return names;
}

std::unique_ptr<RobotWorld> make_robot_world(const Scenario& scenario, Simulation& simulation) {
  const PlanSpec& plan = scenario.world.plan.value();
  const auto first = std::find_if(scenario.agents.begin(), scenario.agents.end(), forages);
  RobotWorld::Options options{
      .plan = plan.plan, .barriers = barriers_of(plan), .sources = {}, .floor = {}};
  for (const std::string& event : events_of(scenario)) {
    options.sources.push_back(source_of(scenario, event));
  }
  options.floor.radius_m = first->robot->radius_m;
  for (const AgentSpec& agent : scenario.agents) {
    if (!forages(agent)) continue;
    drive::Limits& limits = options.floor.limits;
    limits.speed_max_m_per_s = std::max(limits.speed_max_m_per_s, agent.robot->speed_m_per_s);
    limits.turn_max_rad_per_s = std::max(limits.turn_max_rad_per_s, agent.robot->turn_rad_per_s);
  }
  auto world = std::make_unique<RobotWorld>(simulation, std::move(options));
  AgentId id = 0;
  for (std::size_t number = 0; number < scenario.agents.size(); ++number) {
    const AgentSpec& agent = scenario.agents[number];
    for (int i = 0; i < agent.count; ++i, ++id) {
      if (!forages(agent)) continue;
      try {
        world->add(start_of(*agent.robot, *plan.plan),
                   simulation.stream(Purpose("robot start"), Entity::agent(id)));
      } catch (const InputError& error) {
        throw InputError(scenario.file, 0,
                         "agents[" + std::to_string(number) + "].robot: " + error.what());
      }
    }
  }
  return world;
}

std::unique_ptr<TrailWitness> make_trail_witness(const Scenario& scenario, Simulation& simulation,
                                                 const RobotWorld& world,
                                                 std::function<bool(AgentId)> up) {
  const auto first = std::find_if(scenario.agents.begin(), scenario.agents.end(), forages);
  return std::make_unique<TrailWitness>(
      simulation, world,
      TrailWitness::Options{.period = Duration::seconds(scenario.record.series_period_s),
                            .series = scenario.record.series,
                            .crumbs = scenario.record.crumbs == "on",
                            .wrong_m = sense_radius_of(*first->trails),
                            .up = std::move(up)});
}

int robot_of(const PreparedScenario& prepared, AgentId id) {
  const auto before = prepared.specs.begin() + id;
  return static_cast<int>(std::count_if(prepared.specs.begin(), before,
                                        [](const AgentSpec* spec) { return forages(*spec); }));
}

FloorBody::Options body_options(const PreparedScenario& prepared, AgentId id) {
  const RobotSpec& body = prepared.specs[static_cast<std::size_t>(id)]->robot.value();
  return {.robot = robot_of(prepared, id),
          .start = start_of(body, *prepared.scenario.world.plan->plan),
          .fan = std::make_shared<plan::Fan>(body.rays, body.view_rad),
          .range_m = body.range_m};
}

ForagerAgent::Options forager_options(const PreparedScenario& prepared, AgentId id,
                                      std::uint64_t seed) {
  const Scenario& scenario = prepared.scenario;
  const AgentSpec& spec = *prepared.specs[static_cast<std::size_t>(id)];
  const RobotSpec& body = spec.robot.value();
  const TrailsSpec& trails = spec.trails.value();
  ForagerAgent::Options options;
  options.robot = robot_of(prepared, id);
  options.period = Duration::seconds(body.control_period_s);
  options.fan = std::make_shared<plan::Fan>(body.rays, body.view_rad);
  options.shared_frame = body.frame == "shared";
  options.odometry = {.start = {},
                      .forward_bias = body.forward_bias,
                      .turn_bias = body.turn_bias,
                      .forward_m_per_sqrt_m = body.forward_m_per_sqrt_m,
                      .turn_rad_per_sqrt_m = body.turn_rad_per_sqrt_m,
                      .turn_rad_per_sqrt_rad = body.turn_rad_per_sqrt_rad};
  Stream draws(seed, Purpose("robot clock"), Entity::agent(id));
  options.clock_offset_s = body.clock_offset_s * (2.0 * draws.uniform() - 1.0);
  const std::vector<std::string> events = events_of(scenario);
  for (const std::string& event : spec.task->events) {
    const auto at = std::find(events.begin(), events.end(), event);
    options.task.push_back(static_cast<trails::EventId>(at - events.begin()));
  }
  options.respawn = spec.task->respawn;
  options.wait_for_all = spec.task->wait_for_all;
  using Navigation = ForagerAgent::Navigation;
  options.navigation = trails.navigation == "map"       ? Navigation::map
                       : trails.navigation == "explore" ? Navigation::explore
                                                        : Navigation::trails;
  options.pilot = pilot_of(spec);
  options.follower = follower_of(trails);
  options.search_radius_m = 2.0 * sense_radius_of(trails);
  options.estimator = estimator_of(trails, scenario, options.robot);
  options.distance = distance_of(trails);
  options.telling = telling_of(spec.talk.policy);
  if (spec.talk.policy == "periodic") options.talk = talk_of(prepared, id, seed);
  return options;
}

}  // namespace hearsay
