#include "sim/world/robot_floor.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"

namespace hearsay::plan {
namespace {

constexpr double cells_a_side_max = 4096.0;

int cells_along(double side_m, double cell_m) {
  return static_cast<int>(std::clamp(std::ceil(side_m / cell_m), 1.0, cells_a_side_max));
}

}  // namespace

RobotFloor::RobotFloor(const WallIndex& walls, const Options& options)
    : walls_(walls), options_(options) {
  require(options.radius_m >= radius_min_m && std::isfinite(options.radius_m),
          "robot floor: the radius of a robot is too small, or not finite");
  require(options.cell_m > 0.0 && std::isfinite(options.cell_m),
          "robot floor: a cell has a side above 0");
  columns_ = cells_along(walls.width_m(), options.cell_m);
  rows_ = cells_along(walls.height_m(), options.cell_m);
  first_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), -1);
}

const RobotFloor::Robot& RobotFloor::at(int robot) const {
  require(robot >= 0 && robot < robots(), "robot floor: there is no such robot");
  return robots_[static_cast<std::size_t>(robot)];
}

int RobotFloor::cell_of(Point p) const {
  const auto along = [](double at_m, double side_m, int count) {
    return static_cast<int>(std::clamp(at_m / side_m * count, 0.0, count - 1.0));
  };
  return along(p.y_m, walls_.height_m(), rows_) * columns_ +
         along(p.x_m, walls_.width_m(), columns_);
}

void RobotFloor::file(int robot) {
  Robot& r = robots_[static_cast<std::size_t>(robot)];
  r.cell = cell_of(place(r.pose));
  int& first = first_[static_cast<std::size_t>(r.cell)];
  r.before = -1;
  r.next = first;
  if (first >= 0) robots_[static_cast<std::size_t>(first)].before = robot;
  first = robot;
}

void RobotFloor::take_out(int robot) {
  const Robot& r = at(robot);
  if (r.before >= 0) {
    robots_[static_cast<std::size_t>(r.before)].next = r.next;
  } else {
    first_[static_cast<std::size_t>(r.cell)] = r.next;
  }
  if (r.next >= 0) robots_[static_cast<std::size_t>(r.next)].before = r.before;
}

void RobotFloor::move_to(int robot, const drive::Pose& pose) {
  Robot& r = robots_[static_cast<std::size_t>(robot)];
  const bool elsewhere = cell_of(place(pose)) != r.cell;
  if (elsewhere) take_out(robot);
  r.pose = pose;
  if (elsewhere) file(robot);
}

std::span<const Disc> RobotFloor::near(Point from, double within_m, int except) {
  require(within_m >= 0.0 && std::isfinite(within_m), "robot floor: a distance is not negative");
  const double reach_m = within_m + options_.radius_m;
  const int low = cell_of({from.x_m - reach_m, from.y_m - reach_m});
  const int high = cell_of({from.x_m + reach_m, from.y_m + reach_m});
  const int rows = high / columns_ - low / columns_ + 1;
  const int columns = high % columns_ - low % columns_ + 1;
  found_.clear();
  const auto look = [&](int robot) {
    const drive::Pose& pose = robots_[static_cast<std::size_t>(robot)].pose;
    const double dx = pose.x_m - from.x_m, dy = pose.y_m - from.y_m;
    if (robot != except && dx * dx + dy * dy <= reach_m * reach_m) found_.push_back(robot);
  };
  // Where there are more cells than robots it is less to ask each robot.
  const bool each = rows * columns >= robots();
  for (int robot = 0; each && robot < robots(); ++robot) look(robot);
  for (int row = low / columns_; !each && row <= high / columns_; ++row) {
    for (int column = low % columns_; column <= high % columns_; ++column) {
      int robot = first_[static_cast<std::size_t>(row * columns_ + column)];
      for (; robot >= 0; robot = robots_[static_cast<std::size_t>(robot)].next) look(robot);
    }
  }
  // Lists of cells depend on who came when; what is told does not.
  std::sort(found_.begin(), found_.end());
  discs_.clear();
  for (const int robot : found_) discs_.push_back({place(pose(robot)), options_.radius_m});
  return discs_;
}

bool RobotFloor::has_room(const drive::Pose& pose, int except) {
  const Point here = place(pose);
  if (!std::isfinite(pose.heading_rad) || !walls_.contains(here)) return false;
  if (clearance(walls_, here, options_.radius_m) < options_.radius_m) return false;
  return near(here, options_.radius_m, except).empty();
}

int RobotFloor::add(const drive::Pose& pose) {
  if (!has_room(pose, -1)) {
    throw InputError("there is no room for a robot of radius " + std::to_string(options_.radius_m) +
                     " m at (" + std::to_string(pose.x_m) + ", " + std::to_string(pose.y_m) + ")");
  }
  const int robot = robots();
  robots_.push_back({.pose = pose, .command = {}});
  file(robot);
  return robot;
}

bool RobotFloor::carry(int robot, const drive::Pose& pose) {
  at(robot);
  if (!has_room(pose, robot)) return false;
  move_to(robot, pose);
  robots_[static_cast<std::size_t>(robot)].command = {};
  return true;
}

RobotFloor::Step RobotFloor::drive(int robot, const drive::Command& wanted, double dt_s) {
  const Robot& before = at(robot);
  const drive::Command command = drive::limited(wanted, before.command, options_.limits, dt_s);
  const double length_m = command.forward_m_per_s * dt_s;
  const double turn_rad = command.turn_rad_per_s * dt_s;
  const Point here = place(before.pose);
  const auto others = near(here, std::fabs(length_m) + options_.radius_m, robot);
  const ArcAdvance made = advance_along_arc(walls_, {here, before.pose.heading_rad}, length_m,
                                            turn_rad, options_.radius_m, others);
  Step step{.done = command, .blocked = made.blocked};
  if (made.blocked) {
    const double share = length_m == 0.0 ? 1.0 : made.distance_m / std::fabs(length_m);
    step.done = {command.forward_m_per_s * share, command.turn_rad_per_s * share};
  }
  move_to(robot, {made.end.at.x_m, made.end.at.y_m, math::wrap_angle(made.end.heading_rad)});
  robots_[static_cast<std::size_t>(robot)].command = step.done;
  return step;
}

void RobotFloor::scan(int robot, const Fan& fan, double range_m, std::span<double> distances_m) {
  const drive::Pose& from = pose(robot);
  plan::scan(walls_, place(from), from.heading_rad, fan, range_m, near(place(from), range_m, robot),
             distances_m);
}

}  // namespace hearsay::plan
