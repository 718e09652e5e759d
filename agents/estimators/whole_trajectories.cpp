#include "agents/estimators/whole_trajectories.hpp"

#include <algorithm>
#include <utility>

#include "filters/gaussian/trajectory_factor.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay {

using gaussian::Belief;
using gaussian::Rule;
using gaussian::Trajectory;

WholeTrajectories::WholeTrajectories(const Options& options, std::span<const AgentId> neighbours)
    : options_(options) {
  require(options.workspace != nullptr, "trajectories need a workspace");
  require(options.steps_max >= 1, "a trajectory needs at least one stamp");
  require(options.rule == Rule::channel || options.rule == Rule::ci_det ||
              options.rule == Rule::ci_half,
          "this rule is not for whole trajectories");
  for (int s = 0; s < options.subjects; ++s) own_.push_back(unknown());
  if (options_.rule != Rule::channel) return;
  for (const AgentId neighbour : neighbours) common_with(neighbour);
}

WholeTrajectories::Track WholeTrajectories::unknown() const {
  const std::int64_t first = std::max<std::int64_t>(0, now_ - options_.steps_max + 1);
  Track track{Trajectory(static_cast<int>(options_.motion.step.A.rows()), first), {}};
  advance(track.trajectory, now_);
  return track;
}

void WholeTrajectories::advance(Trajectory& trajectory, std::int64_t now) const {
  const std::int64_t first = std::max<std::int64_t>(0, now - options_.steps_max + 1);
  while (trajectory.stamps().back() < now || trajectory.stamps().front() < first) {
    if (trajectory.stamps().back() < now) {
      trajectory.augment(trajectory.stamps().back() + 1, options_.motion.step);
    }
    if (trajectory.stamps().front() >= first) continue;
    if (trajectory.marginalise(0)) continue;
    // Only a belief that a faulty rule blew up: nothing can be concluded from it any more.
    trajectory = Trajectory(trajectory.dimension(), first);
  }
}

void WholeTrajectories::advance(std::int64_t now) {
  require(now >= now_, "an estimator does not go back in time");
  if (now == now_) return;
  now_ = now;
  for (Track& track : own_) advance(track.trajectory, now);
  for (auto& [who, tracks] : common_) {
    for (Track& track : tracks) advance(track.trajectory, now);
  }
}

void WholeTrajectories::measured(int subject, const Belief& information, std::size_t measurement) {
  Track& track = own_[static_cast<std::size_t>(subject)];
  track.trajectory.update(track.trajectory.steps() - 1, information);
  if (keeps_ledger()) track.ledger.measured(measurement);
  ++counts_.measurements;
}

Estimator::Speech WholeTrajectories::speech(AgentId) {
  gaussian::TrajectoryMessage& message = options_.workspace->outgoing_trajectories;
  const std::int64_t period = options_.motion.period.nanoseconds();
  LedgerRider* rider = nullptr;
  Speech speech;
  if (keeps_ledger()) {
    speech.rider = options_.ledgers->make(rider);
    rider->ledgers.clear();
  }
  message.incarnation = incarnation_;
  message.count = next_count_++;
  message.trajectories.resize(own_.size());
  std::size_t spoken = 0;
  for (std::size_t s = 0; s < own_.size(); ++s) {
    const Trajectory& said = own_[s].trajectory;
    // Its mean and the motion alone: as long as nothing was measured or heard, ξ = 0 everywhere.
    const bool silent = gaussian::present(said).omega.isZero(0.0);
    if (silent) continue;
    gaussian::TrajectoryEntry& entry = message.trajectories[spoken++];
    entry.subject = static_cast<std::uint32_t>(s);
    entry.first = said.stamps().front() * period;
    entry.steps.resize(static_cast<std::size_t>(said.steps()));
    for (int k = 0; k < said.steps(); ++k) {
      gaussian::TrajectoryStep& step = entry.steps[static_cast<std::size_t>(k)];
      step.stamp = said.stamps()[static_cast<std::size_t>(k)] * period;
      step.information = {said.omega(k), said.xi(k)};
      step.next.resize(0, 0);
      if (k + 1 < said.steps()) step.next = said.omega_next(k);
    }
    if (rider) rider->ledgers.push_back(own_[s].ledger);
  }
  message.trajectories.resize(spoken);
  if (spoken == 0) return {};
  gaussian::encode(message, options_.workspace->bytes);
  speech.bytes = options_.workspace->bytes;
  return speech;
}

std::vector<WholeTrajectories::Track>& WholeTrajectories::common_with(AgentId neighbour) {
  std::vector<Track>& common = common_[neighbour];
  while (common.size() < own_.size()) common.push_back(unknown());
  return common;
}

void WholeTrajectories::sent(AgentId neighbour) {
  if (options_.rule != Rule::channel) return;
  if (neighbour != no_agent) common_with(neighbour) = own_;
  for (auto& [who, common] : common_) {
    if (neighbour == no_agent) common = own_;
  }
}

std::optional<Trajectory> WholeTrajectories::brought_here(
    const gaussian::TrajectoryEntry& entry) const {
  const std::int64_t period = options_.motion.period.nanoseconds();
  const Trajectory& own = own_[entry.subject].trajectory;
  const auto n = own.dimension();
  if (entry.steps.empty() || entry.first < 0 || entry.first % period != 0) return std::nullopt;
  Trajectory received(n, entry.first / period);
  for (std::size_t k = 0; k < entry.steps.size(); ++k) {
    const gaussian::TrajectoryStep& step = entry.steps[k];
    const bool last = k + 1 == entry.steps.size();
    if (step.stamp != entry.first + static_cast<std::int64_t>(k) * period) return std::nullopt;
    if (step.information.dimension() != n || (step.next.size() == 0) != last) return std::nullopt;
    if (k == 0) {
      received.update(0, step.information);
    } else {
      received.append(step.stamp / period, entry.steps[k - 1].next, step.information);
    }
  }
  if (received.stamps().back() > now_ || received.stamps().front() > own.stamps().front()) {
    return std::nullopt;
  }
  advance(received, now_);
  return received;
}

void WholeTrajectories::heard(AgentId from, std::span<const std::byte> bytes, const Rider* rider) {
  gaussian::TrajectoryMessage& message = options_.workspace->incoming_trajectories;
  if (!gaussian::decode(bytes, message)) {
    ++counts_.refused;
    return;
  }
  const auto* ledgers = static_cast<const LedgerRider*>(rider);
  for (std::size_t i = 0; i < message.trajectories.size(); ++i) {
    const gaussian::TrajectoryEntry& entry = message.trajectories[i];
    auto received = entry.subject < own_.size() ? brought_here(entry) : std::nullopt;
    if (!received) {
      ++counts_.refused;
      continue;
    }
    fuse(entry.subject, from, {std::move(*received), ledgers ? ledgers->ledgers[i] : Ledger{}});
  }
}

void WholeTrajectories::fuse(std::size_t subject, AgentId from, Track received) {
  Track& own = own_[subject];
  if (options_.rule == Rule::channel) {
    Track& common = common_with(from)[subject];
    own.trajectory += received.trajectory;
    own.trajectory -= common.trajectory;
    if (keeps_ledger()) own.ledger.combine(1.0, 1.0, received.ledger, 1.0, &common.ledger);
    common = std::move(received);
    ++counts_.fusions;
    return;
  }
  const auto omega = options_.rule == Rule::ci_half
                         ? std::optional<double>(0.5)
                         : gaussian::intersect_det(own.trajectory, received.trajectory);
  if (!omega) {
    ++counts_.skipped;
    return;
  }
  ++counts_.fusions;
  own.trajectory.intersect(*omega, received.trajectory);
  if (!keeps_ledger()) return;
  own.ledger.combine(*omega, 1.0 - *omega, received.ledger, 0.0, nullptr);
}

void WholeTrajectories::forget() {
  ++incarnation_;
  next_count_ = 1;
  for (Track& track : own_) track = unknown();
  for (auto& [who, common] : common_) common = own_;
}

const TrackedBelief& WholeTrajectories::tracked(int subject) const {
  const Track& track = own_[static_cast<std::size_t>(subject)];
  present_.belief = gaussian::present(track.trajectory);
  present_.ledger = track.ledger;
  return present_;
}

}  // namespace hearsay
