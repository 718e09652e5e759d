// An estimator of several moving states over their last T stamps. What agents tell each other is
// what was measured at each stamp (trajectory_gaussian.hpp): exact on a tree, whatever is late or
// lost.
//
// Its ledger gives multiplicities alone: how much a measurement counts in the present depends on
// all that came after it.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "agents/estimator.hpp"
#include "agents/estimators/trajectory_gaussian.hpp"
#include "filters/gaussian/fusion.hpp"

namespace hearsay {

/// How a rule of agents that tell each other what was measured is called for trajectories; nothing:
/// it is one that needs whole beliefs.
std::optional<TrajectoryExchange> exchange_of(gaussian::Rule rule);
/// The rules there are for trajectories.
std::span<const gaussian::Rule> trajectory_rules();

class SharedTrajectories final : public Estimator {
 public:
  struct Options {
    TrajectoryExchange exchange = TrajectoryExchange::all_but_yours;
    int subjects = 1;
    MotionModel motion;
    int steps_max = 20;                       ///< T, in stamps
    LedgerPool* ledgers = nullptr;            ///< nullptr: no ledger is kept; not owned
    EstimatorWorkspace* workspace = nullptr;  ///< not owned, must be given
  };
  explicit SharedTrajectories(const Options& options);

  void advance(std::int64_t now) override;
  void measured(int subject, const gaussian::Belief& information, std::size_t measurement) override;
  Speech speech(AgentId neighbour) override;
  void sent(AgentId) override {}
  void heard(AgentId from, std::span<const std::byte> bytes, const Rider* rider) override;
  void forget() override;
  const TrackedBelief& tracked(int subject) const override;
  const EstimatorCounts& counts() const override { return counts_; }

 private:
  struct Track {
    mutable TrajectoryEstimator filter;
    Ledger base;  // of what is older than the window
    Ledger own;
    std::map<AgentId, Ledger> said;
    mutable TrackedBelief present;
  };
  bool keeps_ledger() const { return options_.ledgers != nullptr; }
  /// Measurements whose stamp is in [first, last].
  std::span<const std::uint8_t> between(std::size_t subject, std::int64_t first,
                                        std::int64_t last) const;
  /// Everything in the window but what `but` said.
  Ledger window(const Track& track, AgentId but) const;
  bool decode(std::span<const std::byte> bytes);
  void heard(std::size_t subject, AgentId from, const TrajectoryEstimator::Message& message,
             const Ledger* ledger);
  void count();

  Options options_;
  std::vector<Track> tracks_;  // by subject
  TrajectoryEstimator::Message message_;
  mutable std::vector<std::uint8_t> chosen_;
  EstimatorCounts counts_;
};

}  // namespace hearsay
