// Which links are up now, in the course of a run.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "net/link_plan.hpp"

namespace hearsay {

/// Goes through the changes of a plan. A link is named by its number in the topology; both of its
/// directions are always in the same state.
class LinkStates {
 public:
  /// Stands at time 0, with what changes then done. Both must outlive this; `changes` as in
  /// LinkPlan (BrokenInvariant for a link that the topology does not have). Without changes it
  /// costs nothing.
  LinkStates(const Topology& topology, std::span<const LinkChange> changes);

  /// When the next change is due; never() if none is left.
  Time next_change() const {
    return next_ < changes_.size() ? changes_[next_].time : Time::never();
  }
  /// Does all changes up to `now`, inclusive. @throws BrokenInvariant if `now` lies before the
  /// instant of an earlier call.
  void advance(Time now);

  /// True if the link 0 … links() − 1 is up.
  bool up(std::size_t link) const { return up_.empty() || up_[link] != 0; }
  /// True if the link is up and has been since `time`, without interruption.
  bool up_since(std::size_t link, Time time) const {
    return up_.empty() || (up_[link] != 0 && changed_[link] <= time);
  }

 private:
  const Topology* topology_;
  std::span<const LinkChange> changes_;
  std::size_t next_ = 0;
  Time now_;
  std::vector<std::uint8_t> up_;  // a directed link; empty without changes
  std::vector<Time> changed_;     // at the last change, a directed link
};

}  // namespace hearsay
