// What an estimator agent asks of its estimator, whatever a belief is; and what goes beside it: the
// ledger, out of band.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "filters/gaussian/batch.hpp"
#include "filters/gaussian/belief.hpp"
#include "filters/gaussian/message_forms.hpp"
#include "filters/gaussian/trajectory_codec.hpp"
#include "filters/gaussian/transition.hpp"
#include "filters/ledger/ledger.hpp"
#include "net/rider_pool.hpp"
#include "sim/kernel/time.hpp"

namespace hearsay {

/// How all subjects of a run are thought to move: from the instant k·period, stamp k, to the next.
/// Moving states are measured and believed at stamps alone.
struct MotionModel {
  gaussian::Transition step;  ///< n×n
  Duration period;            ///< > 0

  std::int64_t stamp_at(Time time) const { return time.nanoseconds() / period.nanoseconds(); }
};

/// A belief and its ledger. The ledger stays empty where ledgers are off.
struct TrackedBelief {
  gaussian::Belief belief;
  Ledger ledger;
};

/// The ledgers of the beliefs in one message, by position, and of their fresh parts where the rule
/// fuses those apart; rides beside the packet.
class LedgerRider final : public PooledRider<LedgerRider> {
 public:
  std::vector<Ledger> ledgers;
  std::vector<Ledger> fresh;

 private:
  friend class RiderPool<LedgerRider>;
  using PooledRider::PooledRider;
};
using LedgerPool = RiderPool<LedgerRider>;

/// What estimators need only while they speak or hear. One for all agents of a run, so that a
/// message to the next agent finds it in the cache.
struct EstimatorWorkspace {
  gaussian::StampedMessage outgoing, incoming;
  gaussian::MessageExtras outgoing_extras, incoming_extras;
  gaussian::BatchIntersection batch;
  gaussian::TrajectoryMessage outgoing_trajectories, incoming_trajectories;
  std::vector<std::byte> bytes;
  /// Not for beliefs, but for ledgers of trajectories: the stamp of every measurement, by subject.
  std::vector<std::vector<std::int64_t>> measured_at;
};

struct EstimatorCounts {
  std::uint64_t measurements = 0;
  std::uint64_t fusions = 0;
  std::uint64_t skipped = 0;   ///< beliefs the rule could not use
  std::uint64_t refused = 0;   ///< messages malformed, from a stranger or not newer
  std::uint64_t late = 0;      ///< news of a stamp that is gone from the window
  double fusion_gain_max = 0;  ///< largest 1 − σ/min(σ own, σ heard) over fusions
};

/// It knows no clock and no radio: measurements and messages in, beliefs and messages out.
/// What a witness asks of whoever believes, here or in another process.
class Believer {
 public:
  virtual ~Believer() = default;

  /// From here on it is stamp `now`, not before the last one. Nothing where states stand still.
  virtual void advance(std::int64_t now) = 0;
  /// What it believes about a subject now; valid until anything else is called.
  virtual const TrackedBelief& tracked(int subject) const = 0;
  virtual const EstimatorCounts& counts() const = 0;
};

class Estimator : public Believer {
 public:
  /// Uses a measurement's information about the state as it is now (eq. 3.34–3.35). `measurement`
  /// is its index in the subject's MeasurementBook.
  virtual void measured(int subject, const gaussian::Belief& information,
                        std::size_t measurement) = 0;

  /// The agent is about to talk, or would be if it did not only listen: rules that hold what they
  /// hear fuse it now. `degree`: how many neighbours there are now.
  virtual void about_to_talk(int degree) { static_cast<void>(degree); }

  struct Speech {
    std::span<const std::byte> bytes;  ///< valid until the next call of any with this workspace
    RiderPtr rider;
  };
  /// The message to `neighbour`, or to all of them for no_agent (rules that send one broadcast).
  /// A stranger, if there may be any, is remembered from now on.
  /// Subjects nothing is known about are left out; an empty speech says nothing at all.
  virtual Speech speech(AgentId neighbour) = 0;
  /// Tells that the last speech to `neighbour` (no_agent: to all) was handed over to the radio.
  virtual void sent(AgentId neighbour) = 0;

  /// How much less the neighbours would know who predict that nothing was learnt here since it last
  /// spoke: D(now ‖ then) in nats, where then is the belief it held, predicted to now if the state
  /// moves; the largest over subjects. Infinite where it was singular or nothing of the kind is
  /// kept.
  virtual double news_nats() const { return std::numeric_limits<double>::infinity(); }

  /// Takes in a message. Malformed or outdated ones are refused and counted.
  virtual void heard(AgentId from, std::span<const std::byte> bytes, const Rider* rider) = 0;

  /// Comes back from a reboot that lost the memory: it knows nothing and remembers nobody's words.
  virtual void forget() = 0;

  /// All that it knows and remembers, in place of what `memory` held. @return false if estimators
  /// of its kind cannot be saved.
  virtual bool save(std::vector<std::byte>& memory) const {
    static_cast<void>(memory);
    return false;
  }
  /// Takes up, before anything else happens to it, what another with the same options saved.
  /// @return false, and nothing is changed, if the memory is of another kind, or damaged.
  virtual bool recall(std::span<const std::byte> memory) {
    static_cast<void>(memory);
    return false;
  }

  /// What it expects of its next measurement, where that is at hand at no cost: the belief about a
  /// subject as it is now. Else nullptr.
  virtual const gaussian::Belief* expectation(int subject) const {
    static_cast<void>(subject);
    return nullptr;
  }
};

}  // namespace hearsay
