// The program `hearsay`, as a function: a user's own program calls it with a catalogue of its own
// agents and gets every verb (run, sweep, compare, …) for them.
#pragma once

#include "agents/catalog.hpp"

namespace hearsay {

/// Runs the command line. @return the exit code: 0 done, 1 a run failed or (with --strict) a claim
/// was not reproduced, 2 bad input.
int run_program(int argc, char** argv, const Catalog& catalog = {});

}  // namespace hearsay
