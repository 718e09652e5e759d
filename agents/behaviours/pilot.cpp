#include "agents/behaviours/pilot.hpp"

#include <algorithm>
#include <cmath>

#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"

namespace hearsay {
namespace {

constexpr double there_m = 0.02;                    ///< nearer it is at its target
constexpr double turns_per_s = 3.0;                 ///< how fast a heading error is made good
constexpr double stops_rad = 1.2;                   ///< heading error at which it only turns
constexpr double straight_rad = 0.1;                ///< and up to which it drives at full speed
constexpr double ahead_s = 0.4;                     ///< the room ahead is never used up faster
constexpr double keeps_m = 0.01;                    ///< and not to the last
constexpr double moves_m = 0.05;                    ///< less is no motion
constexpr double turns_rad = 0.3;                   ///< neither is less turning
constexpr double aside_rad = 0.2;                   ///< so far off its wish it avoids something
constexpr double pushing_share = 0.01;              ///< of the way it was told to make
constexpr double leg_min_s = 0.5, leg_max_s = 2.0;  ///< of a panic

double way(const drive::Pose& from, plan::Point to) {
  const double dx = to.x_m - from.x_m, dy = to.y_m - from.y_m;
  return std::sqrt(dx * dx + dy * dy);
}

double bearing_of(const drive::Pose& from, plan::Point to) {
  return math::wrap_angle(math::atan2(to.y_m - from.y_m, to.x_m - from.x_m) - from.heading_rad);
}

bool finite(const drive::Pose& p) {
  return std::isfinite(p.x_m) && std::isfinite(p.y_m) && std::isfinite(p.heading_rad);
}

Pilot::Options checked(const Pilot::Options& o) {
  for (const double x : {o.radius_m, o.speed_m_per_s, o.turn_rad_per_s, o.range_m, o.look_ahead_m,
                         o.panic_after_s, o.panic_s, o.hold_s, o.follow_s}) {
    require(x > 0.0 && std::isfinite(x), "pilot: sizes, speeds and times are above 0 and finite");
  }
  require(o.margin_m >= 0.0 && std::isfinite(o.margin_m), "pilot: a margin of 0 or more");
  return o;
}

}  // namespace

Pilot::Pilot(const Options& options, const plan::Fan& fan)
    : options_(checked(options)),
      eyes_(fan, options.range_m),
      wandering_({.manner = options.exploring,
                  .clearance_m = options.radius_m + options.margin_m,
                  .look_ahead_m = options.look_ahead_m,
                  .range_m = options.range_m,
                  .hold_s = options.hold_s,
                  .follow_s = options.follow_s}) {
  const double r = options.radius_m, m = options.margin_m, look = options.look_ahead_m;
  const double least = std::min(m, std::max(0.1 * m, 0.04 * r));
  cares_ = {{{r + m, look, 0.0},
             {r + 0.5 * m, std::max(0.6 * look, std::min(look, 2.0 * r)), 0.3},
             {r + least, std::max(0.35 * look, std::min(look, 2.0 * r)), 0.6}}};
}

void Pilot::reset() {
  doing_ = Doing::nothing;
  panicking_ = false;
}

void Pilot::rest(const Senses& senses) {
  place_ = senses.odometry;
  moved_s_ = turned_s_ = senses.now_s;
}

bool Pilot::stuck(const Senses& senses) {
  const double least_m = std::min(moves_m, 0.2 * options_.speed_m_per_s * options_.panic_after_s);
  if (way(place_, {senses.odometry.x_m, senses.odometry.y_m}) >= least_m) {
    rest(senses);
  } else if (std::fabs(math::wrap_angle(senses.odometry.heading_rad - place_.heading_rad)) >=
             std::min(turns_rad, 0.2 * options_.turn_rad_per_s * options_.panic_after_s)) {
    place_.heading_rad = senses.odometry.heading_rad;
    turned_s_ = senses.now_s;
  }
  // To turn is to move, but not for longer than it takes to turn around.
  const double around_s = 2.0 * math::pi / options_.turn_rad_per_s;
  return senses.now_s - turned_s_ >= options_.panic_after_s ||
         senses.now_s - moved_s_ >= options_.panic_after_s + around_s;
}

void Pilot::begin(const Senses& senses, Doing doing) {
  require(finite(senses.odometry) && std::isfinite(senses.now_s), "pilot: senses are finite");
  eyes_.look(senses.scan_m);
  const bool anew = doing_ == Doing::nothing;
  const bool paused = !anew && senses.now_s - last_s_ > options_.panic_after_s;
  period_s_ = anew || paused ? 0.0 : std::max(senses.now_s - last_s_, 0.0);
  last_s_ = senses.now_s;
  // Wheels that stand though they were told to turn: something is there that it does not see.
  const double told_m = told_m_per_s_ * period_s_;
  pushing_ = told_m > 0.0 &&
             way(last_at_, {senses.odometry.x_m, senses.odometry.y_m}) < pushing_share * told_m;
  last_at_ = senses.odometry;
  told_m_per_s_ = 0.0;
  if (anew || paused) {
    rest(senses);
    chosen_rad_.reset();
    spin_ = 0.0;
    aside_ = false;
  }
  if (doing != doing_) {
    wandering_.restart();
    spot_.reset();
    doing_ = doing;
  }
  if (panicking_ && senses.now_s >= panic_until_s_) {
    panicking_ = false;
    rest(senses);
  } else if (!panicking_ && stuck(senses)) {
    panicking_ = true;
    panic_until_s_ = senses.now_s + options_.panic_s;
    leg_until_s_ = senses.now_s;
    wandering_.restart();
    spot_.reset();
  }
}

drive::Command Pilot::towards(const Senses& senses, plan::Point target, Stream& draws) {
  require(std::isfinite(target.x_m) && std::isfinite(target.y_m), "pilot: a target is finite");
  begin(senses, Doing::towards);
  if (panicking_) return panic(senses, draws);
  return go(senses, target);
}

drive::Command Pilot::through(const Senses& senses, plan::Point target, Stream& draws) {
  require(std::isfinite(target.x_m) && std::isfinite(target.y_m), "pilot: a target is finite");
  begin(senses, Doing::towards);
  if (panicking_) return panic(senses, draws);
  const double distance = way(senses.odometry, target);
  if (distance < there_m) return {};
  return steer(senses, bearing_of(senses.odometry, target),
               std::max(distance, options_.look_ahead_m));
}

drive::Command Pilot::explore(const Senses& senses, Stream& draws) {
  begin(senses, Doing::explore);
  if (panicking_) return panic(senses, draws);
  const double bearing = wandering_.bearing(eyes_, senses.odometry, senses.now_s, draws);
  return steer(senses, bearing, options_.range_m);
}

drive::Command Pilot::search(const Senses& senses, plan::Point centre, double radius_m,
                             Stream& draws) {
  require(std::isfinite(centre.x_m) && std::isfinite(centre.y_m) && radius_m > 0.0 &&
              std::isfinite(radius_m),
          "pilot: a search has a centre, and a radius above 0");
  begin(senses, Doing::search);
  if (panicking_) return panic(senses, draws);
  if (!spot_ || senses.now_s >= spot_until_s_ ||
      way(senses.odometry, *spot_) < std::max(options_.radius_m, there_m)) {
    const double angle = draws.uniform(-math::pi, math::pi);
    const double r = radius_m * std::sqrt(draws.uniform());
    spot_ = {centre.x_m + r * math::cos(angle), centre.y_m + r * math::sin(angle)};
    // Where it cannot go, it tries for so long.
    spot_until_s_ = senses.now_s + 1.5 * way(senses.odometry, *spot_) / options_.speed_m_per_s +
                    math::pi / options_.turn_rad_per_s;
  }
  return go(senses, *spot_);
}

drive::Command Pilot::go(const Senses& senses, plan::Point target) {
  const double distance = way(senses.odometry, target);
  if (distance < there_m) {
    rest(senses);
    return {};
  }
  return steer(senses, bearing_of(senses.odometry, target), distance);
}

drive::Command Pilot::panic(const Senses& senses, Stream& draws) {
  const double heading = senses.odometry.heading_rad;
  if (senses.now_s >= leg_until_s_) {
    eyes_.block(cares_.back().clearance_m, cares_.back().look_m);
    // What it sees is no guide to who touches what he does not see.
    const double anywhere = draws.uniform(-math::pi, math::pi);
    const double drawn = pushing_ ? anywhere : eyes_.any(draws, math::pi).value_or(anywhere);
    leg_rad_ = math::wrap_angle(heading + drawn);
    leg_until_s_ = senses.now_s + draws.uniform(leg_min_s, leg_max_s) +
                   std::fabs(drawn) / options_.turn_rad_per_s;
    chosen_rad_.reset();
  }
  return steer(senses, math::wrap_angle(leg_rad_ - heading), options_.range_m);
}

std::optional<FreeDirections::Choice> Pilot::choose(const FreeDirections::Wish& wish,
                                                    double distance_m) {
  std::optional<FreeDirections::Choice> best;
  for (const Care& care : cares_) {
    if (best && best->cost_rad <= care.costs_rad) break;
    eyes_.block(care.clearance_m, std::min(care.look_m, distance_m));
    const auto choice = eyes_.nearest(wish);
    if (choice && (!best || choice->cost_rad + care.costs_rad < best->cost_rad)) {
      best = {choice->bearing_rad, choice->cost_rad + care.costs_rad};
    }
  }
  return best;
}

bool Pilot::aside(const Senses& senses) {
  const bool past =
      way(aside_at_, {senses.odometry.x_m, senses.odometry.y_m}) > 4.0 * options_.radius_m;
  const double around_s = 2.0 * math::pi / options_.turn_rad_per_s;
  if (past || senses.now_s - aside_s_ > options_.panic_after_s + around_s) aside_ = false;
  return aside_;
}

drive::Command Pilot::steer(const Senses& senses, double bearing_rad, double distance_m) {
  const double heading = senses.odometry.heading_rad;
  FreeDirections::Wish wish{.bearing_rad = bearing_rad};
  if (chosen_rad_) wish.before_rad = *chosen_rad_ - heading;
  const bool in_view = eyes_.seen(FreeDirections::sector(bearing_rad));
  if (!in_view && aside(senses)) wish.bearing_rad = wish.before_rad.value_or(0.0);
  const auto choice = choose(wish, distance_m);
  if (in_view) {
    const double off = choice ? choice->bearing_rad - bearing_rad : math::pi;
    aside_ = std::fabs(math::wrap_angle(off)) > aside_rad;
    aside_at_ = senses.odometry;
    aside_s_ = senses.now_s;
  }
  if (!choice) {
    if (spin_ == 0.0) spin_ = eyes_.most_open() < 0.0 ? -1.0 : 1.0;
    chosen_rad_.reset();
    return {0.0, spin_ * options_.turn_rad_per_s};
  }
  spin_ = 0.0;
  chosen_rad_ = math::wrap_angle(heading + choice->bearing_rad);
  return turn_and_drive(choice->bearing_rad, distance_m);
}

drive::Command Pilot::turn_and_drive(double bearing_rad, double distance_m) {
  // Never farther within a period than it sees by now.
  const double gain = std::min(turns_per_s, period_s_ > 0.0 ? 0.9 / period_s_ : turns_per_s);
  const double turn =
      std::clamp(gain * bearing_rad, -options_.turn_rad_per_s, options_.turn_rad_per_s);
  const double off = std::fabs(bearing_rad);
  const double share = std::clamp((stops_rad - off) / (stops_rad - straight_rad), 0.0, 1.0);
  const double time = std::max(ahead_s, 1.5 * period_s_);
  const double room = std::max(eyes_.ahead_m(options_.radius_m) - keeps_m, 0.0);
  const double speed = std::min({options_.speed_m_per_s * share, room / time, distance_m / time});
  // A robot that is stopped does not turn either, but one that stands does.
  told_m_per_s_ = pushing_ && std::fabs(turn) > 0.0 ? 0.0 : speed;
  return {told_m_per_s_, turn};
}

double Pilot::free_m(const Senses& senses, double bearing_rad) const {
  return eyes_.ray_m(senses.scan_m, bearing_rad);
}

}  // namespace hearsay
