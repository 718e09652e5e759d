// Where an exploring vehicle goes next: one cell on, to where a look is expected to tell most.
//
// Greedy after Merino 2007, section 4.3.1, eq. 4.24: of the moves it could make, a vehicle makes
// the one of greatest alpha·gain − beta·cost. It plans no further, and vehicles do not agree on
// anything: that they part is up to what they tell each other about the map.
//
// Moves of equal worth, to within 1e-12 of the largest amounts compared, are decided by a draw,
// each as likely; there is no draw where one move is best. So where no look tells anything,
//   – and beta = 0: every move is as good, and a vehicle walks at random (staying is a move, too);
//   – and beta > 0: a holonomic vehicle stays, the others go straight on as long as they can.
// The former stays for good, unless it is told something, once nothing in reach is worth its cost,
// and may leave land unseen: alone, it should have beta = 0.
// No rule finds an unknown patch beyond its view but by chance: that is what the horizon is for.
// (Detectors that err leave a little to be gained everywhere, and it goes where that is most.)
#pragma once

#include <concepts>
#include <cstdint>
#include <type_traits>

#include "filters/grid/area.hpp"
#include "filters/grid/gain.hpp"
#include "sim/kernel/random.hpp"

namespace hearsay {

class Exploration {
 public:
  enum class Choice : std::uint8_t {
    gain,         ///< eq. 4.24
    random_walk,  ///< any move but staying, each as likely; gains are not asked for
  };
  enum class Vehicle : std::uint8_t {
    /// Stays, or goes to the centre of one of the cells around that of its place, in the area.
    holonomic,
    /// Goes on by the length of a cell, after a turn by at most turn_max_rad, and never stays. The
    /// turn is one of `headings`, of those that lead to a place in the area. If none does, it turns
    /// towards the centre of the area, as far as it may. So one that began in the area is never
    /// farther from it than the diameter of the circle of its sharpest turns,
    /// cell_m/sin(turn_max_rad/2). (For which the area should have room.)
    constant_speed,
  };

  static constexpr int headings_max = 63;

  struct Options {
    Choice choice = Choice::gain;
    Vehicle vehicle = Vehicle::holonomic;
    /// Of a constant_speed vehicle: the largest turn, in (0, π), and how many turns it chooses
    /// from, evenly over [−turn_max_rad, turn_max_rad]; odd, 3 … headings_max, so that 0 is among
    /// them.
    double turn_max_rad = 0.78539816339744831;
    int headings = 5;
    /// How many cells ahead a move is judged, 1 … Area::side_max; 1 is the text's rule. The gain of
    /// a move is the sum of the gains of looks from 1, …, horizon cells ahead along the straight
    /// line, as far as it lies in the area. That is a heuristic: what two of these looks have in
    /// view counts twice. A look repeated from one place counts once, for it tells less each time:
    /// the gain of staying is that of one look, whatever the horizon.
    int horizon = 1;
    /// alpha and beta of eq. 4.24, ≥ 0, finite. The cost of a move is its length in cells (√2 from
    /// corner to corner), whatever the horizon, + |turn|/π; staying costs 0.
    grid::MoveWeights weights;
  };

  struct State {
    grid::Point place_m;
    /// From x towards y, in (−π, π]. Of a holonomic vehicle the direction of its last move, from
    /// the centre of a cell to the centre of the next; it is kept when it stays.
    double heading_rad = 0.0;
  };

  /// The gain, nats, expected of a look from a state: anything that can be called so. It is
  /// referred to, not copied.
  class Gain {
   public:
    template <class F>
    requires(!std::same_as<F, Gain> && std::is_invocable_r_v<double, const F&, const State&>)
        Gain(const F& f)
        : f_(&f), call_([](const void* g, const State& s) -> double {
            return (*static_cast<const F*>(g))(s);
          }) {}
    double operator()(const State& from) const { return call_(f_, from); }

   private:
    const void* f_;
    double (*call_)(const void*, const State&);
  };

  /// @throws BrokenInvariant for options outside their ranges.
  Exploration(const Options& options, const grid::Area& area);

  /// Where it is after its next move. Asks for at most 8·horizon + 1 (holonomic) or
  /// headings·horizon gains, each finite, and allocates nothing. @throws BrokenInvariant for a gain
  /// or a state that is not finite, and for a holonomic vehicle outside the area.
  State next(const State& here, const Gain& gain, Stream& draws) const;

  const Options& options() const { return options_; }

 private:
  struct Way;
  struct Ways;

  Ways around(const State& here) const;
  Ways ahead(const State& here) const;
  Way turned(const State& here, double turn_rad) const;
  State towards_centre(const State& here) const;
  grid::Move judged(const Way& way, const Gain& gain) const;
  State best(const Ways& ways, const Gain& gain, Stream& draws) const;

  Options options_;
  grid::Area area_;
};

}  // namespace hearsay
