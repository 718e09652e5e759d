// Where a robot heads that follows trails: the crumb of least d near, moved aside to keep lanes
// apart; or nowhere in particular.
#pragma once

#include <optional>

#include "filters/trails/parameters.hpp"
#include "filters/trails/store.hpp"
#include "sim/kernel/random.hpp"
#include "sim/world/differential_drive.hpp"

namespace hearsay {

class TrailFollower {
 public:
  /// What it does where d of the best crumb is small, and the event has not happened.
  enum class TrailEnd {
    explore,  ///< LOST 2002: leaves the trail and explores, as long as the crumb is near
    search,   ///< Shamshirdar 2019: looks about near the crumb
    none,     ///< stays on the trail: trail shortening
  };
  /// How those who go and those who come keep out of each other's way.
  enum class Lanes {
    none,
    so_lost,  ///< Sadat & Vaughan, "SO-LOST", ALife 2010: by λ/2 to the left of opposing crumbs
    highway,  ///< Abdelaal et al., "LOST Highway", CRV 2017: two lanes, drawn trip by trip (here:
              ///< by λ/4 or 3λ/4)
  };
  struct Options {
    double sense_radius_m = 1.0;        ///< r
    std::optional<double> field_rad;    ///< Blinkered LOST: crumbs in view alone
    std::optional<double> trail_end_s;  ///< nothing: as if TrailEnd::none
    TrailEnd trail_end = TrailEnd::explore;
    Lanes lanes = Lanes::none;
    /// Local search: now and then a random move instead of the crumb's.
    double random_chance = 0.0;  ///< ε at first
    double random_falls_by = 0.0;
    trails::Fading fading = trails::Fading::per_success;
  };
  static constexpr double opposing_reach_m = 2.0;  ///< SO-LOST
  static constexpr double lane_max_m = 2.0;        ///< λ ≤ this
  static constexpr double lane_end_s = 2.0;        ///< nearer to an event there are no lanes
  static constexpr double move_s = 1.0;            ///< of a random move, or none
  static constexpr double look_s = 0.5;            ///< it looks for crumbs so often
  /// A robot stops its local search when what it follows has lived so much of its life: the best
  /// way known is walked before it is forgotten.
  static constexpr double worn_share = 0.7;

  /// @throws BrokenInvariant for options outside their ranges.
  explicit TrailFollower(const Options& options);

  enum class Way { explore, follow, search };
  struct Choice {
    Way way = Way::explore;
    trails::Point target;  ///< to follow, or the centre of the search; in the robot's frame
  };
  /// `free_left_m`: the distance that its scanner finds free on its left.
  /// What was chosen is kept until it is time to look again, or it arrives.
  Choice choose(trails::MetricStore& store, trails::EventId goal, const drive::Pose& here,
                double now_s, double free_left_m, Stream& draws);
  /// It came to the event it was after.
  void arrived(Stream& draws);
  /// Looks anew at once.
  void reset() {
    next_look_s_.reset();
    next_move_s_.reset();
  }
  double random_chance() const { return chance_; }

 private:
  Choice look(trails::MetricStore& store, trails::EventId goal, const drive::Pose& here,
              double now_s, double free_left_m, Stream& draws);
  bool moves_at_random(double now_s, double worn, Stream& draws);
  trails::Point in_lane(trails::MetricStore& store, const trails::Crumb& best, trails::EventId goal,
                        const drive::Pose& here, double now_s, double free_left_m) const;

  Options options_;
  double chance_;
  double lane_ = 0.5;  ///< share of λ
  Choice chosen_;
  std::optional<double> next_look_s_;  ///< when to look again
  std::optional<double> next_move_s_;  ///< when to draw again
  bool random_move_ = false;
};

}  // namespace hearsay
