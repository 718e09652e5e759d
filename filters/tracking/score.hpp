// What one who knows the truth says about a tracker: how far off it is, what it misses, what it
// invents, and whether its labels stay with what they named.
//
// A label stays with the truth it followed as long as both are nearer than the cut-off to each
// other; what is left is assigned anew (as in the CLEAR MOT metrics; Bernardin & Stiefelhagen,
// EURASIP J. Image and Video Processing, 2008). So two tracks whose objects cross are not said to
// have swapped labels before they have parted on the wrong sides. OSPA and GOSPA know no labels.
#pragma once

#include <cstdint>
#include <map>
#include <span>

#include "filters/tracking/label_table.hpp"
#include "filters/tracking/ospa.hpp"

namespace hearsay::tracking {

/// An object that is there, by number, or a track that claims one, by label.
struct Placed {
  std::uint32_t name = 0;
  gaussian::Vector position;
};

class TrackScore {
 public:
  struct Options {
    double p = 2.0;  ///< order of OSPA and GOSPA, 1 ≤ p < ∞
    double cutoff_m =
        10.0;  ///< c of both, > 0; nothing farther away than this is a track of an object
  };
  /// @throws BrokenInvariant outside these ranges.
  explicit TrackScore(const Options& options);

  struct Sample {
    Ospa ospa;
    Gospa gospa;
    int missed = 0;        ///< objects without a track
    int false_tracks = 0;  ///< tracks with no object near
    int duplicates = 0;    ///< second and further tracks of an object
    int merged = 0;        ///< among these: tracks that followed another object before
  };
  /// Compares tracks with objects at one instant, later than those before. Names are different
  /// ones. A label that is missing once has ended. @throws BrokenInvariant if dimensions differ.
  Sample sample(std::span<const Placed> truths, std::span<const Placed> tracks);

  struct Counts {
    std::uint64_t label_swaps = 0;  ///< a label went over to another object than it followed before
    std::uint64_t label_changes =
        0;  ///< an object got a label that was new, or its own of old, for another
    std::uint64_t merged_tracks = 0;  ///< a track became a second one of another object
  };
  const Counts& counts() const { return counts_; }

 private:
  std::vector<int> keep(const Table& distances, std::span<const Placed> truths,
                        std::span<const Placed> tracks) const;
  void pair_rest(const Table& distances, std::vector<int>& truth_of) const;
  void book(std::uint32_t truth, Label label);
  void judge_unpaired(const Table& distances, std::span<const Placed> truths, const Placed& track,
                      int row, Sample& sample);

  Options options_;
  // A label that is there, and what it followed last.
  struct Follows {
    std::uint32_t truth;
    bool merged = false;
  };
  std::map<Label, Follows> follows_;
  std::map<std::uint32_t, Label> label_of_;  // of each object, the last
  Counts counts_;
};

}  // namespace hearsay::tracking
