// How a run is shown and stored.
#include "tools/hearsay/run_output.hpp"

#include <fmt/core.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "sim/record/database.hpp"
#include "tools/hearsay/verbs.hpp"

namespace hearsay::program {
namespace {

const ScalarRow* find_scalar(const Record& record, AgentId agent, std::string_view name) {
  for (const ScalarRow& row : record.scalars()) {
    if (row.agent == agent && record.text(row.name) == name) return &row;
  }
  return nullptr;
}

std::string cell(const Record& record, AgentId agent, std::string_view name, int digits) {
  const ScalarRow* row = find_scalar(record, agent, name);
  if (row == nullptr || std::isnan(row->value)) return "-";
  return digits < 0 ? fmt::format("{}", row->value) : fmt::format("{:.{}g}", row->value, digits);
}

void print_table(const Record& record) {
  fmt::print("{:<14} {:<10} {:>12} {:>14} {:>12} {:>8} {:>10} {:>6}\n", "agent", "kind",
             "error [m]", "claimed σ [m]", "measurements", "fusions", "delivered", "lost");
  for (const AgentRow& agent : record.agents()) {
    const auto value = [&](std::string_view name, int digits) {
      return cell(record, agent.agent, name, digits);
    };
    fmt::print("{:<14} {:<10} {:>12} {:>13} {:>12} {:>8} {:>10} {:>6}\n", agent.name, agent.kind,
               value("distance_error_m", 4), value("final_claimed_sigma_m", 4),
               value("measurements", -1), value("fusions", -1), value("packets_delivered", -1),
               value("packets_lost", -1));
  }
}

void print_json(const FinishedRun& finished, std::uint64_t seed) {
  const Record& record = finished.run->record();
  nlohmann::ordered_json out;
  out["seed"] = seed;
  out["status"] = finished.end.ok() ? "ok" : "failed";
  out["reason"] = how_it_ended(finished.end);
  out["end_s"] = finished.end.at.seconds();
  out["events"] = finished.end.events;
  out["digest"] = finished.digest;
  for (const AgentRow& agent : record.agents()) {
    nlohmann::ordered_json entry = {
        {"id", agent.agent}, {"name", agent.name}, {"kind", agent.kind}};
    for (const ScalarRow& row : record.scalars()) {
      if (row.agent != agent.agent) continue;
      entry["scalars"][record.text(row.name)] =
          std::isfinite(row.value) ? nlohmann::ordered_json(row.value) : nlohmann::ordered_json();
    }
    out["agents"].push_back(entry);
  }
  fmt::print("{}\n", out.dump(2));
}

void store(const RunOutput& output, const Scenario& scenario, std::uint64_t seed,
           const FinishedRun& finished) {
  DatabaseWriter database(output.out);
  nlohmann::ordered_json parameters = nlohmann::ordered_json::object();
  for (const std::string& text : output.set) {
    const Override set = parse_set(text);
    parameters[set.key] = set.toml;
  }
  RunRow row;
  row.id = database.next_run_id();
  row.scenario = scenario.file.substr(scenario.file.find_last_of('/') + 1);
  row.parameters_json = parameters.dump();
  row.seed = seed;
  row.ok = finished.end.ok();
  row.reason = how_it_ended(finished.end);
  row.digest = finished.digest;
  row.config_hash = scenario_hash(scenario);
  row.wall_s = finished.wall_s;
  row.events = finished.end.events;
  row.version = program_version();
  database.add(row, finished.run->record());
  database.close();
}

}  // namespace

void probe_output(const std::string& file) { DatabaseWriter probe(file); }

int show_run(const RunOutput& output, const Scenario& scenario, std::uint64_t seed,
             const FinishedRun& finished) {
  if (!output.out.empty()) store(output, scenario, seed, finished);
  if (!finished.end.ok()) fmt::print(stderr, "hearsay: {}\n", how_it_ended(finished.end));
  if (output.json) {
    print_json(finished, seed);
  } else if (output.digest) {
    fmt::print("{}\n", finished.digest);
  } else {
    print_table(finished.run->record());
    fmt::print("\nseed {}: {} at {} s after {} events ({:.3f} s of wall time)\ndigest {}\n", seed,
               to_string(finished.end.reason), finished.end.at.seconds(), finished.end.events,
               finished.wall_s, finished.digest);
    if (!output.out.empty()) fmt::print("stored in {}\n", output.out);
  }
  return finished.end.ok() ? exit_done : exit_failed;
}

}  // namespace hearsay::program
