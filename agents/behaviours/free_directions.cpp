#include "agents/behaviours/free_directions.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"

namespace hearsay {
namespace {

constexpr double width_rad = 2.0 * math::pi / FreeDirections::sectors;
/// Of the costs, against 1 for what is off the wish; together below 1, so that a wish that is free
/// is always granted.
constexpr double left_costs = 1.15, off_before_costs = 0.3, off_heading_costs = 0.1;

double apart(double a, double b) {
  const double d = std::fabs(a - b);
  return d > math::pi ? 2.0 * math::pi - d : d;
}

/// One direction from another, in [−π, π], both in (−π, π].
double from_to(double from, double to) {
  const double d = to - from;
  return d > math::pi ? d - 2.0 * math::pi : d < -math::pi ? d + 2.0 * math::pi : d;
}

}  // namespace

FreeDirections::FreeDirections(const plan::Fan& fan, double range_m)
    : fan_(fan), range_m_(range_m), view_rad_(0.0) {
  require(range_m > 0.0 && std::isfinite(range_m), "free directions: a range above 0, finite");
  const std::size_t rays = fan.directions().size();
  const double first = fan.angle_rad(0);
  require(rays <= 65535 && first < 0.0, "free directions: at most 65535 rays, a field of view");
  view_rad_ = rays > 1 ? (fan.angle_rad(1) - first) * static_cast<double>(rays) : -2.0 * first;
  sector_of_ray_.resize(rays);
  for (std::size_t ray = 0; ray < rays; ++ray) {
    const double angle = fan.angle_rad(ray);
    sector_of_ray_[ray] = static_cast<std::uint8_t>(sector(angle));
    seen_[sector_of_ray_[ray]] = 1;
  }
  for (int s = 0; s < sectors; ++s) {
    if (seen_[at(s)] != 0 || std::fabs(bearing_rad(s)) > 0.5 * view_rad_) continue;
    seen_[at(s)] = 1;
    between_.push_back(
        {static_cast<std::uint8_t>(s), static_cast<std::uint16_t>(ray_at(bearing_rad(s)))});
  }
  for (int i = 0; i <= quotients; ++i) {
    const double half = math::asin(static_cast<double>(i) / quotients) / width_rad;
    half_width_[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(std::floor(half + 0.5));
  }
  open_m_.fill(range_m_);
}

double FreeDirections::bearing_rad(int sector) { return (sector + 0.5) * width_rad - math::pi; }

int FreeDirections::sector(double bearing_rad) {
  const double turns = (bearing_rad + math::pi) / (2.0 * math::pi);
  const double part = (turns - std::floor(turns)) * sectors;
  return std::clamp(static_cast<int>(part), 0, sectors - 1);
}

void FreeDirections::look(std::span<const double> scan_m) {
  require(scan_m.size() == sector_of_ray_.size(), "free directions: one distance a ray of the fan");
  scan_m_ = scan_m;
  open_m_.fill(range_m_);
  bool sound = true;
  for (std::size_t ray = 0; ray < scan_m.size(); ++ray) {
    double& open = open_m_[sector_of_ray_[ray]];
    open = std::min(open, scan_m[ray]);
    sound = sound && scan_m[ray] >= 0.0;
  }
  require(sound, "free directions: distances are not negative");
  for (const Share& share : between_) open_m_[share.sector] = std::min(range_m_, scan_m[share.ray]);
  blocked_.fill(0);
}

void FreeDirections::block(double clearance_m, double within_m) {
  require(clearance_m > 0.0 && within_m > 0.0, "free directions: distances above 0");
  edges_.fill(0);
  int around = 0;  // ranges that reach over the end of the circle
  const double scale = clearance_m * quotients;
  for (int s = 0; s < sectors; ++s) {
    const double d = open_m_[at(s)];
    // What is at the range was not seen.
    if (d >= within_m || d >= range_m_) continue;
    const int quotient = d > clearance_m ? static_cast<int>(scale / d + 0.5) : quotients;
    const int half = half_width_[static_cast<std::size_t>(quotient)];
    int from = s - half, end = s + half + 1;
    if (from < 0) from += sectors, ++around;
    if (end > sectors) end -= sectors, ++around;
    ++edges_[at(from)];
    --edges_[at(end)];
  }
  int depth = around;
  for (int s = 0; s < sectors; ++s) {
    depth += edges_[at(s)];
    blocked_[at(s)] = static_cast<std::int16_t>(depth);
  }
}

std::size_t FreeDirections::ray_at(double bearing_rad) const {
  const double rays = static_cast<double>(sector_of_ray_.size());
  const double place = (bearing_rad / view_rad_ + 0.5) * rays;
  return place >= 0.0 && place <= rays ? static_cast<std::size_t>(std::min(place, rays - 1.0))
                                       : sector_of_ray_.size();
}

double FreeDirections::ray_m(std::span<const double> scan_m, double bearing_rad) const {
  require(scan_m.size() == sector_of_ray_.size(), "free directions: one distance a ray of the fan");
  const std::size_t ray = ray_at(math::wrap_angle(bearing_rad));
  return ray < scan_m.size() ? std::min(range_m_, scan_m[ray]) : range_m_;
}

double FreeDirections::ahead_m(double radius_m) const {
  // Who touches a wall at his side may go along it: what is off by rounding is not in the way.
  const double reach = radius_m - 1e-6, square = reach * reach;
  const auto directions = fan_.directions();
  double free = range_m_;
  for (std::size_t ray = 0; ray < scan_m_.size(); ++ray) {
    const double x = scan_m_[ray] * directions[ray].x_m, y = scan_m_[ray] * directions[ray].y_m;
    if (x <= 0.0 || std::fabs(y) >= reach || x - radius_m >= free) continue;
    if (scan_m_[ray] < range_m_) free = std::min(free, x - std::sqrt(square - y * y));
  }
  return std::max(free, 0.0);
}

std::optional<FreeDirections::Choice> FreeDirections::nearest(const Wish& wish) const {
  const double wanted = math::wrap_angle(wish.bearing_rad);
  const bool held = wish.before_rad.has_value();
  const double before = held ? math::wrap_angle(*wish.before_rad) : 0.0;
  const double before_costs = held ? off_before_costs : 0.0;
  const auto rest = [&](double bearing) {
    return before_costs * apart(bearing, before) + off_heading_costs * std::fabs(bearing);
  };
  const int wanted_sector = sector(wanted);
  if (free(wanted_sector) || !seen(wanted_sector)) return Choice{wanted, rest(wanted)};
  Choice best{0.0, std::numeric_limits<double>::infinity()};
  for (int s = 0; s < sectors; ++s) {
    if (!free(s) || !seen(s)) continue;
    const double bearing = bearing_rad(s), off = from_to(wanted, bearing);
    const double cost = (off > 0.0 ? left_costs * off : -off) + rest(bearing);
    if (cost < best.cost_rad) best = {bearing, cost};
  }
  if (std::isinf(best.cost_rad)) return std::nullopt;
  return best;
}

std::optional<double> FreeDirections::first(bool free_one, double from_rad,
                                            bool counter_clockwise) const {
  int s = sector(from_rad);
  for (int i = 0; i < sectors; ++i) {
    if (free(s) == free_one) return bearing_rad(s);
    s = counter_clockwise ? (s + 1) % sectors : (s + sectors - 1) % sectors;
  }
  return std::nullopt;
}

std::optional<double> FreeDirections::any(Stream& draws, double off_max_rad) const {
  const auto eligible = [&](int s) {
    return free(s) && seen(s) && std::fabs(bearing_rad(s)) <= off_max_rad;
  };
  double sum = 0.0;
  for (int s = 0; s < sectors; ++s) sum += eligible(s) ? open_m(s) : 0.0;
  if (sum <= 0.0) return std::nullopt;
  double left = draws.uniform() * sum;
  std::optional<double> last;
  for (int s = 0; s < sectors && left >= 0.0; ++s) {
    if (!eligible(s)) continue;
    left -= open_m(s);
    last = bearing_rad(s);
  }
  return last;
}

double FreeDirections::most_open() const {
  double best_m = -1.0, bearing = 0.0;
  for (int s = 0; s < sectors; ++s) {
    if (!seen(s)) continue;
    const double off = bearing_rad(s);
    // Of equals the one with the least turn.
    if (open_m(s) > best_m || (open_m(s) == best_m && std::fabs(off) < std::fabs(bearing))) {
      best_m = open_m(s);
      bearing = off;
    }
  }
  return bearing;
}

}  // namespace hearsay
