#include "scenarios/explorers.hpp"

#include <algorithm>
#include <utility>

#include "scenarios/run.hpp"
#include "scenarios/talk.hpp"
#include "sim/kernel/random.hpp"

namespace hearsay {
namespace {

GridBelief::Options belief_of(const GridSpec& spec) {
  if (spec.belief == "beta") {
    return grid::BetaGrid::Options{
        .prior = {spec.prior_alpha.value_or(1.0), spec.prior_beta.value_or(1.0)}};
  }
  const grid::BernoulliGrid::Options usual;
  return grid::BernoulliGrid::Options{.prior = spec.prior.value_or(usual.prior),
                                      .limit = spec.log_odds_max.value_or(usual.limit)};
}

grid::Form form_of(const std::string& message) {
  if (message == "runs") return grid::Form::runs;
  return message == "whole" ? grid::Form::whole : grid::Form::changed;
}

GridSensor::Options sensor_of(const SensorSpec& spec) {
  GridSensor::Options options{
      .detector = spec.detector ? grid::detector_by_name(*spec.detector).value()
                                : grid::Detector{spec.p_detect.value(), spec.p_false.value()},
      .range_max_m = spec.range_max_m.value(),
      .kind = GridSensor::Presence{}};
  if (spec.depression_rad) options.depression_rad = *spec.depression_rad;
  if (spec.kind == "presence") {
    options.kind = GridSensor::Presence{spec.angle_max_rad.value()};
    return options;
  }
  const std::vector<double> size_px = spec.image_px.value_or(std::vector<double>{240.0, 320.0});
  options.kind = GridSensor::Camera{.lens = {spec.focal_px.at(0), spec.focal_px.at(1),
                                             spec.center_px.at(0), spec.center_px.at(1)},
                                    .width = static_cast<int>(size_px.at(0)),
                                    .height = static_cast<int>(size_px.at(1)),
                                    .sigma_position_m = spec.sigma_position_m,
                                    .sigma_attitude_rad = spec.sigma_attitude_rad,
                                    .sigma_pixel = spec.sigma_pixel};
  return options;
}

Exploration::Options exploration_of(const ExplorationSpec& spec) {
  Exploration::Options options;
  if (spec.choice == "random-walk") options.choice = Exploration::Choice::random_walk;
  if (spec.vehicle == "constant-speed") options.vehicle = Exploration::Vehicle::constant_speed;
  if (spec.turn_max_rad) options.turn_max_rad = *spec.turn_max_rad;
  if (spec.headings) options.headings = *spec.headings;
  if (spec.horizon_cells) options.horizon = *spec.horizon_cells;
  options.weights = {spec.gain_weight.value_or(1.0), spec.cost_weight.value_or(0.0)};
  return options;
}

}  // namespace

bool has_explorers(const Scenario& scenario) {
  return std::any_of(scenario.agents.begin(), scenario.agents.end(),
                     [](const AgentSpec& agent) { return agent.kind == "explorer"; });
}

grid::Area area_of(const WorldSpec& world) {
  const AreaSpec& area = world.area.value();
  return grid::Area({.columns = area.columns,
                     .rows = area.rows,
                     .cell_m = area.cell_m,
                     .x_m = area.origin_m.at(0),
                     .y_m = area.origin_m.at(1)});
}

std::vector<grid::Point> target_places_of(const WorldSpec& world, std::uint64_t seed) {
  const AreaSpec& area = world.area.value();
  std::vector<grid::Point> places;
  for (std::size_t i = 0; i < world.targets.size(); ++i) {
    if (const auto& place_m = world.targets[i].position_m) {
      places.push_back({place_m->at(0), place_m->at(1)});
      continue;
    }
    // Draws of its own, whatever the other targets.
    Stream draws(seed, Purpose("target place"), Entity{i});
    const double x = draws.uniform(0.0, area.columns * area.cell_m);
    const double y = draws.uniform(0.0, area.rows * area.cell_m);
    places.push_back({area.origin_m.at(0) + x, area.origin_m.at(1) + y});
  }
  return places;
}

std::unique_ptr<GridWitness> make_grid_witness(const Scenario& scenario, Simulation& simulation,
                                               std::function<Point(AgentId)> place_of) {
  const auto first = std::find_if(scenario.agents.begin(), scenario.agents.end(),
                                  [](const AgentSpec& agent) { return agent.kind == "explorer"; });
  const RecordSpec& record = scenario.record;
  const grid::Area area = area_of(scenario.world);
  return std::make_unique<GridWitness>(
      simulation,
      GridWitness::Options{.area = area,
                           .belief = belief_of(first->grid),
                           .targets = target_places_of(scenario.world, simulation.seed()),
                           .thresholds = record.alarms.thresholds.values,
                           .gate_m = record.alarms.gate_m.value_or(2.0 * area.cell_m()),
                           .period = Duration::seconds(record.series_period_s),
                           .series = record.series,
                           .grids = record.grids == "on",
                           .ledger = record.ledger == "on",
                           .place_of = std::move(place_of)});
}

std::optional<GridSensor::Options> grid_sensor_of(const AgentSpec& spec, const WorldSpec& world) {
  if (spec.sensor.kind == "none") return std::nullopt;
  GridSensor::Options options = sensor_of(spec.sensor);
  options.relief = world.area->relief;
  return options;
}

ExplorerAgent::Options explorer_options(const PreparedScenario& prepared, AgentId id,
                                        std::uint64_t seed, LookSource* looks) {
  const AgentSpec& spec = *prepared.specs[static_cast<std::size_t>(id)];
  const WorldSpec& world = prepared.scenario.world;
  ExplorerAgent::Options options{
      .area = area_of(world),
      .estimator = {.belief = belief_of(spec.grid),
                    .rule = grid::rule_by_name(spec.grid.fusion).value(),
                    .omega = spec.grid.omega.value_or(grid::usual_omega),
                    .form = form_of(spec.grid.message),
                    .whole_every = spec.grid.whole_every.value_or(0),
                    .packet_bytes = static_cast<std::size_t>(spec.grid.packet_bytes_max)},
      .looks = looks,
      .sensor = grid_sensor_of(spec, world),
      .exploration = std::nullopt,
      .talk = std::nullopt};
  options.sensor_period = Duration::seconds(spec.sensor.period_s);
  options.sensor_start = Time::at(Duration::seconds(spec.sensor.start_s));
  if (spec.sensor.end_s) options.sensor_end = Time::at(Duration::seconds(*spec.sensor.end_s));
  if (spec.exploration) {
    options.exploration = exploration_of(*spec.exploration);
    options.speed_m_per_s = spec.exploration->speed_m_per_s;
  }
  if (spec.talk.policy == "periodic") options.talk = talk_of(prepared, id, seed);
  return options;
}

}  // namespace hearsay
