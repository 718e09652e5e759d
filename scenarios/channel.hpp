// From what a scenario says of the channel and of failures to the models of net.
#pragma once

#include <cstdint>
#include <vector>

#include "net/faults.hpp"
#include "net/loss.hpp"
#include "net/propagation.hpp"
#include "scenarios/scenario.hpp"

namespace hearsay {

/// Of model "gilbert-elliott" with mean_burst.
BurstLoss burst_loss_of(const LossSpec& spec);
/// Of model "gilbert-elliott". @throws InputError with what is wrong_with(burst_loss_of(spec)).
GilbertElliott chain_of(const LossSpec& spec);
Loss loss_of(const LossSpec& spec);

GreyZone grey_zone_of(const PropagationSpec& spec);
LogDistance log_distance_of(const PropagationSpec& spec);
/// "by-position": as [radio.propagation] says. "disk": a disk of range_m. Else distance does not
/// matter: whoever the topology joins is in reach.
Propagation propagation_of(const RadioSpec& spec);

Jammer jammer_of(const JammerSpec& spec);
Jammers jammers_of(const RadioSpec& spec);

/// The outages of a run that ends at `end`, of all agents that a dropout names. In a checked
/// scenario an agent's causes are numbered in the order of [[dropouts]].
Dropouts dropouts_of(const Scenario& scenario, std::uint64_t seed, Time end);

}  // namespace hearsay
