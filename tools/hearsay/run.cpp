// hearsay run: one scenario, once.
#include "tools/hearsay/one_run.hpp"
#include "tools/hearsay/run_output.hpp"
#include "tools/hearsay/verbs.hpp"

namespace hearsay::program {

int run(const RunVerb& verb, const Catalog& catalog) {
  std::vector<Override> overrides;
  for (const std::string& text : verb.set) overrides.push_back(parse_set(text));
  const Scenario scenario = load_scenario(verb.scenario, overrides, known_names(catalog));
  const std::uint64_t seed = verb.seed.value_or(scenario.seed);
  LogCache logs;
  const auto prepared = prepare(scenario, catalog, logs);
  if (!verb.out.empty()) probe_output(verb.out);
  const FinishedRun finished = execute(prepared, catalog, seed);
  return show_run({.out = verb.out, .digest = verb.digest, .json = verb.json, .set = verb.set},
                  scenario, seed, finished);
}

}  // namespace hearsay::program
