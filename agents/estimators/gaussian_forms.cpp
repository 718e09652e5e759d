// The estimator's rules that fuse all at once or by parts, and what it says instead of whole
// beliefs.
#include <algorithm>
#include <limits>
#include <optional>

#include "agents/estimators/gaussian.hpp"
#include "filters/gaussian/content.hpp"
#include "filters/gaussian/split.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay {

using gaussian::Belief;
using gaussian::MessageForm;
using gaussian::Rule;
using gaussian::Sends;

namespace {

bool usable(const Belief& belief) {
  const gaussian::Definiteness kind = gaussian::definiteness(belief);
  return kind == gaussian::Definiteness::positive || kind == gaussian::Definiteness::singular;
}

}  // namespace

MessageForm message_form(Rule rule, Content content) {
  const gaussian::RuleInfo& info = gaussian::info(rule);
  if (content != Content::belief) {
    require(can_say_less(rule), "a content that does not go with the rule");
    return content == Content::diagonal ? MessageForm::diagonal : MessageForm::quantised;
  }
  switch (info.sends) {
    case Sends::belief_and_fresh:
      return MessageForm::split;
    case Sends::belief_and_degree:
      return MessageForm::consensus;
    case Sends::hybrid:
      return MessageForm::hybrid;
    case Sends::nothing:
    case Sends::belief:
    case Sends::local_update:
    case Sends::belief_less_heard:
      break;
  }
  return MessageForm::plain;
}

bool can_say_less(Rule rule) {
  const gaussian::RuleInfo& info = gaussian::info(rule);
  return info.sends == Sends::belief && info.memory != gaussian::Memory::last_exchanged;
}

/// Puts less into entry `at` of the message; false if nothing can be said of it.
bool GaussianEstimator::shorten(std::size_t at, LedgerRider* rider) {
  gaussian::BeliefEntry& entry = workspace_->outgoing.message.beliefs[at];
  std::optional<Belief> less;
  if (options_.content == Content::diagonal) {
    less = gaussian::diagonal_part(entry.belief);
  } else if (const auto grid = gaussian::quantise(entry.belief, options_.bits)) {
    workspace_->outgoing_extras.quantised[at] = *grid;
    less = gaussian::belief_of(*grid, options_.bits);
  }
  if (!less) return false;
  if (rider) {
    Ledger& ledger = rider->ledgers[at];
    const int n = options_.dimension;
    ledger.combine(gaussian::gain_of(entry.belief.omega, less->omega), gaussian::Matrix::Zero(n, n),
                   Ledger());
    if (options_.content == Content::quantised) ledger.mark_inexact();
  }
  entry.belief = *less;
  return true;
}

/// What the neighbours make of it by now, who know the motion, too.
void GaussianEstimator::predict_last_said() const {
  for (; last_said_at_ < stamp_; ++last_said_at_) {
    for (Belief& said : last_said_) {
      if (!said.omega.isZero(0.0)) said = gaussian::predict(said, options_.motion->step);
    }
  }
}

double GaussianEstimator::news_nats() const {
  predict_last_said();
  double most = 0.0;
  for (std::size_t s = 0; s < own_.size(); ++s) {
    const Belief& now = own_[s].belief;
    const Belief& then = last_said_[s];
    if (now.omega == then.omega && now.xi == then.xi) continue;
    const auto news = gaussian::kl_divergence_nats(now, then);
    most = std::max(most, news.value_or(std::numeric_limits<double>::infinity()));
  }
  return most;
}

void GaussianEstimator::about_to_talk(int degree) {
  degree_ = degree;
  if (rule_.fuses != gaussian::Fuses::at_once) return;
  for (std::size_t s = 0; s < own_.size(); ++s) fuse_held(s, degree);
}

void GaussianEstimator::hold(std::size_t subject, Neighbour& from, std::size_t at,
                             const LedgerRider* rider) {
  Held& held = from.held[subject];
  held.waits = true;
  held.said.belief = workspace_->incoming.message.beliefs[at].belief;
  if (rider) held.said.ledger = rider->ledgers[at];
  const gaussian::MessageExtras& extras = workspace_->incoming_extras;
  if (rule_.sends != Sends::belief)
    held.degree = static_cast<int>(std::min(extras.degree, 1u << 20));
  if (rule_.sends != Sends::hybrid) return;
  held.fresh.belief = extras.fresh[at];
  if (rider) held.fresh.ledger = rider->fresh[at];
}

/// own = own_weight·own + weight·other.
void GaussianEstimator::add_weighted(TrackedBelief& own, double own_weight, double weight,
                                     const TrackedBelief& other) const {
  own.belief *= own_weight;
  Belief weighted = other.belief;
  weighted *= weight;
  own.belief += weighted;
  if (keeps_ledger()) own.ledger.combine(own_weight, weight, other.ledger, 0.0, nullptr);
}

void GaussianEstimator::fuse_held(std::size_t subject, int degree) {
  to_fuse_.clear();
  TrackedBelief& own = own_[subject];
  const bool own_usable = usable(own.belief);
  for (Neighbour& from : neighbours_) {
    Held& held = from.held[subject];
    if (!held.waits) continue;
    held.waits = false;
    if (own_usable && usable(held.said.belief) && usable(held.fresh.belief)) {
      to_fuse_.push_back(&held);
    } else {
      ++counts_.skipped;
    }
  }
  if (to_fuse_.empty()) return;
  find_weights(subject, degree);
  const Belief before = own.belief;
  const Belief* best = &to_fuse_.front()->said.belief;
  const bool hybrid = rule_.sends == Sends::hybrid;
  const double more = options_.correction - 1.0;  // for what is fresh
  if (hybrid) {
    // What was measured since the last sending takes no part yet.
    add_weighted(own, weights_[0], 1.0 - weights_[0], unsent_[subject]);
    add_weighted(own, 1.0, more * weights_[0], last_fresh_[subject]);
    last_fresh_[subject] = {Belief::unknown(options_.dimension), Ledger()};
  }
  for (std::size_t i = 0; i < to_fuse_.size(); ++i) {
    const Held& held = *to_fuse_[i];
    add_weighted(own, i == 0 && !hybrid ? weights_[0] : 1.0, weights_[i + 1], held.said);
    if (hybrid) add_weighted(own, 1.0, more * weights_[i + 1], held.fresh);
    const auto sigma = gaussian::claimed_sigma(held.said.belief);
    const auto least = gaussian::claimed_sigma(*best);
    if (sigma && (!least || *sigma < *least)) best = &held.said.belief;
    ++counts_.fusions;
  }
  note_gain(before, *best, own.belief);
}

/// Of the own belief and of those in to_fuse_. They add up to one.
void GaussianEstimator::find_weights(std::size_t subject, int degree) {
  weights_.assign(to_fuse_.size() + 1, 0.0);
  if (options_.rule == Rule::ci_batch) {
    matrices_.assign(1, &own_[subject].belief.omega);
    for (const Held* held : to_fuse_) matrices_.push_back(&held->said.belief.omega);
    const std::span<const double> found = workspace_->batch.weights(matrices_);
    std::copy(found.begin(), found.end(), weights_.begin());
    return;
  }
  // Whoever was heard was a neighbour, also if it is none any more.
  const int mine = std::max(degree, static_cast<int>(to_fuse_.size()));
  weights_[0] = 1.0;
  for (std::size_t i = 0; i < to_fuse_.size(); ++i) {
    weights_[i + 1] = gaussian::metropolis_weight(mine, to_fuse_[i]->degree);
    weights_[0] -= weights_[i + 1];
  }
}

void GaussianEstimator::fuse_by_parts(std::size_t subject, std::size_t at, const Ledger* ledger) {
  TrackedBelief& own = own_[subject];
  Belief& part = unsent_[subject].belief;
  const Belief& belief = workspace_->incoming.message.beliefs[at].belief;
  const gaussian::SplitFusion fusion = gaussian::fuse_split(
      own.belief, part.omega, belief, workspace_->incoming_extras.fresh[at].omega);
  if (fusion.skipped == nullptr) part.omega = fusion.independent;
  take(own, {fusion.belief, fusion.own, fusion.received, fusion.skipped}, belief, ledger);
}

}  // namespace hearsay
