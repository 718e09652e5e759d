#include "sim/world/differential_drive.hpp"

#include <algorithm>
#include <cmath>

#include "sim/kernel/error.hpp"
#include "sim/kernel/random.hpp"
#include "sim/math/functions.hpp"

namespace hearsay::drive {
namespace {

/// sin(x)/x.
double sinc(double x) {
  // Below, x⁴/120 is less than half a unit in the last place of 1.
  return std::fabs(x) < 1e-4 ? 1.0 - x * x / 6.0 : math::sin(x) / x;
}

double limited(double wanted, double before, double most, double rate_max, double dt_s) {
  const double possible = std::clamp(wanted, -most, most);
  if (rate_max == 0.0) return possible;
  const double step = rate_max * dt_s;
  return std::clamp(possible, before - step, before + step);
}

/// Where an arc ends: a chord of the way's length, shortened by the turn, half-way between
/// headings.
Pose along(const Pose& from, double way_m, double turn_rad) {
  const double chord_m = way_m * sinc(0.5 * turn_rad);
  const double towards = from.heading_rad + 0.5 * turn_rad;
  return {from.x_m + chord_m * math::cos(towards), from.y_m + chord_m * math::sin(towards),
          math::wrap_angle(from.heading_rad + turn_rad)};
}

bool finite(const Command& c) {
  return std::isfinite(c.forward_m_per_s) && std::isfinite(c.turn_rad_per_s);
}

}  // namespace

Command limited(const Command& wanted, const Command& before, const Limits& limits, double dt_s) {
  require(finite(wanted) && finite(before), "drive: speeds are finite");
  require(dt_s > 0.0, "drive: a step takes time");
  require(limits.speed_max_m_per_s >= 0.0 && limits.turn_max_rad_per_s >= 0.0 &&
              limits.acceleration_max_m_per_s2 >= 0.0 &&
              limits.turn_acceleration_max_rad_per_s2 >= 0.0,
          "drive: limits are not negative");
  return {limited(wanted.forward_m_per_s, before.forward_m_per_s, limits.speed_max_m_per_s,
                  limits.acceleration_max_m_per_s2, dt_s),
          limited(wanted.turn_rad_per_s, before.turn_rad_per_s, limits.turn_max_rad_per_s,
                  limits.turn_acceleration_max_rad_per_s2, dt_s)};
}

Pose driven(const Pose& from, const Command& command, double dt_s) {
  require(finite(command) && dt_s >= 0.0, "drive: speeds are finite, and time does not go back");
  return along(from, command.forward_m_per_s * dt_s, command.turn_rad_per_s * dt_s);
}

Pose relative_to(const Pose& frame, const Pose& place) {
  const double dx = place.x_m - frame.x_m, dy = place.y_m - frame.y_m;
  const double c = math::cos(frame.heading_rad), s = math::sin(frame.heading_rad);
  return {c * dx + s * dy, c * dy - s * dx,
          math::wrap_angle(place.heading_rad - frame.heading_rad)};
}

Odometer::Odometer(const Options& options, std::uint64_t seed, AgentId agent)
    : options_(options), seed_(seed), agent_(agent), pose_(options.start) {
  const auto share = [](double e) { return e >= 0.0 && e < 2.0; };
  require(share(options.forward_bias) && share(options.turn_bias),
          "odometer: a bias is at least 0 and below 2");
  require(options.forward_m_per_sqrt_m >= 0.0 && options.turn_rad_per_sqrt_m >= 0.0 &&
              options.turn_rad_per_sqrt_rad >= 0.0,
          "odometer: a standard deviation is not negative");
  Stream draws(seed, Purpose("odometry bias"), Entity::agent(agent));
  forward_bias_ = options.forward_bias * (draws.uniform() - 0.5);
  turn_bias_ = options.turn_bias * (draws.uniform() - 0.5);
}

void Odometer::drove(const Command& command, double dt_s) {
  require(finite(command) && dt_s >= 0.0, "odometer: speeds are finite, and time does not go back");
  double way_m = command.forward_m_per_s * dt_s;
  double turn_rad = command.turn_rad_per_s * dt_s;
  const double length_m = std::fabs(way_m), turned_rad = std::fabs(turn_rad);
  way_m *= 1.0 + forward_bias_;
  turn_rad *= 1.0 + turn_bias_;
  const bool walks = options_.forward_m_per_sqrt_m > 0.0 || options_.turn_rad_per_sqrt_m > 0.0 ||
                     options_.turn_rad_per_sqrt_rad > 0.0;
  if (walks) {
    Stream draws = Stream::at(seed_, Purpose("odometry walk"), Entity::agent(agent_), steps_++);
    const double along_m = options_.forward_m_per_sqrt_m;
    const double by_way = options_.turn_rad_per_sqrt_m, by_turn = options_.turn_rad_per_sqrt_rad;
    way_m += along_m * std::sqrt(length_m) * draws.normal();
    turn_rad +=
        std::sqrt(by_way * by_way * length_m + by_turn * by_turn * turned_rad) * draws.normal();
  }
  pose_ = along(pose_, way_m, turn_rad);
}

}  // namespace hearsay::drive
