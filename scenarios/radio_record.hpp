// What a run's record says about its radio.
#pragma once

#include <memory>
#include <vector>

#include "net/gossip.hpp"
#include "net/radio.hpp"
#include "sim/kernel/record.hpp"

namespace hearsay {

/// Leaves the sums of each sender and of each link, after the last event. `gossips` by agent, null
/// for who talks over the radio alone.
void record_radio(Record& record, Radio& radio,
                  const std::vector<std::unique_ptr<Gossip>>& gossips);

}  // namespace hearsay
