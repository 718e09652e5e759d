#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "sim/kernel/error.hpp"
#include "sim/kernel/random.hpp"
#include "sim/math/functions.hpp"
#include "sim/world/motion.hpp"
#include "sim/world/motion_parts.hpp"

namespace hearsay::motion {
namespace {

class Roaming final : public Motion {
 public:
  Roaming(const GaussMarkov& options, std::uint64_t seed, AgentId agent)
      : options_(options), seed_(seed), agent_(agent) {
    Stream draw = stream();
    here_m_ = place_in(options.area, options.altitude_m, draw);
    speed_m_per_s_ = draw.normal(options.speed_mean_m_per_s, options.speed_sigma_m_per_s);
    direction_rad_ = options.direction_mean_rad
                         ? draw.normal(*options.direction_mean_rad, options.direction_sigma_rad)
                         : draw.uniform(-math::pi, math::pi);
    settle();
  }

  Leg next() override {
    require(now_ < Time::never(), "Gauss-Markov motion was asked for a leg after the end of time");
    if (now_ == update_at_) update();
    for (;;) {
      Leg leg{.begin = now_,
              .end = update_at_,
              .from_m = here_m_,
              .velocity_m_per_s = {mirrored_[0] * velocity_m_per_s_[0],
                                   mirrored_[1] * velocity_m_per_s_[1], 0.0}};
      const std::size_t axis = meet_wall(leg);
      if (axis < 2) mirrored_[axis] = -mirrored_[axis];
      if (leg.end == now_) continue;  // at the wall already
      now_ = leg.end;
      here_m_ = leg.at(leg.end);
      for (const std::size_t i : {0u, 1u}) {  // rounding may take it out by a last bit
        here_m_[i] = std::clamp(here_m_[i], options_.area.min_m[i], options_.area.max_m[i]);
      }
      return leg;
    }
  }

 private:
  Stream stream() const { return Stream::at(seed_, purpose, Entity::agent(agent_), step_); }

  // Ends the leg at the last nanosecond before the first wall on its way. Returns the axis that the
  // wall is across; 2 if there is none.
  std::size_t meet_wall(Leg& leg) const {
    std::size_t met = 2;
    for (const std::size_t axis : {0u, 1u}) {
      const double v = leg.velocity_m_per_s[axis];
      if (v == 0.0) continue;
      const double wall_m = v > 0.0 ? options_.area.max_m[axis] : options_.area.min_m[axis];
      const double span_ns = std::floor((wall_m - leg.from_m[axis]) / v * 1e9);
      if (!(span_ns < static_cast<double>((leg.end - leg.begin).nanoseconds()))) continue;
      leg.end = leg.begin + Duration::nanoseconds(static_cast<std::int64_t>(span_ns));
      met = axis;
    }
    return met;
  }

  void update() {
    ++step_;
    Stream draw = stream();
    const double kept = options_.alpha;
    const double fresh = std::sqrt((1.0 - kept) * (1.0 + kept));
    const auto drawn = [&](double value, double mean, double sigma) {
      return mean + kept * (value - mean) + draw.normal(0.0, fresh * sigma);
    };
    speed_m_per_s_ =
        drawn(speed_m_per_s_, options_.speed_mean_m_per_s, options_.speed_sigma_m_per_s);
    if (options_.direction_mean_rad) {
      direction_rad_ =
          drawn(direction_rad_, *options_.direction_mean_rad, options_.direction_sigma_rad);
    } else {
      direction_rad_ =
          math::wrap_angle(direction_rad_ + draw.normal(0.0, fresh * options_.direction_sigma_rad));
    }
    settle();
  }

  void settle() {
    velocity_m_per_s_ = {speed_m_per_s_ * math::cos(direction_rad_),
                         speed_m_per_s_ * math::sin(direction_rad_)};
    update_at_ = later(now_, options_.update_period);
  }

  static constexpr Purpose purpose{"gauss-markov"};
  GaussMarkov options_;
  std::uint64_t seed_;
  AgentId agent_;
  std::uint64_t step_ = 0;
  Time now_;
  Time update_at_;
  Point here_m_{};
  double speed_m_per_s_ = 0.0;
  double direction_rad_ = 0.0;
  PlanePoint velocity_m_per_s_{};  // in the open plane
  PlanePoint mirrored_{1.0, 1.0};  // −1: seen in the mirror
};

}  // namespace

std::unique_ptr<Motion> make(const GaussMarkov& options, std::uint64_t seed, AgentId agent) {
  check_area(options.area);
  check_altitude(options.altitude_m);
  const double largest = std::numeric_limits<double>::max();
  check_between(options.speed_mean_m_per_s, 0.0, largest, "speed_mean_m_per_s");
  check_between(options.speed_sigma_m_per_s, 0.0, largest, "speed_sigma_m_per_s");
  if (options.direction_mean_rad) {
    check_between(*options.direction_mean_rad, -1e6, 1e6, "direction_mean_rad");
  }
  check_between(options.direction_sigma_rad, 0.0, 1e6, "direction_sigma_rad");
  if (!(options.alpha >= 0.0 && options.alpha < 1.0)) {
    throw InputError("alpha must be at least 0 and below 1");
  }
  if (options.update_period <= Duration()) throw InputError("update_period must be above 0 s");
  // No draw is farther than 8.6 sigmas out, and a sum of √(1 − α²) α^k of them not farther than
  // √((1 + α)/(1 − α)) times that. So the motion between walls always takes time.
  const double spread = std::sqrt((1.0 + options.alpha) / (1.0 - options.alpha));
  const double fastest = options.speed_mean_m_per_s + 10.0 * spread * options.speed_sigma_m_per_s;
  for (const std::size_t axis : {0u, 1u}) {
    if (options.area.max_m[axis] - options.area.min_m[axis] >= 1e-6 * fastest) continue;
    throw InputError(
        "the area must not be crossed in less than a microsecond, 10 sigmas above "
        "the mean speed");
  }
  return std::make_unique<Roaming>(options, seed, agent);
}

}  // namespace hearsay::motion
