#include "sim/world/target_states.hpp"

#include <cmath>

#include "sim/kernel/error.hpp"
#include "sim/kernel/random.hpp"

namespace hearsay {

std::vector<double> target_states(Motion& motion, Duration period, std::size_t count) {
  require(period > Duration(), "stamps of a target need time between them");
  std::vector<double> states;
  states.reserve(4 * count);
  Leg leg = motion.next();
  Time now;
  for (std::size_t k = 0; k < count; ++k, now = now + period) {
    while (leg.end <= now) leg = motion.next();
    const Point place_m = leg.at(now);
    states.insert(states.end(),
                  {place_m[0], place_m[1], leg.velocity_m_per_s[0], leg.velocity_m_per_s[1]});
  }
  return states;
}

std::vector<double> target_states(const TargetState& start, double psd_m2_per_s3, Duration period,
                                  std::size_t count, std::uint64_t seed, int target) {
  require(period > Duration() && psd_m2_per_s3 >= 0.0,
          "white-noise acceleration needs a period above 0 and a density of at least 0");
  // Cholesky factor of q (dt³/3, dt²/2; dt²/2, dt).
  const double dt = period.seconds();
  const double root = std::sqrt(psd_m2_per_s3 * dt);
  const double place = root * dt / std::sqrt(3.0);
  const double speed = root * std::sqrt(3.0) / 2.0;
  std::vector<double> states(start.begin(), start.end());
  states.reserve(4 * count);
  TargetState s = start;
  for (std::size_t k = 1; k < count; ++k) {
    Stream draws = Stream::at(seed, Purpose("target acceleration"), Entity::agent(target), k);
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const double first = draws.normal();
      const double second = draws.normal();
      s[axis] += s[axis + 2] * dt + place * first;
      s[axis + 2] += speed * first + 0.5 * root * second;
    }
    states.insert(states.end(), s.begin(), s.end());
  }
  return states;
}

}  // namespace hearsay
