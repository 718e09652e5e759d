// What a tracker knows, for who looks into its mind: the witness of its run.
#pragma once

#include <vector>

#include "filters/tracking/tracker.hpp"

namespace hearsay {

class TrackMind {
 public:
  virtual ~TrackMind() = default;
  /// Of when its tracks are, by its clock in ns.
  virtual gaussian::Stamp track_stamp() const = 0;
  virtual std::vector<tracking::Report> confirmed_tracks() const = 0;
};

}  // namespace hearsay
