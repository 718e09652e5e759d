// Robots on a floor as they truly are: where each one is, how far it gets, what its scanner sees.
//
// They are round and of one size, and move one after another, each against the others where they
// are then: who moves first has the right of way. Nobody ever stands in a wall or in another
// robot. Who is near is found by cells of a grid, so what a move or a scan costs grows with the
// robots around, not with all there are.
#pragma once

#include <span>
#include <vector>

#include "sim/world/collision.hpp"
#include "sim/world/differential_drive.hpp"
#include "sim/world/plan.hpp"
#include "sim/world/ray_caster.hpp"
#include "sim/world/wall_index.hpp"

namespace hearsay::plan {

class RobotFloor {
 public:
  struct Options {
    double radius_m = 0.2;  ///< ≥ radius_min_m
    drive::Limits limits;
    double cell_m = 2.0;  ///< of the grid, > 0: about how far is looked most
  };
  /// `walls` must outlive it. @throws BrokenInvariant for options out of range.
  RobotFloor(const WallIndex& walls, const Options& options);

  /// Puts one more robot there. @return its number, from 0. @throws InputError if it would touch a
  /// wall or another robot there, or stand outside of the plan.
  int add(const drive::Pose& pose);
  int robots() const { return static_cast<int>(robots_.size()); }

  const drive::Pose& pose(int robot) const { return at(robot).pose; }
  double radius_m() const { return options_.radius_m; }

  struct Step {
    drive::Command done;   ///< mean speeds over the step: what wheels without slip have turned
    bool blocked = false;  ///< a wall or a robot stopped it
  };
  /// One robot is told to drive so for `dt_s` > 0, and does as far as limits, walls and the others
  /// let it. One that is stopped keeps a share of its turn; one that stands can turn on the spot.
  /// @throws BrokenInvariant for a robot that is not there, as all that follow, or a command that
  /// is not finite.
  Step drive(int robot, const drive::Command& wanted, double dt_s);

  /// Whether one more robot, or `except` itself, can stand there.
  bool has_room(const drive::Pose& pose, int except = -1);

  /// Carries a robot elsewhere: somebody lifts it. False, and it stays, if there is no room there.
  bool carry(int robot, const drive::Pose& pose);

  /// The bodies of all robots but `except` that lie, wholly or in part, within a distance of a
  /// point, by number. Valid until the next call of anything.
  std::span<const Disc> near(Point from, double within_m, int except);

  /// Distances to walls and robots along the rays of a fan that looks along the robot's heading.
  void scan(int robot, const Fan& fan, double range_m, std::span<double> distances_m);

 private:
  struct Robot {
    drive::Pose pose;
    drive::Command command;  ///< as it last drove
    int cell = 0, next = -1, before = -1;
  };
  static Point place(const drive::Pose& pose) { return {pose.x_m, pose.y_m}; }
  const Robot& at(int robot) const;
  int cell_of(Point p) const;
  void file(int robot);
  void take_out(int robot);
  void move_to(int robot, const drive::Pose& pose);

  const WallIndex& walls_;
  Options options_;
  int columns_, rows_;
  std::vector<int> first_;  // robot of each cell, −1: none
  std::vector<Robot> robots_;
  std::vector<int> found_;
  std::vector<Disc> discs_;
};

}  // namespace hearsay::plan
