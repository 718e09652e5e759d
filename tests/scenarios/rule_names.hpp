// The fusion rules as messages list them.
#pragma once

#include <set>
#include <string>
#include <string_view>

#include "filters/gaussian/fusion.hpp"

namespace hearsay {

/// The names of all rules but those in `without`.
inline std::string rules_but(const std::set<std::string_view>& without) {
  std::string names;
  for (const gaussian::RuleInfo& rule : gaussian::rules()) {
    if (without.contains(rule.name)) continue;
    names += (names.empty() ? "" : ", ") + std::string(rule.name);
  }
  return names;
}

}  // namespace hearsay
