// Runs all cells of a study, several at once, into one database.
//
// Workers take runs in the order of their ids and store them in that order (one of them at a
// time), so a database never holds anything but a prefix of the study (and runs of an earlier
// call), and ends the same whatever the number of jobs and however often the sweep was interrupted.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "agents/catalog.hpp"
#include "scenarios/study.hpp"

namespace hearsay::program {

struct SweepOptions {
  std::string database;
  int jobs = 0;        ///< 0: one a processor
  bool retry = false;  ///< run those again that failed before
  /// Called once when everything has been checked, before the database is opened.
  std::function<void()> ready;
  /// Called now and then, by one thread at a time: runs stored so far, of how many to do.
  std::function<void(std::int64_t stored, std::int64_t total)> progress;
};

struct SweepSummary {
  std::int64_t runs = 0;      ///< of the study
  std::int64_t present = 0;   ///< that were there before
  std::int64_t done = 0;      ///< stored by this call
  std::int64_t failed = 0;    ///< of those stored by this call
  std::string first_failure;  ///< message of the first failed run, with its cell
  double wall_s = 0.0;
  bool interrupted = false;  ///< by SIGINT or SIGTERM; what was done is stored
};

/// @throws InputError if the database cannot be used, or holds runs of another configuration.
SweepSummary sweep_study(const Study& study, const Catalog& catalog, const SweepOptions& options);

}  // namespace hearsay::program
