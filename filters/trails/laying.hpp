// How crumbs are laid: two ways, whose d are different quantities.
//
// TemporaryTrail (Shamshirdar 2019, section 4.2.4): crumbs wait until the robot comes to an event,
// and lead to that event. d = time from the crumb on to the arrival: the way that was gone.
//
// ReturnTrail (LOST 2002): a crumb is told when it is laid, and leads back to the event that the
// robot came from. d = time since the robot left it: the way as it was gone in the other direction.
// Robots that go to and fro between A and B lay, going to B, what those who go to A follow.
#pragma once

#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "filters/trails/trail.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay::trails {

/// Says when it is time again, every S seconds, for a caller who comes at steps of his own.
class Beat {
 public:
  /// @throws BrokenInvariant unless the interval is finite and > 0.
  explicit Beat(double interval_s) : interval_s_(interval_s) {
    require(interval_s > 0.0 && std::isfinite(interval_s), "laying: the interval is above 0");
  }
  /// True at the first time after a start, and then every interval. After a pause (a robot that
  /// does not move lays nothing) at once, and from then on. Times a billionth of an interval early
  /// pass: sums of steps are not exact.
  bool due(double now_s) {
    if (started_ && now_s < next_s_ - 1e-9 * interval_s_) return false;
    const double after = started_ ? next_s_ + interval_s_ : now_s + interval_s_;
    next_s_ = after > now_s + 1e-9 * interval_s_ ? after : now_s + interval_s_;
    started_ = true;
    return true;
  }
  void restart() { started_ = false; }

 private:
  double interval_s_;
  double next_s_ = 0.0;
  bool started_ = false;
};

enum class Laid : std::uint8_t {
  nothing,    ///< not yet time
  crumb,      ///< one more
  abandoned,  ///< longer than allowed: the trail is empty again, and its start should be too
};

/// A trail that is not told yet. P: position in a localization-space.
template <typename P>
class TemporaryTrail {
 public:
  struct Options {
    double interval_s = 1.0;       ///< S > 0
    std::size_t crumbs_max = 500;  ///< L: one more, and the trail is abandoned. ≥ 1
  };
  /// @throws BrokenInvariant for options outside their ranges.
  explicit TemporaryTrail(const Options& options) : options_(options), beat_(options.interval_s) {
    require(options.crumbs_max >= 1, "temporary trail: room for a crumb");
  }

  /// While the robot moves, at any steps. `way` is what d counts: time (then it is `now_s`), or
  /// anything else that grows on the way (Shamshirdar's program: steps that are no turns).
  /// @throws BrokenInvariant if time or way goes back or is not finite.
  Laid lay(double now_s, const P& position, double way) {
    require(std::isfinite(now_s) && std::isfinite(way), "temporary trail: finite time and way");
    require(crumbs_.empty() || (now_s >= crumbs_.back().created_s && way >= ways_.back()),
            "temporary trail: neither time nor way goes back");
    if (!beat_.due(now_s)) return Laid::nothing;
    if (crumbs_.size() == options_.crumbs_max) {
      clear();
      ++abandoned_;
      return Laid::abandoned;
    }
    CrumbOf<P>& crumb = crumbs_.emplace_back();
    crumb.position = position;
    crumb.created_s = now_s;
    ways_.push_back(way);
    return Laid::crumb;
  }
  Laid lay(double now_s, const P& position) { return lay(now_s, position, now_s); }

  /// At the place of an event: the crumbs laid since the start, with d counted back from here, by
  /// time of creation; their goal is this event. Valid until the next call; the trail is empty
  /// again. `way` as in lay().
  /// @throws BrokenInvariant if it is less than at the last crumb, or not finite.
  std::span<const CrumbOf<P>> complete(EventId event, double way, Numbering& numbers) {
    require(std::isfinite(way) && (ways_.empty() || way >= ways_.back()),
            "temporary trail: the way does not go back");
    finished_.swap(crumbs_);
    for (std::size_t i = 0; i < finished_.size(); ++i) {
      CrumbOf<P>& crumb = finished_[i];
      crumb.event = event;
      crumb.goal = event;
      crumb.distance_s = static_cast<float>(way - ways_[i]);
      crumb.identity = numbers.take();
    }
    clear();
    return finished_;
  }
  /// Forgets what was laid.
  void clear() {
    crumbs_.clear();
    ways_.clear();
    beat_.restart();
  }

  std::size_t size() const { return crumbs_.size(); }
  std::uint64_t abandoned() const { return abandoned_; }

 private:
  Options options_;
  Beat beat_;
  std::vector<CrumbOf<P>> crumbs_, finished_;
  std::vector<double> ways_;  ///< at each crumb
  std::uint64_t abandoned_ = 0;
};

/// Crumbs that lead back. P: position in a localization-space.
template <typename P>
class ReturnTrail {
 public:
  /// @throws BrokenInvariant unless the interval is finite and > 0.
  explicit ReturnTrail(double interval_s) : beat_(interval_s) {}

  /// The robot is at the place of an event. `way` as in TemporaryTrail. @throws BrokenInvariant if
  /// it is not finite.
  void visit(EventId event, double way) {
    require(std::isfinite(way), "return trail: the way must be finite");
    event_ = event;
    way_ = way;
  }
  /// While the robot moves; every S seconds a crumb, but none before the first event. `goal`: what
  /// it is after, no_event if that is not to be told. @throws BrokenInvariant if the way is less
  /// than at the event, or time or way is not finite.
  std::optional<CrumbOf<P>> lay(double now_s, const P& position, double way, EventId goal,
                                Numbering& numbers) {
    require(std::isfinite(now_s) && std::isfinite(way), "return trail: finite time and way");
    require(event_ == no_event || way >= way_, "return trail: the way does not go back");
    if (event_ == no_event || !beat_.due(now_s)) return std::nullopt;
    return CrumbOf<P>{event_, goal,          position, static_cast<float>(way - way_),
                      now_s,  numbers.take()};
  }
  std::optional<CrumbOf<P>> lay(double now_s, const P& position, EventId goal, Numbering& numbers) {
    return lay(now_s, position, now_s, goal, numbers);
  }
  EventId last_event() const { return event_; }

 private:
  Beat beat_;
  EventId event_ = no_event;
  double way_ = 0.0;
};

}  // namespace hearsay::trails
