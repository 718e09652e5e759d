// How a run is shown and stored.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/hearsay/one_run.hpp"

namespace hearsay::program {

struct RunOutput {
  std::string out;      ///< database; empty: none
  bool digest = false;  ///< print the digest alone
  bool json = false;
  std::vector<std::string> set;  ///< overrides, which are stored with the run
};

/// No run is worth losing to a typo: @throws InputError if the database cannot be written.
void probe_output(const std::string& file);

/// Stores the run, if it is to be, and prints it. @return the exit code.
int show_run(const RunOutput& output, const Scenario& scenario, std::uint64_t seed,
             const FinishedRun& finished);

}  // namespace hearsay::program
