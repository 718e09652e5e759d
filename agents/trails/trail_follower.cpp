#include "agents/trails/trail_follower.hpp"

#include <algorithm>
#include <cmath>

#include "sim/kernel/error.hpp"

namespace hearsay {

TrailFollower::TrailFollower(const Options& options)
    : options_(options), chance_(options.random_chance) {
  require(options.sense_radius_m > 0.0 && std::isfinite(options.sense_radius_m),
          "trail follower: the sense radius is above 0");
  require(options.random_chance >= 0.0 && options.random_chance <= 1.0 &&
              options.random_falls_by >= 0.0,
          "trail follower: a chance is 0 … 1, and does not grow");
}

bool TrailFollower::moves_at_random(double now_s, double worn, Stream& draws) {
  if (options_.random_chance == 0.0) return false;
  if (!next_move_s_ || now_s >= *next_move_s_ - 1e-9) {
    next_move_s_ = now_s + move_s;
    const bool drawn = draws.bernoulli(chance_);
    random_move_ = drawn && worn < worn_share;
    if (options_.fading == trails::Fading::per_iteration) {
      chance_ = std::max(0.0, chance_ - options_.random_falls_by);
    }
  }
  return random_move_;
}

TrailFollower::Choice TrailFollower::choose(trails::MetricStore& store, trails::EventId goal,
                                            const drive::Pose& here, double now_s,
                                            double free_left_m, Stream& draws) {
  if (next_look_s_ && now_s < *next_look_s_ - 1e-9) return chosen_;
  next_look_s_ = now_s + look_s;
  chosen_ = look(store, goal, here, now_s, free_left_m, draws);
  return chosen_;
}

TrailFollower::Choice TrailFollower::look(trails::MetricStore& store, trails::EventId goal,
                                          const drive::Pose& here, double now_s, double free_left_m,
                                          Stream& draws) {
  trails::MetricReach reach{.at = trails::point(here.x_m, here.y_m),
                            .radius_m = options_.sense_radius_m};
  // Who believes himself beyond all positions has nothing near.
  if (!trails::MetricSpace::sound(reach.at)) return {};
  if (options_.field_rad) reach.field = trails::Field{here.heading_rad, *options_.field_rad};
  const trails::Crumb* const best = store.best(goal, reach, now_s);
  if (best == nullptr) return {};
  const bool at_end = options_.trail_end_s && best->distance_s <= *options_.trail_end_s;
  if (at_end && options_.trail_end == TrailEnd::explore) return {};
  if (at_end && options_.trail_end == TrailEnd::search) return {Way::search, best->position};
  if (moves_at_random(now_s, store.worn(*best), draws)) return {};
  const trails::Crumb crumb = *best;
  if (options_.lanes == Lanes::none) return {Way::follow, crumb.position};
  return {Way::follow, in_lane(store, crumb, goal, here, now_s, free_left_m)};
}

trails::Point TrailFollower::in_lane(trails::MetricStore& store, const trails::Crumb& best,
                                     trails::EventId goal, const drive::Pose& here, double now_s,
                                     double free_left_m) const {
  if (best.distance_s <= lane_end_s) return best.position;
  const trails::MetricReach reach{.at = trails::point(here.x_m, here.y_m),
                                  .radius_m = opposing_reach_m};
  const trails::Crumb* const opposing = store.opposing(goal, reach, now_s);
  if (opposing == nullptr || opposing->distance_s <= lane_end_s) return best.position;
  const double dx = best.position.x_m - here.x_m, dy = best.position.y_m - here.y_m;
  const double length_m = std::sqrt(dx * dx + dy * dy);
  if (length_m < 1e-6) return best.position;
  const double shift_m = lane_ * std::min(lane_max_m, std::max(0.0, free_left_m));
  return trails::point(best.position.x_m - dy / length_m * shift_m,
                       best.position.y_m + dx / length_m * shift_m);
}

void TrailFollower::arrived(Stream& draws) {
  if (options_.fading == trails::Fading::per_success) {
    chance_ = std::max(0.0, chance_ - options_.random_falls_by);
  }
  if (options_.lanes == Lanes::highway) lane_ = draws.bernoulli(0.5) ? 0.75 : 0.25;
  reset();
}

}  // namespace hearsay
