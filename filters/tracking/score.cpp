#include "filters/tracking/score.hpp"

#include <algorithm>
#include <cmath>

namespace hearsay::tracking {
namespace {

std::vector<gaussian::Vector> positions(std::span<const Placed> placed) {
  std::vector<gaussian::Vector> out;
  for (const Placed& one : placed) out.push_back(one.position);
  return out;
}

std::size_t index(int i) { return static_cast<std::size_t>(i); }

}  // namespace

TrackScore::TrackScore(const Options& options) : options_(options) {
  require(options.p >= 1.0 && std::isfinite(options.p) && options.cutoff_m > 0.0 &&
              std::isfinite(options.cutoff_m),
          "TrackScore: order and cut-off");
}

TrackScore::Sample TrackScore::sample(std::span<const Placed> truths,
                                      std::span<const Placed> tracks) {
  const Table apart = distances(positions(tracks), positions(truths));
  Sample sample;
  sample.ospa = ospa(apart, options_.p, options_.cutoff_m);
  sample.gospa = gospa(apart, options_.p, options_.cutoff_m);

  std::erase_if(follows_, [&](const auto& entry) {
    return std::ranges::none_of(tracks, [&](const Placed& t) { return t.name == entry.first; });
  });
  std::vector<int> truth_of = keep(apart, truths, tracks);
  pair_rest(apart, truth_of);
  int pairs = 0;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    if (truth_of[i] == unassigned) continue;
    ++pairs;
    book(truths[index(truth_of[i])].name, tracks[i].name);
  }
  sample.missed = static_cast<int>(truths.size()) - pairs;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    if (truth_of[i] != unassigned) continue;
    judge_unpaired(apart, truths, tracks[i], static_cast<int>(i), sample);
  }
  return sample;
}

/// The pairs that were there before and are still near enough.
std::vector<int> TrackScore::keep(const Table& distances, std::span<const Placed> truths,
                                  std::span<const Placed> tracks) const {
  std::vector<int> truth_of(tracks.size(), unassigned);
  for (int i = 0; i < distances.rows(); ++i) {
    const auto followed = follows_.find(tracks[index(i)].name);
    if (followed == follows_.end()) continue;
    for (int j = 0; j < distances.columns(); ++j) {
      if (truths[index(j)].name != followed->second.truth) continue;
      const bool last = label_of_.at(followed->second.truth) == tracks[index(i)].name;
      if (last && distances(i, j) < options_.cutoff_m) truth_of[index(i)] = j;
    }
  }
  return truth_of;
}

void TrackScore::pair_rest(const Table& distances, std::vector<int>& truth_of) const {
  std::vector<int> rows, columns;
  for (int i = 0; i < distances.rows(); ++i) {
    if (truth_of[index(i)] == unassigned) rows.push_back(i);
  }
  for (int j = 0; j < distances.columns(); ++j) {
    if (std::ranges::find(truth_of, j) == truth_of.end()) columns.push_back(j);
  }
  Table rest(static_cast<int>(rows.size()), static_cast<int>(columns.size()));
  for (int i = 0; i < rest.rows(); ++i) {
    for (int j = 0; j < rest.columns(); ++j) {
      rest(i, j) = distances(rows[index(i)], columns[index(j)]);
    }
  }
  const Gospa best = gospa(rest, options_.p, options_.cutoff_m);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (best.truth_of[i] == unassigned) continue;
    truth_of[index(rows[i])] = columns[index(best.truth_of[i])];
  }
}

void TrackScore::book(std::uint32_t truth, Label label) {
  const auto followed = follows_.find(label);
  const auto named = label_of_.find(truth);
  if (followed != follows_.end() && followed->second.truth != truth) {
    ++counts_.label_swaps;
  } else if (named != label_of_.end() && named->second != label) {
    ++counts_.label_changes;
  }
  follows_[label] = {truth, false};
  label_of_[truth] = label;
}

void TrackScore::judge_unpaired(const Table& distances, std::span<const Placed> truths,
                                const Placed& track, int row, Sample& sample) {
  int nearest = unassigned;
  for (int j = 0; j < distances.columns(); ++j) {
    if (!(distances(row, j) < options_.cutoff_m)) continue;
    if (nearest == unassigned || distances(row, j) < distances(row, nearest)) nearest = j;
  }
  const auto followed = follows_.find(track.name);
  const bool merged = nearest != unassigned && followed != follows_.end() &&
                      followed->second.truth != truths[index(nearest)].name;
  if (nearest == unassigned) {
    ++sample.false_tracks;
  } else {
    ++sample.duplicates;
  }
  if (merged) {
    ++sample.merged;
    if (!followed->second.merged) ++counts_.merged_tracks;
  }
  if (followed != follows_.end()) followed->second.merged = merged;
}

}  // namespace hearsay::tracking
