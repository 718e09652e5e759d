// From one robot's frame into another's, by places that both know. Odometry frames of robots differ
// by rotation, translation and (wheels, slip) scale; events happen at the same places of the world,
// so that two places known to both tie the frames together (LOST 2002; Shamshirdar 2019, section
// 4.2.2).
#pragma once

#include <optional>
#include <span>

#include "filters/trails/store.hpp"

namespace hearsay::trails {

/// p ↦ z p + t, points as complex numbers: z = a + ib is scale and rotation. No z is a reflection.
struct Similarity {
  double a = 1.0, b = 0.0;      ///< scale · cos, scale · sin of the rotation
  double x_m = 0.0, y_m = 0.0;  ///< t
  Point apply(const Point& p) const {
    return point(a * p.x_m - b * p.y_m + x_m, b * p.x_m + a * p.y_m + y_m);
  }
  /// Distances grow by it.
  double scale() const;
  /// In (−π, π].
  double rotation_rad() const;
  /// Back again. Nothing if the scale is 0.
  std::optional<Similarity> inverse() const;
};
/// First `inner`, then `outer`.
Similarity chained(const Similarity& outer, const Similarity& inner);

/// A place as the sender has it, and as the receiver has it.
struct PointPair {
  Point from, to;
};

struct AlignOptions {
  /// What to do where the pairs do not give a rotation (none, one, or all in one place). False, the
  /// pessimistic way: nothing. True, the optimistic way: only translate (LOST 2002: one place), or
  /// copy as it is (no place).
  bool optimistic = false;
  /// False: robots whose odometry measures the same metre; rotation and translation only.
  bool scale = true;
  /// Places whose root mean square distance from their centre is less, in either frame, count as
  /// one place: at that distance their own errors (LOST 2002: an event is told within 1 m) turn the
  /// frame by any angle. > 0.
  double spread_min_m = 0.05;
};

enum class Basis : std::uint8_t { nothing, translation, similarity };

struct Alignment {
  Similarity map;                ///< from the sender's frame into the receiver's
  Basis basis = Basis::nothing;  ///< what the pairs gave
  std::size_t pairs = 0;
  double residual_m = 0.0;  ///< root mean square distance of mapped places from the receiver's own
};

/// The similarity of least squares, min Σ |to − z·from − t|²: with two pairs the one that maps both
/// exactly (residual 0). This is Umeyama's (IEEE PAMI 13(4), 1991) in closed form for the plane,
/// z = Σ conj(from)·to / Σ |from|² about the centres; without scale, z/|z| (Procrustes). Nothing
/// where `options` says so. @throws BrokenInvariant for a spread that is not > 0.
std::optional<Alignment> align(std::span<const PointPair> pairs, const AlignOptions& options);

/// The pairs of places of the same event; both by event, rising (as TrailStore::places() and
/// packets are). `out` is overwritten.
void common_places(std::span<const Place> from, std::span<const Place> to,
                   std::vector<PointPair>& out);

/// In the receiver's frame. Times and d stay as they are: d is time on the way, which is the same
/// in all frames.
inline Crumb mapped(Crumb crumb, const Similarity& map) {
  crumb.position = map.apply(crumb.position);
  return crumb;
}
inline Place mapped(Place place, const Similarity& map) {
  place.position = map.apply(place.position);
  return place;
}

}  // namespace hearsay::trails
