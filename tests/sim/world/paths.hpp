// A motion seen as a path: where it is at any time, its legs up to some time.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "sim/world/motion.hpp"

namespace hearsay::motion {

// Asked in order of time.
class Path {
 public:
  explicit Path(std::unique_ptr<Motion> motion) : motion_(std::move(motion)) {
    leg_ = motion_->next();
  }
  const Leg& leg_at(Time time) {
    while (leg_.end <= time && leg_.end != Time::never()) leg_ = motion_->next();
    return leg_;
  }
  Point at(Time time) { return leg_at(time).at(time); }

 private:
  std::unique_ptr<Motion> motion_;
  Leg leg_;
};

// The legs that begin before `end`.
inline std::vector<Leg> legs(Motion& motion, Time end) {
  std::vector<Leg> all{motion.next()};
  while (all.back().end < end) all.push_back(motion.next());
  return all;
}
inline std::vector<Leg> legs(std::unique_ptr<Motion> motion, Time end) {
  return legs(*motion, end);
}

inline Time at_s(double s) { return Time::at(Duration::seconds(s)); }

}  // namespace hearsay::motion
