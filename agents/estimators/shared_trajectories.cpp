#include "agents/estimators/shared_trajectories.hpp"

#include <algorithm>

#include "sim/kernel/error.hpp"

namespace hearsay {

using gaussian::Belief;
using gaussian::Rule;

std::optional<TrajectoryExchange> exchange_of(Rule rule) {
  switch (rule) {
    case Rule::none:
    case Rule::local_update:
      return TrajectoryExchange::own;
    case Rule::naive:
      return TrajectoryExchange::everything;
    case Rule::channel_robust:
      return TrajectoryExchange::all_but_yours;
    default:
      return std::nullopt;
  }
}

std::span<const Rule> trajectory_rules() {
  static constexpr Rule rules[] = {Rule::none,    Rule::local_update,   Rule::naive,
                                   Rule::channel, Rule::channel_robust, Rule::ci_det,
                                   Rule::ci_half};
  return rules;
}

SharedTrajectories::SharedTrajectories(const Options& options) : options_(options) {
  require(options.workspace != nullptr, "trajectories need a workspace");
  for (int s = 0; s < options.subjects; ++s) {
    tracks_.push_back({.filter = TrajectoryEstimator({.exchange = options.exchange,
                                                      .step = options.motion.step,
                                                      .steps_max = options.steps_max},
                                                     0)});
  }
}

std::span<const std::uint8_t> SharedTrajectories::between(std::size_t subject, std::int64_t first,
                                                          std::int64_t last) const {
  const std::vector<std::int64_t>& stamps = options_.workspace->measured_at[subject];
  chosen_.assign(stamps.size(), 0);
  for (std::size_t k = 0; k < stamps.size(); ++k) {
    chosen_[k] = stamps[k] >= first && stamps[k] <= last ? 1 : 0;
  }
  return chosen_;
}

Ledger SharedTrajectories::window(const Track& track, AgentId but) const {
  Ledger sum = track.own;
  for (const auto& [who, ledger] : track.said) {
    if (who != but) sum.combine(1.0, 1.0, ledger, 0.0, nullptr);
  }
  return sum;
}

void SharedTrajectories::advance(std::int64_t now) {
  for (std::size_t s = 0; s < tracks_.size(); ++s) {
    Track& track = tracks_[s];
    const std::int64_t first = std::max(track.filter.first(), now - options_.steps_max + 1);
    if (keeps_ledger() && first > track.filter.first()) {
      track.base.replace(window(track, no_agent), between(s, track.filter.first(), first - 1));
    }
    track.filter.advance(now);
  }
}

void SharedTrajectories::measured(int subject, const Belief& information, std::size_t measurement) {
  Track& track = tracks_[static_cast<std::size_t>(subject)];
  track.filter.measured(track.filter.last(), information);
  if (keeps_ledger()) track.own.measured(measurement);
  ++counts_.measurements;
}

Estimator::Speech SharedTrajectories::speech(AgentId neighbour) {
  gaussian::TrajectoryMessage& message = options_.workspace->outgoing_trajectories;
  const std::int64_t period = options_.motion.period.nanoseconds();
  LedgerRider* rider = nullptr;
  Speech speech;
  if (keeps_ledger()) {
    speech.rider = options_.ledgers->make(rider);
    rider->ledgers.clear();
  }
  std::size_t spoken = 0;
  message.trajectories.resize(tracks_.size());
  for (std::size_t s = 0; s < tracks_.size(); ++s) {
    Track& track = tracks_[s];
    track.filter.speak(neighbour, message_);
    message.incarnation = message_.incarnation;
    message.count = message_.count;
    if (message_.entries.empty()) continue;
    gaussian::TrajectoryEntry& entry = message.trajectories[spoken++];
    entry.subject = static_cast<std::uint32_t>(s);
    entry.first = message_.first * period;
    entry.steps.clear();
    for (const TrajectoryEstimator::Entry& step : message_.entries) {
      entry.steps.push_back({.stamp = step.stamp * period, .information = step.information});
    }
    if (!rider) continue;
    Ledger& told = rider->ledgers.emplace_back();
    const bool own = options_.exchange == TrajectoryExchange::own;
    const bool less = options_.exchange == TrajectoryExchange::all_but_yours;
    told.replace(own ? track.own : window(track, less ? neighbour : no_agent),
                 between(s, track.filter.first(), track.filter.last()));
  }
  message.trajectories.resize(spoken);
  if (spoken == 0) return {};
  gaussian::encode(message, options_.workspace->bytes);
  speech.bytes = options_.workspace->bytes;
  return speech;
}

bool SharedTrajectories::decode(std::span<const std::byte> bytes) {
  gaussian::TrajectoryMessage& message = options_.workspace->incoming_trajectories;
  if (!gaussian::decode(bytes, message)) return false;
  const std::int64_t period = options_.motion.period.nanoseconds();
  const auto fits = [&](gaussian::Stamp stamp) { return stamp >= 0 && stamp % period == 0; };
  for (const gaussian::TrajectoryEntry& entry : message.trajectories) {
    if (entry.subject >= tracks_.size() || !fits(entry.first)) return false;
    for (const gaussian::TrajectoryStep& step : entry.steps) {
      if (!fits(step.stamp) || step.next.size() != 0) return false;
    }
  }
  return true;
}

void SharedTrajectories::heard(AgentId from, std::span<const std::byte> bytes, const Rider* rider) {
  if (!decode(bytes)) {
    ++counts_.refused;
    return;
  }
  const gaussian::TrajectoryMessage& message = options_.workspace->incoming_trajectories;
  const std::int64_t period = options_.motion.period.nanoseconds();
  const auto* ledgers = static_cast<const LedgerRider*>(rider);
  for (std::size_t i = 0; i < message.trajectories.size(); ++i) {
    const gaussian::TrajectoryEntry& entry = message.trajectories[i];
    message_.incarnation = message.incarnation;
    message_.count = message.count;
    message_.first = entry.first / period;
    message_.entries.clear();
    for (const gaussian::TrajectoryStep& step : entry.steps) {
      message_.entries.push_back({step.stamp / period, step.information});
    }
    heard(entry.subject, from, message_, ledgers ? &ledgers->ledgers[i] : nullptr);
  }
  count();
}

void SharedTrajectories::heard(std::size_t subject, AgentId from,
                               const TrajectoryEstimator::Message& message, const Ledger* ledger) {
  Track& track = tracks_[subject];
  if (!track.filter.heard(from, message)) {
    ++counts_.refused;
    return;
  }
  ++counts_.fusions;
  if (!keeps_ledger() || ledger == nullptr) return;
  const std::int64_t first = track.filter.first(), last = track.filter.last();
  if (options_.exchange == TrajectoryExchange::everything) {
    Ledger news;
    news.replace(*ledger, between(subject, first, last));
    track.own.combine(1.0, 1.0, news, 0.0, nullptr);
  } else {
    track.said[from].replace(*ledger, between(subject, std::max(first, message.first), last));
  }
}

void SharedTrajectories::count() {
  counts_.late = 0;
  for (const Track& track : tracks_) counts_.late += track.filter.counts().late;
}

void SharedTrajectories::forget() {
  for (Track& track : tracks_) {
    track.filter.forget(track.filter.last());
    track.base.clear();
    track.own.clear();
    track.said.clear();
  }
}

const TrackedBelief& SharedTrajectories::tracked(int subject) const {
  const auto s = static_cast<std::size_t>(subject);
  const Track& track = tracks_[s];
  track.present.belief = track.filter.present();
  if (keeps_ledger()) {
    Ledger sum = window(track, no_agent);
    sum.replace(track.base, between(s, 0, track.filter.first() - 1));
    track.present.ledger = sum;
  }
  return track.present;
}

}  // namespace hearsay
