// hearsay diff and hearsay export.
#include <fmt/core.h>

#include "sim/record/database.hpp"
#include "tools/hearsay/verbs.hpp"

namespace hearsay::program {

int diff(const DiffVerb& verb) {
  const auto difference =
      first_difference(verb.a, verb.b, {.run_a = verb.run_a, .run_b = verb.run_b});
  if (!difference) {
    fmt::print("the same\n");
    return exit_done;
  }
  fmt::print("{}\n", *difference);
  return exit_failed;
}

int export_csv(const ExportVerb& verb) {
  for (const auto& [table, rows] : hearsay::export_csv(verb.database, verb.directory)) {
    fmt::print("{}/{}.csv: {} rows\n", verb.directory, table, rows);
  }
  return exit_done;
}

}  // namespace hearsay::program
