// An estimator of several moving states over their last T stamps, which tells others its whole
// belief: block tridiagonal, motion model and all. Merino 2007, Algorithm 3.3, eq. 3.41–3.46.
//
//   channel        own + heard − common; common is what was last exchanged, predicted since
//   ci-det, …      ω·own + (1−ω)·heard: one ω for the whole block matrix keeps it tridiagonal
//
// Every window begins T stamps ago (or at 0), also after a reboot, so a message is brought to the
// same stamps by prediction and by marginalising its oldest. Its ledger gives multiplicities alone.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "agents/estimator.hpp"
#include "filters/gaussian/fusion.hpp"

namespace hearsay {

class WholeTrajectories final : public Estimator {
 public:
  struct Options {
    gaussian::Rule rule = gaussian::Rule::ci_det;  ///< channel, ci_det or ci_half
    int subjects = 1;
    MotionModel motion;
    int steps_max = 20;                       ///< T, in stamps
    LedgerPool* ledgers = nullptr;            ///< nullptr: no ledger is kept; not owned
    EstimatorWorkspace* workspace = nullptr;  ///< not owned, must be given
  };
  /// `neighbours`: with whom a channel has something in common from the start.
  WholeTrajectories(const Options& options, std::span<const AgentId> neighbours);

  void advance(std::int64_t now) override;
  void measured(int subject, const gaussian::Belief& information, std::size_t measurement) override;
  Speech speech(AgentId neighbour) override;
  void sent(AgentId neighbour) override;
  void heard(AgentId from, std::span<const std::byte> bytes, const Rider* rider) override;
  void forget() override;
  const TrackedBelief& tracked(int subject) const override;
  const EstimatorCounts& counts() const override { return counts_; }

 private:
  struct Track {
    gaussian::Trajectory trajectory;
    Ledger ledger;
  };
  bool keeps_ledger() const { return options_.ledgers != nullptr; }
  /// Knows how things move, and nothing else.
  Track unknown() const;
  void advance(gaussian::Trajectory& trajectory, std::int64_t now) const;
  std::vector<Track>& common_with(AgentId neighbour);
  /// A trajectory of a message at the stamps of one's own; nothing if it is malformed.
  std::optional<gaussian::Trajectory> brought_here(const gaussian::TrajectoryEntry& entry) const;
  void fuse(std::size_t subject, AgentId from, Track received);

  Options options_;
  std::int64_t now_ = 0;
  std::vector<Track> own_;                        // by subject
  std::map<AgentId, std::vector<Track>> common_;  // of a channel
  mutable TrackedBelief present_;
  std::uint32_t incarnation_ = 0;
  std::uint32_t next_count_ = 1;
  EstimatorCounts counts_;
};

}  // namespace hearsay
