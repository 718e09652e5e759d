// What an agent would believe that heard nobody: the reference for what talking is worth.
// Measurements do not depend on what is heard, so it is what the same agent believes in the same
// run under the rule `none`.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "agents/estimator.hpp"

namespace hearsay {

class Alone {
 public:
  /// Knows nothing yet of `subjects` states of dimension n. `motion`, if any, outlives it.
  Alone(int subjects, int n, const std::optional<MotionModel>& motion);

  /// `information` (n×n) about the state at stamp `now`, not before the last one; 0 if it stands
  /// still.
  void measured(int subject, const gaussian::Belief& information, std::int64_t now);
  /// The memory is lost.
  void forget();
  /// What it believes of a subject at stamp `now`, not before the last one.
  const gaussian::Belief& at(int subject, std::int64_t now);

 private:
  struct Held {
    gaussian::Belief belief;
    std::int64_t stamp = 0;
  };
  const std::optional<MotionModel>& motion_;
  std::vector<Held> held_;  // by subject
};

}  // namespace hearsay
