// Runs on recorded data sets: what there is to believe in, and what was measured.
#pragma once

#include "scenarios/run.hpp"

namespace hearsay {

/// Reads the data set of a scenario that has one, and fills in `log`, `subjects`, `observations`,
/// for localizers `journeys` and `landmarks`, and, where the scenario gives no duration, `end`:
/// when the last robot's log ends, or, of robots that are believed in, when the first one's truth
/// ends.
/// @throws InputError for a data set that cannot be read, and where the run would go on beyond the
/// truth of a robot that is believed in.
void prepare_log(PreparedScenario& prepared, LogCache& logs);

/// Of a scenario with localizers. `prepared` outlives the witness.
std::unique_ptr<PoseWitness> make_pose_witness(const PreparedScenario& prepared,
                                               Simulation& simulation);

/// Leaves in the record what of the log was not used.
void record_log(const PreparedScenario& prepared, Record& record);

}  // namespace hearsay
