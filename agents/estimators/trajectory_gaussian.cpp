#include "agents/estimators/trajectory_gaussian.hpp"

#include <algorithm>
#include <utility>

#include "sim/kernel/error.hpp"

namespace hearsay {

using gaussian::Belief;

TrajectoryEstimator::TrajectoryEstimator(Options options, Stamp first)
    : options_(std::move(options)),
      first_(first),
      last_(first),
      base_(Belief::unknown(dimension())),
      trajectory_(dimension(), first) {
  require(options_.steps_max >= 1, "a trajectory needs at least one stamp");
  own_ = blank();
}

TrajectoryEstimator::Track TrajectoryEstimator::blank() const {
  return Track(2 * static_cast<std::size_t>(options_.steps_max), Belief::unknown(dimension()));
}

std::size_t TrajectoryEstimator::place(Stamp stamp) const {
  const Stamp ring = 2 * options_.steps_max;
  return static_cast<std::size_t>((stamp % ring + ring) % ring);
}

void TrajectoryEstimator::advance(Stamp now) {
  require(now >= last_, "a trajectory does not go back in time");
  current_ = current_ && now == last_;
  while (last_ < now) {
    ++last_;
    at(own_, last_) = Belief::unknown(dimension());
    for (Neighbour& other : neighbours_) at(other.said, last_) = Belief::unknown(dimension());
    if (last_ - first_ < options_.steps_max) continue;
    base_ += all_of(first_, no_agent);
    base_ = gaussian::predict(base_, options_.step);
    ++first_;
  }
}

bool TrajectoryEstimator::measured(Stamp stamp, const Belief& information) {
  require(stamp <= last_, "measured in the future of its trajectory");
  if (stamp < first_) {
    ++counts_.late;
    return false;
  }
  at(own_, stamp) += information;
  current_ = false;
  return true;
}

// Own information and what all but one have said of a stamp.
Belief TrajectoryEstimator::all_of(Stamp stamp, AgentId but) {
  Belief sum = at(own_, stamp);
  for (Neighbour& other : neighbours_) {
    if (other.id != but) sum += at(other.said, stamp);
  }
  return sum;
}

void TrajectoryEstimator::speak(AgentId neighbour, Message& message) {
  message.incarnation = incarnation_;
  message.count = next_count_++;
  message.first = first_;
  message.entries.clear();
  for (Stamp stamp = first_; stamp <= last_; ++stamp) {
    const Belief said = options_.exchange == TrajectoryExchange::own ? at(own_, stamp)
                        : options_.exchange == TrajectoryExchange::everything
                            ? all_of(stamp, no_agent)
                            : all_of(stamp, neighbour);
    if (!said.omega.isZero(0.0)) message.entries.push_back({stamp, said});
  }
}

bool TrajectoryEstimator::usable(const Neighbour& from, const Message& message) const {
  if (from.heard && (message.incarnation < from.incarnation ||
                     (message.incarnation == from.incarnation && message.count <= from.count))) {
    return false;
  }
  Stamp before = message.first - 1;
  for (const Entry& entry : message.entries) {
    const Belief& said = entry.information;
    if (entry.stamp <= before || entry.stamp > last_) return false;
    if (said.dimension() != dimension() || said.omega.rows() != dimension()) return false;
    before = entry.stamp;
  }
  return true;
}

bool TrajectoryEstimator::heard(AgentId from, const Message& message) {
  Neighbour& sender = neighbour(from);
  if (!usable(sender, message)) {
    ++counts_.refused;
    return false;
  }
  sender.heard = true;
  sender.incarnation = message.incarnation;
  sender.count = message.count;
  current_ = false;
  if (options_.exchange == TrajectoryExchange::everything) {
    for (const Entry& entry : message.entries) measured(entry.stamp, entry.information);
    return true;
  }
  const Belief nothing = Belief::unknown(dimension());
  auto entry = message.entries.begin();
  const Stamp remembered = std::max(message.first, last_ - 2 * options_.steps_max + 1);
  for (Stamp stamp = remembered; stamp <= last_; ++stamp) {
    while (entry != message.entries.end() && entry->stamp < stamp) ++entry;
    const bool told = entry != message.entries.end() && entry->stamp == stamp;
    replace(sender, stamp, told ? entry->information : nothing);
  }
  return true;
}

void TrajectoryEstimator::replace(Neighbour& from, Stamp stamp, const Belief& information) {
  Belief& said = at(from.said, stamp);
  if (stamp < first_ && said.omega != information.omega) ++counts_.late;
  said = information;
}

TrajectoryEstimator::Neighbour& TrajectoryEstimator::neighbour(AgentId id) {
  const auto found = std::lower_bound(neighbours_.begin(), neighbours_.end(), id,
                                      [](const Neighbour& n, AgentId i) { return n.id < i; });
  if (found != neighbours_.end() && found->id == id) return *found;
  return *neighbours_.insert(found, {.id = id, .said = blank()});
}

const gaussian::Trajectory& TrajectoryEstimator::belief() {
  if (std::exchange(current_, true)) return trajectory_;
  trajectory_ = gaussian::Trajectory(dimension(), first_);
  trajectory_.update(0, base_);
  for (Stamp stamp = first_; stamp <= last_; ++stamp) {
    if (stamp > first_) trajectory_.augment(stamp, options_.step);
    trajectory_.update(static_cast<int>(stamp - first_), all_of(stamp, no_agent));
  }
  return trajectory_;
}

Belief TrajectoryEstimator::present() {
  Belief belief = base_;
  belief += all_of(first_, no_agent);
  for (Stamp stamp = first_ + 1; stamp <= last_; ++stamp) {
    belief = gaussian::predict(belief, options_.step);
    belief += all_of(stamp, no_agent);
  }
  return belief;
}

void TrajectoryEstimator::forget(Stamp now) {
  ++incarnation_;
  next_count_ = 1;
  first_ = last_ = now;
  base_ = Belief::unknown(dimension());
  own_ = blank();
  neighbours_.clear();
  current_ = false;
}

}  // namespace hearsay
