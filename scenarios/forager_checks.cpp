// What must fit together in floors, and in agents that forage on them.
#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "filters/trails/codec.hpp"
#include "scenarios/names.hpp"
#include "scenarios/plans.hpp"
#include "scenarios/scenario_under_check.hpp"
#include "scenarios/trails_checks.hpp"

namespace hearsay {
namespace {

constexpr std::size_t events_max = 16;  // of a task
constexpr double steps_max = 2e8;       // of control or talk, in a run
constexpr double rays_max = 1e7;        // of all robots
constexpr double way_max_m = 1e3;       // of a robot within a period of control
constexpr double turned_max_rad = 1e2;  // the same
constexpr double crumbs_max = 1e8;      // in the memories of all robots

bool is_forager(const AgentSpec& agent) { return agent.kind == "forager"; }
std::string quoted(const std::string& text) { return "\"" + text + "\""; }

class ForagerChecker {
 public:
  explicit ForagerChecker(const ScenarioUnderCheck& file)
      : file_(file),
        s_(file.scenario),
        foragers_(std::any_of(s_.agents.begin(), s_.agents.end(), is_forager)) {}

  /// What can be said before the plan is read.
  void all_but_places() {
    check_world();
    for (std::size_t i = 0; i < s_.agents.size(); ++i) {
      const AgentSpec& agent = s_.agents[i];
      const KeyPath path = agents_[i];
      if (is_forager(agent)) {
        check_forager(agent, path);
        check_like_first(agent, path, i);
      } else {
        check_other(agent, path);
      }
    }
    if (foragers_) {
      check_packets();
      check_transforms();
    }
  }
  /// The plan has been read.
  void places() {
    if (!foragers_) return;
    for (const plan::Place& place : s_.world.plan->plan->places()) names_.push_back(place.name);
    std::sort(names_.begin(), names_.end());
    check_barriers();
    check_sources();
    for (std::size_t i = 0; i < s_.agents.size(); ++i) {
      if (is_forager(s_.agents[i])) check_places(s_.agents[i], agents_[i]);
    }
  }

 private:
  void check_world() const;
  void check_other(const AgentSpec& agent, const KeyPath& path) const;
  void check_forager(const AgentSpec& agent, const KeyPath& path);
  void check_body(const AgentSpec& agent, const KeyPath& path) const;
  void check_robot(const AgentSpec& agent, const KeyPath& path);
  void check_task(const TaskSpec& task, const TrailsSpec& trails, const KeyPath& path);
  void check_talk(const AgentSpec& agent, const KeyPath& path) const;
  void check_like_first(const AgentSpec& agent, const KeyPath& path, std::size_t number);
  void check_packets() const;
  void check_transforms() const;
  void check_barriers() const;
  void check_sources() const;
  void check_moves(const SourceSpec& source, const KeyPath& path) const;
  void check_places(const AgentSpec& agent, const KeyPath& path) const;
  void check_place(const std::string& name, const KeyPath& path) const;
  [[noreturn]] void fail(const KeyPath& path, const std::string& why) const {
    file_.fail(path, why);
  }
  /// The same with the value that stands there.
  [[noreturn]] void refuse(const KeyPath& path, const std::string& why) const {
    reject(file_.locate(path), path, why);
  }

  const ScenarioUnderCheck& file_;
  const Scenario& s_;
  bool foragers_;
  KeyPath top_;
  KeyPath agents_ = top_["agents"];
  KeyPath world_ = top_["world"];
  KeyPath plan_ = world_["plan"];
  std::vector<std::string> names_;  // of the places of the plan
  std::set<std::string> events_;    // of all tasks
  double rays_ = 0.0, crumbs_ = 0.0;
  const AgentSpec* first_ = nullptr;
  std::size_t first_number_ = 0;
};

void ForagerChecker::check_world() const {
  if (!foragers_) {
    const std::string why = "without effect: no agent is of kind \"forager\"";
    const KeyPath record = top_["record"];
    if (s_.world.plan) fail(plan_, why);
    if (!s_.world.sources.empty()) fail(world_["sources"], why);
    if (s_.record.crumbs == "on") fail(record["crumbs"], why);
    return;
  }
  if (!s_.world.plan) {
    fail(plan_,
         "missing; agents of kind \"forager\" need a floor, as plan = { file = \"plan.txt\" }");
  }
  if (s_.world.log) fail(world_["log"], "does not go with agents of kind \"forager\"");
  if (!s_.world.targets.empty()) {
    fail(world_["targets"],
         "without effect: agents of kind \"forager\" have world.sources instead");
  }
}

void ForagerChecker::check_other(const AgentSpec& agent, const KeyPath& path) const {
  const std::string only = "only for kind = \"forager\"; found " + quoted(agent.kind);
  if (agent.robot) fail(path["robot"], only);
  if (agent.task) fail(path["task"], only);
  if (agent.trails) fail(path["trails"], only);
  const KeyPath talk = path["talk"];
  if (agent.talk.policy == "at-once" || agent.talk.policy == "at-event") {
    fail(talk["policy"], quoted(agent.talk.policy) + " is " + only);
  }
  const bool believes = agent.kind == "estimator" || agent.kind == "tracker" ||
                        agent.kind == "localizer" || agent.kind == "explorer";
  if (foragers_ && believes) {
    fail(path["kind"], quoted(agent.kind) + " does not go with agents of kind \"forager\"");
  }
}

void ForagerChecker::check_forager(const AgentSpec& agent, const KeyPath& path) {
  if (!agent.robot) fail(path["robot"], "missing; as robot = { start = \"A\" }");
  if (!agent.task) fail(path["task"], R"(missing; as task = { events = ["A", "B"] })");
  if (!agent.trails) fail(path["trails"], "missing; as trails = { parameters = \"lost-2002\" }");
  check_body(agent, path);
  check_robot(agent, path["robot"]);
  check_task(*agent.task, *agent.trails, path["task"]);
  check_trails(file_, *agent.trails, path["trails"]);
  check_talk(agent, path["talk"]);
  crumbs_ += 1.0 * agent.count * agent.trails->crumbs_max;
  if (crumbs_ > crumbs_max) {
    fail(path["trails"], "more than 1e8 crumbs, for all foragers together; lower crumbs_max");
  }
}

void ForagerChecker::check_body(const AgentSpec& agent, const KeyPath& path) const {
  const std::string where = "not for kind \"forager\": robot.start says where it begins";
  if (agent.position_m) fail(path["position_m"], where);
  if (agent.circle) fail(path["circle"], where);
  if (agent.motion)
    fail(path["motion"],
         "not for kind \"forager\": it steers itself, and robot.start says where it begins");
  const KeyPath sensor = path["sensor"];
  if (agent.sensor.kind != "none") {
    fail(sensor["kind"], "not for kind \"forager\": it has the scanner of agents.robot");
  }
  if (agent.estimator != EstimatorSpec()) {
    fail(path["estimator"], "without effect: kind = \"forager\" has agents.trails instead");
  }
}

void ForagerChecker::check_robot(const AgentSpec& agent, const KeyPath& path) {
  const RobotSpec& robot = *agent.robot;
  if (s_.radio.topology == "random-geometric") {
    fail(path, "not with topology = \"random-geometric\", which draws where agents stand");
  }
  if (robot.start.empty()) {
    fail(path["start"], "missing; a place of the plan, or \"anywhere\"");
  }
  if (*s_.duration_s / robot.control_period_s > steps_max) {
    fail(path["control_period_s"], "more than 2e8 steps in a run");
  }
  if (robot.speed_m_per_s * robot.control_period_s > way_max_m) {
    fail(path["control_period_s"],
         "at " + to_toml(robot.speed_m_per_s) + " m/s it drives more than 1000 m within it");
  }
  if (robot.turn_rad_per_s * robot.control_period_s > turned_max_rad) {
    fail(path["control_period_s"],
         "at " + to_toml(robot.turn_rad_per_s) + " rad/s it turns by more than 100 rad within it");
  }
  rays_ += 1.0 * agent.count * robot.rays;
  if (rays_ > rays_max) fail(path, "more than 1e7 rays, for all foragers together; lower rays");
}

void ForagerChecker::check_task(const TaskSpec& task, const TrailsSpec& trails,
                                const KeyPath& path) {
  const KeyPath events = path["events"];
  if (task.events.empty()) fail(events, "missing; names of sources or places");
  if (task.events.size() > events_max) {
    fail(events, "has " + std::to_string(task.events.size()) + " events; at most 16 are allowed");
  }
  if (task.events.size() == 1 && !task.respawn) {
    fail(events, "one event alone needs respawn = true, or the robot is there for ever");
  }
  if (task.respawn) check_respawn(file_, trails, path["respawn"]);
  events_.insert(task.events.begin(), task.events.end());
}

void ForagerChecker::check_talk(const AgentSpec& agent, const KeyPath& path) const {
  const TalkSpec& talk = agent.talk;
  const std::string kind = "kind \"forager\" ";
  if (talk.policy != "at-once" && talk.policy != "at-event" && talk.policy != "periodic" &&
      talk.policy != "never") {
    fail(path["policy"],
         kind + R"(knows "at-once", "at-event", "periodic" and "never" alone; found )" +
             quoted(talk.policy));
  }
  if (talk.policy == "at-once" && laying_of(*agent.trails) != trails::Laying::at_once) {
    fail(path["policy"],
         "\"at-once\" needs agents.trails.laying = \"at-once\": the crumbs of a "
         "trail that is told when it is completed have no distances before");
  }
  if (talk.policy == "periodic" && *s_.duration_s / talk.period_s > steps_max) {
    fail(path["period_s"], "more than 2e8 talks in a run");
  }
  if (talk.content != "belief") {
    fail(path["content"], kind + "says whole crumbs; found " + quoted(talk.content));
  }
  if (talk.service != "broadcast") {
    fail(path["service"], kind + "knows \"broadcast\" alone; found " + quoted(talk.service));
  }
}

// They share a floor, and compare distances.
void ForagerChecker::check_like_first(const AgentSpec& agent, const KeyPath& path,
                                      std::size_t number) {
  if (first_ == nullptr) {
    first_ = &agent;
    first_number_ = number;
    return;
  }
  const KeyPath robot = path["robot"], trails = path["trails"];
  const std::string other = "of agents[" + std::to_string(first_number_) + "] ";
  const auto alike = [&](const KeyPath& key, double own, double first, const char* unit) {
    if (own == first) return;
    refuse(key, "must be that " + other + "(" + to_toml(first) + unit + "), as of all foragers");
  };
  alike(robot["radius_m"], agent.robot->radius_m, first_->robot->radius_m, " m");
  alike(robot["control_period_s"], agent.robot->control_period_s, first_->robot->control_period_s,
        " s");
  if (distance_of(*agent.trails) != distance_of(*first_->trails)) {
    fail(trails["distance"], "its crumbs and those " + other +
                                 "count different distances; all foragers of a run count the same");
  }
}

// A robot may come to know the places of all events.
void ForagerChecker::check_packets() const {
  if (events_.size() > trails::packet_places_max) {
    fail(agents_, "there are " + std::to_string(events_.size()) +
                      " events in the tasks of all foragers; at most 64 are allowed");
  }
  const std::size_t least = trails::packet_size(trails::MetricSpace::numbers, events_.size(), 1);
  for (std::size_t i = 0; i < s_.agents.size(); ++i) {
    if (!is_forager(s_.agents[i])) continue;
    const auto bytes = static_cast<std::size_t>(s_.agents[i].trails->packet_bytes_max);
    const KeyPath path = agents_[i], trails = path["trails"], key = trails["packet_bytes_max"];
    if (bytes < least) {
      refuse(key, "a crumb and the places of " + std::to_string(events_.size()) + " events take " +
                      std::to_string(least) + " bytes");
    }
  }
}

// Two robots never have more places in common than there are events.
void ForagerChecker::check_transforms() const {
  if (events_.size() > 1) return;
  for (std::size_t i = 0; i < s_.agents.size(); ++i) {
    const AgentSpec& agent = s_.agents[i];
    if (!is_forager(agent) || agent.talk.policy == "never") continue;
    if (agent.trails->navigation != "trails" || agent.trails->transform != "pessimistic") continue;
    fail(agents_[i]["trails"]["transform"],
         "\"pessimistic\" needs two events: with one place in common it drops all that it hears; "
         "allowed here: \"optimistic\", \"as-is\"");
  }
}

void ForagerChecker::check_barriers() const {
  const KeyPath barriers = plan_["barriers"];
  const plan::Plan& plan = *s_.world.plan->plan;
  for (std::size_t i = 0; i < s_.world.plan->barriers.size(); ++i) {
    const BarrierSpec& barrier = s_.world.plan->barriers[i];
    const KeyPath path = barriers[i];
    const auto corner = [&](const char* key, const std::optional<std::vector<double>>& at) {
      if (!at) fail(path[key], "missing; the barrier is a rectangle between two opposite corners");
      const plan::Point point = {at->at(0), at->at(1)};
      if (plan.contains(point)) return point;
      const KeyPath here = path[key];
      refuse(here, "is not within the plan of " + to_toml(plan.width_m()) + " m × " +
                       to_toml(plan.height_m()) + " m");
    };
    const plan::Point a = corner("corner_m", barrier.corner_m);
    const plan::Point b = corner("opposite_m", barrier.opposite_m);
    if (a.x_m == b.x_m || a.y_m == b.y_m) {
      fail(path["opposite_m"], "the barrier must be wider and higher than 0");
    }
    if (barrier.until_s && *barrier.until_s <= barrier.from_s) {
      fail(path["until_s"], "must be after from_s (" + to_toml(barrier.from_s) + " s)");
    }
  }
}

void ForagerChecker::check_sources() const {
  const KeyPath sources = world_["sources"];
  std::vector<std::string> names;
  for (std::size_t i = 0; i < s_.world.sources.size(); ++i) {
    const SourceSpec& source = s_.world.sources[i];
    const KeyPath path = sources[i];
    if (source.name.empty()) fail(path["name"], "missing; a place of the plan");
    check_place(source.name, path["name"]);
    check_moves(source, path["moves"]);
    if (!events_.contains(source.name)) {
      fail(path["name"], "without effect: " + quoted(source.name) + " is in nobody's task");
    }
    names.push_back(source.name);
  }
  if (const auto i = first_duplicate(names)) {
    fail(sources[*i]["name"], "two sources are called '" + names[*i] + "'");
  }
}

void ForagerChecker::check_moves(const SourceSpec& source, const KeyPath& path) const {
  double before_s = 0.0;
  for (std::size_t i = 0; i < source.moves.size(); ++i) {
    const SourceMoveSpec& move = source.moves[i];
    const KeyPath move_path = path[i];
    if (!move.at_s) fail(move_path["at_s"], "missing");
    if (*move.at_s <= before_s) {
      const KeyPath at = move_path["at_s"];
      refuse(at, "must be after the move before it (" + to_toml(before_s) + " s)");
    }
    before_s = *move.at_s;
    if (move.place.empty()) fail(move_path["place"], "missing; a place of the plan");
    check_place(move.place, move_path["place"]);
  }
}

void ForagerChecker::check_places(const AgentSpec& agent, const KeyPath& path) const {
  const KeyPath robot = path["robot"], task = path["task"], events = task["events"];
  if (agent.robot->start != "anywhere") check_place(agent.robot->start, robot["start"]);
  for (std::size_t i = 0; i < agent.task->events.size(); ++i) {
    check_place(agent.task->events[i], events[i]);
  }
}

void ForagerChecker::check_place(const std::string& name, const KeyPath& path) const {
  if (std::find(names_.begin(), names_.end(), name) != names_.end()) return;
  if (names_.empty()) refuse(path, "the plan has no places");
  // All letters are near to one another.
  refuse(path, "unknown place of the plan" +
                   (name.size() > 1 ? allowed_names(name, names_) : "; allowed: " + join(names_)));
}

}  // namespace

void check_foragers(ScenarioUnderCheck& file) {
  ForagerChecker checker(file);
  checker.all_but_places();
  take_plan(file);
  checker.places();
}

}  // namespace hearsay
