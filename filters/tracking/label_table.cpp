#include "filters/tracking/label_table.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace hearsay::tracking {
namespace {

int position(std::span<const Label> labels, Label label) {
  const auto found = std::find(labels.begin(), labels.end(), label);
  return found == labels.end() ? unassigned : static_cast<int>(found - labels.begin());
}

}  // namespace

LabelTable::LabelTable(const Options& options) : options_(options) {
  require(options.gate > 0.0 && options.apart_max >= 1,
          "LabelTable: gate and apart_max must be positive");
}

std::size_t LabelTable::place(std::uint32_t from, Label theirs) const {
  const auto found = std::lower_bound(
      pairs_.begin(), pairs_.end(), std::pair(from, theirs),
      [](const Pair& pair, const auto& key) { return std::pair(pair.from, pair.theirs) < key; });
  return static_cast<std::size_t>(found - pairs_.begin());
}

bool LabelTable::holds(std::size_t at, std::uint32_t from, Label theirs) const {
  return at < pairs_.size() && pairs_[at].from == from && pairs_[at].theirs == theirs;
}

std::vector<LabelTable::Decision> LabelTable::judge(std::uint32_t from,
                                                    std::span<const Label> theirs,
                                                    std::span<const Label> mine, const Table& d2) {
  require(
      d2.rows() == static_cast<int>(theirs.size()) && d2.columns() == static_cast<int>(mine.size()),
      "LabelTable: a row for each of theirs and a column for each of mine");
  std::erase_if(pairs_, [&](const Pair& pair) {
    return pair.from == from && position(theirs, pair.theirs) == unassigned;
  });
  std::vector<Decision> decisions(theirs.size());
  Table open = d2;  // only pairs that may still be made are finite
  const auto close_row = [&](int i) {
    for (int j = 0; j < open.columns(); ++j) open(i, j) = std::numeric_limits<double>::infinity();
  };
  const auto close_column = [&](int j) {
    for (int i = 0; i < open.rows(); ++i) open(i, j) = std::numeric_limits<double>::infinity();
  };
  for (int i = 0; i < d2.rows(); ++i) {
    const Label label = theirs[static_cast<std::size_t>(i)];
    const std::size_t at = place(from, label);
    if (!holds(at, from, label)) continue;
    Pair& pair = pairs_[at];
    Decision& decision = decisions[static_cast<std::size_t>(i)];
    if (pair.buried) {
      decision.verdict = Verdict::buried;
      continue;
    }
    const int j = position(mine, pair.mine);
    require(j != unassigned, "LabelTable: a pair with a track that has ended");
    const bool inside = d2(i, j) <= options_.gate;
    pair.apart = inside ? 0 : pair.apart + 1;
    if (pair.apart >= options_.apart_max) {
      ++broken_;
      pairs_.erase(pairs_.begin() + static_cast<std::ptrdiff_t>(at));
      continue;
    }
    decision = {inside ? Verdict::same : Verdict::apart, j};
    close_row(i);
    close_column(j);
  }
  const std::vector<int> column_of = pair_within(open, options_.gate, options_.pairing);
  for (std::size_t i = 0; i < theirs.size(); ++i) {
    if (column_of[i] == unassigned) continue;
    add(from, theirs[i], mine[static_cast<std::size_t>(column_of[i])]);
    decisions[i] = {Verdict::same, column_of[i]};
  }
  return decisions;
}

void LabelTable::add(std::uint32_t from, Label theirs, Label mine) {
  const std::size_t at = place(from, theirs);
  if (!holds(at, from, theirs)) {
    pairs_.insert(pairs_.begin() + static_cast<std::ptrdiff_t>(at), Pair{});
  }
  pairs_[at] = Pair{from, theirs, mine, false, 0};
}

void LabelTable::ended(Label mine, bool bury) {
  if (!bury) {
    std::erase_if(pairs_, [&](const Pair& pair) { return !pair.buried && pair.mine == mine; });
    return;
  }
  for (Pair& pair : pairs_) {
    if (pair.mine == mine) pair.buried = true;
  }
}

void LabelTable::forget(std::uint32_t from) {
  std::erase_if(pairs_, [&](const Pair& pair) { return pair.from == from; });
}

std::optional<Label> LabelTable::mine_of(std::uint32_t from, Label theirs) const {
  const std::size_t at = place(from, theirs);
  if (!holds(at, from, theirs) || pairs_[at].buried) return std::nullopt;
  return pairs_[at].mine;
}

}  // namespace hearsay::tracking
