// Whether agents agree: how far their estimates of a subject lie apart, and since when they have
// been near one another.
//
// Who is down takes no part. An agent that is up but has no estimate (it knows nothing yet, or not
// every direction) agrees with nobody. The estimate of an indefinite belief is what its user
// computes, Ω⁻¹ξ, and counts as any other: it may lie anywhere.
#pragma once

#include <optional>

#include "filters/gaussian/belief.hpp"
#include "sim/kernel/time.hpp"

namespace hearsay {

/// The box around all estimates of one subject: distances to the farthest other estimate follow
/// from it alone, so that n agents cost n steps, not n².
class Spread {
 public:
  /// `dimension` of the state, 1 … gaussian::dimension_max.
  explicit Spread(int dimension);
  void clear();
  /// One that takes part: its estimate, or nothing if it has none. Estimates that are not finite
  /// count as none.
  void add(const std::optional<gaussian::Vector>& estimate);

  /// Largest distance along an axis from `estimate`, one of those added, to any other. Nothing
  /// while fewer than two have one.
  std::optional<double> farthest(const gaussian::Vector& estimate) const;
  /// Largest distance along an axis between any two. Nothing while fewer than two have one.
  std::optional<double> width() const;
  /// Those that take part and have no estimate.
  int without_estimate() const { return without_; }

 private:
  gaussian::Vector low_, high_;
  int count_ = 0;
  int without_ = 0;
};

/// Since when all agree, from sample to sample.
class Agreement {
 public:
  struct Options {
    Time from;        ///< first sample; time is counted from here, such as from a heal
    double within_m;  ///< agree: no two estimates farther apart than this along an axis, > 0
    Duration period;  ///< between samples, > 0
  };
  explicit Agreement(const Options& options) : options_(options) {}

  const Options& options() const { return options_; }
  /// Do all that take part agree on this subject?
  bool holds(const Spread& spread) const;
  /// A sample, in order of time: did all agree on all subjects?
  void sample(Time now, bool agreed);
  /// Time of the last sample, if there was one.
  std::optional<Time> last_sample() const { return last_; }
  /// From Options::from to the first sample from which on all samples agreed, s; ∞ if the last one
  /// did not.
  double agree_again_s() const;

 private:
  Options options_;
  std::optional<Time> since_;
  std::optional<Time> last_;
};

}  // namespace hearsay
