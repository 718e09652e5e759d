// In which directions a round robot can go, from what its scanner sees.
//
// The circle around the robot is cut into sectors. Whatever is seen within a look-ahead blocks the
// directions in which the disc would come nearer to it than a clearance: those within
// asin(clearance / distance) of it. That is the vector field histogram (J. Borenstein, Y. Koren,
// IEEE Trans. Robotics and Automation 7(3), 1991), with obstacles enlarged by the robot and a
// choice by cost as in VFH+ (I. Ulrich, J. Borenstein, ICRA 1998), for one scan and without a map.
//
// Directions are bearings: relative to the heading, counter-clockwise, in (−π, π]. What no ray
// looks at is not known, and not blocked unless by something seen next to it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sim/kernel/random.hpp"
#include "sim/world/ray_caster.hpp"

namespace hearsay {

class FreeDirections {
 public:
  static constexpr int sectors = 180;

  /// `fan` must outlive it. @throws BrokenInvariant unless 0 < range_m < ∞, and for a fan that has
  /// no field of view or more than 65535 rays.
  FreeDirections(const plan::Fan& fan, double range_m);

  /// Takes a scan, which must stay while it is asked, and blocks nothing. @throws BrokenInvariant
  /// if there is not one distance ≥ 0 a ray.
  void look(std::span<const double> scan_m);

  /// Blocks the directions that lead nearer than `clearance_m` > 0 to what is seen within
  /// `within_m` > 0, and frees all others. Within the clearance all is blocked that does not lead
  /// away.
  void block(double clearance_m, double within_m);

  static double bearing_rad(int sector);
  /// The sector of a bearing, which is brought to (−π, π].
  static int sector(double bearing_rad);

  bool free(int sector) const { return blocked_[at(sector)] == 0; }
  /// Whether a ray looks there.
  bool seen(int sector) const { return seen_[at(sector)] != 0; }
  /// To the nearest thing in a sector; the range, where no ray looks.
  double open_m(int sector) const { return open_m_[at(sector)]; }
  /// In any scan, along the ray next to a bearing; the range, where none looks.
  double ray_m(std::span<const double> scan_m, double bearing_rad) const;
  /// How far a disc of that radius gets straight on before it touches what is seen.
  double ahead_m(double radius_m) const;

  struct Wish {
    double bearing_rad = 0.0;
    std::optional<double> before_rad;  ///< what was chosen last, as a bearing
  };
  struct Choice {
    double bearing_rad, cost_rad;
  };
  /// The free direction that is seen and of least cost: how far off the wish it is (a little more
  /// to the left, so that two who meet pass each other on the right), plus a share of how far off
  /// the last one and of how far off the heading. The wish itself, if it is free or not in view.
  std::optional<Choice> nearest(const Wish& wish) const;
  /// The first direction from a bearing on, counter-clockwise or clockwise, that is free, or that
  /// is blocked.
  std::optional<double> first(bool free_one, double from_rad, bool counter_clockwise) const;
  /// A free direction that is seen, at most so far off the heading, at random in proportion to how
  /// far it is open there.
  std::optional<double> any(Stream& draws, double off_max_rad) const;
  /// Of all that is seen, free or not, the direction in which it is farthest to anything.
  double most_open() const;

 private:
  static std::size_t at(int sector) { return static_cast<std::size_t>(sector); }
  static constexpr int quotients = 1024;
  /// The ray next to a bearing; their number, where none looks.
  std::size_t ray_at(double bearing_rad) const;

  const plan::Fan& fan_;
  double range_m_, view_rad_;
  std::span<const double> scan_m_;
  struct Share {
    std::uint8_t sector;
    std::uint16_t ray;
  };
  std::vector<std::uint8_t> sector_of_ray_;
  std::vector<Share> between_;  // sectors in view without a ray, each with the ray next to it
  std::array<std::uint8_t, quotients + 1> half_width_{};  // asin, in sectors
  std::array<std::uint8_t, sectors> seen_{};
  std::array<double, sectors> open_m_{};
  std::array<std::int16_t, sectors + 1> edges_{};
  std::array<std::int16_t, sectors> blocked_{};
};

}  // namespace hearsay
