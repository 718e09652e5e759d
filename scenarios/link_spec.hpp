// What a scenario says of when links are up, as typed data.
#pragma once

#include <array>
#include <optional>
#include <vector>

namespace hearsay {

struct OutageSpec {
  std::vector<std::array<int, 2>> links;  ///< at least one; agents by number
  double down_s = 0.0;                    ///< ≥ 0
  std::optional<double> up_s;             ///< > down_s; default: never
};

/// Every agent stands in exactly one of at least two groups.
using GroupsSpec = std::vector<std::vector<int>>;

struct PartitionSpec {
  GroupsSpec groups;
  double from_s = 0.0;            ///< ≥ 0
  std::optional<double> until_s;  ///< > from_s; default: never
};

/// In period k group k mod m is cut off from the others.
struct RotationSpec {
  GroupsSpec groups;
  std::optional<double> period_s;  ///< needed, > 0
  std::optional<double> cut_s;     ///< > 0, at most period_s; default: the whole period
  double from_s = 0.0;             ///< ≥ 0
  std::optional<double> until_s;   ///< > from_s; default: duration_s, and needed without that
};

}  // namespace hearsay
