#include "filters/tracking/tracker.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "filters/tracking/trail.hpp"
#include "sim/kernel/error.hpp"

namespace hearsay::tracking {
namespace {

using gaussian::Belief;
using gaussian::Matrix;
using gaussian::Vector;

constexpr double infinity = std::numeric_limits<double>::infinity();

void require_options(const Tracker::Options& o) {
  require(o.axes >= 1 && o.axes <= 4, "Tracker: 1 to 4 axes");
  require(o.q >= 0.0 && std::isfinite(o.q), "Tracker: q must not be negative");
  require(o.seconds_per_stamp > 0.0, "Tracker: seconds_per_stamp must be positive");
  require(o.q == 0.0 || (o.birth_speed_sigma > 0.0 && std::isfinite(o.birth_speed_sigma)),
          "Tracker: birth_speed_sigma must be positive");
  require(o.gate > 0.0 && std::isfinite(o.gate), "Tracker: the gate must be positive");
  require(o.confirm_hits >= 1 && o.confirm_hits <= o.confirm_scans,
          "Tracker: confirm_hits must be 1 to confirm_scans");
  require(o.misses_max >= 1 && o.tracks_max >= 1 && o.sigma_max > 0.0,
          "Tracker: bounds must be positive");
  require(o.trail == 0 || (o.trail > 0 && o.q > 0.0), "Tracker: trails are of objects that move");
  const gaussian::RuleInfo& rule = gaussian::info(o.rule);
  require(rule.memory == gaussian::Memory::nothing &&
              (rule.sends == gaussian::Sends::belief || rule.sends == gaussian::Sends::nothing),
          "Tracker: the rule must send beliefs and remember nothing");
}

bool covers(const Coverage& coverage, const Vector& position) {
  if (std::isinf(coverage.range)) return true;
  require(coverage.centre.size() == position.size(), "Coverage: the centre has other axes");
  return (position - coverage.centre).squaredNorm() <= coverage.range * coverage.range;
}

double position_sigma(const gaussian::Expected& position) {
  return std::sqrt(position.covariance.trace() / static_cast<double>(position.z.size()));
}

/// For q > 0 and by > 0.
gaussian::Transition motion(const Tracker::Options& o, gaussian::Stamp by) {
  const double dt_s = static_cast<double>(by) * o.seconds_per_stamp;
  return gaussian::white_noise_acceleration(o.axes, dt_s, o.q);
}

/// A copy of `belief`, moved on.
Belief moved(const Belief& belief, const Tracker::Options& o, gaussian::Stamp by) {
  if (o.q == 0.0 || by <= 0) return belief;
  return gaussian::predict(belief, motion(o, by));
}

}  // namespace

Tracker::Tracker(const Options& options, gaussian::Stamp start)
    : options_(options),
      n_(options.q > 0.0 ? 2 * options.axes : options.axes),
      stamp_(start),
      table_({options.gate, options.apart_max, options.pairing}) {
  require_options(options);
  M_ = Matrix::Zero(options.axes, n_);
  for (int i = 0; i < options.axes; ++i) M_(i, i) = 1.0;
}

bool Tracker::predict_to(gaussian::Stamp stamp) {
  if (stamp <= stamp_) return stamp == stamp_;
  for (Track& track : tracks_) track.belief = moved(track.belief, options_, stamp - stamp_);
  stamp_ = stamp;
  end_tracks();
  return true;
}

bool Tracker::scan(gaussian::Stamp stamp, std::span<const gaussian::PositionMeasurement> plots,
                   const Coverage& coverage) {
  if (!predict_to(stamp)) {
    ++counts_.late;
    return false;
  }
  ++counts_.scans;
  counts_.plots += plots.size();
  std::vector<char> used(plots.size(), 0);
  match(plots, coverage, true, used);
  match(plots, coverage, false, used);
  end_tracks();
  for (std::size_t i = 0; i < plots.size(); ++i) {
    if (used[i] == 0) begin_at(plots[i]);
  }
  return true;
}

/// One of the two kinds of tracks takes its plots from those not used yet.
void Tracker::match(std::span<const gaussian::PositionMeasurement> plots, const Coverage& coverage,
                    bool confirmed, std::vector<char>& used) {
  std::vector<Track*> candidates;
  std::vector<std::optional<gaussian::Expected>> positions;
  for (Track& track : tracks_) {
    if (track.confirmed != confirmed) continue;
    candidates.push_back(&track);
    positions.push_back(position(track));
  }
  Table d2(static_cast<int>(candidates.size()), static_cast<int>(plots.size()), infinity);
  for (int i = 0; i < d2.rows(); ++i) {
    const auto& position = positions[static_cast<std::size_t>(i)];
    for (int j = 0; position && j < d2.columns(); ++j) {
      const gaussian::PositionMeasurement& plot = plots[static_cast<std::size_t>(j)];
      if (used[static_cast<std::size_t>(j)] != 0) continue;
      d2(i, j) = gaussian::nis(*position, plot.S, plot.z).value_or(infinity);
    }
  }
  const std::vector<int> plot_of = pair_within(d2, options_.gate, options_.pairing);
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const bool hit = plot_of[i] != unassigned;
    if (hit) {
      const auto j = static_cast<std::size_t>(plot_of[i]);
      candidates[i]->belief += gaussian::measurement_information(M_, plots[j].S, plots[j].z);
      leave_trail(*candidates[i], plots[j]);
      used[j] = 1;
    }
    note(*candidates[i], hit, positions[i] && covers(coverage, positions[i]->z));
  }
}

void Tracker::note(Track& track, bool hit, bool covered) {
  if (!hit && !covered) return;
  ++track.scans;
  track.hits += hit ? 1 : 0;
  track.misses = hit ? 0 : track.misses + 1;
  track.seen = track.seen || hit;
  if (track.hits >= options_.confirm_hits) confirm(track);
}

void Tracker::confirm(Track& track) {
  if (track.confirmed) return;
  track.confirmed = true;
  ++counts_.confirmed;
}

Tracker::End Tracker::end_of(const Track& track) const {
  const auto where = position(track);
  if (!where || !(position_sigma(*where) <= options_.sigma_max)) return End::uncertain;
  if (track.confirmed) return track.misses >= options_.misses_max ? End::missed : End::no;
  const int still = options_.confirm_scans - track.scans;
  return track.hits + still < options_.confirm_hits ? End::unconfirmed : End::no;
}

void Tracker::end_tracks() {
  std::erase_if(tracks_, [&](const Track& track) {
    const End end = end_of(track);
    if (end == End::no) return false;
    if (end == End::unconfirmed) ++counts_.ended_unconfirmed;
    if (end == End::missed) ++counts_.ended_missed;
    if (end == End::uncertain) ++counts_.ended_uncertain;
    table_.ended(track.label, end == End::missed);
    return true;
  });
}

Track* Tracker::begin() {
  if (tracks_.size() >= static_cast<std::size_t>(options_.tracks_max)) {
    ++counts_.no_room;
    return nullptr;
  }
  tracks_.emplace_back();
  tracks_.back().label = next_label_++;
  return &tracks_.back();
}

/// Merino 2007, eq. 3.62–3.63, but with a bound on the velocity: without any, every plot of the
/// next scan would lie inside the gate.
void Tracker::begin_at(const gaussian::PositionMeasurement& plot) {
  Track* track = begin();
  if (track == nullptr) return;
  track->belief = born_of(plot);
  leave_trail(*track, plot);
  ++counts_.born;
  note(*track, true, true);
}

Belief Tracker::born_of(const gaussian::PositionMeasurement& plot) const {
  Belief belief = gaussian::measurement_information(M_, plot.S, plot.z);
  const double variance = options_.birth_speed_sigma * options_.birth_speed_sigma;
  for (int i = options_.axes; i < n_; ++i) belief.omega(i, i) += 1.0 / variance;
  return belief;
}

void Tracker::leave_trail(Track& track, const gaussian::PositionMeasurement& plot) const {
  if (options_.trail == 0) return;
  if (!track.trail) {
    track.trail.emplace(n_, stamp_);
    track.trail->update(0, born_of(plot));
    return;
  }
  const gaussian::Stamp since = stamp_ - track.trail->stamps().back();
  std::optional<gaussian::Transition> there;
  if (since > 0) there = motion(options_, since);
  extend(*track.trail, stamp_, gaussian::measurement_information(M_, plot.S, plot.z), there,
         stamp_ - options_.trail);
}

bool Tracker::usable(const Belief& belief) const {
  if (belief.dimension() != n_ || belief.omega.rows() != n_ || belief.omega.cols() != n_)
    return false;
  if (gaussian::definiteness(belief) != gaussian::Definiteness::positive) return false;
  const auto where = gaussian::expected(belief, M_);
  return where && position_sigma(*where) <= options_.sigma_max;
}

bool Tracker::heard(std::uint32_t from, gaussian::Stamp stamp, std::span<const Report> reports) {
  if (options_.rule == gaussian::Rule::none) return true;
  constexpr gaussian::Stamp age_max = std::numeric_limits<gaussian::Stamp>::max();
  if (stamp > stamp_ || (stamp_ >= 0 && stamp < stamp_ - age_max)) {
    counts_.refused += reports.size();
    return false;
  }
  std::vector<Label> theirs, mine;
  std::vector<Arrival> arrivals;
  std::set<Label> known;
  for (const Report& report : reports) {
    if (!known.insert(report.label).second) {
      ++counts_.refused;
      continue;
    }
    theirs.push_back(report.label);
    const bool fits = report.trail && report.trail->dimension() == n_;
    arrivals.push_back({arrived(report.belief, stamp), fits ? &*report.trail : nullptr});
    if (!arrivals.back().belief) ++counts_.refused;
  }
  for (const Track& track : tracks_) mine.push_back(track.label);
  const auto decisions = table_.judge(from, theirs, mine, separations(arrivals));
  for (std::size_t i = 0; i < decisions.size(); ++i) {
    follow(decisions[i], arrivals[i].belief, from, theirs[i]);
  }
  return true;
}

/// A belief of another tracker as of now; nothing if it is none.
std::optional<Belief> Tracker::arrived(const Belief& belief, gaussian::Stamp stamp) const {
  if (!usable(belief)) return std::nullopt;
  Belief now = moved(belief, options_, stamp_ - stamp);
  if (!usable(now)) return std::nullopt;
  return now;
}

// Positions alone are never farther apart than whole states, and cheaper to compare: where they lie
// outside the gate nothing more is asked.
Table Tracker::separations(std::span<const Arrival> arrivals) const {
  Table d2(static_cast<int>(arrivals.size()), static_cast<int>(tracks_.size()), infinity);
  std::vector<std::optional<gaussian::Expected>> places;
  for (const Track& track : tracks_) places.push_back(position(track));
  for (int i = 0; i < d2.rows(); ++i) {
    const Arrival& arrival = arrivals[static_cast<std::size_t>(i)];
    if (!arrival.belief) continue;
    const auto theirs = gaussian::expected(*arrival.belief, M_);
    for (int j = 0; theirs && j < d2.columns(); ++j) {
      const auto& mine = places[static_cast<std::size_t>(j)];
      if (!mine) continue;
      const auto near = gaussian::nis(*mine, theirs->covariance, theirs->z);
      if (!near || *near > options_.gate) continue;
      d2(i, j) = separation(arrival, tracks_[static_cast<std::size_t>(j)]);
    }
  }
  return d2;
}

double Tracker::separation(const Arrival& theirs, const Track& mine) const {
  const double states =
      gaussian::mahalanobis_squared(*theirs.belief, mine.belief).value_or(infinity);
  if (states > options_.gate || theirs.trail == nullptr || !mine.trail) return states;
  const auto trails = trail_separation(*theirs.trail, *mine.trail, options_.gate);
  return trails ? std::max(states, *trails) : states;
}

void Tracker::follow(const LabelTable::Decision& decision, const std::optional<Belief>& belief,
                     std::uint32_t from, Label theirs) {
  switch (decision.verdict) {
    case LabelTable::Verdict::apart:
      ++counts_.apart;
      return;
    case LabelTable::Verdict::buried:
      ++counts_.buried;
      return;
    case LabelTable::Verdict::same: {
      Track& track = tracks_[static_cast<std::size_t>(decision.mine)];
      if (fuse(track, *belief)) confirm(track);
      return;
    }
    case LabelTable::Verdict::news:
      break;
  }
  if (!belief) return;
  Track* track = begin();
  if (track == nullptr) return;
  track->belief = *belief;
  confirm(*track);
  ++counts_.born_of_hearsay;
  table_.add(from, theirs, track->label);
}

bool Tracker::fuse(Track& track, const Belief& received) {
  Belief fused = track.belief;
  const char* skipped = nullptr;
  if (gaussian::info(options_.rule).fuses == gaussian::Fuses::by_direction) {
    auto fusion = gaussian::fuse_by_direction(options_.rule, track.belief, received);
    fused = fusion.belief;
    skipped = fusion.skipped;
  } else {
    const auto weights = gaussian::coefficients(options_.rule, track.belief, received);
    Belief heard = received;
    heard *= weights.received;
    fused *= weights.own;
    fused += heard;
    skipped = weights.skipped;
  }
  if (skipped != nullptr || !usable(fused)) {
    ++counts_.skipped;
    return false;
  }
  track.belief = fused;
  ++counts_.fusions;
  return true;
}

Tracker::Counts& Tracker::Counts::operator+=(const Counts& other) {
  scans += other.scans;
  plots += other.plots;
  late += other.late;
  born += other.born;
  born_of_hearsay += other.born_of_hearsay;
  confirmed += other.confirmed;
  ended_unconfirmed += other.ended_unconfirmed;
  ended_missed += other.ended_missed;
  ended_uncertain += other.ended_uncertain;
  no_room += other.no_room;
  fusions += other.fusions;
  skipped += other.skipped;
  apart += other.apart;
  buried += other.buried;
  refused += other.refused;
  return *this;
}

std::vector<Report> Tracker::reports() const {
  std::vector<Report> out;
  for (const Track& track : tracks_) {
    if (track.confirmed) out.push_back({track.label, track.belief, track.trail});
  }
  return out;
}

}  // namespace hearsay::tracking
