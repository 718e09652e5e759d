// What a robot knows of trails: the crumbs of all events, and the places.
//
// What it holds depends on what was heard, not on the order, on repetitions, or on how it was cut
// into messages (as long as everything is heard before it vanishes, there are no more events than
// `events_max`, and a store that lets crumbs go after arrivals is not full): crumbs go in one order
// only, the oldest first (by age limit, by arrivals at their event, or because the store is full),
// and what is older than what had to go is not let in again. So a crumb that is heard again is
// known for ever, in memory that does not grow. Of a crumb heard twice with different positions (as
// robots on its way transformed it) the first stays.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "filters/trails/identity_table.hpp"
#include "filters/trails/space.hpp"
#include "filters/trails/trail.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay::trails {

/// What became of a crumb that a store was given.
enum class Fate : std::uint8_t {
  taken,    ///< it is news
  known,    ///< it is there already
  late,     ///< it has outlived its life
  no_room,  ///< older than what had to go from a full store, or of one event too many
  refused,  ///< no sound position, d, time or event; or laid in the future
};

/// How many crumbs met which fate, and how many went; a taken crumb ends in the last two or lives.
struct TrailCounts {
  std::uint64_t taken = 0, known = 0, late = 0, no_room = 0, refused = 0;
  std::uint64_t vanished = 0;  ///< of age or after arrivals
  std::uint64_t dropped = 0;   ///< the oldest of a full store
};

/// How far somebody was told what a store has learned. Starts before the first crumb.
struct Cursor {
  std::uint64_t next = 0;
};
/// Whose crumbs to tell.
struct News {
  bool own_only = false;  ///< not what was heard from others
  RobotId to = no_robot;  ///< leave out crumbs that this robot laid, or that were heard from it
  std::size_t crumbs_max = std::numeric_limits<std::size_t>::max();
};

struct StoreOptions {
  RobotId robot = 0;              ///< whose store it is
  std::size_t crumbs_max = 4096;  ///< ≥ 1
  std::size_t events_max = 16;    ///< ≥ 1
  /// A crumb vanishes when it is older (LOST 2002: 4 min); infinity for never. ≥ 0.
  double age_max_s = 240.0;
  /// A crumb vanishes after so many arrivals at its event since it was laid, that of its own robot
  /// included (Shamshirdar's program: about 11); 0 for never, at most 64.
  int life_arrivals = 0;
  /// Crumbs and places from further in the future are refused: how far clocks may differ.
  double ahead_max_s = 0.0;
};

template <LocalizationSpace S>
class TrailStore {
 public:
  using Position = typename S::Position;
  using Reach = typename S::Reach;
  using Crumb = CrumbOf<Position>;
  using Place = PlaceOf<Position>;

  /// @throws BrokenInvariant for options outside their ranges.
  explicit TrailStore(const StoreOptions& options, const typename S::Options& space = {});

  // Time goes on: each function with `now_s` first lets go of what has outlived its life.
  // @throws BrokenInvariant if it goes back or is not finite.

  void advance(double now_s);
  /// Takes a crumb in this robot's frame: own ones, and what came from `from`. O(log n).
  Fate merge(const Crumb& crumb, double now_s, RobotId from = no_robot);
  /// Takes a place in this robot's frame: the latest of an event replaces the one before. Each
  /// place of a new identity is an arrival, whether or not it is the latest. True if it replaced.
  bool merge(const Place& place, double now_s);
  /// Forgets all, as if nothing had ever been heard; counts stay, and cursors remain valid.
  void clear();

  /// Among the crumbs of `event` in reach the one to follow: of least d (LOST 2002's C; of equal
  /// ones the youngest). Null if there is none; valid until the next call that changes the store.
  const Crumb* best(EventId event, const Reach& reach, double now_s);
  /// All crumbs of `event` in reach (of all events for no_event), in the order of following.
  void within(EventId event, const Reach& reach, double now_s, std::vector<Crumb>& out);
  /// The youngest crumb in reach that was laid by a robot after another goal than `goal` (Sadat &
  /// Vaughan, "SO-LOST", 2010: an opposing crumb). Null if there is none; valid as best().
  const Crumb* opposing(EventId goal, const Reach& reach, double now_s);

  /// Appends crumbs learned since the cursor, in the order in which they were learned, and moves it
  /// behind them. Crumbs that went in between are not told.
  void news(Cursor& cursor, const News& what, double now_s, std::vector<Crumb>& out);

  std::size_t size() const { return table_.size(); }
  /// By event, rising.
  std::span<const Place> places() const { return places_; }
  const Place* place(EventId event) const;
  /// How much of its life a crumb has behind it, 0 … 1, at the time of the last call.
  double worn(const Crumb& crumb) const;
  const TrailCounts& counts() const { return counts_; }
  /// Calls f(crumb) for all, in the order in which they were learned.
  template <typename F>
  void for_each(F&& f) const {
    for (std::uint32_t slot = first_; slot != none; slot = slots_[slot].next) f(slots_[slot].crumb);
  }

 private:
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  static constexpr std::size_t arrivals_most = 64;
  struct Slot {
    Crumb crumb;
    RobotId from = no_robot;
    std::uint64_t learned = 0;
    std::uint32_t before = none, next = none;  ///< in the order in which they were learned
  };
  struct Event {
    EventId event = no_event;
    std::vector<std::uint32_t> heap;  ///< slots, the oldest on top
    std::vector<Age> arrivals;        ///< the latest, rising
  };
  /// Orders a heap so that the oldest is on top.
  auto younger() const {
    return [this](std::uint32_t a, std::uint32_t b) {
      return age_of(slots_[b].crumb) < age_of(slots_[a].crumb);
    };
  }
  bool outlived(const Crumb& crumb, const Event* event) const;
  bool sound(const Crumb& crumb) const;
  Event* find(EventId event);
  Event* find_or_add(EventId event);
  /// The event with the oldest crumb of all. Only if there is one.
  Event& oldest();
  void insert(const Crumb& crumb, RobotId from, Event& event);
  void remove_oldest(Event& event);
  Fate fate_of(const Crumb& crumb);

  StoreOptions options_;
  typename S::Index index_;
  double now_s_ = -std::numeric_limits<double>::infinity();
  std::vector<Slot> slots_;
  std::vector<std::uint32_t> free_;
  std::uint32_t first_ = none, last_ = none;  ///< learned
  std::uint64_t learned_ = 0;
  IdentityTable table_;
  std::vector<Event> events_;  ///< by event, rising
  std::vector<Place> places_;
  std::optional<Age> floor_;  ///< the youngest that had to go for room
  TrailCounts counts_;
};

using MetricStore = TrailStore<MetricSpace>;
using Crumb = CrumbOf<Point>;
using Place = PlaceOf<Point>;

}  // namespace hearsay::trails

#include "filters/trails/store_impl.hpp"
