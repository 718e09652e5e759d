// From [radio] of a scenario to the radio network of a run.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "net/radio.hpp"
#include "scenarios/scenario.hpp"

namespace hearsay {

/// Where agents stand, by number, if the file says so.
using Places = std::vector<std::optional<std::array<double, 2>>>;

Topology topology_of(const Scenario& scenario, const Places& places);
RadioOptions radio_options(const RadioSpec& spec);

}  // namespace hearsay
