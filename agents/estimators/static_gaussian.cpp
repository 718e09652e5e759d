#include "agents/estimators/static_gaussian.hpp"

#include <algorithm>

#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

using gaussian::Belief;
using gaussian::Memory;
using gaussian::Sends;

}  // namespace

RiderPtr LedgerPool::make(LedgerRider*& rider) {
  if (free_.empty()) {
    riders_.push_back(std::unique_ptr<LedgerRider>(new LedgerRider(free_)));
    free_.reserve(riders_.size());
    rider = riders_.back().get();
  } else {
    rider = free_.back();
    free_.pop_back();
  }
  return RiderPtr(rider);
}

StaticGaussianEstimator::StaticGaussianEstimator(const Options& options,
                                                 std::span<const AgentId> neighbours)
    : options_(options), rule_(gaussian::info(options.rule)), workspace_(options.workspace) {
  if (workspace_ == nullptr) {
    own_workspace_ = std::make_unique<EstimatorWorkspace>();
    workspace_ = own_workspace_.get();
  }
  const auto subjects = static_cast<std::size_t>(options.subjects);
  own_.assign(subjects, unknown());
  if (rule_.sends == Sends::local_update) unsent_ = own_;
  for (const AgentId id : neighbours) neighbours_.push_back(make_neighbour(id));
}

StaticGaussianEstimator::Neighbour StaticGaussianEstimator::make_neighbour(AgentId id) const {
  Neighbour neighbour{.id = id, .memory = {}};
  if (rule_.memory != Memory::nothing) {
    neighbour.memory.assign(own_.size(), unknown());
  }
  return neighbour;
}

TrackedBelief StaticGaussianEstimator::unknown() const {
  return {Belief::unknown(options_.dimension),
          keeps_ledger() && options_.motion ? Ledger::moving(options_.dimension) : Ledger{}};
}

void StaticGaussianEstimator::advance(std::int64_t now) {
  if (!options_.motion) return;
  require(now >= stamp_, "an estimator does not go back in time");
  for (; stamp_ < now; ++stamp_) {
    for (TrackedBelief& tracked : own_) predict(tracked, stamp_);
    for (TrackedBelief& tracked : unsent_) predict(tracked, stamp_);
    for (Neighbour& neighbour : neighbours_) {
      for (TrackedBelief& tracked : neighbour.memory) predict(tracked, stamp_);
    }
  }
}

void StaticGaussianEstimator::predict(TrackedBelief& tracked, std::int64_t step) const {
  if (tracked.belief.omega.isZero(0.0) && tracked.ledger.weights().empty()) return;
  const gaussian::Prediction predicted =
      gaussian::predict_with_gain(tracked.belief, options_.motion->step);
  tracked.belief = predicted.belief;
  if (!keeps_ledger()) return;
  tracked.ledger.predict(predicted.F, predicted.belief.omega, static_cast<std::size_t>(step));
}

void StaticGaussianEstimator::measured(int subject, const Belief& information,
                                       std::size_t measurement) {
  const auto s = static_cast<std::size_t>(subject);
  const auto use = [&](TrackedBelief& tracked) {
    tracked.belief += information;
    if (keeps_ledger()) tracked.ledger.measured(measurement);
  };
  use(own_[s]);
  if (!unsent_.empty()) use(unsent_[s]);
  ++counts_.measurements;
}

StaticGaussianEstimator::Speech StaticGaussianEstimator::speech(AgentId neighbour) {
  const Neighbour* to = neighbour == no_agent ? nullptr : find(neighbour);
  const std::vector<TrackedBelief>& says = unsent_.empty() ? own_ : unsent_;
  const bool less_heard = rule_.sends == Sends::belief_less_heard;
  require(!less_heard || to != nullptr, "a rule that speaks to each neighbour needs one");
  LedgerRider* rider = nullptr;
  Speech speech;
  if (keeps_ledger()) speech.rider = options_.ledgers->make(rider);

  gaussian::Message& message = workspace_->outgoing.message;
  std::size_t spoken = 0;
  message.beliefs.resize(own_.size());
  if (rider) rider->ledgers.resize(own_.size());
  for (std::size_t s = 0; s < own_.size(); ++s) {
    gaussian::BeliefEntry& entry = message.beliefs[spoken];
    entry.subject = static_cast<std::uint32_t>(s);
    entry.belief = says[s].belief;
    if (less_heard) entry.belief -= to->memory[s].belief;
    if (entry.belief.omega.isZero(0.0)) continue;
    if (rider) {
      rider->ledgers[spoken] = says[s].ledger;
      if (less_heard) {
        rider->ledgers[spoken].combine(1.0, 0.0, own_[s].ledger, 1.0, &to->memory[s].ledger);
      }
    }
    ++spoken;
  }
  message.beliefs.resize(spoken);
  if (spoken == 0) return {};
  message.incarnation = incarnation_;
  message.count = next_count_++;
  if (options_.motion) {
    workspace_->outgoing.stamp = stamp_ * options_.motion->period.nanoseconds();
    gaussian::encode(workspace_->outgoing, workspace_->bytes);
  } else {
    gaussian::encode(message, workspace_->bytes);
  }
  speech.bytes = workspace_->bytes;
  return speech;
}

void StaticGaussianEstimator::sent(AgentId neighbour) {
  for (TrackedBelief& unsent : unsent_) unsent = unknown();
  if (rule_.memory != Memory::last_exchanged) return;
  for (Neighbour& to : neighbours_) {
    if (neighbour == no_agent || neighbour == to.id) to.memory = own_;
  }
}

void StaticGaussianEstimator::heard(AgentId from, std::span<const std::byte> bytes,
                                    const Rider* rider) {
  Neighbour* sender = find(from);
  const gaussian::Message& message = workspace_->incoming.message;
  if (sender == nullptr || !decode(bytes, workspace_->incoming) || outdated(*sender, message)) {
    ++counts_.refused;
    return;
  }
  const auto usable = [this](const gaussian::BeliefEntry& entry) {
    return entry.subject < own_.size() && entry.belief.dimension() == options_.dimension;
  };
  if (!std::all_of(message.beliefs.begin(), message.beliefs.end(), usable)) {
    ++counts_.refused;
    return;
  }
  sender->heard = true;
  sender->incarnation = message.incarnation;
  sender->count = message.count;
  const auto* ledgers = static_cast<const LedgerRider*>(rider);
  for (std::size_t i = 0; i < message.beliefs.size(); ++i) {
    const gaussian::BeliefEntry& entry = message.beliefs[i];
    const auto subject = static_cast<int>(entry.subject);
    const Ledger* ledger = ledgers ? &ledgers->ledgers[i] : nullptr;
    if (!options_.motion) {
      fuse(subject, *sender, entry.belief, ledger);
      continue;
    }
    received_.belief = entry.belief;
    if (ledger != nullptr) received_.ledger = *ledger;
    std::int64_t step = workspace_->incoming.stamp / options_.motion->period.nanoseconds();
    for (; step < stamp_; ++step) predict(received_, step);
    fuse(subject, *sender, received_.belief, ledger ? &received_.ledger : nullptr);
  }
}

bool StaticGaussianEstimator::decode(std::span<const std::byte> bytes,
                                     gaussian::StampedMessage& message) const {
  if (!options_.motion) return gaussian::decode(bytes, message.message);
  const std::int64_t period = options_.motion->period.nanoseconds();
  return gaussian::decode(bytes, message) && message.stamp >= 0 &&
         message.stamp <= stamp_ * period && message.stamp % period == 0;
}

bool StaticGaussianEstimator::outdated(Neighbour& from, const gaussian::Message& message) const {
  // Algorithm 3.4 as printed adds whatever arrives; only the rule that replaces needs an order.
  if (rule_.memory != Memory::last_heard || !from.heard) return false;
  if (message.incarnation != from.incarnation) return message.incarnation < from.incarnation;
  return message.count <= from.count;
}

void StaticGaussianEstimator::fuse(int subject, Neighbour& from, const Belief& belief,
                                   const Ledger* ledger) {
  const auto s = static_cast<std::size_t>(subject);
  TrackedBelief& own = own_[s];
  if (rule_.directional) return fuse_by_direction(own, belief, ledger);
  TrackedBelief* memory = rule_.memory == Memory::nothing ? nullptr : &from.memory[s];
  const gaussian::Coefficients k = gaussian::coefficients(options_.rule, own.belief, belief);
  if (k.skipped != nullptr) {
    ++counts_.skipped;
    return;
  }
  ++counts_.fusions;
  const Belief before = own.belief;
  own.belief *= k.own;
  Belief weighted = belief;
  weighted *= k.received;
  own.belief += weighted;
  if (memory != nullptr && k.common != 0.0) {
    weighted = memory->belief;
    weighted *= k.common;
    own.belief -= weighted;
  }
  if (keeps_ledger() && ledger != nullptr) {
    own.ledger.combine(k.own, k.received, *ledger, k.common, memory ? &memory->ledger : nullptr);
  }
  if (memory != nullptr) {
    memory->belief = belief;
    if (ledger != nullptr) memory->ledger = *ledger;
  }
  note_gain(before, belief, own.belief);
}

void StaticGaussianEstimator::fuse_by_direction(TrackedBelief& own, const Belief& belief,
                                                const Ledger* ledger) {
  const gaussian::DirectionalFusion fusion =
      gaussian::fuse_by_direction(options_.rule, own.belief, belief);
  if (fusion.skipped != nullptr) {
    ++counts_.skipped;
    return;
  }
  ++counts_.fusions;
  note_gain(own.belief, belief, fusion.belief);
  own.belief = fusion.belief;
  if (keeps_ledger() && ledger != nullptr) {
    own.ledger.combine(fusion.own, fusion.received, *ledger);
  }
}

void StaticGaussianEstimator::note_gain(const Belief& before, const Belief& received,
                                        const Belief& after) {
  const auto a = gaussian::claimed_sigma(before);
  const auto b = gaussian::claimed_sigma(received);
  const auto c = gaussian::claimed_sigma(after);
  if (!a || !b || !c) return;
  counts_.fusion_gain_max = std::max(counts_.fusion_gain_max, 1.0 - *c / std::min(*a, *b));
}

void StaticGaussianEstimator::new_incarnation() {
  ++incarnation_;
  next_count_ = 1;
}

void StaticGaussianEstimator::forget() {
  new_incarnation();
  for (std::vector<TrackedBelief>* beliefs : {&own_, &unsent_}) {
    for (TrackedBelief& tracked : *beliefs) tracked = unknown();
  }
  for (Neighbour& neighbour : neighbours_) neighbour = make_neighbour(neighbour.id);
}

StaticGaussianEstimator::Neighbour* StaticGaussianEstimator::find(AgentId id) {
  const auto found = std::lower_bound(neighbours_.begin(), neighbours_.end(), id,
                                      [](const Neighbour& n, AgentId i) { return n.id < i; });
  if (found != neighbours_.end() && found->id == id) return &*found;
  return options_.strangers ? &*neighbours_.insert(found, make_neighbour(id)) : nullptr;
}

}  // namespace hearsay
