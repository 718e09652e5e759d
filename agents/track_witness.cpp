#include "agents/track_witness.hpp"

namespace hearsay {
namespace {

/// Where confirmed tracks are at `now`: on from their last stamp at their last velocity.
std::vector<tracking::Placed> places_of(const TrackMind& mind, Time now) {
  std::vector<tracking::Placed> places;
  const double dt_s = 1e-9 * static_cast<double>(now.nanoseconds() - mind.track_stamp());
  for (const tracking::Report& report : mind.confirmed_tracks()) {
    const auto state = gaussian::state(report.belief);
    if (!state) continue;
    gaussian::Vector position = state->head(2);
    if (state->size() == 4) position += dt_s * state->tail(2);
    places.push_back({report.label, position});
  }
  return places;
}

}  // namespace

TrackWitness::TrackWitness(Simulation& simulation, const Options& options)
    : simulation_(simulation), options_(options) {}

void TrackWitness::watch(AgentId agent, const TrackMind& mind) {
  watched_.push_back({agent, &mind, tracking::TrackScore(options_.score)});
}

void TrackWitness::start() { schedule_sample(Time()); }

void TrackWitness::schedule_sample(Time at) {
  if (at > simulation_.end()) return;
  simulation_.schedule(at, Phase::observe, [this, at] {
    sample();
    schedule_sample(at + options_.period);
  });
}

void TrackWitness::sample() {
  const Time now = simulation_.now();
  last_sample_ = now;
  std::vector<tracking::Placed> truths;
  for (std::size_t i = 0; i < options_.targets.size(); ++i) {
    const auto at = options_.targets[i].at(now);
    truths.push_back({static_cast<std::uint32_t>(i), gaussian::Vector(2)});
    truths.back().position << at[0], at[1];
  }
  for (Watched& watched : watched_) {
    keep(watched.agent, watched.score.sample(truths, places_of(*watched.mind, now)));
  }
}

void TrackWitness::keep(AgentId agent, const tracking::TrackScore::Sample& sample) {
  Record& record = simulation_.record();
  const auto row = [&](bool wanted, const char* name, double value) {
    if (wanted) record.series(simulation_.now(), agent, record.name(""), record.name(name), value);
  };
  row(options_.gospa_m, "gospa_m", sample.gospa.distance);
  row(options_.ospa_m, "ospa_m", sample.ospa.distance);
  row(options_.missed_targets, "missed_targets", sample.missed);
  row(options_.false_tracks, "false_tracks", sample.false_tracks);
  row(options_.double_tracks, "double_tracks", sample.duplicates);
}

void TrackWitness::finish() {
  if (last_sample_ != simulation_.now()) sample();
  Record& record = simulation_.record();
  for (const Watched& watched : watched_) {
    const tracking::TrackScore::Counts& counts = watched.score.counts();
    const auto leave = [&](const char* name, std::uint64_t value) {
      record.scalar(watched.agent, record.name(name), static_cast<double>(value));
    };
    leave("label_swaps", counts.label_swaps);
    leave("label_changes", counts.label_changes);
    leave("merged_tracks", counts.merged_tracks);
  }
}

}  // namespace hearsay
