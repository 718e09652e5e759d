// What a robot that localizes itself went through: its odometry and what it saw, read from a log
// beforehand.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "filters/localization/pose_filter.hpp"
#include "sim/kernel/time.hpp"

namespace hearsay {

/// Velocities from here to the next.
struct Drive {
  Time from;
  double forward_m_per_s, turn_rad_per_s;
};

/// It saw a companion, or a landmark.
struct Encounter {
  Time time;
  bool companion;
  int subject;  ///< number of the agent, or of the landmark
  double range_m, bearing_rad;
};

struct TruePose {
  Time time;
  localization::Pose pose;
};

struct Journey {
  localization::Pose start;           ///< true, at time 0
  std::vector<Drive> drives;          ///< by time
  std::vector<Encounter> encounters;  ///< by time
  std::vector<TruePose> truth;        ///< one a sample of the witness, from 0 on; ends with the log
};

/// Goes through the odometry of a journey, piece by piece.
class Odometer {
 public:
  /// `drives` by time; they outlive it.
  explicit Odometer(std::span<const Drive> drives) : drives_(drives) {}

  /// From where it was to `now`: calls step(until, forward, turn, dt_s) for every stretch of
  /// constant velocities. Before the first and after the last it stands still.
  template <typename Step>
  void advance(Time now, Step&& step) {
    while (at_ < now) {
      while (next_ < drives_.size() && drives_[next_].from <= at_) ++next_;
      const Time until = next_ < drives_.size() ? std::min(now, drives_[next_].from) : now;
      const Drive still{};
      const Drive& drive = next_ > 0 && !over() ? drives_[next_ - 1] : still;
      step(until, drive.forward_m_per_s, drive.turn_rad_per_s, (until - at_).seconds());
      at_ = until;
    }
  }

 private:
  /// The last one says when the log ends.
  bool over() const { return next_ == drives_.size(); }

  std::span<const Drive> drives_;
  std::size_t next_ = 0;
  Time at_;
};

}  // namespace hearsay
