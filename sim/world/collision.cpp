#include "sim/world/collision.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"

namespace hearsay::plan {
namespace {

constexpr double never = std::numeric_limits<double>::infinity();

struct Vector {
  double x, y;
};
inline Vector operator-(Point a, Point b) { return {a.x_m - b.x_m, a.y_m - b.y_m}; }
inline double dot(Vector a, Vector b) { return a.x * b.x + a.y * b.y; }
inline double cross(Vector a, Vector b) { return a.x * b.y - a.y * b.x; }
inline double norm(Vector a) { return std::sqrt(dot(a, a)); }

/// From the nearest point of a segment to p.
Vector apart(Point p, const Segment& s) {
  const Vector w = s.to - s.from, v = p - s.from;
  const double square = dot(w, w);
  const double along = std::clamp(dot(v, w), 0.0, square) / square;
  return {v.x - along * w.x, v.y - along * w.y};
}

/// Where p, outside the circle of radius r around c, enters it on its way along d.
double enter_circle(Point p, Vector d, Point c, double r) {
  const Vector m = c - p;
  const double ahead = dot(m, d), aside = std::fabs(cross(m, d));
  if (ahead <= 0.0 || aside >= r) return never;
  return std::max(0.0, ahead - std::sqrt((r - aside) * (r + aside)));
}

/// Where p, farther than r from the segment, comes within r of it: over its side, or at an end.
double enter_rounded(Point p, Vector d, const Segment& s, double r) {
  double t = std::min(enter_circle(p, d, s.from, r), enter_circle(p, d, s.to, r));
  const Vector w = s.to - s.from, v = p - s.from;
  const double length = norm(w);
  const double height = cross(w, v) / length, climb = cross(w, d) / length;
  const double fall = height > 0.0 ? -climb : climb;
  if (fall > 0.0) {  // at a height below r the foot is beyond an end
    const double at = std::max(0.0, std::fabs(height) - r) / fall;
    const double foot = dot(v, w) + at * dot(d, w);
    if (foot >= 0.0 && foot <= length * length) t = std::min(t, at);
  }
  return t;
}

/// The way until a coordinate leaves 0 … side at this speed.
double until_edge(double at, double speed, double side) {
  if (speed == 0.0) return never;
  return speed > 0.0 ? (side - at) / speed : -at / speed;
}

/// The way until a disc of radius r touches something, `gap` being the vector from it to the
/// disc's centre and enter(r) the way until the centre is within r. The distance to what is convex
/// has, along a line, no minimum but one: where it does not fall at first it never will.
template <typename Enter>
double until_contact(Vector gap, Vector d, double r, Enter&& enter) {
  const double square = dot(gap, gap);
  if (square > r * r) return enter(r);
  if (dot(gap, d) >= 0.0) return never;
  const double inner = r - std::min(slack_m, 0.5 * r);
  return square > inner * inner ? enter(inner) : 0.0;
}

}  // namespace

Advance advance(const WallIndex& walls, Point from, Point to, double radius_m,
                std::span<const Disc> others) {
  require(walls.contains(from), "advance: begins outside the plan");
  require(std::fabs(to.x_m) <= 1e12 && std::fabs(to.y_m) <= 1e12, "advance: an end within ±1e12 m");
  require(radius_m >= radius_min_m && std::isfinite(radius_m), "advance: a radius of 1 µm or more");
  const double length = norm(to - from);
  if (length == 0.0) return {from, 0.0, false};
  const Vector d{(to.x_m - from.x_m) / length, (to.y_m - from.y_m) / length};
  // Only a disc that begins in a wall can get to the edge of the plan.
  double free = std::min(until_edge(from.x_m, d.x, walls.width_m()),
                         until_edge(from.y_m, d.y, walls.height_m()));
  for (const Disc& other : others) {
    const double r = radius_m + other.radius_m;
    free = std::min(free, until_contact(from - other.at, d, r, [&](double limit) {
                      return enter_circle(from, d, other.at, limit);
                    }));
  }
  // Piece by piece, so that a long way does not look at all that its box holds; each wall is
  // measured against the whole way.
  const double piece = std::max(walls.cell_m(), radius_m), reach = radius_m + 1e-9;
  for (double begin = 0.0; begin < std::min(length, free); begin += piece) {
    const double end = std::min(begin + piece, length);
    const Point a{from.x_m + d.x * begin, from.y_m + d.y * begin};
    const Point b{from.x_m + d.x * end, from.y_m + d.y * end};
    const Point low{std::min(a.x_m, b.x_m) - reach, std::min(a.y_m, b.y_m) - reach};
    const Point high{std::max(a.x_m, b.x_m) + reach, std::max(a.y_m, b.y_m) + reach};
    walls.for_each_in(low, high, [&](const Segment& s) {
      free = std::min(free, until_contact(apart(from, s), d, radius_m, [&](double limit) {
                        return enter_rounded(from, d, s, limit);
                      }));
    });
  }
  if (!(free < length)) return {to, length, false};
  const Point at{std::clamp(from.x_m + d.x * free, 0.0, walls.width_m()),
                 std::clamp(from.y_m + d.y * free, 0.0, walls.height_m())};
  return {at, free, true};
}

ArcAdvance advance_along_arc(const WallIndex& walls, const Pose& from, double length_m,
                             double turn_rad, double radius_m, std::span<const Disc> others) {
  require(
      std::fabs(length_m) <= 1e4 && std::fabs(turn_rad) <= 1e3 && std::isfinite(from.heading_rad),
      "arc: at most 10 km and 1000 rad, a finite heading");
  // A chord over the angle a of an arc of length l is l a / 8 away from it in its middle.
  const double bend = std::fabs(length_m * turn_rad);
  const double pieces = std::max(
      {1.0, std::ceil(std::fabs(turn_rad) / 0.1), std::ceil(std::sqrt(bend / (8.0 * 0.001)))});
  ArcAdvance result{from, 0.0, false};
  for (double i = 0.0; i < pieces && !result.blocked; i += 1.0) {
    const double half = 0.5 * turn_rad / pieces;
    const double heading = from.heading_rad + (2.0 * i + 1.0) * half;
    const double arc = length_m / pieces;
    const double chord = half == 0.0 ? arc : arc * math::sin(half) / half;
    const Point start = result.end.at;
    const Point aim{start.x_m + chord * math::cos(heading), start.y_m + chord * math::sin(heading)};
    const Advance step = advance(walls, start, aim, radius_m, others);
    const double share = step.blocked ? step.distance_m / std::fabs(chord) : 1.0;
    result.end = {step.at, from.heading_rad + 2.0 * half * (i + share)};
    result.distance_m += std::fabs(arc) * share;
    result.blocked = step.blocked;
  }
  return result;
}

double clearance(const WallIndex& walls, Point from, double up_to_m) {
  require(walls.contains(from), "clearance: outside the plan");
  require(up_to_m >= 0.0, "clearance: a limit of 0 or more");
  double square = up_to_m * up_to_m;
  walls.for_each_in({from.x_m - up_to_m, from.y_m - up_to_m},
                    {from.x_m + up_to_m, from.y_m + up_to_m}, [&](const Segment& s) {
                      const Vector gap = apart(from, s);
                      square = std::min(square, dot(gap, gap));
                    });
  return std::sqrt(square);
}

}  // namespace hearsay::plan
