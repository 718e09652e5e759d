// hearsay agent, world, live: the same agents as processes of the operating system.
#include <fmt/core.h>
#include <unistd.h>

#include <cstdio>
#include <exception>

#include "net/live/port.hpp"
#include "tools/hearsay/one_run.hpp"
#include "tools/hearsay/run_output.hpp"
#include "tools/hearsay/verbs.hpp"
#include "tools/live/agent.hpp"
#include "tools/live/children.hpp"
#include "tools/live/world.hpp"

namespace hearsay::program {
namespace {

/// What agents tell each other past the world, no world can put in order.
void require_radio_fits(const LiveVerb& verb) {
  if (!verb.lockstep || verb.radio != "direct") return;
  throw InputError("--radio direct: not with --lockstep, which needs the world's radio");
}

Scenario scenario_of(const LiveVerb& verb, const Catalog& catalog) {
  std::vector<Override> overrides;
  for (const std::string& text : verb.set) overrides.push_back(parse_set(text));
  return load_scenario(verb.scenario, overrides, known_names(catalog));
}

std::shared_ptr<const PreparedScenario> prepared_of(const Scenario& scenario,
                                                    const Catalog& catalog) {
  LogCache logs;
  return prepare(scenario, catalog, logs);
}

/// In real time nobody can carry ledgers along.
Scenario as_it_is_lived(Scenario scenario, const LiveVerb& verb) {
  if (!verb.lockstep) scenario.record.ledger = "off";
  return scenario;
}

fleet::FleetOptions fleet_of(const LiveVerb& verb) {
  return {.fleet = verb.fleet, .interface = verb.interface, .domain = verb.domain};
}

/// Lines for whoever started this process, or for a person who looks on.
std::function<void(const std::string&)> status_printer(const LiveVerb& verb) {
  if (!verb.status && isatty(STDERR_FILENO) != 1) return [](const std::string&) {};
  return [child = verb.status](const std::string& text) {
    if (child) {
      fmt::print("{}{}\n", fleet::status_mark, text);
      std::fflush(stdout);
    } else {
      fmt::print(stderr, "\r\x1b[K{}", text);
    }
  };
}

void say_where_it_listens(const LiveVerb& verb) {
  if (verb.interface.empty()) return;
  fmt::print(stderr, "hearsay: fleet '{}' is open to whoever is on the network of interface '{}'\n",
             verb.fleet, verb.interface);
}

std::string version_text() { return "hearsay " + program_version(); }

void print_timing(const fleet::WorldResult& result, const LiveVerb& verb) {
  if (verb.lockstep || verb.digest || verb.json) return;
  fmt::print(
      "{} deadlines of {:g} ms missed, {} reports late, {} packets dropped as unsound or old\n",
      result.late, fleet::deadline_s * 1e3, result.silent, result.dropped);
}

}  // namespace

int live_world(const LiveVerb& verb, const Catalog& catalog) {
  require_radio_fits(verb);
  const Scenario as_given = scenario_of(verb, catalog);
  const Scenario scenario = as_it_is_lived(as_given, verb);
  const auto prepared = prepared_of(scenario, catalog);
  const std::uint64_t seed = verb.seed.value_or(scenario.seed);
  if (!verb.out.empty()) probe_output(verb.out);
  say_where_it_listens(verb);
  const fleet::WorldOptions options{.fleet = fleet_of(verb),
                                    .seed = seed,
                                    .lockstep = verb.lockstep,
                                    .speed = verb.speed,
                                    .patience_s = verb.patience_s,
                                    .scenario_hash = scenario_hash(as_given),
                                    .version = version_text()};
  fleet::WorldResult result = fleet::run_world(prepared, catalog, options, status_printer(verb));
  if (!result.trouble.empty()) {
    fmt::print(stderr, "hearsay world: {}\n", result.trouble);
    return exit_failed;
  }
  const FinishedRun finished{.run = std::move(result.run),
                             .end = result.end,
                             .digest = result.digest,
                             .wall_s = result.wall_s};
  const RunOutput output{
      .out = verb.out, .digest = verb.digest, .json = verb.json, .set = verb.set};
  const int code = show_run(output, scenario, seed, finished);
  print_timing(result, verb);
  return code;
}

int live_agent(const LiveVerb& verb, const Catalog& catalog) {
  const Scenario scenario = scenario_of(verb, catalog);
  const auto prepared = prepared_of(scenario, catalog);
  say_where_it_listens(verb);
  const fleet::AgentOptions options{.fleet = fleet_of(verb),
                                    .id = verb.agent,
                                    .direct = verb.radio == "direct",
                                    .patience_s = verb.patience_s,
                                    .memory = verb.memory,
                                    .scenario_hash = scenario_hash(scenario),
                                    .version = version_text()};
  const std::string trouble = fleet::run_agent(prepared, catalog, options, status_printer(verb));
  if (trouble.empty()) return exit_done;
  fmt::print(stderr, "hearsay agent {}: {}\n", verb.agent, trouble);
  return exit_failed;
}

int live_fleet(const LiveVerb& verb, const Catalog& catalog) {
  require_radio_fits(verb);
  // Told here, once, and not by each process.
  const Scenario scenario = scenario_of(verb, catalog);
  const auto prepared = prepared_of(scenario, catalog);
  if (!verb.out.empty()) probe_output(verb.out);
  fleet::FleetOptions options = fleet_of(verb);
  if (options.fleet.empty()) options.fleet = fmt::format("hearsay-{}", getpid());
  {
    const live::Port probe(
        {.fleet = options.fleet, .interface = options.interface, .domain = options.domain});
  }
  std::vector<std::string> common = {verb.scenario, "--status", "--fleet",
                                     options.fleet, "--domain", std::to_string(verb.domain),
                                     "--radio",     verb.radio};
  if (!verb.interface.empty()) common.insert(common.end(), {"--interface", verb.interface});
  for (const std::string& set : verb.set) common.insert(common.end(), {"--set", set});
  std::vector<fleet::ChildSpec> children(1 + prepared->specs.size());
  children[0] = {.name = "world", .arguments = {"world"}};
  std::vector<std::string>& world = children[0].arguments;
  world.insert(world.end(), common.begin(), common.end());
  if (verb.lockstep) world.push_back("--lockstep");
  if (!verb.lockstep) world.insert(world.end(), {"--speed", fmt::format("{}", verb.speed)});
  if (verb.seed) world.insert(world.end(), {"--seed", std::to_string(*verb.seed)});
  if (!verb.out.empty()) world.insert(world.end(), {"--out", verb.out});
  if (verb.digest) world.push_back("--digest");
  if (verb.json) world.push_back("--json");
  for (std::size_t i = 0; i < prepared->specs.size(); ++i) {
    children[i + 1] = {.name = prepared->names[i],
                       .arguments = {"agent", "--id", std::to_string(i)}};
    children[i + 1].arguments.insert(children[i + 1].arguments.end(), common.begin(), common.end());
  }
  const fleet::ChildrenResult result = fleet::run_children(children);
  for (const std::string& line : result.lines) fmt::print("{}\n", line);
  return result.code;
}

}  // namespace hearsay::program
