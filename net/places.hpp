// Where moving radios are, and who is near whom.
//
// Each agent has a leg of its path (sim/kernel/leg.hpp), so its place is exact at any time. To find
// who is near, agents are filed in a grid over x and y (net/place_grid.hpp) where they are at that
// time, and count as candidates there until they are farther than a slack from it. A look-up goes
// through the cells that reach plus slack touch, and works out where each candidate within reach
// plus slack is at the time asked for. Somebody must file an agent anew by the time that set() and
// refresh() give: net/movement.hpp does.
//
// What a look-up finds depends on legs and time alone, not on slack or on who was filed when.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "net/place_grid.hpp"
#include "sim/kernel/ids.hpp"
#include "sim/kernel/leg.hpp"
#include "sim/kernel/time.hpp"

namespace hearsay {

/// Somebody whom a look-up found.
struct Nearby {
  AgentId agent;
  double squared_distance_m2;
};

class Places {
 public:
  /// For agents 0 … agents−1, none of which is anywhere yet. Look-ups are quickest at `reach_m`.
  /// With more slack agents are filed anew less often, and look-ups see more candidates: a tenth to
  /// a half of the reach serves most. It may be 0 if nobody moves in x and y.
  /// @throws InputError unless agents is 1 … 1e7, reach_m > 0 and slack_m ≥ 0, both finite.
  Places(int agents, double reach_m, double slack_m);

  /// From `now` on `agent` moves along `leg`, which has begun and is not over.
  /// @return the last time (> now) at which look-ups find it. By then it must be set() again, if
  /// its leg is over, or else at least refresh()ed.
  /// @throws BrokenInvariant if it is not within ±1e13 m in x and y, or moves and there is no
  /// slack.
  Time set(AgentId agent, const Leg& leg, Time now);
  /// Files it where it is now. Return and errors as for set().
  Time refresh(AgentId agent, Time now);

  /// The leg of `agent`, which was set.
  const Leg& leg(AgentId agent) const { return legs_[static_cast<std::size_t>(agent)].leg; }
  /// Where it is at a time within its leg.
  Point at(AgentId agent, Time time) const { return leg(agent).at(time); }

  /// All others within the constructor's `reach_m` (inclusive, in three dimensions) of `agent` at
  /// `time`, by number. The distance from a to b has the bits of that from b to a. `time` is
  /// neither before anybody was last filed nor after what that returned. The result is valid until
  /// the next look-up.
  std::span<const Nearby> near(AgentId agent, Time time);
  /// Likewise everybody within `reach_m` ≥ 0 of a place.
  std::span<const Nearby> around(const Point& place_m, double reach_m, Time time);

  int agents() const { return static_cast<int>(legs_.size()); }
  double reach_m() const { return reach_m_; }

 private:
  struct alignas(64) OwnLeg {  // a line of the cache
    Leg leg;
  };
  struct Look;
  struct Cells;
  std::int64_t cell_number(double coordinate_m) const;
  std::span<const Nearby> look(const Point& place_m, double reach_m, Time time, AgentId except);
  void collect(const Look& look);
  void collect_from_tile(const Look& look, const Cells& cells, const PlaceGrid::Line* tile,
                         std::int64_t column, std::int64_t row);
  void collect_from(const Look& look, const PlaceGrid::Line& line, float x, float y);
  void sort_candidates();

  double reach_m_;
  double slack_m_;
  double cell_m_;
  double cells_per_m_;
  double largest_m_ = 0.0;  // coordinate so far: rounding is proportional to it
  std::vector<OwnLeg> legs_;
  PlaceGrid grid_;
  std::vector<AgentId> candidates_, sorted_;
  std::size_t candidate_count_ = 0;
  std::vector<Nearby> hits_;
};

}  // namespace hearsay
