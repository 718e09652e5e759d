// hearsay check: are these files fit for use?
#include <fmt/core.h>

#include "scenarios/loader.hpp"
#include "scenarios/run.hpp"
#include "sim/kernel/error.hpp"
#include "tools/hearsay/verbs.hpp"

namespace hearsay::program {
namespace {

void check_file(const std::string& file, const KnownNames& names) {
  if (is_study(file)) {
    const Study study = load_study(file, names);
    const std::size_t cell_count = cells(study).size();
    fmt::print("{}: study of {} cells × {} repetitions, {} claims\n", file, cell_count,
               study.repetitions, study.claims.size());
  } else {
    const Scenario scenario = load_scenario(file, {}, names);
    fmt::print("{}: scenario of {} agents\n", file, scenario.agent_count());
  }
}

}  // namespace

int check(const CheckVerb& verb, const Catalog& catalog) {
  const KnownNames names = known_names(catalog);
  int code = exit_done;
  for (const std::string& file : verb.files) {
    try {
      check_file(file, names);
    } catch (const InputError& error) {
      fmt::print(stderr, "hearsay: {}\n", error.what());
      code = exit_bad_input;
    }
  }
  return code;
}

}  // namespace hearsay::program
