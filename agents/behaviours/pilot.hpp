// How a robot on two wheels drives: from what its scanner sees and where it wants to go, to what
// its wheels are told.
//
// It goes in the free direction nearest to the wanted one (free_directions.hpp), slower the more it
// has to turn and the less room there is ahead. It keeps a margin from obstacles where there is
// room; where that would lead it far off its way, or nowhere, it makes do with less, and looks less
// far ahead. Where nothing is free it turns on the spot towards the more open side. Where it does
// not see it turns, but does not drive; and it does not turn back to what it goes around before it
// is past it.
//
// A robot that wants to drive and does not move panics, as those of LOST do (R. Vaughan, K. Støy,
// G. Sukhatme, M. Matarić, IEEE Trans. Robotics and Automation 18(5), 2002): for a while it makes
// random turns and moves, which dissolves jams. It knows by its odometry whether it moves.
//
// It never sees a true pose.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "agents/behaviours/free_directions.hpp"
#include "agents/behaviours/wandering.hpp"
#include "sim/kernel/random.hpp"
#include "sim/world/differential_drive.hpp"
#include "sim/world/plan.hpp"
#include "sim/world/ray_caster.hpp"

namespace hearsay {

class Pilot {
 public:
  /// What it does where it has nowhere to go.
  using Exploring = Wandering::Manner;

  /// Finite, and above 0 unless noted.
  struct Options {
    double radius_m = 0.25;       ///< of the body
    double speed_m_per_s = 0.25;  ///< at most
    double turn_rad_per_s = 1.0;  ///< at most
    double range_m = 5.0;         ///< of the scanner
    double margin_m = 0.12;       ///< ≥ 0, kept from obstacles where there is room
    double look_ahead_m = 1.5;    ///< what is farther is not in the way
    double panic_after_s = 2.0;   ///< without motion
    double panic_s = 6.0;         ///< how long a panic lasts
    double hold_s = 20.0;         ///< mean time for which a heading is held that leads nowhere
    double follow_s = 40.0;  ///< mean time for which walls or corridors are followed at a stretch
    Exploring exploring = Exploring::roam;
  };
  /// `fan` must outlive it. @throws BrokenInvariant for options out of range, a fan without a field
  /// of view.
  Pilot(const Options& options, const plan::Fan& fan);

  struct Senses {
    double now_s = 0.0;              ///< by any clock, never falling
    std::span<const double> scan_m;  ///< one distance a ray of the fan
    drive::Pose odometry;
  };

  // Each of these is called once a control period, of any length, and allocates nothing.
  // @throws BrokenInvariant for senses or places that are not finite.

  /// Towards a point in the frame of the odometry, around what is in the way.
  drive::Command towards(const Senses& senses, plan::Point target, Stream& draws);
  /// The same at full speed, past it: a waypoint. Who stands at one and gets no other panics.
  drive::Command through(const Senses& senses, plan::Point target, Stream& draws);
  /// Anywhere, to see what is there.
  drive::Command explore(const Senses& senses, Stream& draws);
  /// From point to point, drawn within `radius_m` > 0 of a centre in the frame of the odometry.
  drive::Command search(const Senses& senses, plan::Point centre, double radius_m, Stream& draws);

  /// Free distance along the ray next to a direction relative to the heading; the range where it is
  /// free so far, or no ray looks.
  double free_m(const Senses& senses, double bearing_rad) const;
  /// Whether the last command was one of panic.
  bool panicking() const { return panicking_; }
  /// Forgets what it was about: it was carried elsewhere, or lost its memory.
  void reset();

  const Options& options() const { return options_; }

 private:
  enum class Doing : std::uint8_t { nothing, towards, explore, search };
  /// How near to obstacles, and how far ahead they matter, and what it is worth to avoid that.
  struct Care {
    double clearance_m, look_m, costs_rad;
  };

  void begin(const Senses& senses, Doing doing);
  void rest(const Senses& senses);
  bool stuck(const Senses& senses);
  drive::Command go(const Senses& senses, plan::Point target);
  drive::Command panic(const Senses& senses, Stream& draws);
  drive::Command steer(const Senses& senses, double bearing_rad, double distance_m);
  std::optional<FreeDirections::Choice> choose(const FreeDirections::Wish& wish, double distance_m);
  /// Whether it still goes around something that was in view, and in the way.
  bool aside(const Senses& senses);
  drive::Command turn_and_drive(double bearing_rad, double distance_m);

  Options options_;
  FreeDirections eyes_;
  Wandering wandering_;
  std::array<Care, 3> cares_;

  Doing doing_ = Doing::nothing;
  double last_s_ = 0.0, period_s_ = 0.0;
  drive::Pose last_at_;
  double told_m_per_s_ = 0.0;         // at the last call
  bool pushing_ = false;              // it did not get on since, though told to
  std::optional<double> chosen_rad_;  // direction last taken, in the frame of the odometry
  double spin_ = 0.0;                 // 1, −1: it turns on the spot until something is free
  bool aside_ = false;                // it had to go another way than it wished
  drive::Pose aside_at_;
  double aside_s_ = 0.0;

  drive::Pose place_;  // where it was when it last moved
  double moved_s_ = 0.0, turned_s_ = 0.0;
  bool panicking_ = false;
  double panic_until_s_ = 0.0, leg_until_s_ = 0.0;
  double leg_rad_ = 0.0;

  std::optional<plan::Point> spot_;  // of a search
  double spot_until_s_ = 0.0;
};

}  // namespace hearsay
