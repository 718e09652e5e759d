#include "agents/robots/robot_world.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"

namespace hearsay {
namespace {

std::vector<plan::Rectangle> areas_of(const std::vector<RobotWorld::Barrier>& barriers) {
  std::vector<plan::Rectangle> areas;
  for (const RobotWorld::Barrier& barrier : barriers) areas.push_back(barrier.area);
  return areas;
}

// Ways are looked for on a grid that is fine enough for doors.
constexpr double way_spacing_m = 0.125;

// Points where room is looked for, along a side of so many metres.
std::int64_t points_along(double side_m, double radius_m) {
  constexpr double most = 500.0;
  return static_cast<std::int64_t>(std::clamp(std::ceil(2.0 * side_m / radius_m), 1.0, most));
}

}  // namespace

RobotWorld::RobotWorld(Simulation& simulation, Options options)
    : simulation_(simulation),
      options_(std::move(options)),
      walls_(*options_.plan, areas_of(options_.barriers)),
      floor_(walls_, options_.floor) {
  // Robots are put on the floor before anything happens on it.
  for (std::size_t i = 0; i < options_.barriers.size(); ++i) {
    if (options_.barriers[i].from <= Time()) walls_.block(i);
  }
}

const RobotWorld::Source& RobotWorld::source(trails::EventId event) const {
  require(event < options_.sources.size(), "robot world: there is no such event");
  return options_.sources[event];
}

bool RobotWorld::in_barrier(plan::Point p) const {
  for (std::size_t i = 0; i < options_.barriers.size(); ++i) {
    const plan::Rectangle& area = options_.barriers[i].area;
    const bool within = p.x_m >= area.min.x_m && p.x_m <= area.max.x_m && p.y_m >= area.min.y_m &&
                        p.y_m <= area.max.y_m;
    if (within && walls_.up(i)) return true;
  }
  return false;
}

std::optional<drive::Pose> RobotWorld::room(const Start& start, Stream& draws, int robot) {
  for (int i = 0; i < options_.tries; ++i) {
    drive::Pose pose;
    // In the square around the start, those in its corners not taken: even over the disc.
    const double reach_m = start.scatter_m;
    const double u = draws.uniform(), v = draws.uniform(), w = draws.uniform();
    pose.heading_rad = math::wrap_angle(start.heading_rad.value_or(2.0 * math::pi * w));
    if (!start.at) {
      pose.x_m = u * walls_.width_m();
      pose.y_m = v * walls_.height_m();
    } else {
      const double dx = (2.0 * u - 1.0) * reach_m, dy = (2.0 * v - 1.0) * reach_m;
      if (dx * dx + dy * dy > reach_m * reach_m) continue;
      pose.x_m = start.at->x_m + dx;
      pose.y_m = start.at->y_m + dy;
    }
    if (fits(start, pose, robot)) return pose;
  }
  return std::nullopt;
}

bool RobotWorld::fits(const Start& start, const drive::Pose& pose, int robot) {
  const plan::Point p{pose.x_m, pose.y_m};
  if (!floor_.has_room(pose, robot) || !options_.plan->free(p) || in_barrier(p)) return false;
  return !start.at || !advance(walls_, p, *start.at, plan::radius_min_m).blocked;
}

std::optional<drive::Pose> RobotWorld::room_of_all(const Start& start, Stream& draws) {
  const double u = draws.uniform(), w = draws.uniform();
  drive::Pose pose;
  pose.heading_rad = math::wrap_angle(start.heading_rad.value_or(2.0 * math::pi * w));
  plan::Point low, high{walls_.width_m(), walls_.height_m()};
  if (start.at) {
    pose.x_m = start.at->x_m;
    pose.y_m = start.at->y_m;
    if (fits(start, pose, -1)) return pose;
    low = {std::max(low.x_m, pose.x_m - start.scatter_m),
           std::max(low.y_m, pose.y_m - start.scatter_m)};
    high = {std::min(high.x_m, pose.x_m + start.scatter_m),
            std::min(high.y_m, pose.y_m + start.scatter_m)};
  }
  const std::int64_t columns = points_along(high.x_m - low.x_m, floor_.radius_m());
  const std::int64_t rows = points_along(high.y_m - low.y_m, floor_.radius_m());
  const double dx_m = (high.x_m - low.x_m) / static_cast<double>(columns);
  const double dy_m = (high.y_m - low.y_m) / static_cast<double>(rows);
  const std::int64_t points = columns * rows;
  const auto first = static_cast<std::int64_t>(u * static_cast<double>(points));
  for (std::int64_t i = 0; i < points; ++i) {
    const std::int64_t k = (first + i) % points;
    pose.x_m = low.x_m + (static_cast<double>(k % columns) + 0.5) * dx_m;
    pose.y_m = low.y_m + (static_cast<double>(k / columns) + 0.5) * dy_m;
    if (start.at) {
      const double x_m = pose.x_m - start.at->x_m, y_m = pose.y_m - start.at->y_m;
      if (x_m * x_m + y_m * y_m > start.scatter_m * start.scatter_m) continue;
    }
    if (fits(start, pose, -1)) return pose;
  }
  return std::nullopt;
}

int RobotWorld::add(const Start& start, Stream draws) {
  auto pose = room(start, draws, -1);
  if (!pose) pose = room_of_all(start, draws);
  if (pose) return floor_.add(*pose);
  throw InputError(
      "no room is found for robot " + std::to_string(floor_.robots()) + " of radius " +
      std::to_string(floor_.radius_m()) + " m " +
      (start.at ? "within scatter_m = " + std::to_string(start.scatter_m) + " m of its start"
                : "anywhere on the floor"));
}

bool RobotWorld::carry(int robot, const Start& start, Stream draws) {
  const auto pose = room(start, draws, robot);
  return pose && floor_.carry(robot, *pose);
}

void RobotWorld::report(const char* kind, const std::string& detail) {
  changed_ = simulation_.now();
  simulation_.record().event(simulation_.now(), no_agent, kind, detail);
}

void RobotWorld::start() {
  for (std::size_t i = 0; i < options_.barriers.size(); ++i) {
    const Barrier& barrier = options_.barriers[i];
    simulation_.schedule(barrier.from, Phase::world, [this, i] {
      walls_.block(i);
      report("barrier", "up " + std::to_string(i));
    });
    if (barrier.until == Time::never()) continue;
    simulation_.schedule(barrier.until, Phase::world, [this, i] {
      walls_.unblock(i);
      report("barrier", "down " + std::to_string(i));
    });
  }
  for (std::size_t i = 0; i < options_.sources.size(); ++i) {
    for (std::size_t m = 0; m < options_.sources[i].moves.size(); ++m) {
      simulation_.schedule(options_.sources[i].moves[m].at, Phase::world,
                           [this, i, m] { move(i, m); });
    }
  }
}

void RobotWorld::move(std::size_t source, std::size_t move) {
  Source& moved = options_.sources[source];
  moved.at = moved.moves[move].to;
  report("source", moved.name + " moves to " + moved.moves[move].place);
}

bool RobotWorld::happens(int robot, trails::EventId event) {
  require(event < options_.sources.size(), "robot world: there is no such event");
  Source& there = options_.sources[event];
  const drive::Pose& here = pose(robot);
  const double dx = here.x_m - there.at.x_m, dy = here.y_m - there.at.y_m;
  if (dx * dx + dy * dy > there.radius_m * there.radius_m) return false;
  if (!there.units) return true;
  if (*there.units == 0) return false;
  if (--*there.units == 0) report("source", there.name + " is dry");
  return true;
}

std::optional<plan::Path> RobotWorld::way(int robot, trails::EventId event) const {
  const drive::Pose& here = pose(robot);
  return plan::shortest_path(walls_, {here.x_m, here.y_m}, source(event).at,
                             options_.floor.radius_m, way_spacing_m);
}

}  // namespace hearsay
