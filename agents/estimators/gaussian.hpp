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
#include "filters/gaussian/message_forms.hpp"

namespace hearsay {

/// What of a belief is said. Only rules that send nothing but their belief, and remember nothing
/// that was said, may say less.
enum class Content {
  belief,     ///< all of it
  diagonal,   ///< gaussian::diagonal_part(); nothing of a singular belief
  quantised,  ///< gaussian::quantise(); nothing of a singular belief, and the ledger is inexact
};

/// True for rules whose content may be another than whole beliefs.
bool can_say_less(gaussian::Rule rule);

/// How messages under a rule and content are encoded.
/// @throws BrokenInvariant if the content does not go with the rule.
gaussian::MessageForm message_form(gaussian::Rule rule, Content content);

class GaussianEstimator final : public Estimator {
 public:
  struct Options {
    gaussian::Rule rule = gaussian::Rule::none;
    double omega = 0.5;       ///< weight of the own belief under ci-fixed, (0, 1]
    double correction = 1.0;  ///< γ of hybrid-consensus, ≥ 1
    Content content = Content::belief;
    int bits = 8;                             ///< of an entry that is quantised, 4 … 16
    bool exact = true;                        ///< false: ledgers are inexact from the start
    int subjects = 1;                         ///< states estimated, ≥ 1
    int dimension = 2;                        ///< of each state, n
    std::optional<MotionModel> motion;        ///< nothing: states stand still
    LedgerPool* ledgers = nullptr;            ///< nullptr: no ledger is kept; not owned
    EstimatorWorkspace* workspace = nullptr;  ///< nullptr: one of its own; not owned
    bool strangers = false;  ///< others than `neighbours` may be heard, and are then remembered
  };
  /// `neighbours`: whom a memory is kept for, by number.
  GaussianEstimator(const Options& options, std::span<const AgentId> neighbours);

  void advance(std::int64_t now) override;
  void measured(int subject, const gaussian::Belief& information, std::size_t measurement) override;
  void about_to_talk(int degree) override;
  Speech speech(AgentId neighbour) override;
  void sent(AgentId neighbour) override;
  void heard(AgentId from, std::span<const std::byte> bytes, const Rider* rider) override;

  /// As if the agent had rebooted: later messages are newer than all before.
  void new_incarnation();
  void forget() override;
  bool save(std::vector<std::byte>& memory) const override;
  bool recall(std::span<const std::byte> memory) override;

  double news_nats() const override;

  gaussian::Rule rule() const { return options_.rule; }
  gaussian::MessageForm form() const { return form_; }
  int subjects() const { return static_cast<int>(own_.size()); }
  const TrackedBelief& tracked(int subject) const override {
    return own_[static_cast<std::size_t>(subject)];
  }
  const gaussian::Belief* expectation(int subject) const override {
    return &own_[static_cast<std::size_t>(subject)].belief;
  }
  using Counts = EstimatorCounts;
  const Counts& counts() const override { return counts_; }

 private:
  /// The newest that was heard of a subject and is not fused yet.
  struct Held {
    bool waits = false;
    int degree = 0;
    TrackedBelief said;
    TrackedBelief fresh;  // only where the rule fuses it apart
  };
  struct Neighbour {
    AgentId id;
    bool heard = false;
    std::uint32_t incarnation = 0;
    std::uint32_t count = 0;
    std::vector<TrackedBelief> memory;  // by subject; what the rule books as common
    std::vector<Held> held;             // by subject; of rules that fuse all at once
  };
  Neighbour* find(AgentId id);
  Neighbour make_neighbour(AgentId id) const;
  TrackedBelief unknown() const;
  void predict(TrackedBelief& tracked, std::int64_t step) const;
  bool decode(std::span<const std::byte> bytes, gaussian::StampedMessage& message) const;
  bool outdated(Neighbour& from, const gaussian::Message& message) const;
  bool put_into_words(std::size_t subject, const Neighbour* to, std::size_t at, LedgerRider* rider);
  bool shorten(std::size_t at, LedgerRider* rider);
  void predict_last_said() const;
  void hold(std::size_t subject, Neighbour& from, std::size_t at, const LedgerRider* rider);
  void fuse_held(std::size_t subject, int degree);
  void find_weights(std::size_t subject, int degree);
  void add_weighted(TrackedBelief& own, double own_weight, double weight,
                    const TrackedBelief& other) const;
  void fuse_by_parts(std::size_t subject, std::size_t at, const Ledger* ledger);
  void take(TrackedBelief& own, const gaussian::DirectionalFusion& fusion,
            const gaussian::Belief& belief, const Ledger* ledger);
  void fuse(int subject, Neighbour& from, const gaussian::Belief& belief, const Ledger* ledger);
  void fuse_older(int subject, Neighbour& from, const gaussian::Belief& belief,
                  const Ledger* ledger);
  void fuse_by_direction(TrackedBelief& own, const gaussian::Belief& belief, const Ledger* ledger);
  void note_gain(const gaussian::Belief& before, const gaussian::Belief& received,
                 const gaussian::Belief& after);
  bool keeps_ledger() const { return options_.ledgers != nullptr; }

  Options options_;
  const gaussian::RuleInfo& rule_;
  gaussian::MessageForm form_;
  std::vector<TrackedBelief> own_;
  std::vector<TrackedBelief> unsent_;      // by subject; what was measured since it last sent
  std::vector<TrackedBelief> last_fresh_;  // by subject; unsent_ when it last sent, until fused
  // By subject; own belief when it last sent, as it is predicted for stamp last_said_at_: so far as
  // somebody asked.
  mutable std::vector<gaussian::Belief> last_said_;
  mutable std::int64_t last_said_at_ = 0;
  std::vector<Held*> to_fuse_;  // of fuse_held()
  std::vector<const gaussian::Matrix*> matrices_;
  std::vector<double> weights_;  // own first, then as in to_fuse_
  int degree_ = 0;
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
