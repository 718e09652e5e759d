// An estimator of one moving state over its last T stamps, which may exchange what was measured at
// each stamp with others. Merino 2007, Algorithm 3.3 and section 3.2.2.
//
// Every agent holds the same model of the motion, once. What travels are measurements alone: for
// each stamp the sum of their information, a block-diagonal matrix. So late, lost and reordered
// messages do no harm: a newer message replaces an older one of the same sender, stamp by stamp.
//
//   belief = base (all that is older than the window) + motion + own + Σ heard from neighbour
//
// When the window moves on, its oldest stamp is marginalised into the base, with what every
// neighbour had said of it by then. Later news of it is dropped and counted: less information, but
// never the same twice. On a tree, all_but_yours is exact while every measurement reaches everybody
// before anybody marginalises its stamp.
#pragma once

#include <cstdint>
#include <vector>

#include "filters/gaussian/trajectory.hpp"
#include "sim/kernel/ids.hpp"

namespace hearsay {

/// What is told to a neighbour.
enum class TrajectoryExchange : std::uint8_t {
  own,            ///< what was measured here
  everything,     ///< what was measured here and heard, all of it added up over and over: naive
  all_but_yours,  ///< what was measured here and heard from others: channel-robust
};

class TrajectoryEstimator {
 public:
  using Stamp = gaussian::Stamp;
  struct Options {
    TrajectoryExchange exchange = TrajectoryExchange::all_but_yours;
    gaussian::Transition step;  ///< from a stamp to the next; n×n
    int steps_max = 20;         ///< T ≥ 1: stamps in the window
  };
  /// Knows nothing; its window is the stamp `first`.
  TrajectoryEstimator(Options options, Stamp first);

  int dimension() const { return static_cast<int>(options_.step.A.rows()); }
  Stamp first() const { return first_; }
  Stamp last() const { return last_; }
  int steps_max() const { return options_.steps_max; }

  /// The window reaches to `now` ≥ last() from here on.
  void advance(Stamp now);

  /// Something was measured here at a stamp up to last(). False, and it is counted as late, if that
  /// stamp is not in the window any more.
  bool measured(Stamp stamp, const gaussian::Belief& information);

  /// What was measured at a stamp, all in one.
  struct Entry {
    Stamp stamp;
    gaussian::Belief information;
  };
  struct Message {
    std::uint32_t incarnation = 0;
    std::uint32_t count = 0;
    Stamp first = 0;             ///< of older stamps it says nothing
    std::vector<Entry> entries;  ///< by stamp; a stamp that is missing has no information
  };
  /// Fills in what is to be said to `neighbour` now.
  void speak(AgentId neighbour, Message& message);

  /// Takes a message in. Older than the last one, of another dimension, out of order or about the
  /// future: it is refused and counted, and the answer is false.
  bool heard(AgentId from, const Message& message);

  /// The belief over the window, first() … last(). Valid until anything is called that is not
  /// const.
  const gaussian::Trajectory& belief();

  /// The belief about the state at last() alone: what a filter over all of it says, also while
  /// that does not determine it.
  gaussian::Belief present();

  /// Comes back from a reboot that lost the memory, at stamp `now`.
  void forget(Stamp now);

  struct Counts {
    std::uint64_t late = 0;     ///< measurements and entries with news of a stamp that is gone
    std::uint64_t refused = 0;  ///< messages
  };
  const Counts& counts() const { return counts_; }

 private:
  // Information by stamp, in a ring that also remembers what is gone from the window last.
  using Track = std::vector<gaussian::Belief>;
  struct Neighbour {
    AgentId id;
    bool heard = false;
    std::uint32_t incarnation = 0;
    std::uint32_t count = 0;
    Track said;
  };
  gaussian::Belief& at(Track& track, Stamp stamp) const { return track[place(stamp)]; }
  std::size_t place(Stamp stamp) const;
  Track blank() const;
  Neighbour& neighbour(AgentId id);
  gaussian::Belief all_of(Stamp stamp, AgentId but);
  bool usable(const Neighbour& from, const Message& message) const;
  void replace(Neighbour& from, Stamp stamp, const gaussian::Belief& information);

  Options options_;
  Stamp first_;
  Stamp last_;
  gaussian::Belief base_;
  Track own_;
  std::vector<Neighbour> neighbours_;  // by number
  gaussian::Trajectory trajectory_;
  bool current_ = false;  // trajectory_
  std::uint32_t incarnation_ = 0;
  std::uint32_t next_count_ = 1;
  Counts counts_;
};

}  // namespace hearsay
