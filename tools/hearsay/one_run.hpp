// One run with its digest, ready to be stored.
#pragma once

#include <memory>
#include <string>

#include "scenarios/run.hpp"
#include "sim/record/digest.hpp"

namespace hearsay::program {

struct FinishedRun {
  std::unique_ptr<Run> run;  ///< only its record is left
  RunEnd end;
  std::string digest;
  double wall_s = 0.0;
};

/// Executes the scenario with `seed`. A failure in the run is in `end`, not an exception.
FinishedRun execute(const std::shared_ptr<const PreparedScenario>& prepared, const Catalog& catalog,
                    std::uint64_t seed);

/// The reason of a run's end, or the message of its failure.
std::string how_it_ended(const RunEnd& end);

/// The config_hash of a scenario: of its content, that of the files it names with it, wherever they
/// lie. Of a recorded data set the name of its folder counts alone.
std::string scenario_hash(Scenario scenario);

/// The version that goes with results: of the program.
std::string program_version();

}  // namespace hearsay::program
