// From [radio] of a scenario to the radio network of a run.
#pragma once

#include "net/radio.hpp"
#include "scenarios/links.hpp"
#include "scenarios/scenario.hpp"

namespace hearsay {

RadioOptions radio_options(const Scenario& scenario);

}  // namespace hearsay
