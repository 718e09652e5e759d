#include "agents/estimators/gaussian.hpp"

#include <algorithm>

#include "sim/kernel/error.hpp"

namespace hearsay {
namespace {

using gaussian::Belief;
using gaussian::Fuses;
using gaussian::Memory;
using gaussian::Sends;

}  // namespace

GaussianEstimator::GaussianEstimator(const Options& options, std::span<const AgentId> neighbours)
    : options_(options),
      rule_(gaussian::info(options.rule)),
      form_(message_form(options.rule, options.content)),
      workspace_(options.workspace) {
  if (workspace_ == nullptr) {
    own_workspace_ = std::make_unique<EstimatorWorkspace>();
    workspace_ = own_workspace_.get();
  }
  const auto subjects = static_cast<std::size_t>(options.subjects);
  own_.assign(subjects, unknown());
  if (keeps_ledger() && !options.exact) {
    for (TrackedBelief& own : own_) own.ledger.mark_inexact();
  }
  if (rule_.sends == Sends::local_update || rule_.sends == Sends::belief_and_fresh ||
      rule_.sends == Sends::hybrid) {
    unsent_.assign(subjects, unknown());
  }
  if (rule_.sends == Sends::hybrid) last_fresh_ = unsent_;
  last_said_.assign(subjects, Belief::unknown(options_.dimension));
  for (const AgentId id : neighbours) neighbours_.push_back(make_neighbour(id));
}

GaussianEstimator::Neighbour GaussianEstimator::make_neighbour(AgentId id) const {
  Neighbour neighbour{.id = id, .memory = {}, .held = {}};
  if (rule_.memory == Memory::held) {
    neighbour.held.assign(own_.size(), {.said = unknown(), .fresh = unknown()});
  } else if (rule_.memory != Memory::nothing) {
    neighbour.memory.assign(own_.size(), unknown());
  }
  return neighbour;
}

TrackedBelief GaussianEstimator::unknown() const {
  return {Belief::unknown(options_.dimension),
          keeps_ledger() && options_.motion ? Ledger::moving(options_.dimension) : Ledger{}};
}

void GaussianEstimator::advance(std::int64_t now) {
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

void GaussianEstimator::predict(TrackedBelief& tracked, std::int64_t step) const {
  if (tracked.belief.omega.isZero(0.0) && tracked.ledger.weights().empty()) return;
  const gaussian::Prediction predicted =
      gaussian::predict_with_gain(tracked.belief, options_.motion->step);
  tracked.belief = predicted.belief;
  if (!keeps_ledger()) return;
  tracked.ledger.predict(predicted.F, predicted.belief.omega, static_cast<std::size_t>(step));
}

void GaussianEstimator::measured(int subject, const Belief& information, std::size_t measurement) {
  const auto s = static_cast<std::size_t>(subject);
  const auto use = [&](TrackedBelief& tracked) {
    tracked.belief += information;
    if (keeps_ledger()) tracked.ledger.measured(measurement);
  };
  use(own_[s]);
  if (!unsent_.empty()) use(unsent_[s]);
  ++counts_.measurements;
}

GaussianEstimator::Speech GaussianEstimator::speech(AgentId neighbour) {
  const Neighbour* to = neighbour == no_agent ? nullptr : find(neighbour);
  require(rule_.sends != Sends::belief_less_heard || to != nullptr,
          "a rule that speaks to each neighbour needs one");
  LedgerRider* rider = nullptr;
  Speech speech;
  if (keeps_ledger()) {
    speech.rider = options_.ledgers->make(rider);
    rider->ledgers.resize(own_.size());
    if (rule_.sends == Sends::hybrid) rider->fresh.resize(own_.size());
  }
  gaussian::Message& message = workspace_->outgoing.message;
  gaussian::MessageExtras& extras = workspace_->outgoing_extras;
  message.beliefs.resize(own_.size());
  if (!unsent_.empty()) extras.fresh.resize(own_.size());
  extras.degree = static_cast<std::uint32_t>(degree_);
  extras.bits = options_.bits;
  if (options_.content == Content::quantised) extras.quantised.resize(own_.size());
  std::size_t spoken = 0;
  for (std::size_t s = 0; s < own_.size(); ++s) {
    if (put_into_words(s, to, spoken, rider)) ++spoken;
  }
  message.beliefs.resize(spoken);
  if (spoken == 0) return {};
  message.incarnation = incarnation_;
  message.count = next_count_++;
  if (options_.motion) {
    workspace_->outgoing.stamp = stamp_ * options_.motion->period.nanoseconds();
    gaussian::encode(form_, workspace_->outgoing, workspace_->outgoing_extras, workspace_->bytes);
  } else {
    gaussian::encode(form_, message, workspace_->outgoing_extras, workspace_->bytes);
  }
  speech.bytes = workspace_->bytes;
  return speech;
}

/// Fills in entry `at` of the message; false if there is nothing to say.
bool GaussianEstimator::put_into_words(std::size_t subject, const Neighbour* to, std::size_t at,
                                       LedgerRider* rider) {
  const bool update = rule_.sends == Sends::local_update;
  const bool less_heard = rule_.sends == Sends::belief_less_heard;
  const TrackedBelief& says = update ? unsent_[subject] : own_[subject];
  gaussian::BeliefEntry& entry = workspace_->outgoing.message.beliefs[at];
  entry.subject = static_cast<std::uint32_t>(subject);
  entry.belief = says.belief;
  if (less_heard) entry.belief -= to->memory[subject].belief;
  if (entry.belief.omega.isZero(0.0)) return false;
  if (rider) {
    rider->ledgers[at] = says.ledger;
    if (!options_.exact) rider->ledgers[at].mark_inexact();
    if (less_heard) {
      rider->ledgers[at].combine(1.0, 0.0, says.ledger, 1.0, &to->memory[subject].ledger);
    }
    if (rule_.sends == Sends::hybrid) rider->fresh[at] = unsent_[subject].ledger;
  }
  if (!unsent_.empty() && !update) workspace_->outgoing_extras.fresh[at] = unsent_[subject].belief;
  return options_.content == Content::belief || shorten(at, rider);
}

void GaussianEstimator::sent(AgentId neighbour) {
  if (!last_fresh_.empty()) last_fresh_ = unsent_;
  for (TrackedBelief& unsent : unsent_) unsent = unknown();
  for (std::size_t s = 0; s < own_.size(); ++s) last_said_[s] = own_[s].belief;
  last_said_at_ = stamp_;
  if (rule_.memory != Memory::last_exchanged) return;
  for (Neighbour& to : neighbours_) {
    if (neighbour == no_agent || neighbour == to.id) to.memory = own_;
  }
}

void GaussianEstimator::heard(AgentId from, std::span<const std::byte> bytes, const Rider* rider) {
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
    const Ledger* const ledger = ledgers ? &ledgers->ledgers[i] : nullptr;
    if (rule_.fuses == Fuses::at_once) {
      hold(entry.subject, *sender, i, ledgers);
    } else if (rule_.fuses == Fuses::by_parts) {
      fuse_by_parts(entry.subject, i, ledger);
    } else if (options_.motion) {
      fuse_older(subject, *sender, entry.belief, ledger);
    } else {
      fuse(subject, *sender, entry.belief, ledger);
    }
  }
}

/// A belief about a moving state, which is brought to the present first.
void GaussianEstimator::fuse_older(int subject, Neighbour& from, const Belief& belief,
                                   const Ledger* ledger) {
  received_.belief = belief;
  if (ledger != nullptr) received_.ledger = *ledger;
  std::int64_t step = workspace_->incoming.stamp / options_.motion->period.nanoseconds();
  for (; step < stamp_; ++step) predict(received_, step);
  fuse(subject, from, received_.belief, ledger ? &received_.ledger : nullptr);
}

bool GaussianEstimator::decode(std::span<const std::byte> bytes,
                               gaussian::StampedMessage& message) const {
  if (!options_.motion) {
    return gaussian::decode(form_, bytes, message.message, workspace_->incoming_extras);
  }
  const std::int64_t period = options_.motion->period.nanoseconds();
  return gaussian::decode(form_, bytes, message, workspace_->incoming_extras) &&
         message.stamp >= 0 && message.stamp <= stamp_ * period && message.stamp % period == 0;
}

bool GaussianEstimator::outdated(Neighbour& from, const gaussian::Message& message) const {
  // Algorithm 3.4 as printed adds whatever arrives; only rules that replace need an order, and
  // those for which what was fresh once is not any more.
  const bool ordered = rule_.memory == Memory::last_heard || rule_.memory == Memory::held ||
                       rule_.fuses == Fuses::by_parts;
  if (!ordered || !from.heard) return false;
  if (message.incarnation != from.incarnation) return message.incarnation < from.incarnation;
  return message.count <= from.count;
}

void GaussianEstimator::fuse(int subject, Neighbour& from, const Belief& belief,
                             const Ledger* ledger) {
  const auto s = static_cast<std::size_t>(subject);
  TrackedBelief& own = own_[s];
  if (rule_.fuses == Fuses::by_direction) return fuse_by_direction(own, belief, ledger);
  TrackedBelief* memory = rule_.memory == Memory::nothing ? nullptr : &from.memory[s];
  const gaussian::Coefficients k =
      gaussian::coefficients(options_.rule, own.belief, belief, options_.omega);
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

void GaussianEstimator::fuse_by_direction(TrackedBelief& own, const Belief& belief,
                                          const Ledger* ledger) {
  take(own, gaussian::fuse_by_direction(options_.rule, own.belief, belief), belief, ledger);
}

void GaussianEstimator::take(TrackedBelief& own, const gaussian::DirectionalFusion& fusion,
                             const Belief& belief, const Ledger* ledger) {
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

void GaussianEstimator::note_gain(const Belief& before, const Belief& received,
                                  const Belief& after) {
  const auto a = gaussian::claimed_sigma(before);
  const auto b = gaussian::claimed_sigma(received);
  const auto c = gaussian::claimed_sigma(after);
  if (!a || !b || !c) return;
  counts_.fusion_gain_max = std::max(counts_.fusion_gain_max, 1.0 - *c / std::min(*a, *b));
}

void GaussianEstimator::new_incarnation() {
  ++incarnation_;
  next_count_ = 1;
}

void GaussianEstimator::forget() {
  new_incarnation();
  for (std::vector<TrackedBelief>* beliefs : {&own_, &unsent_, &last_fresh_}) {
    for (TrackedBelief& tracked : *beliefs) tracked = unknown();
  }
  if (keeps_ledger() && !options_.exact) {
    for (TrackedBelief& own : own_) own.ledger.mark_inexact();
  }
  last_said_.assign(own_.size(), Belief::unknown(options_.dimension));
  for (Neighbour& neighbour : neighbours_) neighbour = make_neighbour(neighbour.id);
}

GaussianEstimator::Neighbour* GaussianEstimator::find(AgentId id) {
  const auto found = std::lower_bound(neighbours_.begin(), neighbours_.end(), id,
                                      [](const Neighbour& n, AgentId i) { return n.id < i; });
  if (found != neighbours_.end() && found->id == id) return &*found;
  return options_.strangers ? &*neighbours_.insert(found, make_neighbour(id)) : nullptr;
}

}  // namespace hearsay
