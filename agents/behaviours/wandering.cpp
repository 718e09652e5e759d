#include "agents/behaviours/wandering.hpp"

#include <algorithm>
#include <cmath>

#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"

namespace hearsay {
namespace {

/// A heading that can be kept only by turning away by more than this is blocked.
constexpr double blocked_rad = 0.8;
/// It does not turn back where it came from, unless it must.
constexpr double roam_rad = 1.8;
/// Walls are looked for from a little behind the side on.
constexpr double side_rad = 1.9;
constexpr double other_side_rad = 0.6;  ///< and so far to the other side
/// Around the end of a wall it drives a curve: more would be to turn on the spot.
constexpr double curve_rad = 0.5;
/// What is farther behind is where it came from.
constexpr double ahead_rad = 2.0;
constexpr double hall_rad = 3.0;    ///< with more free around it is in no corridor
constexpr double wide_rad = 1.4;    ///< an opening that is no corridor any more
constexpr double ended_rad = 0.35;  ///< a branch has ended from which it is farther to the next
constexpr double between_branches_m = 1.5;

double way(const drive::Pose& a, const drive::Pose& b) {
  const double dx = a.x_m - b.x_m, dy = a.y_m - b.y_m;
  return std::sqrt(dx * dx + dy * dy);
}

}  // namespace

Wandering::Wandering(const Options& options) : options_(options) {
  for (const double x : {options.clearance_m, options.look_ahead_m, options.range_m, options.hold_s,
                         options.follow_s}) {
    require(x > 0.0 && std::isfinite(x), "wandering: distances and times above 0, finite");
  }
}

void Wandering::restart() { started_ = false; }

double Wandering::bearing(FreeDirections& eyes, const drive::Pose& odometry, double now_s,
                          Stream& draws) {
  if (!started_ || (options_.manner != Manner::roam && now_s >= phase_until_s_)) {
    roaming_ = options_.manner == Manner::roam || (started_ && !roaming_);
    const double mean_s = roaming_ ? options_.hold_s : options_.follow_s;
    phase_until_s_ = now_s + draws.exponential(1.0 / mean_s);
    left_ = draws.bernoulli(0.5);
    wall_at_.reset();
    branches_ = 0;
    decided_at_ = odometry;
    heading_rad_.reset();
    if (!started_) heading_rad_ = odometry.heading_rad;
    until_s_ = now_s + draws.exponential(1.0 / options_.hold_s);
    started_ = true;
  }
  if (roaming_) return roam(eyes, odometry, now_s, draws);
  return options_.manner == Manner::wall ? follow(eyes, odometry, now_s, draws)
                                         : along(eyes, odometry, now_s, draws);
}

double Wandering::roam(FreeDirections& eyes, const drive::Pose& odometry, double now_s,
                       Stream& draws) {
  eyes.block(options_.clearance_m, options_.look_ahead_m);
  bool again = !heading_rad_ || now_s >= until_s_;
  if (!again) {
    const double bearing = math::wrap_angle(*heading_rad_ - odometry.heading_rad);
    const auto nearest = eyes.nearest({bearing, std::nullopt});
    again = nearest && std::fabs(math::wrap_angle(nearest->bearing_rad - bearing)) > blocked_rad;
  }
  if (again) {
    std::optional<double> ahead = eyes.any(draws, roam_rad);
    if (!ahead) ahead = eyes.any(draws, math::pi);
    const double drawn = ahead.value_or(draws.uniform(-math::pi, math::pi));
    heading_rad_ = math::wrap_angle(odometry.heading_rad + drawn);
    until_s_ = now_s + draws.exponential(1.0 / options_.hold_s);
  }
  return math::wrap_angle(*heading_rad_ - odometry.heading_rad);
}

bool Wandering::beside(const FreeDirections& eyes) const {
  const double within = options_.clearance_m + 0.5;
  const int middle = FreeDirections::sector(left_ ? 0.5 * math::pi : -0.5 * math::pi);
  constexpr int spread = FreeDirections::sectors / 6;
  for (int i = -spread; i <= spread; ++i) {
    const int s = (middle + i + FreeDirections::sectors) % FreeDirections::sectors;
    if (eyes.open_m(s) < within) return true;
  }
  return false;
}

double Wandering::follow(FreeDirections& eyes, const drive::Pose& odometry, double now_s,
                         Stream& draws) {
  if (beside(eyes)) wall_at_ = odometry;
  // Around the end of a wall it is lost for less than this.
  const double lost_m = 3.0 * options_.clearance_m;
  if (!wall_at_ || way(odometry, *wall_at_) > lost_m) return roam(eyes, odometry, now_s, draws);
  heading_rad_ = odometry.heading_rad;
  until_s_ = now_s + options_.hold_s;
  eyes.block(options_.clearance_m, std::min(options_.look_ahead_m, 2.5 * options_.clearance_m));
  const double sign = left_ ? 1.0 : -1.0, curve = sign * curve_rad;
  double edge = sign * side_rad;
  if (eyes.free(FreeDirections::sector(edge))) {
    // Nothing right at its side: what is ahead is the wall that it turns its side to; or there is
    // an end to go around.
    const auto wall = eyes.first(false, edge, !left_);
    if (!wall || *wall * sign < -other_side_rad || *wall * sign > side_rad) return curve;
    edge = *wall;
  }
  const double along = eyes.first(true, edge, !left_).value_or(math::pi);
  return left_ ? std::min(along, curve) : std::max(along, curve);
}

void Wandering::find_openings(const FreeDirections& eyes) {
  openings_count_ = 0;
  constexpr int n = FreeDirections::sectors;
  const auto open = [&](int s) { return eyes.free(s % n) && eyes.seen(s % n); };
  int begin = 0;
  while (begin < n && open(begin)) ++begin;
  if (begin == n) {
    openings_[openings_count_++] = {0.0, 2.0 * math::pi};
    return;
  }
  constexpr double sector_rad = 2.0 * math::pi / n;
  for (int s = begin; s < begin + n; ++s) {
    if (!open(s)) continue;
    int end = s;
    while (open(end)) ++end;
    const double middle = math::wrap_angle(0.5 * (s + end) * sector_rad - math::pi);
    openings_[openings_count_++] = {middle, (end - s) * sector_rad};
    s = end;
  }
}

const Wandering::Opening* Wandering::branch(double held_rad, int branches, Stream& draws) const {
  if (openings_count_ == 0) return nullptr;
  const std::size_t of = branches > 0 ? static_cast<std::size_t>(branches) : openings_count_;
  std::uint64_t pick = draws.below(of);
  for (std::size_t i = 0; i < openings_count_; ++i) {
    const double off = std::fabs(math::wrap_angle(openings_[i].middle_rad - held_rad));
    if (branches > 0 && off >= ahead_rad) continue;
    if (pick-- == 0) return &openings_[i];
  }
  return nullptr;
}

double Wandering::along(FreeDirections& eyes, const drive::Pose& odometry, double now_s,
                        Stream& draws) {
  const double corridor_m = std::min(0.7 * options_.range_m, 2.0 * options_.look_ahead_m);
  for (const double within_m : {corridor_m, 0.5 * corridor_m}) {
    eyes.block(options_.clearance_m, within_m);
    find_openings(eyes);
    if (openings_count_ > 0) break;
  }
  double open_rad = 0.0;
  for (std::size_t i = 0; i < openings_count_; ++i) open_rad += openings_[i].width_rad;
  if (open_rad > hall_rad) return roam(eyes, odometry, now_s, draws);
  until_s_ = now_s + options_.hold_s;
  double held = heading_rad_ ? math::wrap_angle(*heading_rad_ - odometry.heading_rad) : 0.0;
  if (openings_count_ == 0) held = eyes.most_open();  // in a crowd
  const Opening* chosen = nullptr;
  int branches = 0;
  double nearest_rad = math::pi;
  for (std::size_t i = 0; i < openings_count_; ++i) {
    const double off = std::fabs(math::wrap_angle(openings_[i].middle_rad - held));
    branches += off < ahead_rad;
    const double outside = std::max(off - 0.5 * openings_[i].width_rad, 0.0);
    if (outside < nearest_rad) {
      nearest_rad = outside;
      chosen = &openings_[i];
    }
  }
  const bool moved = way(odometry, decided_at_) > between_branches_m;
  const bool junction = branches > std::max(branches_, 1) && moved;
  if (moved) branches_ = branches;
  const bool ended = nearest_rad > ended_rad;
  if (ended && branches == 0 && heading_rad_) {
    // To the end of a dead end, for there may be a way around its corner.
    eyes.block(options_.clearance_m, std::min(options_.look_ahead_m, 2.0 * options_.clearance_m));
    const auto on = eyes.nearest({held, std::nullopt});
    if (on && std::fabs(math::wrap_angle(on->bearing_rad - held)) < ended_rad) return held;
  }
  if (!heading_rad_ || junction || ended) {
    chosen = branch(held, branches, draws);
    // In an open place there is a branch everywhere.
    if (chosen != nullptr) held = draws.uniform(chosen->from_rad(), chosen->to_rad());
    decided_at_ = odometry;
    branches_ = branches;
  }
  double bearing = held;
  if (chosen != nullptr) {
    // An open place is crossed as it was entered, a corridor in its middle.
    const double slack = chosen->width_rad > wide_rad ? 0.5 * chosen->width_rad - 0.3 : 0.0;
    const double off = math::wrap_angle(held - chosen->middle_rad);
    bearing = math::wrap_angle(chosen->middle_rad + std::clamp(off, -slack, slack));
  }
  heading_rad_ = math::wrap_angle(odometry.heading_rad + bearing);
  return bearing;
}

}  // namespace hearsay
