#include "filters/trails/frames.hpp"

#include <cmath>

#include "sim/kernel/error.hpp"
#include "sim/math/functions.hpp"

namespace hearsay::trails {
namespace {

/// Sums over pairs about their centres.
struct Moments {
  double from_x = 0.0, from_y = 0.0, to_x = 0.0, to_y = 0.0;  ///< centres
  double from_square = 0.0, to_square = 0.0;                  ///< Σ |from|², Σ |to|²
  double dot = 0.0, cross = 0.0;                              ///< of Σ conj(from)·to
};

Moments moments(std::span<const PointPair> pairs) {
  Moments m;
  const auto n = static_cast<double>(pairs.size());
  for (const PointPair& pair : pairs) {
    m.from_x += pair.from.x_m / n;
    m.from_y += pair.from.y_m / n;
    m.to_x += pair.to.x_m / n;
    m.to_y += pair.to.y_m / n;
  }
  for (const PointPair& pair : pairs) {
    const double px = pair.from.x_m - m.from_x, py = pair.from.y_m - m.from_y;
    const double qx = pair.to.x_m - m.to_x, qy = pair.to.y_m - m.to_y;
    m.from_square += px * px + py * py;
    m.to_square += qx * qx + qy * qy;
    m.dot += px * qx + py * qy;
    m.cross += px * qy - py * qx;
  }
  return m;
}

double residual(std::span<const PointPair> pairs, const Similarity& map) {
  double sum = 0.0;
  for (const PointPair& pair : pairs) {
    const Point& p = pair.from;
    const double x = map.a * p.x_m - map.b * p.y_m + map.x_m - pair.to.x_m;
    const double y = map.b * p.x_m + map.a * p.y_m + map.y_m - pair.to.y_m;
    sum += x * x + y * y;
  }
  return pairs.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(pairs.size()));
}

}  // namespace

double Similarity::scale() const { return std::sqrt(a * a + b * b); }

double Similarity::rotation_rad() const { return math::atan2(b, a); }

std::optional<Similarity> Similarity::inverse() const {
  const double square = a * a + b * b;
  if (!(square > 0.0)) return std::nullopt;
  Similarity back{a / square, -b / square, 0.0, 0.0};
  back.x_m = -(back.a * x_m - back.b * y_m);
  back.y_m = -(back.b * x_m + back.a * y_m);
  return back;
}

Similarity chained(const Similarity& outer, const Similarity& inner) {
  return {outer.a * inner.a - outer.b * inner.b, outer.a * inner.b + outer.b * inner.a,
          outer.a * inner.x_m - outer.b * inner.y_m + outer.x_m,
          outer.b * inner.x_m + outer.a * inner.y_m + outer.y_m};
}

std::optional<Alignment> align(std::span<const PointPair> pairs, const AlignOptions& options) {
  require(options.spread_min_m > 0.0, "align: the least spread is greater than 0");
  const Moments m = moments(pairs);
  Alignment found{.map = {}, .basis = Basis::nothing, .pairs = pairs.size()};
  const double least =
      options.spread_min_m * options.spread_min_m * static_cast<double>(pairs.size());
  const double overlap = std::sqrt(m.dot * m.dot + m.cross * m.cross);
  // Places that lie about their centres without any common turn (a mirror image does) have z = 0.
  if (pairs.size() >= 2 && m.from_square >= least && m.to_square >= least &&
      overlap > 1e-9 * std::sqrt(m.from_square) * std::sqrt(m.to_square)) {
    const double by = options.scale ? m.from_square : overlap;
    found.map.a = m.dot / by;
    found.map.b = m.cross / by;
    found.basis = Basis::similarity;
  } else if (!options.optimistic) {
    return std::nullopt;
  } else if (!pairs.empty()) {
    found.basis = Basis::translation;
  }
  found.map.x_m = m.to_x - (found.map.a * m.from_x - found.map.b * m.from_y);
  found.map.y_m = m.to_y - (found.map.b * m.from_x + found.map.a * m.from_y);
  found.residual_m = residual(pairs, found.map);
  return found;
}

void common_places(std::span<const Place> from, std::span<const Place> to,
                   std::vector<PointPair>& out) {
  out.clear();
  auto theirs = from.begin();
  auto own = to.begin();
  while (theirs != from.end() && own != to.end()) {
    if (theirs->event < own->event) {
      ++theirs;
    } else if (own->event < theirs->event) {
      ++own;
    } else {
      out.push_back({(theirs++)->position, (own++)->position});
    }
  }
}

}  // namespace hearsay::trails
