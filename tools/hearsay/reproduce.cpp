// hearsay reproduce: studies → figures → claims report.
#include <fmt/core.h>
#include <spawn.h>
#include <sys/wait.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <deque>
#include <filesystem>
#include <fstream>
#include <thread>

#include "scenarios/run.hpp"
#include "sim/kernel/error.hpp"
#include "tools/analysis/claims.hpp"
#include "tools/hearsay/progress.hpp"
#include "tools/hearsay/share.hpp"
#include "tools/hearsay/sweep_engine.hpp"
#include "tools/hearsay/verbs.hpp"

extern char** environ;

namespace hearsay::program {
namespace {

namespace fs = std::filesystem;

/// One study to reproduce and where its results go.
struct Target {
  fs::path study;
  fs::path results;  ///< folder
};

struct Outcome {
  std::vector<analysis::ClaimResult> claims;
  std::vector<fs::path> files;
  std::string table;  ///< of the first figure that is a Markdown table
  bool failed = false;
};

std::vector<fs::path> themes(const fs::path& scenarios) {
  std::vector<fs::path> found;
  for (const fs::directory_entry& entry : fs::directory_iterator(scenarios)) {
    if (entry.is_directory() && !studies_of(entry.path()).empty()) found.push_back(entry.path());
  }
  std::sort(found.begin(), found.end());
  return found;
}

std::string names_of(const std::vector<fs::path>& paths) {
  std::string text;
  for (const fs::path& path : paths) text += (text.empty() ? "" : ", ") + path.filename().string();
  return text;
}

std::string study_name(const fs::path& study) {
  const std::string name = study.filename().string();
  return name.substr(0, name.find('.'));
}

/// "dropouts" means the study of that name; if there is none, all called "dropouts-…".
std::vector<fs::path> chosen_studies(const fs::path& folder, const std::string& only) {
  const std::vector<fs::path> all = studies_of(folder);
  if (only.empty()) return all;
  std::vector<fs::path> exact, family;
  for (const fs::path& study : all) {
    if (study_name(study) == only) exact.push_back(study);
    if (study_name(study).starts_with(only + "-")) family.push_back(study);
  }
  return exact.empty() ? family : exact;
}

/// What may stand behind "rumour/".
std::string study_names_of(const fs::path& folder) {
  std::string text;
  for (const fs::path& study : studies_of(folder)) {
    text += (text.empty() ? "" : ", ") + folder.filename().string() + "/" + study_name(study);
  }
  return text;
}

/// "rumour" is a theme, "rumour/trees" one of its studies, "rumour/dropouts" several of one family,
/// "" everything.
std::vector<Target> targets(const ReproduceVerb& verb) {
  const fs::path scenarios = share_directory() / "scenarios";
  const std::vector<fs::path> known = themes(scenarios);
  const std::string theme = verb.what.substr(0, verb.what.find('/'));
  const std::string only =
      verb.what.find('/') == std::string::npos ? "" : verb.what.substr(verb.what.find('/') + 1);
  std::vector<Target> chosen;
  std::string there_are = names_of(known);
  for (const fs::path& folder : known) {
    if (!theme.empty() && folder.filename() != theme) continue;
    for (const fs::path& study : chosen_studies(folder, only)) {
      chosen.push_back({study, fs::path(verb.out) / folder.filename()});
    }
    if (chosen.empty()) there_are = study_names_of(folder);
  }
  if (chosen.empty()) {
    throw InputError("nothing to reproduce is called '" + verb.what + "'; there are: " + there_are);
  }
  return chosen;
}

/// A figure script at work.
struct Drawing {
  pid_t child;
  fs::path output;
};

/// Starts a figure script. @throws InputError if it cannot be started.
Drawing start_drawing(const Figure& figure, const fs::path& database, const fs::path& output) {
  const fs::path script = share_directory() / "tools" / "figures" / figure.script;
  if (!fs::exists(script)) throw InputError(script.string(), 0, "no such figure script");
  std::vector<std::string> words = {"/usr/bin/python3", script.string(), database.string(),
                                    output.string()};
  words.insert(words.end(), figure.arguments.begin(), figure.arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  pid_t child = 0;
  const int error = posix_spawn(&child, argv[0], nullptr, nullptr, argv.data(), environ);
  if (error != 0) {
    throw InputError(words[0] + " cannot be started (" + std::strerror(error) +
                     "); figures need python3 with numpy and matplotlib");
  }
  return {child, output};
}

bool finish_drawing(const Drawing& drawing) {
  int status = 0;
  while (waitpid(drawing.child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

/// Draws all figures of a study, `at_once` at a time. @throws InputError if one fails, after all.
void draw(const Study& study, const fs::path& database, const fs::path& results,
          std::size_t at_once) {
  std::string failed;
  std::deque<Drawing> drawings;
  const auto finish_first = [&] {
    if (!finish_drawing(drawings.front())) failed = drawings.front().output.string();
    drawings.pop_front();
  };
  for (const Figure& figure : study.figures) {
    if (drawings.size() >= at_once) finish_first();
    drawings.push_back(start_drawing(figure, database, results / figure.output));
  }
  while (!drawings.empty()) finish_first();
  if (!failed.empty()) throw InputError(failed, 0, "could not be drawn (see above)");
}

std::string read_file(const fs::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// The study with its log's directory in place; nothing if it needs one and none was given.
std::optional<Study> load(const Target& target, const ReproduceVerb& verb, const Catalog& catalog) {
  const KnownNames names = known_names(catalog);
  std::vector<Override> overrides;
  Study study = load_study(target.study.string(), names, overrides);
  if (!load_scenario(study.scenario_file, {}, names).world.log) return study;
  if (verb.data.empty()) {
    const std::string message =
        "study '" + study.name + "' replays a recorded log: give its folder with --data DIR";
    if (!verb.what.empty()) throw InputError(message);
    fmt::print("{}; left out\n\n", message);
    return std::nullopt;
  }
  overrides.push_back({"world.log.directory", "'" + verb.data + "'", "--data"});
  return load_study(target.study.string(), names, overrides);
}

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw InputError(folder.string(), 0, "cannot be written: " + error.message());
}

void forget(const fs::path& database) {
  for (const char* suffix : {"", "-wal", "-shm"}) fs::remove(database.string() + suffix);
}

SweepSummary sweep_all(const Study& study, const Catalog& catalog, const ReproduceVerb& verb,
                       const fs::path& database) {
  Progress progress(study.name);
  const auto ready = [&] {
    make_folder(database.parent_path());
    if (verb.fresh) forget(database);
  };
  const SweepOptions options = {
      .database = database.string(),
      .jobs = verb.jobs,
      .ready = ready,
      .progress = [&](std::int64_t done, std::int64_t total) { progress.show(done, total); }};
  return sweep_study(study, catalog, options);
}

Outcome reproduce_one(const Study& study, const Target& target, const ReproduceVerb& verb,
                      const Catalog& catalog) {
  Outcome outcome;
  const fs::path database = target.results / (study.name + ".db");
  const SweepSummary summary = sweep_all(study, catalog, verb, database);
  fmt::print("{}: {} runs, {} new in {:.1f} s ({:.0f} a second), {} failed\n", study.name,
             summary.present + summary.done, summary.done, summary.wall_s,
             static_cast<double>(summary.done) / std::max(summary.wall_s, 1e-9), summary.failed);
  if (summary.failed > 0) fmt::print(stderr, "hearsay: {}\n", summary.first_failure);
  outcome.failed = summary.failed > 0 || summary.interrupted;
  if (summary.interrupted) return outcome;

  const unsigned processors = std::max(1u, std::thread::hardware_concurrency());
  draw(study, database, target.results,
       verb.jobs > 0 ? static_cast<std::size_t>(verb.jobs) : processors);
  for (const Figure& figure : study.figures) {
    const fs::path output = target.results / figure.output;
    outcome.files.push_back(output);
    if (output.extension() == ".md" && outcome.table.empty()) outcome.table = read_file(output);
  }
  if (!study.claims.empty()) {
    outcome.claims = analysis::judge(database.string(), study);
    const fs::path report = target.results / (study.name + "-claims.md");
    const fs::path json = target.results / (study.name + "-claims.json");
    analysis::write_claims_report(outcome.claims, study.title.empty() ? study.name : study.title,
                                  report.string(), json.string());
    outcome.files.push_back(report);
  }
  outcome.files.push_back(database);
  return outcome;
}

void print(const Outcome& outcome) {
  if (!outcome.table.empty()) fmt::print("\n{}\n", outcome.table);
  for (const analysis::ClaimResult& result : outcome.claims) {
    fmt::print("  {:<14}  {}\n", analysis::to_string(result.verdict), result.claim.text);
  }
  fmt::print("\n");
  for (const fs::path& file : outcome.files) fmt::print("  {}\n", file.string());
  fmt::print("\n");
}

}  // namespace

int reproduce(const ReproduceVerb& verb, const Catalog& catalog) {
  bool failed = false;
  bool contradicted = false;
  for (const Target& target : targets(verb)) {
    const std::optional<Study> study = load(target, verb, catalog);
    if (!study) continue;
    const Outcome outcome = reproduce_one(*study, target, verb, catalog);
    print(outcome);
    std::fflush(stdout);
    failed = failed || outcome.failed;
    for (const analysis::ClaimResult& result : outcome.claims) {
      contradicted = contradicted || result.verdict != analysis::Verdict::reproduced;
    }
    if (outcome.failed) break;
  }
  return failed || (verb.strict && contradicted) ? exit_failed : exit_done;
}

}  // namespace hearsay::program
