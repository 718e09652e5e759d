// A tracker of objects whose number is not known: scans with false alarms and missed detections in,
// tracks out. It knows no clock and no radio; other trackers' tracks come in as labels and beliefs.
//
// A track is a label, a Gaussian belief about (position, velocity) or position, and its history. A
// scan is matched first to confirmed tracks, then what is left of it to tentative ones; a plot
// nobody claims begins a tentative track. What another tracker tells is matched by a label table
// and fused by a rule that needs no memory. Merino 2007, sections 3.7–3.8; birth by m hits out of n
// scans is common practice (Bar-Shalom & Fortmann 1988).
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "filters/gaussian/distance.hpp"
#include "filters/gaussian/fusion.hpp"
#include "filters/gaussian/trajectory.hpp"
#include "filters/tracking/label_table.hpp"

namespace hearsay::tracking {

struct Track {
  Label label = 0;  ///< never used again by this tracker
  gaussian::Belief belief;
  bool confirmed = false;
  bool seen = false;  ///< by this tracker's own scans; else known from others alone
  int scans = 0;      ///< that could have seen it
  int hits = 0;       ///< of these
  int misses = 0;     ///< in a row, up to now
  /// Of this tracker's own plots, if the tracker keeps trails; nothing while it has no plot.
  std::optional<gaussian::Trajectory> trail;
};

/// A track as it is told to others.
struct Report {
  Label label = 0;
  gaussian::Belief belief;
  std::optional<gaussian::Trajectory> trail;  ///< if it has one
};

/// Where a scan would have seen an object: within `range` of `centre` (one entry an axis).
/// By default everywhere.
struct Coverage {
  gaussian::Vector centre;
  double range = std::numeric_limits<double>::infinity();
};

class Tracker {
 public:
  struct Options {
    int axes = 2;  ///< of a position, 1 … 4
    /// White-noise acceleration, m²/s³, with n = 2·axes; 0: objects stand still, n = axes.
    double q = 0.1;
    double seconds_per_stamp = 1e-9;
    /// For q > 0: of a velocity nothing is known about, m/s an axis.
    double birth_speed_sigma = 10.0;
    double gate = gate_of_merino;  ///< of d², scan to track and track to track
    Pairing pairing = Pairing::nearest;
    int confirm_hits = 3;      ///< a track is confirmed by m hits …
    int confirm_scans = 4;     ///< … among its first n scans, 1 ≤ m ≤ n, else it ends
    int misses_max = 5;        ///< a confirmed track ends at so many misses in a row, ≥ 1
    double sigma_max = 100.0;  ///< a track ends where √(tr Σ/axes) of its position is larger, m
    int tracks_max = 1000;     ///< no track begins beyond, ≥ 1
    gaussian::Rule rule = gaussian::Rule::none;  ///< one that remembers nothing and sends beliefs
    int apart_max = 3;                           ///< see LabelTable
    /// For q > 0, ≥ 0: trails are kept for so long, and tracks of others are compared by them, too;
    /// 0: by their states alone.
    gaussian::Stamp trail = 0;
  };
  /// Without tracks, at stamp `start`. @throws BrokenInvariant outside the ranges above.
  Tracker(const Options& options, gaussian::Stamp start);

  /// Moves all tracks on to a stamp. False, and nothing changes, if it lies in the past.
  bool predict_to(gaussian::Stamp stamp);

  /// Uses a scan: position measurements of that stamp, in any order, of which each object gives at
  /// most one. False, and counted as late, if the stamp lies in the past.
  /// @throws BrokenInvariant if a plot has other than `axes` axes or no covariance.
  bool scan(gaussian::Stamp stamp, std::span<const gaussian::PositionMeasurement> plots,
            const Coverage& coverage = {});

  /// Uses all tracks that agent `from` had at `stamp`, moved on to now. Where both a track of mine
  /// and one of theirs have a trail with common stamps, the farther apart of states and trails
  /// counts (trail_separation()). Under the rule `none` nothing happens. What cannot be a belief
  /// about such an object, or bears a label twice, is refused and counted. False, and all is
  /// refused, if the stamp lies in the future: predict_to(now) first.
  bool heard(std::uint32_t from, gaussian::Stamp stamp, std::span<const Report> reports);
  /// Agent `from` counts its labels anew.
  void forget(std::uint32_t from) { table_.forget(from); }

  /// What is told to others: the confirmed tracks.
  std::vector<Report> reports() const;

  gaussian::Stamp stamp() const { return stamp_; }
  /// By label.
  std::span<const Track> tracks() const { return tracks_; }
  /// M (axes×n): what is measured of a state.
  const gaussian::Matrix& position_of_state() const { return M_; }
  /// Mean and covariance of a track's position.
  std::optional<gaussian::Expected> position(const Track& track) const {
    return gaussian::expected(track.belief, M_);
  }
  const LabelTable& labels() const { return table_; }

  struct Counts {
    std::uint64_t scans = 0, plots = 0;
    std::uint64_t late = 0;  ///< scans of the past
    std::uint64_t born = 0;  ///< from plots
    std::uint64_t born_of_hearsay = 0;
    std::uint64_t confirmed = 0;  ///< of all, by own scans or by others
    std::uint64_t ended_unconfirmed = 0, ended_missed = 0, ended_uncertain = 0;
    std::uint64_t no_room = 0;  ///< tracks that were not begun
    std::uint64_t fusions = 0;
    std::uint64_t skipped = 0;  ///< beliefs the rule could not use
    std::uint64_t apart = 0;    ///< beliefs outside the gate of their partner
    std::uint64_t buried = 0;   ///< beliefs about what this tracker has given up
    std::uint64_t refused = 0;  ///< reports that are none
    Counts& operator+=(const Counts& other);
  };
  const Counts& counts() const { return counts_; }

 private:
  enum class End { no, unconfirmed, missed, uncertain };
  void match(std::span<const gaussian::PositionMeasurement> plots, const Coverage& coverage,
             bool confirmed, std::vector<char>& used);
  void note(Track& track, bool hit, bool covered);
  End end_of(const Track& track) const;
  void end_tracks();
  Track* begin();
  void begin_at(const gaussian::PositionMeasurement& plot);
  gaussian::Belief born_of(const gaussian::PositionMeasurement& plot) const;
  void leave_trail(Track& track, const gaussian::PositionMeasurement& plot) const;
  bool usable(const gaussian::Belief& belief) const;
  std::optional<gaussian::Belief> arrived(const gaussian::Belief& belief,
                                          gaussian::Stamp stamp) const;
  struct Arrival {
    std::optional<gaussian::Belief> belief;  // as of now; nothing if it is none
    const gaussian::Trajectory* trail = nullptr;
  };
  Table separations(std::span<const Arrival> arrivals) const;
  double separation(const Arrival& theirs, const Track& mine) const;
  void follow(const LabelTable::Decision& decision, const std::optional<gaussian::Belief>& belief,
              std::uint32_t from, Label theirs);
  bool fuse(Track& track, const gaussian::Belief& received);
  void confirm(Track& track);

  Options options_;
  int n_;
  gaussian::Matrix M_;
  gaussian::Stamp stamp_;
  std::vector<Track> tracks_;
  LabelTable table_;
  Label next_label_ = 0;
  Counts counts_;
};

}  // namespace hearsay::tracking
