// An estimator of several states: one Gaussian belief each, about the state as it is now, fused by
// a rule with what other agents say. Merino 2007, Algorithm 3.4, with the rule of lines 9–12
// exchangeable.
//
// States stand still, or move by a model that all agents share. Then every belief, and all that is
// remembered of others, is predicted from stamp to stamp, and a message is brought to the present
// before it is fused: the approximate exchange of filters (eq. 2.22), in which the noise of the
// motion, common to all, makes even disjoint measurements depend on each other.
//
// Beside each belief rides its ledger (out of band, see filters/ledger). Both are combined by the
// same coefficients, so the ledger cannot disagree with the rule.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "agents/estimator.hpp"
#include "filters/gaussian/fusion.hpp"

namespace hearsay {

class StaticGaussianEstimator final : public Estimator {
 public:
  struct Options {
    gaussian::Rule rule = gaussian::Rule::none;
    int subjects = 1;                         ///< states estimated, ≥ 1
    int dimension = 2;                        ///< of each state, n
    std::optional<MotionModel> motion;        ///< nothing: states stand still
    LedgerPool* ledgers = nullptr;            ///< nullptr: no ledger is kept; not owned
    EstimatorWorkspace* workspace = nullptr;  ///< nullptr: one of its own; not owned
    bool strangers = false;  ///< others than `neighbours` may be heard, and are then remembered
  };
  /// `neighbours`: whom a memory is kept for, by number.
  StaticGaussianEstimator(const Options& options, std::span<const AgentId> neighbours);

  void advance(std::int64_t now) override;
  void measured(int subject, const gaussian::Belief& information, std::size_t measurement) override;
  Speech speech(AgentId neighbour) override;
  void sent(AgentId neighbour) override;
  void heard(AgentId from, std::span<const std::byte> bytes, const Rider* rider) override;

  /// As if the agent had rebooted: later messages are newer than all before.
  void new_incarnation();
  void forget() override;

  gaussian::Rule rule() const { return options_.rule; }
  int subjects() const { return static_cast<int>(own_.size()); }
  const TrackedBelief& tracked(int subject) const override {
    return own_[static_cast<std::size_t>(subject)];
  }
  using Counts = EstimatorCounts;
  const Counts& counts() const override { return counts_; }

 private:
  struct Neighbour {
    AgentId id;
    bool heard = false;
    std::uint32_t incarnation = 0;
    std::uint32_t count = 0;
    std::vector<TrackedBelief> memory;  // by subject; what the rule books as common
  };
  Neighbour* find(AgentId id);
  Neighbour make_neighbour(AgentId id) const;
  TrackedBelief unknown() const;
  void predict(TrackedBelief& tracked, std::int64_t step) const;
  bool decode(std::span<const std::byte> bytes, gaussian::StampedMessage& message) const;
  bool outdated(Neighbour& from, const gaussian::Message& message) const;
  void fuse(int subject, Neighbour& from, const gaussian::Belief& belief, const Ledger* ledger);
  void fuse_by_direction(TrackedBelief& own, const gaussian::Belief& belief, const Ledger* ledger);
  void note_gain(const gaussian::Belief& before, const gaussian::Belief& received,
                 const gaussian::Belief& after);
  bool keeps_ledger() const { return options_.ledgers != nullptr; }

  Options options_;
  const gaussian::RuleInfo& rule_;
  std::vector<TrackedBelief> own_;
  std::vector<TrackedBelief> unsent_;  // by subject; for rules that send local updates
  std::vector<Neighbour> neighbours_;
  TrackedBelief received_;  // a belief about a moving state, brought to the present
  std::int64_t stamp_ = 0;
  std::uint32_t incarnation_ = 0;
  std::uint32_t next_count_ = 1;
  Counts counts_;
  std::unique_ptr<EstimatorWorkspace> own_workspace_;
  EstimatorWorkspace* workspace_;
};

}  // namespace hearsay
