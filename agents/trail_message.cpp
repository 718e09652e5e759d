#include "agents/trail_message.hpp"

namespace hearsay {
namespace {

using gaussian::Trajectory;
using gaussian::TrajectoryStep;

/// False unless the steps are a trail of dimension n, none of them later than `now`.
bool take_trail(std::span<const TrajectoryStep> steps, int n, gaussian::Stamp now,
                std::optional<Trajectory>& out) {
  out.reset();
  for (std::size_t k = 0; k < steps.size(); ++k) {
    const TrajectoryStep& step = steps[k];
    const bool last = k + 1 == steps.size();
    const bool tied = step.next.size() > 0;
    if (step.information.dimension() != n || tied == last || step.stamp > now) return false;
    if (out && step.stamp <= out->stamps().back()) return false;
    if (out) {
      out->append(step.stamp, steps[k - 1].next, step.information);
    } else {
      out.emplace(n, step.stamp).update(0, step.information);
    }
  }
  return true;
}

}  // namespace

void put_tracks(std::span<const tracking::Report> reports, gaussian::Stamp now,
                gaussian::TrajectoryMessage& out) {
  out.trajectories.resize(reports.size());
  for (std::size_t i = 0; i < reports.size(); ++i) {
    const tracking::Report& report = reports[i];
    gaussian::TrajectoryEntry& entry = out.trajectories[i];
    const int steps = report.trail ? report.trail->steps() : 0;
    entry.subject = report.label;
    entry.first = steps > 0 ? report.trail->stamps().front() : now;
    entry.steps.resize(static_cast<std::size_t>(steps) + 1);
    for (int k = 0; k < steps; ++k) {
      const Trajectory& trail = *report.trail;
      TrajectoryStep& step = entry.steps[static_cast<std::size_t>(k)];
      step.stamp = trail.stamps()[static_cast<std::size_t>(k)];
      step.information.omega = trail.omega(k);
      step.information.xi = trail.xi(k);
      step.next.resize(0, 0);
      if (k + 1 < steps) step.next = trail.omega_next(k);
    }
    entry.steps.back() = {.stamp = now, .information = report.belief, .next = {}};
  }
}

std::optional<gaussian::Stamp> take_tracks(const gaussian::TrajectoryMessage& message,
                                           std::vector<tracking::Report>& out) {
  out.resize(message.trajectories.size());
  std::optional<gaussian::Stamp> now;
  for (std::size_t i = 0; i < out.size(); ++i) {
    const std::vector<TrajectoryStep>& steps = message.trajectories[i].steps;
    if (steps.empty() || steps.back().next.size() > 0) return std::nullopt;
    if (steps.back().stamp != now.value_or(steps.back().stamp)) return std::nullopt;
    now = steps.back().stamp;
    out[i].label = message.trajectories[i].subject;
    out[i].belief = steps.back().information;
    const auto trail = std::span(steps).first(steps.size() - 1);
    if (!take_trail(trail, out[i].belief.dimension(), *now, out[i].trail)) return std::nullopt;
  }
  return now;
}

}  // namespace hearsay
