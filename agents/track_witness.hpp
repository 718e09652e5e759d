// The omniscient witness of a run with trackers: now and then it compares everybody's tracks with
// the truth. No agent can ask it anything, and none is changed by being looked at.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "agents/target_truth.hpp"
#include "agents/track_mind.hpp"
#include "filters/tracking/score.hpp"
#include "sim/kernel/simulation.hpp"

namespace hearsay {

class TrackWitness {
 public:
  struct Options {
    std::span<const TargetTruth> targets;  ///< they outlive the witness
    tracking::TrackScore::Options score;
    Duration period;  ///< > 0: samples at 0, period, … and at the end
    // Which are kept over time; counts of labels and tracks are always left at the end.
    bool gospa_m = false, ospa_m = false, missed_targets = false, false_tracks = false,
         double_tracks = false;
  };
  /// `simulation` must outlive the witness.
  TrackWitness(Simulation& simulation, const Options& options);

  /// From now on `agent`'s confirmed tracks are compared. Agents in ascending number.
  /// `mind` is there until finish() is over.
  void watch(AgentId agent, const TrackMind& mind);

  /// Schedules the samples up to the end of the run. Once, before it starts.
  void start();
  /// Takes the last sample (unless it was due at this very instant) and leaves final values.
  void finish();

 private:
  struct Watched {
    AgentId agent;
    const TrackMind* mind;
    tracking::TrackScore score;
  };
  void schedule_sample(Time at);
  void sample();
  void keep(AgentId agent, const tracking::TrackScore::Sample& sample);

  Simulation& simulation_;
  Options options_;
  std::vector<Watched> watched_;
  std::optional<Time> last_sample_;
};

}  // namespace hearsay
