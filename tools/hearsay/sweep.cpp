// hearsay sweep: all cells of a study into one database.
#include <fmt/core.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "scenarios/loader.hpp"
#include "scenarios/run.hpp"
#include "sim/kernel/error.hpp"
#include "tools/hearsay/progress.hpp"
#include "tools/hearsay/sweep_engine.hpp"
#include "tools/hearsay/verbs.hpp"

namespace hearsay::program {

int sweep(const SweepVerb& verb, const Catalog& catalog) {
  if (!is_study(verb.study)) {
    throw InputError(verb.study, 0,
                     "is a scenario, not a study (it names no `scenario`); use: hearsay run");
  }
  std::vector<Override> overrides;
  for (const std::string& text : verb.set) overrides.push_back(parse_set(text));
  const Study study = load_study(verb.study, known_names(catalog), overrides);
  const std::string out = verb.out.empty() ? study.name + ".db" : verb.out;

  SweepSummary summary;
  {
    Progress progress(study.name);
    summary = sweep_study(
        study, catalog,
        {.database = out,
         .jobs = verb.jobs,
         .retry = verb.retry,
         .progress = [&](std::int64_t done, std::int64_t total) { progress.show(done, total); }});
  }
  if (verb.json) {
    const nlohmann::ordered_json json = {
        {"study", study.name},      {"database", out},
        {"runs", summary.runs},     {"present", summary.present},
        {"done", summary.done},     {"failed", summary.failed},
        {"wall_s", summary.wall_s}, {"interrupted", summary.interrupted}};
    fmt::print("{}\n", json.dump(2));
  } else {
    fmt::print("{}: {} runs in {}, {} new in {:.1f} s ({:.0f} a second), {} failed\n", study.name,
               summary.present + summary.done, out, summary.done, summary.wall_s,
               static_cast<double>(summary.done) / summary.wall_s, summary.failed);
  }
  if (summary.failed > 0) fmt::print(stderr, "hearsay: {}\n", summary.first_failure);
  if (summary.interrupted) {
    fmt::print(stderr, "hearsay: interrupted; the same command goes on where it stopped\n");
    return exit_failed;
  }
  return summary.failed > 0 ? exit_failed : exit_done;
}

}  // namespace hearsay::program
