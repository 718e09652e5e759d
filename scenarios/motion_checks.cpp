#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/motion.hpp"
#include "scenarios/scenario_under_check.hpp"
#include "scenarios/tracks.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

enum class Need { needed, allowed };

// A key that only some kinds have.
struct Key {
  const char* key;
  Need need;
  std::vector<std::string> kinds;
  bool given;
  const char* example = "";
};

std::vector<Key> keys_of(const MotionSpec& s) {
  using enum Need;
  const std::vector<std::string> way = {"waypoints"}, mow = {"lawn-mower"},
                                 wander = {"random-waypoint"}, roam = {"gauss-markov"},
                                 track = {"track"}, accelerate = {"white-noise-acceleration"},
                                 both = {"waypoints", "lawn-mower"},
                                 areas = {"lawn-mower", "random-waypoint", "gauss-markov"};
  return {
      {"points_m", needed, way, !s.points_m.empty(), ", as [[0, 0], [100, 50]]"},
      {"speed_m_per_s", needed, both, s.speed_m_per_s.has_value()},
      {"pause_s", allowed, way, s.pause_s.has_value()},
      {"repeat", allowed, both, s.repeat.has_value()},
      {"area_m", needed, areas, !s.area_m.empty(), ", as [[0, 0], [100, 50]]"},
      {"lane_spacing_m", needed, mow, s.lane_spacing_m.has_value()},
      {"speed_min_m_per_s", needed, wander, s.speed_min_m_per_s.has_value()},
      {"speed_max_m_per_s", needed, wander, s.speed_max_m_per_s.has_value()},
      {"pause_min_s", allowed, wander, s.pause_min_s.has_value()},
      {"pause_max_s", allowed, wander, s.pause_max_s.has_value()},
      {"speed_mean_m_per_s", needed, roam, s.speed_mean_m_per_s.has_value()},
      {"speed_sigma_m_per_s", needed, roam, s.speed_sigma_m_per_s.has_value()},
      {"direction_mean_rad", allowed, roam, s.direction_mean_rad.has_value()},
      {"direction_sigma_rad", needed, roam, s.direction_sigma_rad.has_value()},
      {"alpha", needed, roam, s.alpha.has_value()},
      {"update_period_s", allowed, roam, s.update_period_s.has_value()},
      {"velocity_m_per_s", allowed, accelerate, s.velocity_m_per_s.has_value()},
      {"acceleration_psd_m2_per_s3", needed, accelerate, s.acceleration_psd_m2_per_s3.has_value()},
      {"file", needed, track, s.file.has_value(), ", a CSV file t_s,agent,x_m,y_m"}};
}

std::string either(const std::vector<std::string>& kinds) {
  std::string text;
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    if (i > 0) text += i + 1 == kinds.size() ? " or " : ", ";
    text += "\"" + kinds[i] + "\"";
  }
  return text;
}

class MotionChecker {
 public:
  explicit MotionChecker(ScenarioUnderCheck& file)
      : file_(file), places_m_(agent_positions(file.scenario)) {}

  void all() {
    std::size_t first = 0;  // agent of the entry
    for (std::size_t i = 0; i < file_.scenario.agents.size(); ++i) {
      AgentSpec& agent = file_.scenario.agents[i];
      if (agent.motion) check(agents_[i], agent, first);
      first += static_cast<std::size_t>(agent.count);
    }
    const KeyPath world = top_["world"];
    const KeyPath targets = world["targets"];
    for (std::size_t i = 0; i < file_.scenario.world.targets.size(); ++i) {
      const TargetSpec& target = file_.scenario.world.targets[i];
      if (target.motion) check(targets[i], target, static_cast<int>(i));
    }
  }

 private:
  void check(const KeyPath& path, AgentSpec& agent, std::size_t first);
  void check(const KeyPath& path, const TargetSpec& target, int number) const;
  void check_keys(const KeyPath& path, const MotionSpec& spec) const;
  void check_place(const KeyPath& path, const AgentSpec& agent) const;
  void check_values(const KeyPath& path, const MotionSpec& spec) const;
  void check_area(const KeyPath& path, const MotionSpec& spec) const;
  void take_tracks(const KeyPath& path, AgentSpec& agent, std::size_t first);

  ScenarioUnderCheck& file_;
  const std::vector<std::optional<std::array<double, 2>>> places_m_;  // by agent
  KeyPath top_;
  KeyPath agents_ = top_["agents"];
  std::map<std::string, std::shared_ptr<const Tracks>> files_;  // read already
};

void MotionChecker::check(const KeyPath& path, AgentSpec& agent, std::size_t first) {
  const KeyPath motion_path = path["motion"];
  if (file_.scenario.radio.topology == "random-geometric") {
    file_.fail(motion_path,
               "not with topology = \"random-geometric\", which draws where agents stand");
  }
  if (agent.motion->kind == "white-noise-acceleration") {
    file_.fail(motion_path["kind"], "\"white-noise-acceleration\" is for targets, not for agents");
  }
  check_keys(motion_path, *agent.motion);
  check_place(path, agent);
  check_values(motion_path, *agent.motion);
  if (agent.motion->kind == "track") take_tracks(motion_path, agent, first);
  try {
    make_motion(agent, places_m_[first], static_cast<AgentId>(first), file_.scenario.seed);
  } catch (const InputError& error) {
    file_.fail(motion_path, error.what());
  }
}

void MotionChecker::check(const KeyPath& path, const TargetSpec& target, int number) const {
  const MotionSpec& spec = *target.motion;
  const KeyPath motion_path = path["motion"];
  if (spec.kind == "track" || spec.kind == "steered") {
    file_.fail(motion_path["kind"], "\"" + spec.kind + "\" is for agents, not for targets");
  }
  check_keys(motion_path, spec);
  check_values(motion_path, spec);
  const bool draws = spec.kind == "random-waypoint" || spec.kind == "gauss-markov";
  if (draws == target.position_m.has_value() && spec.kind != "waypoints" &&
      spec.kind != "lawn-mower") {
    file_.fail(path["position_m"],
               draws ? "not with motion.kind = \"" + spec.kind + "\", which draws where it begins"
                     : "missing; where it begins");
  }
  if (!file_.scenario.world.step_s) {
    file_.fail(
        motion_path,
        "needs world.step_s: how often agents look at targets that move and believe in them");
  }
  if (spec.kind == "white-noise-acceleration") return;
  try {
    make_motion(target, number, file_.scenario.seed);
  } catch (const InputError& error) {
    file_.fail(motion_path, error.what());
  }
}

void MotionChecker::check_keys(const KeyPath& path, const MotionSpec& spec) const {
  for (const Key& key : keys_of(spec)) {
    const bool fits = std::find(key.kinds.begin(), key.kinds.end(), spec.kind) != key.kinds.end();
    if (key.given && !fits) {
      file_.fail(path[key.key],
                 "only for kind = " + either(key.kinds) + "; found \"" + spec.kind + "\"");
    }
    if (fits && !key.given && key.need == Need::needed) {
      file_.fail(path, "kind \"" + spec.kind + "\" needs " + key.key + key.example);
    }
  }
}

void MotionChecker::check_place(const KeyPath& path, const AgentSpec& agent) const {
  const std::string& kind = agent.motion->kind;
  if ((kind == "hover" || kind == "steered") && !placed(agent)) {
    file_.fail(path["motion"], "kind \"" + kind + "\" needs to know where: position_m or circle");
  }
  const bool draws = kind == "random-waypoint" || kind == "gauss-markov";
  if (!placed(agent) || (!draws && kind != "track")) return;
  file_.fail(path[agent.circle ? "circle" : "position_m"],
             "not with motion.kind = \"" + kind + "\", which " +
                 (draws ? "draws where it begins" : "has it from its file"));
}

void MotionChecker::check_values(const KeyPath& path, const MotionSpec& spec) const {
  const auto refuse = [&](const char* key, const std::string& why) {
    const KeyPath key_path = path[key];
    reject(file_.locate(key_path), key_path, why);
  };
  if (!spec.area_m.empty()) check_area(path["area_m"], spec);
  if (spec.speed_max_m_per_s && *spec.speed_max_m_per_s < *spec.speed_min_m_per_s) {
    refuse("speed_max_m_per_s",
           "must be at least speed_min_m_per_s (" + to_toml(*spec.speed_min_m_per_s) + " m/s)");
  }
  const double pause_min_s = spec.pause_min_s.value_or(0.0);
  if (pause_min_s > spec.pause_max_s.value_or(0.0)) {
    if (!spec.pause_max_s) file_.fail(path["pause_min_s"], "needs pause_max_s, too");
    refuse("pause_max_s", "must be at least pause_min_s (" + to_toml(pause_min_s) + " s)");
  }
  if (spec.alpha == 1.0) refuse("alpha", "must be less than 1, or nothing is ever forgotten");
}

void MotionChecker::check_area(const KeyPath& path, const MotionSpec& spec) const {
  const TomlNode& node = file_.locate(path);
  if (spec.area_m.size() != 2) reject(node, path, "must be two corners, as [[0, 0], [100, 50]]");
  if (spec.area_m[0][0] == spec.area_m[1][0] || spec.area_m[0][1] == spec.area_m[1][1]) {
    reject(node, path, "must be opposite corners of a rectangle that is wider and higher than 0");
  }
}

void MotionChecker::take_tracks(const KeyPath& path, AgentSpec& agent, std::size_t first) {
  const std::string& name = *agent.motion->file;
  if (name.empty()) file_.fail(path["file"], "missing; which CSV file t_s,agent,x_m,y_m");
  auto& tracks = files_[name];
  if (!tracks) tracks = std::make_shared<const Tracks>(read_tracks(name, file_));
  for (std::size_t i = first; i < first + static_cast<std::size_t>(agent.count); ++i) {
    if (!(*tracks)[i].empty()) continue;
    file_.fail(path["file"], name + " has no row of agent '" + file_.agents()[i] + "'");
  }
  agent.motion->tracks = tracks;
}

}  // namespace

void check_motion(ScenarioUnderCheck& file) { MotionChecker(file).all(); }

}  // namespace hearsay
