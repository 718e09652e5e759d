// The omniscient witness of a run with certainty grids: it hears every look at once, keeps the
// central grid, and now and then compares everybody's grid with it, with the truth and with the
// others'. No agent can ask it anything, and none is changed by being looked at.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "agents/grids/grid_estimator.hpp"
#include "filters/grid/regions.hpp"
#include "net/places.hpp"
#include "sim/kernel/simulation.hpp"

namespace hearsay {

class GridWitness {
 public:
  struct Options {
    grid::Area area;
    GridBelief::Options belief;        ///< of the central grid
    std::vector<grid::Point> targets;  ///< what is truly there; they may lie outside the area
    std::vector<double> thresholds;    ///< of alarms; the first is that of alarms_found_s
    double gate_m = 1.0;               ///< an alarm farther from all targets is false, > 0
    Duration period;                   ///< > 0: samples at 0, period, … and at the end
    std::vector<std::string> series;   ///< names of metrics kept over time; others are ignored
    bool grids = false;                ///< all cells of all grids at the end
    bool ledger = true;                ///< keep ledgers and what follows from them
    std::function<Point(AgentId)> place_of;
  };
  /// `simulation` must outlive the witness.
  GridWitness(Simulation& simulation, Options options);

  /// 1 for each cell with a target, else 0.
  std::span<const unsigned char> truth() const { return truth_; }

  /// For estimators: where the riders of their messages come from; nullptr if ledgers are off.
  RiderPool<GridRider>* riders() { return options_.ledger ? &riders_ : nullptr; }

  /// An agent looked now. @return the looks' indices in the run's book, valid until the next call;
  /// none if ledgers are off.
  std::span<const std::uint32_t> looked(AgentId agent, std::span<const grid::CellLook> looks);
  /// From now on `agent`'s grid is compared. Agents in ascending number.
  /// `mind` is there until finish() is over.
  void watch(AgentId agent, const GridMind& mind);

  /// Schedules the samples up to the end of the run. Once, before it starts.
  void start();
  /// Takes the last sample (unless it was due at this very instant) and leaves final values.
  void finish();

 private:
  struct Watched {
    AgentId agent;
    const GridMind* mind;
    std::vector<unsigned char> seen;  // 1 for each cell it looked at
    std::optional<Time> found;        // since when it has had an alarm at every target
  };
  struct Wanted {
    bool kl, entropy, disagreement, place;
    bool multiplicity_mean, multiplicity_max, multiplicity_share;
    bool detected, false_alarms, position_error, cells_detected, cells_false, cells_hearsay;
    bool alarms() const {
      return detected || false_alarms || position_error || cells_detected || cells_false ||
             cells_hearsay;
    }
  };
  void schedule_sample(Time at);
  void sample();
  void sample(AgentId agent, const GridBelief& belief);
  void sample_alarms(AgentId agent, const GridBelief& belief);
  void sample_ledger(const Watched& watched);
  void sample_disagreement();
  void keep(AgentId agent, NameId subject, const char* name, double value,
            Origin origin = Origin::run);
  /// True if it has an alarm at every target.
  bool finds_all(const GridBelief& belief);
  void leave_grid(AgentId agent, const GridBelief& belief);
  void leave_seen();

  Simulation& simulation_;
  Options options_;
  Wanted wanted_;
  std::vector<unsigned char> truth_;
  RiderPool<GridRider> riders_;
  grid::LookBook book_;
  std::vector<std::uint32_t> indices_;  // of the looks just made
  GridBelief central_;
  std::optional<Time> central_found_;
  std::vector<Watched> watched_;
  std::vector<NameId> threshold_names_;
  grid::RegionFinder finder_;
  std::vector<unsigned char> marks_, central_marks_;
  std::vector<float> lowest_, highest_;  // probability of each cell, over all agents
  std::uint64_t looks_ = 0;
  std::optional<Time> last_sample_;
};

}  // namespace hearsay
