#include "sim/world/motion.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <sstream>
#include <string>
#include <utility>

#include "sim/kernel/error.hpp"
#include "sim/kernel/random.hpp"
#include "sim/world/motion_parts.hpp"

namespace hearsay::motion {
namespace {

constexpr double coordinate_max_m = 1e12;
constexpr double lanes_max = 1e6;

[[noreturn]] void refuse(const std::string& what, const char* allowed, double value) {
  std::ostringstream text;
  text.precision(17);
  text << what << " must be " << allowed << ", not " << value;
  throw InputError(text.str());
}

// Stands still for ever.
class Hovering final : public Motion {
 public:
  explicit Hovering(const Hover& options)
      : place_m_(at_altitude(options.position_m, options.altitude_m)) {}
  Leg next() override {
    require(!std::exchange(done_, true), "a hovering thing was asked for a second leg");
    return rest(Time(), Time::never(), place_m_);
  }

 private:
  Point place_m_;
  bool done_ = false;
};

class Touring final : public Motion {
 public:
  explicit Touring(const Waypoints& options) : options_(options) {
    here_m_ = point(0);
    pausing_ = !options.start_m;
    if (options.start_m) here_m_ = at_altitude(*options.start_m, options.altitude_m);
  }

  Leg next() override {
    require(now_ < Time::never(), "a tour that has ended was asked for its next leg");
    // Points may coincide and pauses may be of no length: there is a leg in one round at the
    // latest, because a tour that repeats has two different points.
    for (;;) {
      if (!pausing_) {
        pausing_ = true;
        const Point from_m = here_m_;
        here_m_ = point(target_);
        if (here_m_ != from_m) {
          return keep(straight(now_, from_m, here_m_, options_.speed_m_per_s));
        }
      }
      pausing_ = false;
      if (!advance()) return keep(rest(now_, Time::never(), here_m_));
      if (options_.pause > Duration())
        return keep(rest(now_, later(now_, options_.pause), here_m_));
    }
  }

 private:
  Point point(std::size_t i) const {
    return at_altitude(options_.points_m[i], options_.altitude_m);
  }
  Leg keep(const Leg& leg) {
    now_ = leg.end;
    return leg;
  }
  // Chooses where to go after point target_; false if that was the last.
  bool advance() {
    const std::size_t last = options_.points_m.size() - 1;
    switch (options_.repeat) {
      case Repeat::once:
        return target_++ < last;
      case Repeat::loop:
        target_ = target_ == last ? 0 : target_ + 1;
        return true;
      case Repeat::back_and_forth:
        if (target_ == (back_ ? 0 : last)) back_ = !back_;
        target_ = back_ ? target_ - 1 : target_ + 1;
        return true;
    }
    return false;
  }

  Waypoints options_;
  Time now_;
  Point here_m_;  // or, on the way, where it goes
  std::size_t target_ = 0;
  bool pausing_ = true;  // at point target_; else on the way there
  bool back_ = false;
};

class Following final : public Motion {
 public:
  explicit Following(const Track& options) : options_(options) {}

  Leg next() override {
    require(now_ < Time::never(), "a track that has ended was asked for its next leg");
    const auto& samples = options_.samples;
    // A sample at the start of the run leaves no time to wait for it.
    if (next_ == 0 && samples[0].time == now_) ++next_;
    const Point from_m = place(next_ == 0 ? 0 : next_ - 1);
    if (next_ == samples.size()) return keep(rest(now_, Time::never(), from_m));
    const Time end = samples[next_].time;
    const Point to_m = place(next_++);
    if (to_m == from_m) return keep(rest(now_, end, from_m));
    const double span_s = (end - now_).seconds();
    return keep({.begin = now_,
                 .end = end,
                 .from_m = from_m,
                 .velocity_m_per_s = {(to_m[0] - from_m[0]) / span_s,
                                      (to_m[1] - from_m[1]) / span_s, 0.0}});
  }

 private:
  Point place(std::size_t i) const {
    return at_altitude(options_.samples[i].position_m, options_.altitude_m);
  }
  Leg keep(const Leg& leg) {
    now_ = leg.end;
    return leg;
  }
  Track options_;
  Time now_;
  std::size_t next_ = 0;  // the sample that it waits for or goes to
};

bool all_equal(const std::vector<PlanePoint>& points) {
  return std::all_of(points.begin(), points.end(),
                     [&](const PlanePoint& p) { return p == points.front(); });
}

}  // namespace

void check_above_zero(double value, const char* what) {
  if (!(value > 0.0) || !std::isfinite(value)) refuse(what, "above 0 and finite", value);
}

void check_between(double value, double low, double high, const char* what) {
  if (value >= low && value <= high) return;
  std::ostringstream allowed;
  allowed << "between " << low << " and " << high;
  refuse(what, allowed.str().c_str(), value);
}

void check_pause(Duration pause, const char* what) {
  check_between(pause.seconds(), 0.0, 9e9, what);
}

void check_point(const PlanePoint& point_m, const char* what) {
  for (const double x : point_m) check_between(x, -coordinate_max_m, coordinate_max_m, what);
}

void check_altitude(double altitude_m) {
  check_between(altitude_m, -coordinate_max_m, coordinate_max_m, "altitude_m");
}

void check_area(const Rectangle& area) {
  check_point(area.min_m, "a corner of the area");
  check_point(area.max_m, "a corner of the area");
  for (const std::size_t axis : {0u, 1u}) {
    check_above_zero(area.max_m[axis] - area.min_m[axis], "the length of a side of the area");
  }
}

Point place_in(const Rectangle& area, double altitude_m, Stream& stream) {
  const double x_m = stream.uniform(area.min_m[0], area.max_m[0]);
  const double y_m = stream.uniform(area.min_m[1], area.max_m[1]);
  return {x_m, y_m, altitude_m};
}

Time later(Time begin, Duration span) {
  return span < Time::never() - begin ? begin + span : Time::never();
}

Leg straight(Time begin, const Point& from_m, const Point& to_m, double speed_m_per_s) {
  const double distance_m = std::sqrt(squared_distance_m2(from_m, to_m));
  const double span_s = distance_m / speed_m_per_s;
  Leg leg{.begin = begin, .end = Time::never(), .from_m = from_m};
  double divisor_s = span_s;
  if (span_s < 9e9) {
    const Duration span = std::max(Duration::seconds(span_s), Duration::nanoseconds(1));
    leg.end = later(begin, span);
    divisor_s = span.seconds();
  }
  for (std::size_t i = 0; i < 3; ++i) leg.velocity_m_per_s[i] = (to_m[i] - from_m[i]) / divisor_s;
  return leg;
}

Leg leg_to(Time begin, const Point& from_m, const Point& to_m, double speed_m_per_s) {
  constexpr double farthest_m = 1e12;
  require(speed_m_per_s > 0.0 && std::isfinite(speed_m_per_s), "a leg needs a speed above 0");
  require(std::fabs(to_m[0]) <= farthest_m && std::fabs(to_m[1]) <= farthest_m &&
              std::isfinite(to_m[2]) && from_m != to_m,
          "a leg leads to another place, within 1e12 m");
  return straight(begin, from_m, to_m, speed_m_per_s);
}

std::unique_ptr<Motion> make(const Hover& options) {
  check_point(options.position_m, "position_m");
  check_altitude(options.altitude_m);
  return std::make_unique<Hovering>(options);
}

std::unique_ptr<Motion> make(const Waypoints& options) {
  if (options.points_m.empty()) throw InputError("waypoints: there are no points_m");
  for (const PlanePoint& p : options.points_m) check_point(p, "a coordinate of points_m");
  if (options.start_m) check_point(*options.start_m, "start_m");
  check_above_zero(options.speed_m_per_s, "speed_m_per_s");
  check_pause(options.pause, "pause in s");
  check_altitude(options.altitude_m);
  if (options.repeat != Repeat::once && all_equal(options.points_m)) {
    throw InputError("waypoints: to repeat, points_m must hold at least two different points");
  }
  return std::make_unique<Touring>(options);
}

std::unique_ptr<Motion> make(const LawnMower& options) {
  check_area(options.area);
  check_above_zero(options.lane_spacing_m, "lane_spacing_m");
  const auto& [min_m, max_m] = options.area;
  const double height_m = max_m[1] - min_m[1];
  // A spacing that divides the height up to rounding is meant to divide it.
  const double lanes = std::max(1.0, std::ceil(height_m / options.lane_spacing_m - 1e-9));
  if (lanes > lanes_max) refuse("the number of lanes", "at most 1e6", lanes);
  Waypoints tour{.speed_m_per_s = options.speed_m_per_s,
                 .repeat = options.repeat,
                 .start_m = options.start_m,
                 .altitude_m = options.altitude_m};
  for (int lane = 0; lane < static_cast<int>(lanes); ++lane) {
    const double y_m = min_m[1] + height_m * ((lane + 0.5) / lanes);
    const bool rightward = lane % 2 == 0;
    tour.points_m.push_back({rightward ? min_m[0] : max_m[0], y_m});
    tour.points_m.push_back({rightward ? max_m[0] : min_m[0], y_m});
  }
  return make(tour);
}

std::unique_ptr<Motion> make(const Track& options) {
  if (options.samples.empty()) throw InputError("track: there are no samples");
  check_altitude(options.altitude_m);
  for (std::size_t i = 0; i < options.samples.size(); ++i) {
    const TrackSample& sample = options.samples[i];
    check_point(sample.position_m, "a coordinate of a track");
    if (sample.time < Time()) refuse("the time of a sample", "at least 0 s", sample.time.seconds());
    if (i == 0 || sample.time > options.samples[i - 1].time) continue;
    refuse("the time of a sample", "after that of the sample before", sample.time.seconds());
  }
  return std::make_unique<Following>(options);
}

}  // namespace hearsay::motion
