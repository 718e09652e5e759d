// Where a robot heads that has nowhere to go, from what it sees around it.
//
// Three manners. To roam is to hold a heading for an exponentially distributed time, or until it is
// blocked, and to draw another one then, not back if it can, in proportion to how far it is open
// that way. To follow walls is to keep one as near at a side, drawn at random, as the clearance
// allows, so that a robot goes around rooms and through their doors. To explore corridors is what
// the robots of LOST do (R. Vaughan, K. Støy, G. Sukhatme, M. Matarić, IEEE Trans. Robotics and
// Automation 18(5), 2002): to head for what is open, to take a branch at random where there are
// several, and to turn around where it ends. Who follows walls or corridors roams in between: a
// wall may be an island's, and not every place lies at a corridor.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "agents/behaviours/free_directions.hpp"
#include "sim/kernel/random.hpp"
#include "sim/world/differential_drive.hpp"

namespace hearsay {

class Wandering {
 public:
  enum class Manner : std::uint8_t { roam, wall, corridor };
  struct Options {
    Manner manner = Manner::roam;
    double clearance_m = 0.35;  ///< > 0, from the middle of the robot
    double look_ahead_m = 1.5;  ///< > 0
    double range_m = 5.0;       ///< > 0, of the scanner
    double hold_s = 20.0;       ///< > 0, mean time that a heading is held
    double follow_s = 40.0;  ///< > 0, mean time that walls or corridors are followed at a stretch
  };
  explicit Wandering(const Options& options);

  /// The bearing to head for. `eyes` has looked; what it blocks is changed.
  double bearing(FreeDirections& eyes, const drive::Pose& odometry, double now_s, Stream& draws);
  /// It begins anew: where it heads by then is held at first, a side is drawn again.
  void restart();

 private:
  /// Neighbouring directions that are free.
  struct Opening {
    double middle_rad, width_rad;
    double from_rad() const { return middle_rad - 0.5 * width_rad; }
    double to_rad() const { return middle_rad + 0.5 * width_rad; }
  };
  double roam(FreeDirections& eyes, const drive::Pose& odometry, double now_s, Stream& draws);
  double follow(FreeDirections& eyes, const drive::Pose& odometry, double now_s, Stream& draws);
  double along(FreeDirections& eyes, const drive::Pose& odometry, double now_s, Stream& draws);
  bool beside(const FreeDirections& eyes) const;
  void find_openings(const FreeDirections& eyes);
  /// One of the openings ahead at random; any, where there is none ahead.
  const Opening* branch(double held_rad, int branches, Stream& draws) const;

  Options options_;
  bool started_ = false, roaming_ = false;
  double phase_until_s_ = 0.0;          // it roams, or does not
  std::optional<double> heading_rad_;   // that is held, in the frame of the odometry
  double until_s_ = 0.0;                // it is held while it roams
  bool left_ = false;                   // where it has its wall
  std::optional<drive::Pose> wall_at_;  // where it last had it there
  drive::Pose decided_at_;              // where it last chose among branches
  int branches_ = 0;
  std::array<Opening, FreeDirections::sectors / 2> openings_{};
  std::size_t openings_count_ = 0;
};

}  // namespace hearsay
