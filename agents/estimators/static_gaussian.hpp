// An estimator of several static states: one Gaussian belief each, fused by a rule with what other
// agents say. It knows no clock and no radio: measurements and messages in, beliefs and messages
// out. Merino 2007, Algorithm 3.4, with the rule of lines 9–12 exchangeable.
//
// Beside each belief rides its ledger (out of band, see filters/ledger). Both are combined by the
// same coefficients, so the ledger cannot disagree with the rule.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "filters/gaussian/codec.hpp"
#include "filters/gaussian/fusion.hpp"
#include "filters/ledger/ledger.hpp"
#include "net/packet.hpp"

namespace hearsay {

/// A belief and its ledger. The ledger stays empty where ledgers are off.
struct TrackedBelief {
  gaussian::Belief belief;
  Ledger ledger;
};

/// The ledgers of the beliefs in one message, by position; rides beside the packet.
class LedgerRider final : public Rider {
 public:
  std::vector<Ledger> ledgers;

 private:
  friend class LedgerPool;
  explicit LedgerRider(std::vector<LedgerRider*>& home) : home_(home) {}
  void recycle() override { home_.push_back(this); }
  std::vector<LedgerRider*>& home_;
};

/// Riders of one run, reused. Must outlive every packet that carries one.
class LedgerPool {
 public:
  LedgerPool() = default;
  LedgerPool(const LedgerPool&) = delete;
  LedgerPool& operator=(const LedgerPool&) = delete;
  RiderPtr make(LedgerRider*& rider);

 private:
  std::vector<std::unique_ptr<LedgerRider>> riders_;
  std::vector<LedgerRider*> free_;
};

/// What estimators need only while they speak or hear. One for all agents of a run, so that a
/// message to the next agent finds it in the cache.
struct EstimatorWorkspace {
  gaussian::Message outgoing, incoming;
  std::vector<std::byte> bytes;
};

class StaticGaussianEstimator {
 public:
  struct Options {
    gaussian::Rule rule = gaussian::Rule::none;
    int subjects = 1;                         ///< states estimated, ≥ 1
    int dimension = 2;                        ///< of each state, n
    LedgerPool* ledgers = nullptr;            ///< nullptr: no ledger is kept; not owned
    EstimatorWorkspace* workspace = nullptr;  ///< nullptr: one of its own; not owned
    bool strangers = false;  ///< others than `neighbours` may be heard, and are then remembered
  };
  /// `neighbours`: whom a memory is kept for, by number.
  StaticGaussianEstimator(const Options& options, std::span<const AgentId> neighbours);

  /// Uses a measurement's information (eq. 3.34–3.35) at once. `measurement` is its index in the
  /// subject's MeasurementBook.
  void measured(int subject, const gaussian::Belief& information, std::size_t measurement);

  /// What this estimator has to say now.
  struct Speech {
    std::span<const std::byte> bytes;  ///< valid until the next call of any with this workspace
    RiderPtr rider;
  };
  /// The message to `neighbour`, or to all of them for no_agent (rules that send one broadcast).
  /// A stranger, if there may be any, is remembered from now on.
  /// Subjects nothing is known about are left out; an empty speech says nothing at all.
  Speech speech(AgentId neighbour);
  /// Tells that the last speech to `neighbour` (no_agent: to all) was handed over to the radio.
  void sent(AgentId neighbour);

  /// Fuses a message. Malformed or outdated ones are refused and counted.
  void heard(AgentId from, std::span<const std::byte> bytes, const Rider* rider);

  /// As if the agent had rebooted: later messages are newer than all before.
  void new_incarnation();
  /// The same after a reboot that lost the memory: it knows nothing and remembers nobody's words.
  void forget();

  gaussian::Rule rule() const { return options_.rule; }
  int subjects() const { return static_cast<int>(own_.size()); }
  const TrackedBelief& tracked(int subject) const {
    return own_[static_cast<std::size_t>(subject)];
  }

  struct Counts {
    std::uint64_t measurements = 0;
    std::uint64_t fusions = 0;
    std::uint64_t skipped = 0;   ///< beliefs the rule could not use
    std::uint64_t refused = 0;   ///< messages malformed, from a stranger or not newer
    double fusion_gain_max = 0;  ///< largest 1 − σ/min(σ own, σ heard) over fusions
  };
  const Counts& counts() const { return counts_; }

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
  std::uint32_t incarnation_ = 0;
  std::uint32_t next_count_ = 1;
  Counts counts_;
  std::unique_ptr<EstimatorWorkspace> own_workspace_;
  EstimatorWorkspace* workspace_;
};

}  // namespace hearsay
