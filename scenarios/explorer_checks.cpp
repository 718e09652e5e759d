// What must fit together in areas, and in agents that explore them.
#include <algorithm>
#include <cmath>
#include <string>

#include "agents/sensors/truth_image.hpp"
#include "scenarios/explorers.hpp"
#include "scenarios/heights.hpp"
#include "scenarios/scenario_under_check.hpp"
#include "sim/math/functions.hpp"

namespace hearsay {
namespace {

constexpr std::size_t thresholds_max = 100;
constexpr double recorded_cells_max = 1e6;
constexpr double named_cells_max = 60'000;  // a record has 65,535 names in all
constexpr double all_cells_max = 1e9;

bool is_camera(const SensorSpec& sensor) { return sensor.kind == "segmented-camera"; }
bool is_for_grids(const SensorSpec& sensor) {
  return is_camera(sensor) || sensor.kind == "presence";
}

class ExplorerChecker {
 public:
  explicit ExplorerChecker(const ScenarioUnderCheck& file)
      : file_(file),
        s_(file.scenario),
        explorers_(has_explorers(s_)),
        places_(agent_positions(s_)) {}

  void all() {
    check_world();
    check_record();
    for (std::size_t i = 0; i < s_.agents.size(); ++i) {
      const AgentSpec& agent = s_.agents[i];
      const KeyPath path = agents_[i];
      check_sensor_keys(agent.sensor, path["sensor"]);
      if (agent.kind == "explorer") {
        check_explorer(agent, path);
      } else {
        check_other(agent, path);
      }
      number_ += static_cast<std::size_t>(agent.count);
    }
  }

 private:
  void check_world() const;
  void check_record() const;
  void check_sensor_keys(const SensorSpec& sensor, const KeyPath& path) const;
  void check_other(const AgentSpec& agent, const KeyPath& path) const;
  void check_explorer(const AgentSpec& agent, const KeyPath& path);
  void check_talk(const TalkSpec& talk, const KeyPath& path) const;
  void check_grid(const GridSpec& grid, const KeyPath& path) const;
  void check_packets(const AgentSpec& agent, const KeyPath& path) const;
  void check_like_first(const GridSpec& grid, const KeyPath& path);
  void check_sensor(const AgentSpec& agent, const KeyPath& path) const;
  void check_detector(const SensorSpec& sensor, const KeyPath& path) const;
  void check_image(const SensorSpec& sensor, const KeyPath& path) const;
  void check_way(const AgentSpec& agent, const KeyPath& path) const;
  void check_exploration(const ExplorationSpec& exploration, const KeyPath& path) const;
  [[noreturn]] void fail(const KeyPath& path, const std::string& why) const {
    file_.fail(path, why);
  }

  const ScenarioUnderCheck& file_;
  const Scenario& s_;
  bool explorers_;
  std::vector<std::optional<std::array<double, 2>>> places_;
  std::size_t number_ = 0;  // of the first agent of the entry at hand
  KeyPath top_;
  KeyPath agents_ = top_["agents"];
  const GridSpec* first_ = nullptr;
  const GridSpec* first_teller_ = nullptr;  // whose rule sends
};

void ExplorerChecker::check_world() const {
  const KeyPath world = top_["world"];
  const KeyPath targets = world["targets"];
  const KeyPath area = world["area"];
  if (!explorers_) {
    if (s_.world.area) fail(area, "without effect: no agent is of kind \"explorer\"");
    return;
  }
  if (!s_.world.area) fail(area, "missing; agents of kind \"explorer\" need cells to explore");
  if (s_.world.log) fail(area, "not with [world.log]");
  const AreaSpec& spec = *s_.world.area;
  const double far_m = 1e8;  // a vehicle that cannot turn well leaves it by 2000 cells
  if (spec.cell_m * std::max(spec.columns, spec.rows) > far_m ||
      std::abs(spec.origin_m.at(0)) > far_m || std::abs(spec.origin_m.at(1)) > far_m) {
    fail(area, "must lie within 100000 km of the origin");
  }
  double all_cells = 0.0;
  for (const AgentSpec& agent : s_.agents) {
    if (agent.kind == "explorer") all_cells += 1.0 * spec.columns * spec.rows * agent.count;
  }
  if (all_cells > all_cells_max) fail(area, "has more than 1e9 cells, for all explorers together");
  for (std::size_t i = 0; i < s_.world.targets.size(); ++i) {
    const TargetSpec& target = s_.world.targets[i];
    const KeyPath path = targets[i];
    if (target.motion) fail(path["motion"], "grids are about what stands still");
    if (!target.position_m) continue;
    const double x = target.position_m->at(0), y = target.position_m->at(1);
    if (!area_of(s_.world).at({x, y})) fail(path["position_m"], "lies outside world.area");
  }
}

void ExplorerChecker::check_record() const {
  const KeyPath record = top_["record"];
  const KeyPath alarms = record["alarms"];
  const RecordSpec& spec = s_.record;
  if (!explorers_) {
    const std::string why = "without effect: no agent is of kind \"explorer\"";
    if (spec.alarms != AlarmSpec()) fail(alarms, why);
    if (spec.grids == "on") fail(record["grids"], why);
    return;
  }
  const auto& thresholds = spec.alarms.thresholds.values;
  if (thresholds.size() > thresholds_max) {
    fail(alarms["thresholds"], "has more than 100 thresholds");
  }
  if (std::adjacent_find(thresholds.begin(), thresholds.end(), std::greater_equal<>()) !=
      thresholds.end()) {
    fail(alarms["thresholds"], "must rise");
  }
  const double cells = static_cast<double>(s_.world.area->columns) * s_.world.area->rows;
  if (spec.grids == "on" && cells > named_cells_max) {
    fail(record["grids"], "more than 60000 cells of an area are not recorded");
  }
  if (spec.grids == "on" && cells * s_.agent_count() > recorded_cells_max) {
    fail(record["grids"], "more than a million cells of all agents together are not recorded");
  }
}

void ExplorerChecker::check_sensor_keys(const SensorSpec& sensor, const KeyPath& path) const {
  const auto only = [&](bool given, const char* key, bool fits, const char* kinds) {
    if (given && !fits) {
      fail(path[key], std::string("only for kind = ") + kinds + "; found \"" + sensor.kind + "\"");
    }
  };
  const char* const both = "\"segmented-camera\" or \"presence\"";
  only(sensor.detector.has_value(), "detector", is_for_grids(sensor), both);
  only(sensor.p_detect.has_value(), "p_detect", is_for_grids(sensor), both);
  only(sensor.p_false.has_value(), "p_false", is_for_grids(sensor), both);
  only(sensor.depression_rad.has_value(), "depression_rad", is_for_grids(sensor), both);
  only(sensor.angle_max_rad.has_value(), "angle_max_rad", sensor.kind == "presence",
       "\"presence\"");
  only(sensor.image_px.has_value(), "image_px", is_camera(sensor), "\"segmented-camera\"");
}

void ExplorerChecker::check_other(const AgentSpec& agent, const KeyPath& path) const {
  const std::string only = "only for kind = \"explorer\"; found \"" + agent.kind + "\"";
  if (agent.grid != GridSpec()) fail(path["grid"], only);
  if (agent.exploration) fail(path["exploration"], only);
  const KeyPath sensor = path["sensor"];
  if (is_for_grids(agent.sensor)) {
    fail(sensor["kind"], "\"" + agent.sensor.kind + "\" looks at the cells of grids: " + only);
  }
  const bool anywhere = std::any_of(s_.world.targets.begin(), s_.world.targets.end(),
                                    [](const TargetSpec& t) { return !t.position_m; });
  if (explorers_ && anywhere && agent.sensor.kind != "none") {
    fail(sensor["kind"], "\"" + agent.sensor.kind + "\" needs targets with position_m");
  }
  const bool believes =
      agent.kind == "estimator" || agent.kind == "tracker" || agent.kind == "localizer";
  if (explorers_ && believes) {
    fail(path["kind"], "\"" + agent.kind + "\" does not go with agents of kind \"explorer\"");
  }
}

void ExplorerChecker::check_explorer(const AgentSpec& agent, const KeyPath& path) {
  if (agent.estimator != EstimatorSpec()) {
    fail(path["estimator"], "without effect: kind = \"explorer\" has agents.grid instead");
  }
  check_talk(agent.talk, path["talk"]);
  check_grid(agent.grid, path["grid"]);
  check_packets(agent, path["grid"]);
  check_like_first(agent.grid, path["grid"]);
  check_sensor(agent, path);
  check_way(agent, path);
}

void ExplorerChecker::check_talk(const TalkSpec& talk, const KeyPath& path) const {
  const std::string kind = "kind \"explorer\" knows ";
  if (talk.policy != "periodic" && talk.policy != "never") {
    fail(path["policy"], kind + "\"periodic\" and \"never\" alone; found \"" + talk.policy + "\"");
  }
  const auto talks_max = static_cast<double>(ExplorerAgent::talks_max);
  if (talk.policy == "periodic" && *s_.duration_s / talk.period_s >= talks_max) {
    fail(path["period_s"], "more than 2^28 talks in a run");
  }
  if (talk.content != "belief") {
    fail(path["content"], "kind \"explorer\" has agents.grid.message instead");
  }
  if (is_gossip(talk.service)) {
    fail(path["service"],
         kind + "\"broadcast\" and \"acknowledged\" alone; found \"" + talk.service + "\"");
  }
}

void ExplorerChecker::check_grid(const GridSpec& grid, const KeyPath& path) const {
  const bool beta = grid.belief == "beta";
  const grid::RuleInfo& rule = grid::info(grid::rule_by_name(grid.fusion).value());
  if (beta ? !rule.beta : !rule.bernoulli) {
    std::string allowed;
    for (const grid::RuleInfo& other : grid::rules()) {
      if (!(beta ? other.beta : other.bernoulli)) continue;
      allowed += (allowed.empty() ? "" : ", ") + std::string(other.name);
    }
    fail(path["fusion"], "\"" + grid.fusion + "\" does not go with belief = \"" + grid.belief +
                             "\"; allowed: " + allowed);
  }
  const bool weighs = rule.rule == grid::Rule::geometric_mean ||
                      rule.rule == grid::Rule::linear_pool ||
                      rule.rule == grid::Rule::averaged_parameters;
  if (grid.omega && !weighs) {
    fail(path["omega"], "without effect under fusion \"" + grid.fusion +
                            "\"; only with geometric-mean, linear-pool, averaged-parameters");
  }
  const auto only = [&](bool given, const char* key, bool fits, const char* belief) {
    if (given && !fits) fail(path[key], std::string("only for belief = ") + belief);
  };
  only(grid.prior.has_value(), "prior", !beta, "\"bernoulli\"");
  only(grid.log_odds_max.has_value(), "log_odds_max", !beta, "\"bernoulli\"");
  only(grid.prior_alpha.has_value(), "prior_alpha", beta, "\"beta\"");
  only(grid.prior_beta.has_value(), "prior_beta", beta, "\"beta\"");
  const double limit = grid.log_odds_max.value_or(grid::BernoulliGrid::Options().limit);
  if (std::abs(grid::log_odds_of(grid.prior.value_or(0.5))) > limit) {
    fail(path["log_odds_max"], "the prior is believed in more firmly than that");
  }
  if (grid.whole_every && grid.message != "changed") {
    fail(path["whole_every"], "only for message = \"changed\"; found \"" + grid.message + "\"");
  }
}

void ExplorerChecker::check_packets(const AgentSpec& agent, const KeyPath& path) const {
  const GridSpec& grid = agent.grid;
  if (grid.fusion == "none" || agent.talk.policy == "never") return;
  const grid::Form form = grid.message == "runs"      ? grid::Form::runs
                          : grid.message == "changed" ? grid::Form::changed
                                                      : grid::Form::whole;
  const std::size_t layers =
      grid.belief == "beta" ? grid::BetaGrid::layers : grid::BernoulliGrid::layers;
  const std::size_t blocks =
      grid::blocks_that_fit(form, layers, static_cast<std::size_t>(grid.packet_bytes_max));
  const auto cells = static_cast<std::uint64_t>(area_of(s_.world).cells());
  if (cells > blocks * ExplorerAgent::packets_a_talk_max) {
    fail(path["packet_bytes_max"], "all cells would take more than 2^20 packets");
  }
  // The last cells would never be told; the packets of other forms are mostly fewer.
  const std::uint64_t packets = (cells + blocks - 1) / blocks;
  const auto queue = static_cast<std::uint64_t>(s_.radio.queue_packets_max);
  if (form == grid::Form::whole && packets > queue) {
    fail(path["packet_bytes_max"], "all cells take " + std::to_string(packets) +
                                       " packets, but radio.queue_packets_max is " +
                                       std::to_string(queue));
  }
}

void ExplorerChecker::check_like_first(const GridSpec& grid, const KeyPath& path) {
  if (first_ == nullptr) first_ = &grid;
  const bool alike = grid.belief == first_->belief && grid.prior == first_->prior &&
                     grid.prior_alpha == first_->prior_alpha &&
                     grid.prior_beta == first_->prior_beta &&
                     grid.log_odds_max == first_->log_odds_max;
  if (!alike) {
    fail(path,
         "all explorers of a run share belief, prior and limit: they understand each "
         "other, and have one central grid");
  }
  // To tell each neighbour what it did not say itself, and to all what one believes.
  const grid::Sends sends = grid::info(grid::rule_by_name(grid.fusion).value()).sends;
  if (sends == grid::Sends::nothing) return;
  if (first_teller_ == nullptr) first_teller_ = &grid;
  if (sends == grid::info(grid::rule_by_name(first_teller_->fusion).value()).sends) return;
  fail(path["fusion"], "\"" + grid.fusion + "\" and \"" + first_teller_->fusion +
                           "\" of another explorer do not understand each other");
}

void ExplorerChecker::check_sensor(const AgentSpec& agent, const KeyPath& path) const {
  const SensorSpec& sensor = agent.sensor;
  const KeyPath sensor_path = path["sensor"];
  if (sensor.kind == "none") return;
  if (!is_for_grids(sensor)) {
    fail(sensor_path["kind"],
         "agents of kind \"explorer\" have a sensor of kind \"segmented-camera\" or "
         "\"presence\", or none; found \"" +
             sensor.kind + "\"");
  }
  if (!agent.motion || agent.motion->altitude_m <= 0.0) {
    fail(sensor_path["kind"], "\"" + sensor.kind +
                                  "\" needs to know how high over the ground the agent flies, as "
                                  "motion = { kind = \"steered\", altitude_m = 40 }");
  }
  if (!sensor.range_max_m) {
    fail(sensor_path["range_max_m"], "missing; from how far does a look tell nothing any more?");
  }
  if (*sensor.range_max_m <= agent.motion->altitude_m) {
    fail(sensor_path["range_max_m"], "must be more than motion.altitude_m (" +
                                         to_toml(agent.motion->altitude_m) +
                                         " m), or the ground is out of sight");
  }
  check_detector(sensor, sensor_path);
  if (sensor.kind == "presence") {
    if (!sensor.angle_max_rad) {
      fail(sensor_path["angle_max_rad"], "missing; kind \"presence\" needs how wide it looks");
    }
    return;
  }
  check_image(sensor, sensor_path);
}

void ExplorerChecker::check_detector(const SensorSpec& sensor, const KeyPath& path) const {
  if (sensor.detector) {
    if (sensor.p_detect) fail(path["p_detect"], "not together with detector");
    if (sensor.p_false) fail(path["p_false"], "not together with detector");
    return;
  }
  if (!sensor.p_detect) fail(path["p_detect"], "missing; give it with p_false, or a detector");
  if (!sensor.p_false) fail(path["p_false"], "missing; give it with p_detect, or a detector");
  if (*sensor.p_false >= *sensor.p_detect) {
    fail(path["p_false"], "must be less than p_detect (" + to_toml(*sensor.p_detect) + ")");
  }
}

void ExplorerChecker::check_image(const SensorSpec& sensor, const KeyPath& path) const {
  if (sensor.sigma_pixel < 0.5) {
    fail(path["sigma_pixel"], "must be at least 0.5 for kind \"segmented-camera\"");
  }
  if (!sensor.image_px) return;
  double pixels = 1.0;
  for (const double side : *sensor.image_px) {
    if (side != std::floor(side) || side > grid::SegmentedImage::side_max) {
      fail(path["image_px"], "must be two whole numbers of pixels, at most 4096 each");
    }
    pixels *= side;
  }
  if (pixels > TruthImage::pixels_max) {
    fail(path["image_px"], "has more than " + std::to_string(TruthImage::pixels_max) + " pixels");
  }
}

void ExplorerChecker::check_way(const AgentSpec& agent, const KeyPath& path) const {
  const bool steered = agent.motion && agent.motion->kind == "steered";
  if (agent.exploration && !steered) {
    fail(path["exploration"], "needs motion.kind = \"steered\"");
  }
  const KeyPath motion = path["motion"];
  if (!agent.motion) {
    fail(path["motion"], "missing; agents of kind \"explorer\" fly, or hover, over the area");
  }
  if (steered && !agent.exploration) {
    fail(motion["kind"], "\"steered\" needs agents.exploration: where does it go?");
  }
  if (!agent.exploration) return;
  const KeyPath exploration = path["exploration"];
  if (agent.exploration->choice == "gain" && agent.sensor.kind == "none") {
    fail(exploration["choice"], "\"gain\" is that of a look, and there is no sensor");
  }
  check_exploration(*agent.exploration, exploration);
  const KeyPath place = path[agent.circle ? "circle" : "position_m"];
  for (std::size_t i = 0; i < static_cast<std::size_t>(agent.count); ++i) {
    const auto& at = places_[number_ + i];
    if (at && !area_of(s_.world).at({(*at)[0], (*at)[1]})) {
      fail(place, "an explorer begins inside world.area");
    }
  }
}

void ExplorerChecker::check_exploration(const ExplorationSpec& exploration,
                                        const KeyPath& path) const {
  const bool turns = exploration.vehicle == "constant-speed";
  const bool gains = exploration.choice == "gain";
  const auto only = [&](bool given, const char* key, bool fits, const char* what) {
    if (given && !fits) fail(path[key], std::string("only for ") + what);
  };
  const char* const vehicle = "vehicle = \"constant-speed\"";
  const char* const choice = "choice = \"gain\"";
  only(exploration.turn_max_rad.has_value(), "turn_max_rad", turns, vehicle);
  only(exploration.headings.has_value(), "headings", turns, vehicle);
  only(exploration.horizon_cells.has_value(), "horizon_cells", gains, choice);
  only(exploration.gain_weight.has_value(), "gain_weight", gains, choice);
  only(exploration.cost_weight.has_value(), "cost_weight", gains, choice);
  if (exploration.headings.value_or(5) % 2 == 0) fail(path["headings"], "must be odd");
  const double cell_s = s_.world.area->cell_m / exploration.speed_m_per_s;
  if (!(cell_s >= 1e-9 && cell_s <= 1e9)) {
    fail(path["speed_m_per_s"],
         "a cell (" + to_toml(s_.world.area->cell_m) + " m) must take 1e-9 s to 1e9 s");
  }
}

}  // namespace

void check_explorers(ScenarioUnderCheck& file) {
  ExplorerChecker(file).all();
  take_heights(file);
}

}  // namespace hearsay
