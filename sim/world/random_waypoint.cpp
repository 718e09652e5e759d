#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "sim/kernel/error.hpp"
#include "sim/kernel/random.hpp"
#include "sim/math/functions.hpp"
#include "sim/world/motion.hpp"
#include "sim/world/motion_parts.hpp"

namespace hearsay::motion {
namespace {

// The mean of 1/v for v even on [low, high].
double mean_slowness(double low, double high) {
  const double width = high - low;
  if (width == 0.0) return 1.0 / low;
  const double log_ratio =
      width < low ? math::log1p(width / low) : math::log(high) - math::log(low);
  return log_ratio / width;
}

class Wandering final : public Motion {
 public:
  Wandering(const RandomWaypoint& options, std::uint64_t seed, AgentId agent)
      : options_(options), seed_(seed), agent_(agent) {}

  Leg next() override {
    require(now_ < Time::never(), "an endless random waypoint leg was to be followed by another");
    Leg leg = trip_ == 0 ? first() : Leg{.end = Time()};
    while (leg.end == leg.begin) leg = pause_ > Duration() ? stay() : travel();
    now_ = leg.end;
    return leg;
  }

 private:
  Stream stream() const { return Stream::at(seed_, purpose, Entity::agent(agent_), trip_); }

  // Of no length if it is a pause that is over at once.
  Leg first() {
    Stream draw = stream();
    ++trip_;
    const double pause_s = 0.5 * (options_.pause_min.seconds() + options_.pause_max.seconds());
    const double trip_s = mean_distance_m(options_.area.max_m[0] - options_.area.min_m[0],
                                          options_.area.max_m[1] - options_.area.min_m[1]) *
                          mean_slowness(options_.speed_min_m_per_s, options_.speed_max_m_per_s);
    if (draw.bernoulli(pause_s / (pause_s + trip_s))) return first_pause(draw);
    return first_trip(draw);
  }

  // An instant in a pause falls into a long one in proportion to its length, and anywhere in it.
  Leg first_pause(Stream& draw) {
    here_m_ = place_in(options_.area, options_.altitude_m, draw);
    const double low_s = options_.pause_min.seconds();
    const double high_s = options_.pause_max.seconds();
    const double whole_s =
        std::sqrt(low_s * low_s + draw.uniform() * (high_s * high_s - low_s * low_s));
    pause_ = Duration::seconds(whole_s * (1.0 - draw.uniform()));
    return stay();
  }

  // An instant on the way falls into a trip in proportion to its length and its slowness, and
  // anywhere in it.
  Leg first_trip(Stream& draw) {
    const Point corner_m = {options_.area.min_m[0], options_.area.min_m[1], 0.0};
    const Point opposite_m = {options_.area.max_m[0], options_.area.max_m[1], 0.0};
    const double longest_m = std::sqrt(squared_distance_m2(corner_m, opposite_m));
    Point from_m, to_m;
    double length_m = 0.0;
    do {
      from_m = place_in(options_.area, options_.altitude_m, draw);
      to_m = place_in(options_.area, options_.altitude_m, draw);
      length_m = std::sqrt(squared_distance_m2(from_m, to_m));
    } while (!(draw.uniform() * longest_m < length_m));
    const double gone = draw.uniform();
    for (std::size_t i = 0; i < 2; ++i) from_m[i] += gone * (to_m[i] - from_m[i]);
    const double low = options_.speed_min_m_per_s;
    const double high = options_.speed_max_m_per_s;
    const double log_ratio = math::log(high) - math::log(low);
    const double speed = std::min(low * math::exp(draw.uniform() * log_ratio), high);
    draw_pause(draw);
    here_m_ = to_m;
    return from_m == to_m ? Leg{.end = Time()} : straight(now_, from_m, to_m, speed);
  }

  Leg travel() {
    Stream draw = stream();
    ++trip_;
    const Point from_m = here_m_;
    here_m_ = place_in(options_.area, options_.altitude_m, draw);
    const double speed = draw.uniform(options_.speed_min_m_per_s, options_.speed_max_m_per_s);
    draw_pause(draw);
    return from_m == here_m_ ? Leg{.end = Time()} : straight(now_, from_m, here_m_, speed);
  }

  Leg stay() {
    const Leg leg = rest(now_, later(now_, pause_), here_m_);
    pause_ = Duration();
    return leg;
  }

  void draw_pause(Stream& draw) {
    pause_ =
        Duration::seconds(draw.uniform(options_.pause_min.seconds(), options_.pause_max.seconds()));
  }

  static constexpr Purpose purpose{"random waypoint"};
  RandomWaypoint options_;
  std::uint64_t seed_;
  AgentId agent_;
  std::uint64_t trip_ = 0;  // the next to be drawn; 0: what is under way at the start
  Time now_;
  Point here_m_{};  // where the trip ends
  Duration pause_;  // still to come there
};

}  // namespace

double mean_distance_m(double a_m, double b_m) {
  // Santaló's sum, with d − a written as b²/(d + a) and so on: nothing cancels in a thin rectangle.
  const double a = std::max(a_m, b_m);
  const double b = std::min(a_m, b_m);
  const double d = math::hypot(a, b);
  const double lengths = 3.0 * d - a * (a / (d + a)) - b * (b / (d + b));
  const double across = b * (b / a) * math::log((a + d) / b);
  const double along = a * (a / b) * math::log1p(b / a * (1.0 + b / (d + a)));
  return (lengths + 2.5 * (across + along)) / 15.0;
}

std::unique_ptr<Motion> make(const RandomWaypoint& options, std::uint64_t seed, AgentId agent) {
  check_area(options.area);
  check_altitude(options.altitude_m);
  check_above_zero(options.speed_min_m_per_s, "speed_min_m_per_s");
  check_between(options.speed_max_m_per_s, options.speed_min_m_per_s,
                std::numeric_limits<double>::max(), "speed_max_m_per_s");
  check_pause(options.pause_min, "pause_min in s");
  check_pause(options.pause_max, "pause_max in s");
  check_between(options.pause_max.seconds(), options.pause_min.seconds(), 9e9, "pause_max in s");
  return std::make_unique<Wandering>(options, seed, agent);
}

}  // namespace hearsay::motion
