// A floor with robots that drive by their pilots, for tests.
#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "agents/behaviours/pilot.hpp"
#include "sim/kernel/error.hpp"
#include "sim/kernel/random.hpp"
#include "sim/math/functions.hpp"
#include "sim/world/collision.hpp"
#include "sim/world/plan.hpp"
#include "sim/world/ray_caster.hpp"
#include "sim/world/robot_floor.hpp"
#include "sim/world/wall_index.hpp"

namespace hearsay {

class PilotBed {
 public:
  static constexpr double step_s = 0.1;

  PilotBed(const plan::Drawing& drawing, const Pilot::Options& options, int rays = 180,
           double view_rad = 2.0 * math::pi)
      : drawing_(drawing),
        plan_(drawing),
        options_(options),
        fan_(rays, view_rad),
        scan_m_(static_cast<std::size_t>(rays)) {}

  /// One more robot, if there is room.
  bool add(const drive::Pose& pose) {
    try {
      floor_.add(pose);
    } catch (const InputError&) {
      return false;
    }
    pilots_.emplace_back(options_, fan_);
    draws_.emplace_back(11, Purpose("pilot"), Entity::agent(static_cast<AgentId>(robots() - 1)));
    return true;
  }
  void add_anywhere(Stream& draws) {
    for (;;) {
      const drive::Pose pose{draws.uniform(0.0, plan_.width_m()),
                             draws.uniform(0.0, plan_.height_m()),
                             draws.uniform(-math::pi, math::pi)};
      if (open({pose.x_m, pose.y_m}) && add(pose)) return;
    }
  }

  int robots() const { return floor_.robots(); }
  const drive::Pose& pose(int robot) const { return floor_.pose(robot); }
  Pilot& pilot(int robot) { return pilots_[static_cast<std::size_t>(robot)]; }
  Stream& draws(int robot) { return draws_[static_cast<std::size_t>(robot)]; }
  const plan::Plan& plan() const { return plan_; }
  const plan::WallIndex& walls() const { return walls_; }
  double now_s() const { return steps_ * step_s; }
  void pass() { ++steps_; }

  /// What the robot sees and believes: where it is, for these odometers do not err.
  Pilot::Senses senses(int robot) {
    floor_.scan(robot, fan_, options_.range_m, scan_m_);
    return {now_s(), scan_m_, floor_.pose(robot)};
  }
  plan::RobotFloor::Step drive(int robot, const drive::Command& command) {
    return floor_.drive(robot, command, step_s);
  }
  /// Explores alone for a step.
  void explore(int robot) { drive(robot, pilot(robot).explore(senses(robot), draws(robot))); }
  /// Goes for a target for a step.
  drive::Command towards(int robot, plan::Point target) {
    const drive::Command command = pilot(robot).towards(senses(robot), target, draws(robot));
    drive(robot, command);
    return command;
  }

  double distance_m(int robot, plan::Point to) const {
    return math::hypot(pose(robot).x_m - to.x_m, pose(robot).y_m - to.y_m);
  }
  /// Not within a wall cell.
  bool open(plan::Point p) const {
    return !drawing_.wall(static_cast<int>(std::floor(p.x_m / drawing_.cell_m)),
                          static_cast<int>(std::floor(p.y_m / drawing_.cell_m)));
  }

 private:
  plan::Drawing drawing_;
  plan::Plan plan_;
  plan::WallIndex walls_{plan_};
  Pilot::Options options_;
  plan::Fan fan_;
  plan::RobotFloor floor_{
      walls_,
      {.radius_m = options_.radius_m, .limits = {options_.speed_m_per_s, options_.turn_rad_per_s}}};
  std::vector<double> scan_m_;
  std::vector<Pilot> pilots_;
  std::vector<Stream> draws_;
  int steps_ = 0;
};

}  // namespace hearsay
