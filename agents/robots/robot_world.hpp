// The floor of a run on which robots drive: what is true of it, and what changes in its course.
// Barriers go up and down, sources move and run dry. Behaviours never ask it where they are; they
// learn what their scanners see, what their wheels have turned, and that an event happens.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "filters/trails/trail.hpp"
#include "sim/kernel/simulation.hpp"
#include "sim/world/robot_floor.hpp"
#include "sim/world/shortest_path.hpp"

namespace hearsay {

class RobotWorld {
 public:
  struct Barrier {
    plan::Rectangle area;
    Time from;  ///< it is up from then on …
    Time until = Time::never();
  };
  struct Move {
    Time at;
    plan::Point to;
    std::string place;  ///< its name
  };
  /// Where an event happens to a robot that comes near.
  struct Source {
    std::string name;
    plan::Point at;
    double radius_m = 1.0;               ///< > 0
    std::optional<std::uint64_t> units;  ///< nothing: as often as somebody comes
    std::vector<Move> moves;             ///< rising in time
  };
  struct Options {
    std::shared_ptr<const plan::Plan> plan;
    std::vector<Barrier> barriers;
    std::vector<Source> sources;  ///< by EventId
    plan::RobotFloor::Options floor;
    int tries = 1000;  ///< for a place with room
  };
  /// `simulation` outlives it. @throws InputError for barriers that are not within the plan.
  RobotWorld(Simulation& simulation, Options options);

  /// Where a robot is put, and put back.
  struct Start {
    std::optional<plan::Point> at;      ///< nothing: anywhere
    double scatter_m = 0.0;             ///< at most so far from there, on a straight way
    std::optional<double> heading_rad;  ///< nothing: any
  };
  /// Puts one more robot on the floor, not into a barrier that is up, or comes up at 0: where
  /// Options::tries draws find room first; if none does, at the start, or at the first point with
  /// room of a lattice over the whole disc, half a radius apart or a 500th of a side: however small
  /// the part of the disc that has room, whether it is found is no matter of luck.
  /// @return its number, from 0. @throws InputError if no room is found.
  int add(const Start& start, Stream draws);
  /// Carries a robot there, if draws find room, as for add().
  bool carry(int robot, const Start& start, Stream draws);

  plan::RobotFloor& floor() { return floor_; }
  const drive::Pose& pose(int robot) const { return floor_.pose(robot); }

  /// Schedules what is to change. Once, before the run.
  void start();

  /// Whether the event happens to the robot now: it is near, and there is something left. If so, it
  /// is one unit less.
  bool happens(int robot, trails::EventId event);
  const std::string& name_of(trails::EventId event) const { return source(event).name; }
  std::size_t events() const { return options_.sources.size(); }
  /// When a barrier or a source last changed; nothing before.
  std::optional<Time> changed() const { return changed_; }

  /// For who has the map: the shortest way to an event; nothing if there is none.
  std::optional<plan::Path> way(int robot, trails::EventId event) const;

 private:
  const Source& source(trails::EventId event) const;
  void move(std::size_t source, std::size_t move);
  std::optional<drive::Pose> room(const Start& start, Stream& draws, int robot);
  std::optional<drive::Pose> room_of_all(const Start& start, Stream& draws);
  /// Whether there is room for that robot, or one more if −1, on a straight way from the start.
  bool fits(const Start& start, const drive::Pose& pose, int robot);
  /// Whether the point lies in a barrier that is up.
  bool in_barrier(plan::Point p) const;
  void report(const char* kind, const std::string& detail);

  Simulation& simulation_;
  Options options_;
  plan::WallIndex walls_;
  plan::RobotFloor floor_;
  std::optional<Time> changed_;
};

}  // namespace hearsay
