// The command line: options and help of each verb. (CLI11 is slow to compile: it is included here
// alone.)
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <functional>

#include "sim/kernel/error.hpp"
#include "tools/hearsay/program.hpp"
#include "tools/hearsay/verbs.hpp"

namespace hearsay {
namespace {

using namespace program;
using Action = std::function<int()>;

CLI::App* add_verb(CLI::App& app, const std::string& name, const std::string& what,
                   const std::string& examples) {
  CLI::App* verb = app.add_subcommand(name, what);
  verb->footer("Examples:\n" + examples);
  return verb;
}

void add_jobs(CLI::App* verb, int& jobs) {
  verb->add_option("-j,--jobs", jobs, "Runs at once (default: one a processor)")
      ->check(CLI::Range(1, 1024));
}

void add_run(CLI::App& app, const Catalog& catalog, Action& action) {
  auto options = std::make_shared<RunVerb>();
  CLI::App* verb = add_verb(app, "run", "Run one scenario and show how it ended",
                            "  hearsay run scenarios/rumour/rumour.toml\n"
                            "  hearsay run ring.toml --seed 7 --set radio.loss.probability=0.3\n"
                            "  hearsay run ring.toml --out ring.db\n"
                            "  hearsay run ring.toml --digest");
  verb->add_option("scenario", options->scenario, "Scenario file (TOML)")->required();
  verb->add_option("--seed", options->seed, "Seed of all random draws (default: the scenario's)");
  verb->add_option("--set", options->set, "Override a key of the scenario: key=value; repeatable")
      ->take_all()
      ->allow_extra_args(false);
  verb->add_option("--out", options->out, "Store the run in this SQLite file");
  verb->add_flag("--digest", options->digest, "Print the digest alone");
  verb->add_flag("--json", options->json, "Print as JSON");
  verb->callback([&action, options, &catalog] {
    action = [options, &catalog] { return program::run(*options, catalog); };
  });
}

void add_sweep(CLI::App& app, const Catalog& catalog, Action& action) {
  auto options = std::make_shared<SweepVerb>();
  CLI::App* verb =
      add_verb(app, "sweep",
               "Run all cells of a study into one database; goes on where an earlier call stopped",
               "  hearsay sweep scenarios/rumour/rumour.study.toml --out rumour.db --jobs 2\n"
               "  hearsay sweep my.study.toml --set radio.rate_bps=9600\n"
               "  hearsay sweep my.study.toml --retry");
  verb->add_option("study", options->study, "Study file (TOML)")->required();
  verb->add_option("--out", options->out, "SQLite file (default: <study>.db)");
  verb->add_option("--set", options->set,
                   "Override a key of the scenario in every cell; repeatable")
      ->take_all()
      ->allow_extra_args(false);
  add_jobs(verb, options->jobs);
  verb->add_flag("--retry", options->retry, "Run those again that failed before");
  verb->add_flag("--json", options->json, "Print the summary as JSON");
  verb->callback([&action, options, &catalog] {
    action = [options, &catalog] { return program::sweep(*options, catalog); };
  });
}

void add_compare(CLI::App& app, Action& action) {
  auto options = std::make_shared<CompareVerb>();
  CLI::App* verb =
      add_verb(app, "compare", "Paired differences of a metric along one axis of a study",
               "  hearsay compare rumour.db --metric rms_error_m --by rule --baseline none\n"
               "  hearsay compare rumour.db --metric nees --by loss --at 60 --agents each");
  verb->add_option("database", options->database, "SQLite file of a sweep")->required();
  verb->add_option("--metric", options->metric, "What to compare (hearsay list metrics)")
      ->required();
  verb->add_option("--by", options->by, "Axis to compare along")->required();
  verb->add_option("--baseline", options->baseline, "Label to compare with (default: the first)");
  verb->add_option("--agents", options->agents, "mean, each, max, central, or an agent (mean)");
  verb->add_option("--study", options->study, "Study, where the file holds several");
  verb->add_option("--at", options->at, "end, or an instant in seconds (end)");
  verb->add_flag("--json", options->json, "Print as JSON");
  verb->callback([&action, options] { action = [options] { return program::compare(*options); }; });
}

void add_reproduce(CLI::App& app, const Catalog& catalog, Action& action) {
  auto options = std::make_shared<ReproduceVerb>();
  CLI::App* verb = add_verb(app, "reproduce", "Redo studies: runs, figures, tables, claims report",
                            "  hearsay reproduce rumour\n"
                            "  hearsay reproduce rumour/trees --strict\n"
                            "  hearsay reproduce rumour/dropouts   (all called dropouts-…)\n"
                            "  hearsay reproduce mrclam --data ~/mrclam6\n"
                            "  hearsay reproduce --out /tmp/results");
  verb->add_option("what", options->what, "Theme, or theme/study (default: everything)");
  verb->add_option("--out", options->out, "Folder for the results (results)");
  verb->add_option("--data", options->data,
                   "Folder of the recorded log, for studies that replay one");
  add_jobs(verb, options->jobs);
  verb->add_flag("--strict", options->strict, "Exit code 1 unless every claim is reproduced");
  verb->add_flag("--fresh", options->fresh, "Forget the runs of earlier calls");
  verb->callback([&action, options, &catalog] {
    action = [options, &catalog] { return program::reproduce(*options, catalog); };
  });
}

void add_check(CLI::App& app, const Catalog& catalog, Action& action) {
  auto options = std::make_shared<CheckVerb>();
  CLI::App* verb = add_verb(app, "check", "Check scenario and study files without running them",
                            "  hearsay check ring.toml ring.study.toml");
  verb->add_option("files", options->files, "Files (TOML)")->required();
  verb->callback([&action, options, &catalog] {
    action = [options, &catalog] { return program::check(*options, catalog); };
  });
}

void add_list(CLI::App& app, const Catalog& catalog, Action& action) {
  auto options = std::make_shared<ListVerb>();
  CLI::App* verb = add_verb(app, "list", "Show what there is to choose from",
                            "  hearsay list rules\n"
                            "  hearsay list keys\n"
                            "  hearsay list metrics --json");
  verb->add_option("what", options->what,
                   "rules, radios, sensors, agents, metrics, keys, scenarios (default: all)")
      ->check(CLI::IsMember(
          {"rules", "radios", "sensors", "agents", "metrics", "keys", "scenarios", "all"}));
  verb->add_flag("--json", options->json, "Print as JSON");
  verb->callback([&action, options, &catalog] {
    action = [options, &catalog] { return program::list(*options, catalog); };
  });
}

void add_diff(CLI::App& app, Action& action) {
  auto options = std::make_shared<DiffVerb>();
  CLI::App* verb = add_verb(app, "diff",
                            "Name the first row in which two databases, or two runs, differ; exit "
                            "code 1 if they do",
                            "  hearsay diff a.db b.db\n"
                            "  hearsay diff a.db a.db --run-a 1 --run-b 2");
  verb->add_option("a", options->a, "SQLite file")->required();
  verb->add_option("b", options->b, "SQLite file")->required();
  CLI::Option* a =
      verb->add_option("--run-a", options->run_a, "Compare only this run of the first");
  CLI::Option* b = verb->add_option("--run-b", options->run_b, "… with this run of the second");
  a->needs(b);
  b->needs(a);
  verb->callback([&action, options] { action = [options] { return program::diff(*options); }; });
}

void add_export(CLI::App& app, Action& action) {
  auto options = std::make_shared<ExportVerb>();
  CLI::App* verb = add_verb(app, "export", "Write a database as CSV files, one a table",
                            "  hearsay export rumour.db --csv rumour-csv");
  verb->add_option("database", options->database, "SQLite file")->required();
  verb->add_option("--csv", options->directory, "Folder for the CSV files")->required();
  verb->callback(
      [&action, options] { action = [options] { return program::export_csv(*options); }; });
}

/// What the processes of a fleet have in common.
CLI::App* add_fleet(CLI::App& app, const std::string& name, const std::string& what,
                    const std::string& examples, LiveVerb& options) {
  CLI::App* verb = add_verb(app, name, what, examples);
  verb->add_option("scenario", options.scenario, "Scenario file (TOML)")->required();
  verb->add_option("--set", options.set, "Override a key of the scenario: key=value; repeatable")
      ->take_all()
      ->allow_extra_args(false);
  verb->add_option("--domain", options.domain, "DDS domain (77)")->check(CLI::Range(0, 230));
  verb->add_option("--interface", options.interface,
                   "Network interface, e.g. eth0; opens the fleet to that network (default: this "
                   "machine alone)");
  verb->add_option("--radio", options.radio,
                   "scenario: the world's radio loses, delays and reaches as the scenario says; "
                   "direct: agents hear each other over DDS itself, in real time")
      ->check(CLI::IsMember({"scenario", "direct"}));
  verb->add_flag("--status", options.status)->group("");
  return verb;
}

void add_world_options(CLI::App* verb, LiveVerb& options) {
  verb->add_option("--seed", options.seed, "Seed of all random draws (default: the scenario's)");
  CLI::Option* lockstep = verb->add_flag(
      "--lockstep", options.lockstep,
      "The world gives out time and waits for each agent: the digest of the simulated run");
  verb->add_option("--speed", options.speed, "Real time: simulated seconds a second (1)")
      ->check(CLI::Range(1e-3, 1e3))
      ->excludes(lockstep);
  verb->add_option("--out", options.out, "Store the run in this SQLite file");
  verb->add_flag("--digest", options.digest, "Print the digest alone");
  verb->add_flag("--json", options.json, "Print as JSON");
}

void add_patience(CLI::App* verb, LiveVerb& options, const std::string& whom) {
  verb->add_option("--patience", options.patience_s, "Seconds to wait for " + whom + " (30)")
      ->check(CLI::Range(0.1, 86400.0));
}

void add_live(CLI::App& app, const Catalog& catalog, Action& action) {
  auto options = std::make_shared<LiveVerb>();
  CLI::App* verb = add_fleet(app, "live", "Run a scenario as processes: a world and its agents",
                             "  hearsay live ring.toml --lockstep --digest\n"
                             "  hearsay live ring.toml --speed 10 --out live.db\n"
                             "  hearsay live ring.toml --radio direct",
                             *options);
  verb->add_option("--fleet", options->fleet, "Name of the fleet (default: one of its own)");
  add_world_options(verb, *options);
  verb->callback([&action, options, &catalog] {
    action = [options, &catalog] { return program::live_fleet(*options, catalog); };
  });
}

void add_world(CLI::App& app, const Catalog& catalog, Action& action) {
  auto options = std::make_shared<LiveVerb>();
  CLI::App* verb =
      add_fleet(app, "world", "The world of a fleet as a process: truth, sensors, radio and record",
                "  hearsay world ring.toml --fleet mine --out mine.db\n"
                "  hearsay world ring.toml --fleet mine --lockstep",
                *options);
  options->fleet = "hearsay";
  verb->add_option("--fleet", options->fleet, "Name of the fleet (hearsay)");
  add_world_options(verb, *options);
  add_patience(verb, *options, "all agents");
  verb->callback([&action, options, &catalog] {
    action = [options, &catalog] { return program::live_world(*options, catalog); };
  });
}

void add_agent(CLI::App& app, const Catalog& catalog, Action& action) {
  auto options = std::make_shared<LiveVerb>();
  CLI::App* verb = add_fleet(app, "agent", "One agent of a scenario as a process",
                             "  hearsay agent ring.toml --id 0 --fleet mine\n"
                             "  hearsay agent ring.toml --id 3 --fleet mine --interface eth0",
                             *options);
  options->fleet = "hearsay";
  verb->add_option("--fleet", options->fleet, "Name of the fleet (hearsay)");
  verb->add_option("--id", options->agent, "Which agent, from 0 in file order")->required();
  add_patience(verb, *options, "a world");
  verb->add_option(
      "--memory", options->memory,
      "File that keeps what the agent remembers, for the process that takes its place");
  verb->callback([&action, options, &catalog] {
    action = [options, &catalog] { return program::live_agent(*options, catalog); };
  });
}

}  // namespace

int run_program(int argc, char** argv, const Catalog& catalog) {
  CLI::App app{
      "hearsay: a deterministic simulator of agents that estimate, talk over bad radios, and "
      "believe "
      "too much of what they hear"};
  app.name("hearsay");
  app.set_version_flag("--version", "hearsay " HEARSAY_VERSION);
  app.require_subcommand(1);
  app.footer("hearsay VERB --help shows options and examples of a verb.");
  Action action;
  add_run(app, catalog, action);
  add_sweep(app, catalog, action);
  add_compare(app, action);
  add_reproduce(app, catalog, action);
  add_check(app, catalog, action);
  add_list(app, catalog, action);
  add_diff(app, action);
  add_export(app, action);
  add_live(app, catalog, action);
  add_world(app, catalog, action);
  add_agent(app, catalog, action);
  try {
    app.parse(argc, argv);
    return action();
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? exit_done : exit_bad_input;
  } catch (const InputError& error) {
    fmt::print(stderr, "hearsay: {}\n", error.what());
    return exit_bad_input;
  } catch (const std::exception& error) {
    fmt::print(stderr, "hearsay: internal error: {}\n", error.what());
    return exit_failed;
  }
}

}  // namespace hearsay
