// The omniscient witness of a run: it hears every measurement at once, keeps the central belief and
// the book of measurements, and compares what each agent believes with the truth, with the central
// belief and with the ledger. No agent can ask it anything.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "agents/agreement.hpp"
#include "agents/estimator_witness.hpp"
#include "agents/metrics.hpp"
#include "sim/kernel/simulation.hpp"

namespace hearsay {

/// A state that agents estimate, and the truth.
struct Subject {
  std::string name;
  /// n numbers; of a moving state n for each stamp, from 0 to the end of the run.
  std::vector<double> truth;
  /// True R (n×n) of a step, if its motion follows the agents' model; 0×0: it does not.
  gaussian::Matrix motion_noise = {};

  /// n numbers, from 0 on; beyond the last stamp the last.
  std::span<const double> truth_at(std::int64_t stamp, int n) const;
};

class Witness final : public EstimatorWitness {
 public:
  struct Options {
    std::vector<Subject> subjects;                ///< all of the same dimension n
    std::optional<MotionModel> motion;            ///< nothing: they stand still
    std::vector<Metric> series;                   ///< kept over time
    Duration series_period;                       ///< > 0: samples at 0, period, … and at the end
    bool ledger = true;                           ///< keep ledgers and what follows from them
    std::optional<Agreement::Options> agreement;  ///< since when all agree; nothing: not asked
    std::function<bool(AgentId)> up;              ///< whether an agent is up; empty: all are
  };
  /// `simulation` must outlive the witness.
  Witness(Simulation& simulation, Options options);

  /// An agent made a measurement now. @return its index in the subject's book.
  std::size_t measured(int subject, const gaussian::Belief& information);

  double distance_error_m(int subject, const gaussian::Belief& belief) override;
  void watch(AgentId agent, Believer& believer) override;
  LedgerPool* ledgers() override { return options_.ledger ? &pool_ : nullptr; }
  /// Shared by all of the run.
  EstimatorWorkspace& workspace() override { return workspace_; }

  /// Schedules the samples up to the end of the run. Once, before it starts.
  void start();
  /// Takes the last sample (unless it was due at this very instant) and leaves final values.
  void finish();

 private:
  struct Watched {
    AgentId agent;
    Believer* believer;
    double reach_gap_max = 0.0;
    std::vector<double> distances_m = {};  // of moving subjects: errors at all samples
    std::uint64_t samples = 0;
    std::uint64_t not_positive = 0;
    bool overflow_told = false;
  };
  using Values = std::array<double, series_metric_count>;

  void schedule_sample(Time at);
  void schedule_agreement(Time at);
  void sample();
  void sample_agreement();
  /// Brings the central filter and all agents to the present.
  void advance();
  /// Measures how far the estimates of those who are up lie apart.
  void gather_spreads();
  bool up(AgentId agent) const { return !options_.up || options_.up(agent); }
  double disagreement(const Watched& watched, const gaussian::Assessment& assessment,
                      int subject) const;
  void sample(Watched& watched, int subject);
  /// √(trace/axes) of the block of P (n×n) that belongs to positions.
  double position_sigma(const gaussian::Matrix& P) const;
  double claimed_sigma(const gaussian::Belief& belief,
                       const gaussian::Assessment& assessment) const;
  void measure_velocity(const gaussian::Belief& belief, const gaussian::Vector& error,
                        Values& values) const;
  Values measure(const TrackedBelief& tracked, const gaussian::Assessment& assessment, int subject,
                 bool central) const;
  void measure_ledger(const TrackedBelief& tracked, const gaussian::Assessment& assessment,
                      int subject, Values& values) const;
  void keep(AgentId agent, int subject, const Values& values);
  void keep_distance(std::vector<double>& distances_m, const Values& values) const;
  void finish(Watched& watched);
  bool wants(Metric metric) const { return wanted_[static_cast<std::size_t>(metric)]; }
  gaussian::Vector truth(int subject) const;
  double distance_m(const std::optional<gaussian::Vector>& state, int subject) const;

  Simulation& simulation_;
  Options options_;
  int dimension_;
  int axes_;  // positions among the n numbers, first
  std::int64_t stamp_ = 0;
  std::array<bool, series_metric_count> wanted_{};
  std::array<NameId, series_metric_count> metric_names_{};
  std::vector<NameId> subject_names_;
  LedgerPool pool_;
  EstimatorWorkspace workspace_;
  std::vector<MeasurementBook> books_;  // by subject
  std::vector<TrackedBelief> central_;  // by subject
  std::vector<double> central_distances_m_;
  std::vector<Watched> watched_;
  std::vector<Spread> spreads_;  // by subject; at the instant of a sample
  std::optional<Agreement> agreement_;
  std::uint64_t measurements_ = 0;
  std::optional<Time> last_sample_;
};

}  // namespace hearsay
