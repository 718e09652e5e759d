// From [radio] of a scenario to who can hear whom, and when.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "net/link_plan.hpp"
#include "scenarios/scenario.hpp"
#include "sim/kernel/leg.hpp"

namespace hearsay {

/// Where agents stand, by number, if the file says so.
using AgentPlaces = std::vector<std::optional<std::array<double, 2>>>;

/// The same in space, if all are known; else empty.
std::vector<Point> positions_of(const AgentPlaces& places);

/// True if which links there are depends on the seed.
bool is_drawn(const RadioSpec& radio);

/// All links that may be up in a run with this seed. `scenario` is a checked one.
Topology topology_of(const Scenario& scenario, const AgentPlaces& places, std::uint64_t seed);
/// Likewise with the scenario's own seed.
Topology topology_of(const Scenario& scenario, const AgentPlaces& places);

/// These links, and when they are up.
/// @throws InputError, naming the scenario's file, if they change too often.
LinkPlan make_link_plan(const Scenario& scenario, const AgentPlaces& places, std::uint64_t seed);

}  // namespace hearsay
