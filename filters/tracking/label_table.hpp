// Whose label is which of mine.
//
// Every agent numbers its tracks itself, so a label means nothing to anybody else. Each keeps a
// table of pairs (agent, its label, my label). A pair is made when two tracks that have no partner
// lie within the gate, and is used from then on without being judged again (Merino 2007,
// section 3.8.2), until it has lain outside for a number of messages in a row.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "filters/tracking/association.hpp"

namespace hearsay::tracking {

using Label = std::uint32_t;

class LabelTable {
 public:
  struct Options {
    double gate = gate_of_merino;  ///< of d², > 0
    int apart_max = 3;  ///< a pair outside the gate in so many messages in a row is broken, ≥ 1
    Pairing pairing = Pairing::nearest;
  };
  /// @throws BrokenInvariant outside the ranges above.
  explicit LabelTable(const Options& options);

  /// What is to be done with one of the tracks that another agent told of.
  enum class Verdict {
    same,    ///< it is my track `mine`
    apart,   ///< it is my track `mine`, but outside the gate now: not to be used
    buried,  ///< it was a track of mine that I gave up, and is none of those I have
    news,    ///< none of mine
  };
  struct Decision {
    Verdict verdict = Verdict::news;
    int mine = unassigned;  ///< position in `mine`
  };
  /// Judges a message of agent `from` with all its tracks, labels `theirs` (different ones),
  /// against my tracks, labels `mine` (different ones). d2(i, j): squared distance of theirs[i] and
  /// mine[j], infinite where there is none. At most one of theirs is paired with one of mine.
  /// Labels of this agent that are not in the message any more are forgotten, so the table never
  /// holds more than the last message of each agent. @throws BrokenInvariant if the sizes disagree.
  std::vector<Decision> judge(std::uint32_t from, std::span<const Label> theirs,
                              std::span<const Label> mine, const Table& d2);

  /// Makes a pair of a track of theirs that was `news` and the new track of mine that it became.
  void add(std::uint32_t from, Label theirs, Label mine);
  /// My track has ended. `bury`: I know that there is nothing, so others shall not bring it back;
  /// else its pairs are dropped.
  void ended(Label mine, bool bury);
  /// Everything about this agent: its labels begin anew.
  void forget(std::uint32_t from);

  /// My label for theirs, if they are a pair.
  std::optional<Label> mine_of(std::uint32_t from, Label theirs) const;
  std::size_t size() const { return pairs_.size(); }
  /// Pairs that were broken because they lay outside the gate for good.
  std::uint64_t broken() const { return broken_; }

 private:
  struct Pair {
    std::uint32_t from = 0;
    Label theirs = 0;
    Label mine = 0;
    bool buried = false;
    int apart = 0;  // messages in a row outside the gate
  };
  /// Where the pair stands, or would.
  std::size_t place(std::uint32_t from, Label theirs) const;
  bool holds(std::size_t at, std::uint32_t from, Label theirs) const;

  Options options_;
  std::vector<Pair> pairs_;  // by (from, theirs)
  std::uint64_t broken_ = 0;
};

}  // namespace hearsay::tracking
