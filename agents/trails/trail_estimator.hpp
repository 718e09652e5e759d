// What a robot knows of trails, how it lays its own, what it tells and how it takes in what others
// tell: LOST in the frame of its own odometry. Where crumbs lead and what d counts is said in
// filters/trails/laying.hpp, how frames are brought together in filters/trails/frames.hpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "filters/trails/codec.hpp"
#include "filters/trails/frames.hpp"
#include "filters/trails/laying.hpp"
#include "filters/trails/parameters.hpp"
#include "filters/trails/store.hpp"

namespace hearsay {

class TrailEstimator {
 public:
  struct Options {
    trails::StoreOptions store;
    double cell_m = 1.0;  ///< of the index: about the sense radius
    trails::Laying laying = trails::Laying::at_once;
    double interval_s = 1.0;             ///< S
    std::size_t trail_crumbs_max = 500;  ///< L, of a trail that is not told yet
    bool names_goal = false;             ///< crumbs laid at once say what the robot is after
    bool relay = false;                  ///< it tells what it heard, too
    bool as_is = false;                  ///< positions of others are taken for its own
    trails::AlignOptions align;          ///< else they are brought into its frame, or not taken
    std::size_t packet_bytes = 1400;
  };
  struct Counts {
    std::uint64_t laid = 0;       ///< crumbs
    std::uint64_t heard = 0;      ///< crumbs of packets that could be taken in
    std::uint64_t refused = 0;    ///< packets that are none
    std::uint64_t no_frame = 0;   ///< packets dropped: too few common places
    std::uint64_t abandoned = 0;  ///< trails that grew too long
  };
  /// @throws BrokenInvariant for options outside their ranges.
  explicit TrailEstimator(const Options& options);

  // Times are those of the robot's own clock; `way` is what d counts (laying.hpp).

  /// The robot is at the place of an event. @return the crumbs of a trail that this completes.
  std::span<const trails::Crumb> visit(trails::EventId event, const trails::Point& at, double now_s,
                                       double way);
  /// While it moves; at each step. `laid()` is the crumb, if it is told at once.
  trails::Laid lay(double now_s, const trails::Point& at, double way, trails::EventId goal);
  const trails::Crumb& laid() const { return laid_; }
  /// Forgets the trail that is not told yet.
  void set_off_anew() { temporary_.clear(); }
  /// It was carried elsewhere: no way leads from here to where it came from.
  void carried();
  /// Loses its memory.
  void forget();

  /// A packet from another robot. @return what it taught: crumbs that are new.
  std::span<const trails::Identity> heard(std::span<const std::byte> bytes, double now_s);
  /// Who sent the last packet that was one.
  trails::RobotId heard_from() const { return heard_from_; }
  /// Packets with its places and all that is new since it last spoke; none if there is nothing.
  /// Valid until the next call.
  std::span<const std::vector<std::byte>> speech(double now_s);

  trails::MetricStore& store() { return store_; }
  const trails::MetricStore& store() const { return store_; }
  const Counts& counts() const { return counts_; }

 private:
  void merge(const trails::Crumb& crumb, double now_s);

  Options options_;
  trails::MetricStore store_;
  trails::ReturnTrail<trails::Point> return_;
  trails::TemporaryTrail<trails::Point> temporary_;
  std::uint32_t incarnation_ = 0, messages_ = 0;
  trails::Numbering numbers_;
  trails::Cursor told_;
  bool places_changed_ = false;
  trails::MetricEncoder encoder_;
  Counts counts_;
  trails::Crumb laid_;
  std::vector<trails::Crumb> news_;
  std::vector<trails::Place> places_;
  std::vector<trails::PointPair> pairs_;
  std::vector<trails::Identity> taken_;
  trails::RobotId heard_from_ = trails::no_robot;
};

}  // namespace hearsay
