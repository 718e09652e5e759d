// The body of a robot, as its behaviour knows it: what it can do on the floor of its world, and
// what it feels there. The floor is in this process (agents/robots/floor_body) or in another
// (agents/remote/remote_body).
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "filters/trails/trail.hpp"
#include "sim/world/robot_floor.hpp"
#include "sim/world/shortest_path.hpp"

namespace hearsay {

class RobotBody {
 public:
  virtual ~RobotBody() = default;

  /// Where it truly is. Its radio goes there, and who has a map is told; nobody else is.
  virtual const drive::Pose& pose() const = 0;
  /// Distances along the rays of its scanner, m; as many as it has.
  virtual void scan(std::span<double> distances_m) = 0;
  /// It is told to drive so for `dt_s` > 0. @return what it did.
  virtual plan::RobotFloor::Step drive(const drive::Command& wanted, double dt_s) = 0;
  /// Whether the event happens to it now; if so, there is one unit less of it.
  virtual bool happens(trails::EventId event) = 0;
  /// Somebody puts it back to its start, with the draws of the `count`-th time; false if they find
  /// no room.
  virtual bool put_back(std::uint64_t count) = 0;
  /// For who has the map: the shortest way to an event; nothing if there is none.
  virtual std::optional<plan::Path> way(trails::EventId event) = 0;
};

}  // namespace hearsay
